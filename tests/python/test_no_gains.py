"""Weights of LQR whose Riccati equation has no solution end a flight where they would command, with a cause of their own."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import detumble
from detumble.campaigns.result import CampaignResult
from detumble.errors import ScenarioError
from detumble.failures import NO_GAINS, cause
from detumble.scenario import Scenario
from detumble.scenario.faults import validated
from pages import call

CAUSE = str(cause(NO_GAINS))
DECADES = {"distribution": "log_uniform", "low": [1e-150] * 3, "high": [1e9] * 3}
"""Axis by axis: with products of inertia about a third of such draws has no solution."""
FULL = [[0.1, 0.01, 0.0], [0.01, 0.1, 0.003], [0.0, 0.003, 0.05]]
APART = {"q_error": [1e-148, 5e-81, 2e-75], "q_rate": [4e-86, 3e-68, 2e-16], "r": 1.0}
"""Has a solution about principal axes, and none about others."""


def scenario(*dispersed: str, **changes: Any) -> Scenario:
    """Give a flight of 4 s that is captured after 1 s, and stays within every threshold."""
    raw = detumble.load("paper").to_dict()
    raw["time"]["duration"] = 4.0
    raw["chaser"]["inertia"] = FULL
    raw["capture"] |= {"distance": 1e3, "angle_deg": 179.0, "rate": 10.0, "dwell": 1.0}
    raw["settled"] = {"angle_deg": 180.0, "rate": 10.0}
    raw["campaign"] = {"end": "duration"}
    lqr = raw["laws"]["lqr"]
    weights = {name: value if name == "r" else [value] * 3 for name, value in lqr["rotation"].items()}
    lqr["rotation"], lqr["stack"] = weights, {"rotation": dict(weights)}
    raw["dispersions"] = [{"field": field, **DECADES} for field in dispersed]
    for path, value in changes.items():
        section, _, name = path.partition("__")
        raw[section][name] = value
    return validated(raw, "weights far apart")


def flown(scenario: Scenario, out: Path) -> CampaignResult:
    return detumble.campaign(scenario, "lqr", runs=40, seed=1, out=out)


@pytest.mark.parametrize(("field", "time"), [("rotation", 0.0), ("stack.rotation", 1.0)])
def test_a_run_ends_where_it_would_be_commanded_and_its_replay_tells_the_same(
    field: str, time: float, tmp_path: Path
) -> None:
    result = flown(scenario(f"laws.lqr.{field}.q_error", f"laws.lqr.{field}.q_rate"), tmp_path)
    table = result.runs.to_polars()
    lost = table.filter(table["failure"] == CAUSE)
    assert 5 < lost.height < 35
    assert result.statistics.failures[CAUSE].count == lost.height
    assert set(lost["end_time_s"]) == {time}
    assert lost["diverged_time_s"].is_null().all()
    assert lost["capture_time_s"].to_list() == [None if field == "rotation" else 1.0] * lost.height
    assert lost["settling_time_s"].is_null().all()
    assert not lost["success"].any()
    assert set(table.filter(table["success"])["end_time_s"]) == {4.0}

    index = int(lost["index"][0])
    flight = result.replay(index)
    event = flight.event("no_gains")
    assert event is not None
    assert (event.time, event.details["cause"]) == (time, CAUSE)
    assert (flight.broken_off, flight.diverged) == (True, False)
    assert flight.history["time"][-1] == time
    assert all(np.isfinite(values).all() for values in flight.history.values())
    assert not flight.history["torque"][-1].any()
    assert flight.warnings == (f"broken off at {time:.10g} s: {CAUSE}", *flight.scenario.warnings)
    row = lost.row(0, named=True)
    assert {key: row[key] for key in ("delta_v_m_s", "capture_rate_rad_s", "final_rate_rad_s")} == {
        key: flight.metrics.to_json()[key] for key in ("delta_v_m_s", "capture_rate_rad_s", "final_rate_rad_s")
    }
    code, printed = call(["run", "--replay", f"{tmp_path}:{index}", "--out", str(tmp_path / "again")])
    assert code == 1
    assert CAUSE in printed


def test_the_stack_as_it_truly_is_may_have_no_gains_where_its_design_has(tmp_path: Path) -> None:
    told = scenario(chaser__inertia=[0.1, 0.1, 0.05], capture__transition="momentum_conserving")
    raw = told.to_dict()
    raw["belief"] = {"stack": "true"}
    raw["laws"]["lqr"]["stack"]["rotation"] = APART
    flight = detumble.simulate(validated(raw, "told"), "lqr")
    event = flight.event("no_gains")
    assert event is not None
    assert (event.time, flight.metrics.capture_time, flight.metrics.settled_tick) == (1.0, 1.0, None)
    again = detumble.replay_wrench(flight)
    assert all(np.array_equal(flight.history[name], again.history[name]) for name in flight.history)


def test_nominal_weights_without_a_solution_are_refused(tmp_path: Path) -> None:
    raw = scenario().to_dict()
    raw["laws"]["lqr"]["rotation"] = APART
    refused = validated(raw, "refused")
    for fly in (detumble.simulate, detumble.campaign):
        with pytest.raises(ScenarioError, match=r"laws\.lqr: the Riccati equation has no solution"):
            fly(refused, "lqr")
    refused.save(tmp_path / "refused.toml")
    code, printed = call(["run", str(tmp_path / "refused.toml"), "--law", "lqr"])
    assert (code, "Riccati" in printed) == (2, True)


def test_figures_are_drawn_of_the_runs_that_there_are(tmp_path: Path) -> None:
    field = "laws.lqr.rotation"
    chosen = scenario(f"{field}.q_error", f"{field}.q_rate")
    chosen.save(tmp_path / "s.toml")
    shared = ["campaign", str(tmp_path / "s.toml"), "--law", "lqr", "--seed", "1", "--json"]
    code, _ = call([*shared, "--runs", "40", "--figures", "--out", str(tmp_path / "some")])
    assert code == 0
    assert (tmp_path / "some" / "figures" / "envelope.png").exists()


def test_a_campaign_of_which_no_run_can_be_flown_fails_after_it_has_printed(tmp_path: Path) -> None:
    """The first run of some seed has no gains; of the nominal case nothing is known."""
    chosen = scenario("laws.lqr.rotation.q_error", "laws.lqr.rotation.q_rate")
    chosen.save(tmp_path / "s.toml")
    seed = next(seed for seed in range(30) if CAUSE in detumble.campaign(chosen, "lqr", 1, seed).statistics.failures)
    shared = ["campaign", str(tmp_path / "s.toml"), "--law", "lqr", "--json", "--figures"]
    code, printed = call([*shared, "--runs", "1", "--seed", str(seed), "--out", str(tmp_path / "one")])
    assert code == 1
    assert json.loads(printed[printed.index("{") : printed.rindex("}") + 1])["failures"] == {CAUSE: 1}


def test_a_flight_that_ends_at_capture_needs_no_gains_of_the_stack(tmp_path: Path) -> None:
    fields = ("laws.lqr.stack.rotation.q_error", "laws.lqr.stack.rotation.q_rate")
    result = flown(scenario(*fields, campaign__end="captured"), tmp_path)
    assert result.statistics.success.count == result.statistics.captured.count == 40
    table = flown(scenario(*fields), tmp_path / "longer").runs.to_polars()
    assert table.filter(table["failure"] == CAUSE)["final_rate_rad_s"].is_null().all()
