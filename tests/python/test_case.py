"""The case that the core takes: resolved, in the core's own names."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from detumble.compiled import core
from detumble.errors import RequestError, ScenarioError
from detumble.scenario import Scenario, load, with_settings
from detumble.scenario.conversions import ticks
from detumble.scenario.core import case
from detumble.simulation import simulate

DATA = Path(__file__).parents[1] / "data"
FILES = ["paper", *sorted((DATA / "scenarios").glob("*.toml"))]


def listed(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: listed(element) for key, element in value.items()}
    return [listed(element) for element in value] if isinstance(value, list | tuple) else value


@pytest.mark.parametrize("source", FILES, ids=str)
def test_the_core_mirrors_the_model(source: str) -> None:
    """The core refuses names that it does not know, so equality here means that no field is lost on either side."""
    scenario = load(source)
    for law in (*scenario.laws.closed_loop, "none"):
        recipe = case(scenario, law)
        assert listed(core().echo(recipe)) == recipe


def test_defaults_and_beliefs_are_resolved(paper: Scenario) -> None:
    recipe = case(with_settings(paper, ["chaser.inertia=[[.1, .01, 0], [.01, .1, 0], [0, 0, .05]]"]), "prrl")
    assert recipe["orbit"]["mean_motion"] == pytest.approx(1.0618120e-3, rel=1e-7)
    assert recipe["belief"]["stack_mass"] == 14.0
    assert recipe["belief"]["stack_inertia"] == [[0.1 + 0.05, 0.01, 0], [0.01, 0.1 + 0.05, 0], [0, 0, 0.05 + 0.08]]
    assert recipe["capture"]["speed"] == math.inf
    assert recipe["goal"]["after_capture"] == recipe["goal"]["position"] == [0.0, 0.3, 0.0]
    assert recipe["actuators"]["force"] == [0.1, 0.1, 0.1]
    assert math.hypot(*recipe["start"]["debris_attitude"]) == pytest.approx(1.0, abs=1e-15)
    assert recipe["plan"]["periods"] == 6000
    believed = case(with_settings(paper, ["belief.stack_mass=20", "belief.chaser_inertia=[1, 2, 9]"]), "pd")["belief"]
    assert believed["stack_mass"] == 20.0
    assert believed["chaser_inertia"][2][2] == 9.0


def test_the_form_chooses_the_terminal_exponent(paper: Scenario) -> None:
    for form, exponent in (("printed", 5 / 3), ("corrected", 7 / 9)):
        law = case(with_settings(paper, [f"laws.tsmc.form={form}"]), "tsmc")["law"]
        assert law["before"]["rotation"]["exponent"] == exponent


def test_a_second_set_of_gains_is_for_the_stack_and_its_channel_alone(paper: Scenario) -> None:
    law = case(with_settings(paper, ["laws.prrl.stack={rotation = {slope=1, gain=2, layer=3}}"]), "prrl")["law"]
    assert law["after"]["rotation"] == {"slope": [1.0] * 3, "gain": [2.0] * 3, "layer": [3.0] * 3, "alpha": 0.7}
    assert law["after"]["translation"] == law["before"]["translation"]


def test_ticks_are_not_lost_or_won_by_rounding() -> None:
    assert [ticks(n * 0.1, 0.1) for n in range(200)] == list(range(200))
    assert [ticks(x, 0.1) for x in (0.0, 1e-3, 0.1000001, 1.1)] == [0, 1, 2, 11]


def test_a_step_divides_the_period_evenly(paper: Scenario) -> None:
    for step, count in ((0.1, 1), (0.05, 2), (0.06, 2), (0.03, 4), (0.1 / 3, 3), (0.01, 10)):
        plan = case(with_settings(paper, [f"time.integration_step={step!r}"]), "pd")["plan"]
        assert plan["steps_per_period"] == count


def test_open_loop_counts_segments_in_ticks_and_never_merges(paper: Scenario) -> None:
    segment = "laws.none.segments=[{start = 0.3, end = 1.1, frame = 'body', torque = [1, 2, 3]}]"
    recipe = case(with_settings(paper, [segment]), "none")
    expected = {"first_tick": 3, "end_tick": 11, "frame": "body", "force": [0.0] * 3, "torque": [1.0, 2.0, 3.0]}
    assert recipe["law"] == {"kind": "none", "segments": [expected]}
    assert recipe["plan"]["transition"] == "none"


def test_open_loop_that_outlasts_the_flight_acts_to_its_end(paper: Scenario) -> None:
    segment = "laws.none.segments=[{start = 1, end = 1e9, force = [1, 0, 0]}]"
    (flown,) = case(with_settings(paper, [segment]), "none")["law"]["segments"]
    assert (flown["first_tick"], flown["end_tick"]) == (10, 6001)


def test_a_law_without_gains_or_unknown_is_refused(paper: Scenario) -> None:
    paper.laws.pd = None
    with pytest.raises(ScenarioError, match=r"laws\.pd  missing; this scenario has gains for lqr, sosmc, tsmc, prrl"):
        case(paper, "pd")
    with pytest.raises(RequestError, match=r"law 'prl': must be one of pd, .*; did you mean prrl\?$"):
        case(paper, "prl")


def test_waits_longer_than_the_flight_are_never_over(paper: Scenario) -> None:
    settings = ["time.control_period=1e-3", "time.integration_step=1e-3", "time.duration=2", "capture.dwell=4.3e6"]
    chosen = with_settings(paper, [*settings, "campaign.hold=1e7"])
    plan = case(chosen, "prrl")["plan"]
    assert (plan["periods"], plan["dwell_ticks"], plan["hold_ticks"]) == (2000, 2001, 2001)
    assert simulate(chosen).metrics.capture_time is None


@pytest.mark.parametrize(
    "settings",
    [
        ["time.control_period=5e-324", "time.integration_step=5e-324"],
        ["laws.none.segments=[{start=0, end=1e308}]", "time.control_period=1e-3", "time.duration=2"],
    ],
    ids=str,
)
def test_ratios_of_times_too_large_for_a_number_are_refused(paper: Scenario, settings: list[str]) -> None:
    with pytest.raises(ScenarioError, match="whole number of control periods"):
        with_settings(paper, settings)
