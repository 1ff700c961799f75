"""What a campaign draws: the values of the dispersed fields, run by run, and any run as a scenario of its own."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from detumble.compiled import core
from detumble.scenario.core import design
from detumble.scenario.dispersions.fitting import members, resolved
from detumble.scenario.faults import validated
from detumble.scenario.rules import active
from detumble.scenario.step import integration_step
from detumble.scenario.tables import body_rules

if TYPE_CHECKING:
    from detumble.scenario.model import Scenario


def spec(scenario: Scenario) -> dict[str, Any]:
    """Give all that is dispersed as the core takes it.

    Args:
        scenario: the nominal case with its dispersions.

    Returns:
        Nested dicts and lists, in the units of the fields, nothing left to default.

    Raises:
        ScenarioError: the scenario contradicts itself.
    """
    scenario.check()
    resolved_all: list[dict[str, Any]] = []
    named: dict[str, tuple[int, int]] = {}
    for number, dispersion in enumerate(scenario.dispersions):
        aim, one = resolved(dispersion, scenario.at)
        resolved_all.append(one)
        named |= members(number, dispersion, aim)
    return {"dispersions": resolved_all, "correlations": [group.resolved(named) for group in scenario.correlations]}


def draw(scenario: Scenario, seed: int, first: int, count: int) -> dict[str, NDArray[np.float64]]:
    """Draw the dispersed fields of runs `first` to `first + count - 1`.

    A run's values depend on the seed, its index and the field's own distribution (and group of correlations) alone.

    Args:
        scenario: the nominal case with its dispersions.
        seed: of the campaign, 0 to 2^64 - 1.
        first: index of the first run.
        count: number of runs.

    Returns:
        By path, in the order of the file and the unit of the field: shape (count,), or (count, 3) for a vector, (count, 4)
        for an attitude (unit quaternion, scalar first and not negative), (count, 6) for an inertia (xx, yy, zz, xy, xz, yz).

    Raises:
        ScenarioError: the scenario contradicts itself.
    """
    drawn: dict[str, NDArray[np.float64]] = core().draw(spec(scenario), seed, first, count)
    return drawn


def drawn_scenario(scenario: Scenario, seed: int, index: int) -> Scenario:
    """Give one run of a campaign as a scenario without dispersions.

    The integration step is written as the number that the campaign flies. What the laws believe stays the nominal design:
    beliefs that the file leaves to default are written out where the bodies behind them are dispersed.

    Args:
        scenario: the nominal case with its dispersions.
        seed: of the campaign.
        index: of the run.

    Raises:
        ScenarioError: the scenario contradicts itself.
    """
    drawn = draw(scenario, seed, index, 1)
    raw = scenario.to_dict()
    del raw["dispersions"], raw["correlations"]
    if scenario.time.integration_step == "auto":
        raw["time"]["integration_step"] = integration_step(scenario)
    for rules in body_rules().values():
        own, rule = rules[0], active(rules, scenario.at)
        if rule.design and own.permitted(scenario.at) and not drawn.keys().isdisjoint(rule.of):
            _put(raw, own.of[0], design(own.of[0], scenario.at))
    for path, values in drawn.items():
        _put(raw, path, _value(values[0]))
    return validated(raw, f"{scenario.title}, run {index}")


def _put(raw: dict[str, Any], path: str, value: Any) -> None:
    *tables, name = path.split(".")
    for table in tables:
        raw = raw[table]
    raw[name] = value


def _value(row: Any) -> Any:
    if np.size(row) == 6:
        xx, yy, zz, xy, xz, yz = row.tolist()
        return [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    return row.tolist()
