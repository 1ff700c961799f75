"""What is drawn reaches the core: every field, under every law, as the number that the drawn scenario would give."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache
from typing import Any

import numpy as np
import pytest

import detumble
from detumble.campaigns.columns import RESULTS, SCALARS
from detumble.campaigns.recipe import Recipe
from detumble.campaigns.runs.draws import draw, drawn_scenario
from detumble.campaigns.runs.flying import fly_runs
from detumble.campaigns.runs.overlay import overlay
from detumble.compiled import core
from detumble.scenario import LAWS, Scenario
from detumble.scenario.core import case
from detumble.scenario.dispersions.fitting import fields
from detumble.scenario.faults import validated
from detumble.scenario.laws import REGISTER
from detumble.scenario.quantity import Quantity

ALL_LAWS = (*LAWS, "none")
SEED = 5
RUNS = 2
MANY = 16
UNLESS_GIVEN = ("orbit.altitude", "orbit.earth_radius", "orbit.radius", "goal.position")
"""Stand instead of one another, or need one another: each is in one of the two scenarios."""


def maximal(**changes: Any) -> Scenario:
    """Give a flight of 3 s with a field of every kind, in which everything matters.

    It starts within the thresholds and is captured after 1 s; the stack then flies gains of its own.
    """
    raw = detumble.load("paper").to_dict()
    raw["time"] = {"duration": 3.0, "control_period": 0.1, "integration_step": 0.1}
    raw["chaser"] |= {"position": [0.15, 0.4, -0.1], "velocity": [0.01, -0.02, 0.015], "rate": [0.01, -0.01, 0.02]}
    raw["debris"] |= {"attitude": [0.99, 0.1, 0.05, -0.086], "tumble_rate": [0.02, 0.015, -0.01]}
    raw["chaser"] |= {"attitude": [1.0, 0.0, 0.0, 0.0]}
    raw["goal"] = {"position": [0.0, 0.3, 0.0], "position_after_capture": [0.0, 0.2, 0.1]}
    raw["capture"] = {"distance": 0.4, "angle_deg": 30.0, "rate": 0.06, "speed": 0.05, "dwell": 1.0}
    raw["capture"] |= {"transition": "momentum_conserving"}
    raw["settled"] = {"angle_deg": 30.0, "rate": 0.06}
    raw["actuators"] = {"force_limit": [0.02, 0.015, 0.01], "torque_limit": [5e-3, 5e-3, 1e-3]}
    raw["sensors"] = {f"{name}_sigma": 1e-3 for name in ("position", "velocity", "attitude", "rate")}
    raw["disturbances"] = {
        "gravity_gradient": True,
        "constant": {"axes": "body"}
        | {f"{body}_force": [2e-3, -1e-3, 1e-3] for body in ("chaser", "debris")}
        | {f"{body}_torque": [2e-4, -1e-4, 1e-4] for body in ("chaser", "debris")},
    }
    for law in LAWS:
        gains = raw["laws"][law]
        if REGISTER[law].forms():
            gains["form"] = "corrected"
        if "layer" in gains["rotation"]:
            gains["rotation"]["layer"] = 0.2
        gains["stack"] = {channel: dict(gains[channel]) for channel in ("translation", "rotation")}
    raw["laws"]["none"] = {"segments": [{"start": 0.5, "end": 2.0, "force": [0.01, 0.02, 0.0], "torque": [0, 1e-4, 0]}]}
    for path, value in changes.items():
        section, _, name = path.partition("__")
        raw[section] = {**raw[section], name: value} if name else value
    return validated(raw, "maximal")


@cache
def scenarios() -> dict[str, Scenario]:
    grasping = {"chaser__grasp_point": [-0.1, 0.02, 0.01], "debris__grasp_point": [0.1, 0.2, -0.04]}
    after = {"position_after_capture": [0.0, 0.2, 0.1], "acceleration_feedforward": True}
    told = {"belief": {"stack": "true"}, "orbit": {"radius": 7071e3}}
    return {
        "fixed goal": maximal(),
        "grasp points": maximal(**grasping, goal=after, **told),
        "own powers": with_own_powers(maximal()),
    }


def with_own_powers(scenario: Scenario) -> Scenario:
    """Give PRRL-SMC an alpha in every channel of both sets, beside the one that they would share."""
    gains = scenario.laws.prrl
    assert gains is not None
    assert gains.stack is not None
    for number, channel in enumerate(
        (gains.translation, gains.rotation, gains.stack.translation, gains.stack.rotation)
    ):
        assert channel is not None
        channel.alpha = 0.6 + 0.05 * number
    return scenario


def spread(path: str, quantity: Quantity, nominal: Any) -> dict[str, Any]:
    """Disperse a field so far that it matters."""
    if quantity.shape == "quaternion":
        return {"field": path, "distribution": "attitude", "sigma": 0.05}
    if quantity.shape == "inertia":
        return {"field": path, "distribution": "inertia", "relative": 0.05, "axes_sigma": 0.05}
    if path.startswith(("capture.", "settled.")):
        return {"field": path, "distribution": "uniform", "low": 0.01 * nominal, "high": 1.5 * nominal}
    if path.endswith(".alpha"):
        return {"field": path, "distribution": "uniform", "low": 0.5, "high": 0.9}
    values = np.atleast_1d(nominal)
    width = 0.1 * np.abs(values).max()
    low, high = ((values + sign * width * 0.5).tolist() for sign in (-1, 1))
    single = len(values) == 1
    return {"field": path, "distribution": "uniform"} | (
        {"low": low[0], "high": high[0]} if single else {"low": low, "high": high}
    )


def dispersed(scenario: Scenario, *paths: str) -> Scenario:
    """Give a scenario with these fields dispersed; beliefs left to default are spread about the design."""
    design = case(scenario, "pd")["belief"]
    raw = scenario.to_dict()
    raw["dispersions"] = []
    for path in paths:
        nominal = scenario.at(path)
        nominal = design[path.rpartition(".")[2]] if nominal is None else nominal
        raw["dispersions"].append(spread(path, fields()[path], nominal))
    return validated(raw, "maximal")


def present(scenario: Scenario) -> list[str]:
    """Name the fields that a scenario has."""
    told = scenario.belief.stack == "true"
    beliefs = [path for path in fields() if path.startswith("belief.") and not (told and "stack" in path)]
    given = [path for path in fields() if scenario.at(path) is not None or path in beliefs]
    return [path for path in given if not refused(scenario, path)]


def refused(scenario: Scenario, path: str) -> bool:
    """Tell whether nothing depends on a field, whatever the law: it cannot be dispersed."""
    if path == "laws.prrl.alpha":  # where each channel has one of its own
        return all(scenario.at(f"laws.prrl.{table}rotation.alpha") is not None for table in ("", "stack."))
    return path == "orbit.earth_radius" and scenario.orbit.radius is not None


EVERY = [("fixed goal", path) for path in present(scenarios()["fixed goal"])]
EVERY += [("own powers", path) for path in present(scenarios()["own powers"]) if path.endswith(".alpha")]
EVERY += [("grasp points", path) for path in present(scenarios()["grasp points"]) if not path.startswith("laws.")]


def flat(value: Any, path: str = "") -> Iterator[tuple[str, float]]:
    """Give the numbers of a case one by one: `chaser.inertia[1][2]`."""
    if isinstance(value, dict):
        for name, inner in value.items():
            yield from flat(inner, f"{path}.{name}" if path else name)
    elif isinstance(value, list):
        for place, inner in enumerate(value):
            yield from flat(inner, f"{path}[{place}]")
    else:
        yield path, value


def overlaid(nominal: dict[str, Any], columns: dict[str, Any], run: int) -> dict[str, Any]:
    """Give the numbers of a run: those of the nominal case with its rows of the columns written over them."""
    numbers = dict(flat(nominal))
    for path, values in columns.items():
        places = [place for place in numbers if place == path or place.startswith(f"{path}[")]
        assert len(places) == values.shape[1], path
        numbers |= dict(zip(places, values[run].tolist(), strict=True))
    return numbers


def test_every_field_is_in_one_of_the_scenarios() -> None:
    found = {path for _, path in EVERY}
    assert found == set(fields())
    assert len(found) > 80
    for path in found - set(UNLESS_GIVEN) - {"belief.stack_mass", "belief.stack_inertia"}:
        assert ("fixed goal", path) in EVERY or path.endswith(("grasp_point", ".alpha")), path


@pytest.mark.parametrize(("name", "path"), EVERY, ids=lambda value: value.replace(" ", "-"))
def test_the_numbers_of_a_run_are_those_of_its_scenario_and_it_flies_by_them(name: str, path: str) -> None:
    """Bit by bit: the numbers under every law, and the run's results against one flight of the drawn scenario's case."""
    nominal = scenarios()[name]
    scenario = dispersed(nominal, path)
    drawn = draw(scenario, SEED, 0, RUNS)
    runs = [drawn_scenario(scenario, SEED, index) for index in range(RUNS)]
    owner = path.split(".")[1] if path.startswith("laws.") else None
    for law in ALL_LAWS if owner is None else (owner, "none"):
        columns = overlay(scenario, law, drawn)
        given = case(scenario, law, until_the_end=False)
        assert bool(columns) == (owner in (None, law)), law
        recipe = Recipe(scenario.to_toml(), law, SEED, arithmetic="portable")
        flown = fly_runs(recipe, 0, RUNS).columns
        for index, run in enumerate(runs):
            expected = case(run, law, until_the_end=False)
            numbers, wanted = overlaid(given, columns, index), dict(flat(expected))
            if scenario.belief.stack == "true":  # then nobody asks what the stack was designed to be
                for place in [place for place in wanted if place.startswith("belief.stack_")]:
                    numbers[place] = wanted[place]
            assert numbers == wanted, law
            assert (numbers != dict(flat(given))) == bool(columns), law
            alone = core().fly(expected, seed=SEED, index=index, backend="portable", differing=list(columns))["summary"]
            for metric in SCALARS:
                found = float(alone[metric.name])
                assert found == flown[metric.key][index] or (math.isnan(found) and math.isnan(flown[metric.key][index]))


@pytest.mark.parametrize("name", scenarios())
def test_every_field_makes_a_difference_under_a_law_that_knows_it(name: str) -> None:
    scenario = scenarios()[name]

    def results(scenario: Scenario, law: str) -> bytes:
        columns = fly_runs(Recipe(scenario.to_toml(), law, SEED), 0, MANY).columns
        numbers = [np.asarray(columns[result.name], float) for result in RESULTS if result.name != "failure"]
        return np.array(numbers).tobytes()

    undisturbed = {law: results(scenario, law) for law in LAWS}
    for path in present(scenario):
        changed = dispersed(scenario, path)
        owner = path.split(".")[1] if path.startswith("laws.") else None
        moved = {law for law in LAWS if owner in (None, law) and results(changed, law) != undisturbed[law]}
        if path.startswith(("settled.", "actuators.")):  # not every law ends near a threshold, or meets a limit
            assert moved, path
        elif path.startswith("belief."):
            assert {"sosmc", "tsmc", "prrl"} <= moved, path
        else:
            assert moved == ({owner} if owner else set(LAWS)), path


def test_many_dispersed_fields_at_once_keep_their_places() -> None:
    for scenario in scenarios().values():
        together = dispersed(scenario, *present(scenario))
        drawn = draw(together, SEED, 0, RUNS)
        for law in ALL_LAWS:
            columns = overlay(together, law, drawn)
            given = case(together, law, until_the_end=False)
            for index in range(RUNS):
                wanted = dict(flat(case(drawn_scenario(together, SEED, index), law, until_the_end=False)))
                numbers = overlaid(given, columns, index)
                if together.belief.stack == "true":
                    numbers |= {place: wanted[place] for place in wanted if place.startswith("belief.stack_")}
                assert numbers == wanted, law


def test_what_nothing_depends_on_is_refused() -> None:
    for name, path in (("grasp points", "orbit.earth_radius"), ("own powers", "laws.prrl.alpha")):
        assert refused(scenarios()[name], path)
        with pytest.raises(detumble.ScenarioError, match="does nothing"):
            dispersed(scenarios()[name], path)


@pytest.mark.parametrize("own", [True, False])
def test_a_drawn_goal_is_the_stacks_too_unless_it_has_its_own(own: bool) -> None:
    goal = {"position": [0.0, 0.3, 0.0]} | ({"position_after_capture": [0.0, 0.2, 0.1]} if own else {})
    scenario = dispersed(maximal(goal=goal), "goal.position")
    columns = overlay(scenario, "pd", draw(scenario, SEED, 0, RUNS))
    assert set(columns) == {"goal.position"} | (set() if own else {"goal.after_capture"})
    for index in range(RUNS):
        wanted = case(drawn_scenario(scenario, SEED, index), "pd", until_the_end=False)
        assert overlaid(case(scenario, "pd", until_the_end=False), columns, index) == dict(flat(wanted))


@pytest.mark.parametrize("channels", [(), ("rotation",), ("translation", "rotation")])
def test_gains_reach_the_stack_unless_it_has_its_own(channels: tuple[str, ...]) -> None:
    raw = maximal().to_dict()
    raw["laws"]["prrl"]["stack"] = {channel: raw["laws"]["prrl"][channel] for channel in channels}
    scenario = dispersed(
        validated(raw, "maximal"), "laws.prrl.rotation.gain", "laws.prrl.translation.slope", "laws.prrl.alpha"
    )
    columns = overlay(scenario, "prrl", draw(scenario, SEED, 0, RUNS))
    both = {"translation.slope": "translation", "rotation.gain": "rotation"}
    expected = {f"law.{phase}.{channel}.alpha" for phase in ("before", "after") for channel in set(both.values())}
    expected |= {f"law.before.{gain}" for gain in both}
    expected |= {f"law.after.{gain}" for gain, channel in both.items() if channel not in channels}
    assert set(columns) == expected
