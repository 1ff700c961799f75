"""The scenario as the core takes it: plain numbers, everything resolved, nothing left to default.

What becomes what is declared (`detumble.scenario.tables`); here are the loops over these declarations.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from detumble.checking import choice
from detumble.errors import Fault, ScenarioError
from detumble.scenario import conversions
from detumble.scenario.laws import LAWS
from detumble.scenario.plan import PLAN, SEGMENT
from detumble.scenario.rules import active
from detumble.scenario.step import integration_step
from detumble.scenario.tables import body_rules, law_rules, law_words, quantities

if TYPE_CHECKING:
    from collections.abc import Callable

    from detumble.scenario.conversions import Array
    from detumble.scenario.laws import Segment
    from detumble.scenario.model import Scenario
    from detumble.scenario.rules import At, Rule

Tree = dict[str, Any]


def case(scenario: Scenario, law: str, *, until_the_end: bool = True) -> Tree:
    """Give everything that the core needs for one flight.

    Args:
        scenario: what is flown; checked here once more as a whole.
        law: one of `LAWS`, or `none` for open loop.
        until_the_end: fly the whole duration, whatever the scenario says of the flights of its campaigns.

    Returns:
        Nested dicts of floats, ints, bools and lists, SI, quaternions normalised, inertias 3x3.

    Raises:
        RequestError: there is no such law.
        ScenarioError: the scenario contradicts itself, or has no gains for the law.
    """
    choice("law", law, LAWS, {"none": "for open loop"})
    scenario.check()
    _check_gains(scenario, law)
    tree: Tree = {}
    for path, rules in (body_rules() | law_rules(law)).items():
        _put(tree, path, _plain(converted(active(rules, scenario.at), scenario.at)))
    _put_plan(tree, scenario, law, until_the_end)
    return tree


def _check_gains(scenario: Scenario, law: str) -> None:
    if law != "none" and getattr(scenario.laws, law) is None:
        given = ", ".join(scenario.laws.closed_loop) or "no law"
        raise ScenarioError(scenario.title, [Fault(f"laws.{law}", f"missing; this scenario has gains for {given}")])


def _put_plan(tree: Tree, scenario: Scenario, law: str, until_the_end: bool) -> None:
    """Write the plan, the law's kind and form, and the open-loop segments."""
    asked = {
        "flight.law": law,
        "flight.whole": until_the_end,
        "time.integration_step": integration_step(scenario),
    }

    def at(path: str) -> Any:
        return asked[path] if path in asked else scenario.at(path)

    for path, rules in (PLAN | law_words(law)).items():
        _put(tree, path, _word(rules, at))
    if law == "none":
        segments = scenario.laws.none.segments if scenario.laws.none else []
        tree["law"]["segments"] = [
            {key: _word(rules, partial(_in_segment, segment, at)) for key, rules in SEGMENT.items()}
            for segment in segments
        ]


def _in_segment(segment: Segment, at: At, path: str) -> Any:
    section, _, name = path.partition(".")
    return getattr(segment, name) if section == "segment" else at(path)


def converted(rule: Rule, at: At, column: Callable[[str], Array | None] = lambda _: None) -> Array:
    """Give what a rule makes of the values of its fields.

    Args:
        rule: that applies.
        at: gives the scenario's values by path.
        column: gives the draws of a field by path, (n, k); None where the scenario's own value holds.

    Returns:
        Shape (k,), or (n, k) if one of the fields is drawn.
    """
    values = []
    for path in rule.of:
        drawn = column(path)
        values.append(np.array(quantities()[path].numbers(at(path))) if drawn is None else drawn)
    return conversions.NUMBERS[rule.conversion](*values)


def design(path: str, at: At) -> Any:
    """Give what stands for a field that is absent and follows from the nominal bodies, as beliefs do; None for other fields.

    Args:
        path: of the scenario: `belief.stack_mass`.
        at: gives the scenario's values by path.

    Returns:
        In the unit of the field; an inertia as a 3x3 list.
    """
    place = quantities()[path].place
    rule = next((rule for rule in place.otherwise if rule.design), None) if place else None
    return None if rule is None else _plain(converted(rule, at))


def _word(rules: tuple[Rule, ...], at: At) -> Any:
    rule = active(rules, at)
    if rule.constant is not None:
        return rule.constant
    value = conversions.PLAN[rule.conversion](*map(at, rule.of))
    return list(value) if isinstance(value, tuple) else value


def _plain(numbers: Array) -> Any:
    """Give one number as a float, a vector as a list, nine numbers as the rows of a matrix."""
    if numbers.size == 1:
        return float(numbers[0])
    return (numbers.reshape(3, 3) if numbers.size == 9 else numbers).tolist()


def _put(tree: Tree, path: str, value: Any) -> None:
    *steps, name = path.split(".")
    for step in steps:
        tree = tree.setdefault(step, {})
    tree[name] = value
