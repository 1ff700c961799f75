"""All rules from fields to numbers of the core, collected from where they are declared.

Numbers are declared on the fields (`Quantity.place`), gains by the laws' classes, clocks and switches in
`detumble.scenario.plan`.
"""

from __future__ import annotations

from functools import cache
from itertools import chain
from typing import TYPE_CHECKING, Any, get_origin

from detumble.scenario.laws import CHANNELS, LAWS, REGISTER
from detumble.scenario.laws.base import gains_of_section
from detumble.scenario.quantity import Quantity
from detumble.scenario.reflection import quantity_of, section_of
from detumble.scenario.rules import Rule, Table, constant

if TYPE_CHECKING:
    from collections.abc import Iterator

    from pydantic.fields import FieldInfo

    from detumble.scenario.section import Section


@cache
def leaves() -> dict[str, FieldInfo]:
    """Give every field of a scenario that is no table, by its dotted path, in the order of the file; lists are left out."""
    from detumble.scenario.model import Scenario

    return dict(_leaves(Scenario, ""))


def _leaves(section: type[Section], path: str) -> Iterator[tuple[str, FieldInfo]]:
    for name, field in section.model_fields.items():
        inner = section_of(field.annotation)
        if inner is None:
            yield path + name, field
        elif get_origin(field.annotation) is not list:
            yield from _leaves(inner, f"{path}{name}.")


@cache
def quantities() -> dict[str, Quantity]:
    """Give every quantity of a scenario by its dotted path, in the order of the file; those within lists are left out."""
    found = {path: quantity_of(field) for path, field in leaves().items()}
    return {path: quantity for path, quantity in found.items() if quantity is not None}


@cache
def body_rules() -> Table:
    """Give the rules of all numbers but the law's gains: of each field with a place in the core."""
    table: dict[str, tuple[Rule, ...]] = {}
    for path, quantity in quantities().items():
        if quantity.place is not None:
            table[quantity.place.path] = quantity.place.rules(path, quantity.conversion)
    return table


@cache
def law_rules(law: str) -> Table:
    """Give the rules of a law's gains, before and after capture.

    A stack's channel without gains of its own keeps those of before; a gain that a channel may leave to the law is the law's.

    Args:
        law: one of `LAWS`; `none` has no gains.
    """
    if law == "none":
        return {}
    section = REGISTER[law]
    table: Table = {}
    shared = gains_of_section(section)
    for channel in CHANNELS:
        gains, own, stack = section.channel(channel), f"laws.{law}.{channel}", f"laws.{law}.stack.{channel}"
        phases: dict[str, list[tuple[str, tuple[tuple[str, Any], ...]]]]
        phases = {"before": [(own, ())], "after": [(stack, ()), (own, ((stack, None),))]}
        for phase, sources in phases.items():
            for name, gain in gains.gains().items():
                rules = [Rule(gain.conversion, (f"{source}.{name}",), when) for source, when in sources]
                rules += [Rule(gain.conversion, (f"laws.{law}.{name}",))] if name in shared else []
                table[f"law.{phase}.{channel}.{name}"] = tuple(rules)
            for by_form in gains.by_form:
                table[f"law.{phase}.{channel}.{by_form.name}"] = tuple(
                    Rule(
                        "ratio",
                        tuple(f"{source}.{name}" for name in fraction.fields),
                        ((f"laws.{law}.form", form), *when),
                    )
                    for form, fraction in by_form.fractions.items()
                    for source, when in sources
                )
    return table


def law_words(law: str) -> Table:
    """Give the rules of a law's kind, and of its form where it has that option."""
    forms = law != "none" and REGISTER[law].forms()
    table: Table = {"law.kind": (constant(law),)}
    return table | {"law.form": (Rule("word", (f"laws.{law}.form",)),)} if forms else table


@cache
def readers() -> dict[str, list[tuple[Rule, ...]]]:
    """Give the rules of every number that a field may become part of, by the path of the field."""
    found: dict[str, list[tuple[Rule, ...]]] = {}
    for rules in chain(body_rules().values(), *(law_rules(law).values() for law in LAWS)):
        for path in dict.fromkeys(path for rule in rules for path in rule.of):
            found.setdefault(path, []).append(rules)
    return found
