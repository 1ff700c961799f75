"""The flights of a campaign: flown again to the bit, ended early without a trace, failed for the reason that is given."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm

import detumble
from detumble.campaigns.columns import SCALARS
from detumble.campaigns.result import CampaignResult, read_campaign
from detumble.campaigns.store.shard import digest
from detumble.compiled import core
from detumble.errors import RequestError
from detumble.failures import CAUSES
from detumble.flight import Flight
from detumble.scenario import Scenario
from detumble.scenario.faults import validated
from uncertain import flown, rows_digest, uncertain

LAWS = ("pd", "prrl", "none")


def ending(how: str, **more: Any) -> Scenario:
    """Give the uncertain scenario with another way to end."""
    scenario = uncertain()
    scenario.campaign.end = how  # type: ignore[assignment]
    for name, value in more.items():
        setattr(scenario.campaign, name, value)
    return scenario


@pytest.fixture(scope="module")
def campaigns(tmp_path_factory: pytest.TempPathFactory) -> dict[str, CampaignResult]:
    folder = tmp_path_factory.mktemp("campaigns")
    return {law: flown(folder / law, law) for law in LAWS}


# --- flown again -------------------------------------------------------------------------------------------------------


def assorted(result: CampaignResult, each: int = 3) -> list[int]:
    """Choose some runs of every kind: each cause of failure, success, ended early and not."""
    table = result.runs.to_polars()
    kinds = table.with_columns(early=table["end_time_s"] < 60.0).group_by("failure", "early", maintain_order=True)
    return [index for _, kind in kinds for index in kind["index"].head(each).to_list()]


@pytest.mark.parametrize("law", LAWS)
def test_a_run_flown_again_has_every_bit_of_its_row(campaigns: dict[str, CampaignResult], law: str) -> None:
    result = campaigns[law]
    table = result.runs.to_polars()
    chosen = assorted(result)
    assert len(chosen) >= {"pd": 20, "prrl": 4, "none": 4}[law]
    for index in chosen:
        row = table.row(index, named=True)
        flight = result.replay(index)
        found = flight.metrics.to_json()
        assert {metric.key: found[metric.key] for metric in SCALARS} == {m.key: row[m.key] for m in SCALARS}
        assert (flight.seed, flight.index, flight.law) == (3, index, law)
        if not flight.diverged:
            assert flight.history["time"][-1] == row["end_time_s"]
        for name in ("chaser.mass", "laws.pd.translation.kp"):
            assert flight.scenario.at(name) == row[name]
        assert flight.history["position"][0].tolist() == [row[f"chaser.position.{axis}"] for axis in "xyz"]
        assert flight.scenario.dispersions == []


def test_a_replay_is_the_same_from_the_folder_and_on_every_wide_back_end(campaigns: dict[str, CampaignResult]) -> None:
    result = campaigns["pd"]
    again = read_campaign(result.folder)
    for index in assorted(result, each=1):
        one = result.replay(index)
        for other in (again.replay(index), *(again.replay(index, backend=name) for name in core().backends()[1:])):
            assert repr(other.metrics) == repr(one.metrics)
            assert all(one.history[name].tobytes() == other.history[name].tobytes() for name in one.history)


@pytest.mark.parametrize("backend", core().backends())
def test_whatever_flew_a_run_it_is_flown_again_to_the_bit(tmp_path: Path, backend: str) -> None:
    flown(tmp_path, runs=20, backend=backend)
    result = read_campaign(tmp_path)
    rows = result.runs.to_polars()
    for index in range(20):
        flight, row = result.replay(index), rows.row(index, named=True)
        found = flight.metrics.to_json()
        assert {metric.key: found[metric.key] for metric in SCALARS} == {m.key: row[m.key] for m in SCALARS}
        assert (flight.backend == "portable") == (backend == "portable")


@pytest.mark.parametrize("index", [-1, 400])
def test_a_run_that_the_campaign_does_not_have_cannot_be_flown_again(
    campaigns: dict[str, CampaignResult], index: int
) -> None:
    with pytest.raises(RequestError, match=f"run {index}: the campaign has runs 0 to 399"):
        campaigns["pd"].replay(index)


# --- ended early -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("law", ["pd", "prrl"])
def test_a_flight_ended_when_settled_is_the_beginning_of_the_whole_one(
    campaigns: dict[str, CampaignResult], tmp_path: Path, law: str
) -> None:
    early, whole = campaigns[law], detumble.campaign(ending("duration"), law, 400, 3, tmp_path)
    first, last = (result.runs.to_polars() for result in (early, whole))
    assert (last["end_time_s"] == 60.0).all()
    for name in ("capture_time_s", "settling_time_s", "failure", "diverged_time_s", "delta_v_to_capture_m_s"):
        assert first[name].equals(last[name], null_equal=True), name
    ended = first.filter(first["end_time_s"] < 60.0)
    settled = ended.filter(ended["success"])
    assert len(settled) > 30
    waited = settled["end_time_s"] - settled["capture_time_s"] - settled["settling_time_s"]
    assert (waited - 5.0).abs().max() < 1e-9
    diverged = ended.filter(~ended["success"])
    assert (diverged["end_time_s"] == diverged["diverged_time_s"]).all()
    for index in (*settled["index"].head(5), *diverged["index"].head(2), *(i for i in assorted(early, 1))):
        short, long = early.replay(index).history, whole.replay(index).history
        for name, series in short.items():
            assert series.tobytes() == long[name][: len(series)].tobytes(), name


def test_the_hold_is_how_long_a_stack_must_have_been_settled(tmp_path: Path) -> None:
    at_once = detumble.campaign(ending("settled", hold=0.0), "prrl", 50, 3, tmp_path / "0").runs.to_polars()
    later = detumble.campaign(ending("settled", hold=7.25), "prrl", 50, 3, tmp_path / "7").runs.to_polars()
    for rows, hold in ((at_once, 0.0), (later, 7.3)):
        rows = rows.filter(rows["end_time_s"] < 60.0)
        waited = rows["end_time_s"] - rows["capture_time_s"] - rows["settling_time_s"]
        assert len(rows) > 40
        assert (waited - hold).abs().max() < 1e-9


def test_a_flight_ended_at_capture_has_succeeded_then(campaigns: dict[str, CampaignResult], tmp_path: Path) -> None:
    result = detumble.campaign(ending("captured"), "pd", 400, 3, tmp_path)
    rows, whole = result.runs.to_polars(), campaigns["pd"].runs.to_polars()
    captured = rows.filter(rows["capture_time_s"].is_not_null())
    assert len(captured) > 60
    assert captured["success"].all()
    assert (captured["end_time_s"] == captured["capture_time_s"]).all()
    assert rows["capture_time_s"].equals(whole["capture_time_s"], null_equal=True)
    assert result.statistics.success.count == result.statistics.captured.count == len(captured)
    index = captured["index"][0]
    short, long = result.replay(index), campaigns["pd"].replay(index)
    assert short.history["position"].tobytes() == long.history["position"][: len(short.history["time"])].tobytes()
    assert short.history["captured"].tolist() == [0.0] * (len(short.history["time"]) - 1) + [1.0]


def test_bodies_that_do_not_merge_are_done_at_capture(tmp_path: Path) -> None:
    scenario = ending("settled")
    scenario.capture.merge = False
    rows = detumble.campaign(scenario, "prrl", 100, 3, tmp_path).runs.to_polars()
    assert rows["success"].sum() > 90
    assert rows.filter(rows["success"])["end_time_s"].equals(rows.filter(rows["success"])["capture_time_s"])
    assert rows["settling_time_s"].is_null().all()


def test_lanes_are_busy_though_flights_are_of_unequal_length(tmp_path: Path) -> None:
    scenario = ending("captured")
    scenario.time.duration = 30.0
    result = detumble.campaign(scenario, "prrl", 20_000, 3, tmp_path / "full", threads=2)
    ticks = result.runs.to_polars()["end_time_s"].to_numpy() * 10.0 + 1.0
    assert ticks.max() > 4.0 * ticks.min()
    assert result.effort.ticks == round(ticks.sum())
    assert result.effort.to_json()["lane_use"] > 0.9
    alone = detumble.campaign(scenario, "prrl", 2_000, 3, tmp_path / "alone", threads=1, shard=70)
    assert rows_digest(alone) == digest(result.runs.to_polars().head(2_000))


# --- failed ------------------------------------------------------------------------------------------------------------

STILL = {"attitude": [1.0, 0.0, 0.0, 0.0], "rate": [0.0, 0.0, 0.0]}


def drifting(position: list[float], velocity: list[float], spin: float = 0.0, turned: float = 0.0) -> dict[str, Any]:
    """Give a flight without forces, in which debris turned by an angle about z spins about z."""
    half = 0.5 * turned
    raw = uncertain().to_dict()
    raw["chaser"] |= {"position": position, "velocity": velocity, **STILL}
    raw["debris"] |= {"attitude": [math.cos(half), 0.0, 0.0, math.sin(half)], "tumble_rate": [0.0, 0.0, spin]}
    raw["goal"] = {"position": [0.0, 0.3, 0.0]}
    raw["capture"] = {"distance": 0.5, "angle_deg": 20.0, "rate": 0.05, "speed": 0.08, "dwell": 0.0}
    raw["dispersions"] = []
    raw["laws"]["none"] = {"segments": []}
    return raw


def with_dwell(raw: dict[str, Any]) -> dict[str, Any]:
    raw["capture"] |= {"distance": 0.1, "dwell": 5.0}
    return raw


GOAL, AT_REST = [0.0, 0.3, 0.0], [0.0, 0.0, 0.0]
FAILING = {
    "never captured: distance": drifting([0.0, 10.0, 0.0], AT_REST),
    "never captured: angle": drifting(GOAL, AT_REST, turned=1.5),
    "never captured: rate": drifting(GOAL, AT_REST, spin=0.3),
    "never captured: speed": drifting(GOAL, [0.0, 0.0, 0.2]),
    "never captured: distance + angle": drifting([0.0, -10.0, 0.0], AT_REST, turned=1.5),
    "never captured: angle + rate": drifting(GOAL, AT_REST, spin=0.06, turned=0.4),
    "never captured: distance + angle + rate + speed": drifting([0.0, 99.0, 0.0], [0.0, 0.0, 0.5], 0.06, 0.4),
    # 30 s until it is near, by when the debris, aligned at first, has turned by 1.2 rad
    "never captured: not all at once": drifting([0.0, 0.3, 2.0], [0.0, 0.0, -0.05], spin=0.04),
    # 2.9 s within 0.1 m of the goal
    "never captured: dwell": with_dwell(drifting([0.0, 0.3, 2.0], [0.0, 0.0, -0.07])),
}


@pytest.mark.parametrize("cause", FAILING)
def test_what_was_missing_is_named(cause: str, tmp_path: Path) -> None:
    result = detumble.campaign(validated(FAILING[cause], cause), "none", 10, 0, tmp_path)
    assert cause in CAUSES
    assert result.runs.to_polars()["failure"].to_list() == [cause] * 10
    assert result.to_json()["failures"] == {cause: 10}
    assert (result.statistics.success.count, result.statistics.captured.count) == (0, 0)


def test_a_flight_that_misses_nothing_is_captured(tmp_path: Path) -> None:
    result = detumble.campaign(validated(drifting(GOAL, AT_REST), "near"), "none", 10, 0, tmp_path)
    assert result.statistics.success.count == result.statistics.captured.count == 10
    assert result.runs.to_polars()["failure"].is_null().all()


def test_a_stack_that_does_not_settle_and_a_state_that_leaves_the_numbers_are_named(tmp_path: Path) -> None:
    raw = uncertain().to_dict()
    raw["dispersions"] = []
    restless = raw | {"settled": {"angle_deg": 1e-6, "rate": 1e-9}}
    result = detumble.campaign(validated(restless, "restless"), "prrl", 10, 0, tmp_path / "restless")
    assert result.to_json()["failures"] == {"captured, not settled": 10}
    assert result.statistics.captured.count == 10
    raw["laws"]["pd"]["translation"]["kp"] = 1e5  # kp T² / m > 4: each tick overshoots by more than it started with
    result = detumble.campaign(validated(raw, "wild"), "pd", 10, 0, tmp_path / "wild")
    assert result.to_json()["failures"] == {"diverged": 10}
    assert result.runs.to_polars()["end_time_s"].max() < 60.0


def causes_of(flight: Flight, scenario: Scenario) -> set[str]:
    """Give the thresholds that never held in the history of a flight that was not captured."""
    held = {
        "distance": flight.history["distance"] < scenario.capture.distance,
        "angle": flight.history["angle_error"] < math.radians(scenario.capture.angle_deg),
        "rate": flight.history["rate_error"] < scenario.capture.rate,
        "speed": flight.history["speed_error"] < (scenario.capture.speed or math.inf),
    }
    missed = {name for name, when in held.items() if not when.any()}
    if missed:
        return missed
    return {"dwell"} if np.logical_and.reduce(list(held.values())).any() else {"not all at once"}


def test_causes_are_those_that_the_histories_show(campaigns: dict[str, CampaignResult]) -> None:
    result = campaigns["pd"]
    failures = result.runs.to_polars()["failure"].to_list()
    lost = [i for i in range(400) if failures[i] and failures[i].startswith("never captured: ")][:60]
    assert len({failures[i] for i in lost}) >= 5
    for index in lost:
        told = set(failures[index].removeprefix("never captured: ").split(" + "))
        assert causes_of(result.replay(index), uncertain()) == told, index


# --- thrust ------------------------------------------------------------------------------------------------------------


def test_force_and_torque_act_as_their_gains_say(tmp_path: Path) -> None:
    """Open loop: Δv = g F t / m, spin = g τ t / I about a principal axis, motion as the HCW equations answer a constant force."""
    raw = drifting([0.0, 5.0, 0.0], AT_REST)
    force, torque, seconds, mass, spin_inertia = np.array([0.004, -0.02, 0.01]), 1e-4, 50.0, 9.0, 0.05
    raw["laws"]["none"] = {
        "segments": [{"start": 0, "end": seconds, "force": force.tolist(), "torque": [0, 0, torque]}]
    }
    raw["time"] = {"duration": seconds, "control_period": 0.1, "integration_step": 0.1}
    raw["dispersions"] = [
        {"field": f"actuators.{name}_gain", "distribution": "uniform", "low": 0.5, "high": 1.5}
        for name in ("force", "torque")
    ]
    scenario = validated(raw, "pushed")
    assert raw["chaser"]["mass"] == mass
    assert raw["chaser"]["inertia"][2] == spin_inertia
    result = detumble.campaign(scenario, "none", 100, 0, tmp_path)
    rows = result.runs.to_polars()
    gain, turn = rows["actuators.force_gain"].to_numpy(), rows["actuators.torque_gain"].to_numpy()
    assert gain.std() > 0.2
    np.testing.assert_allclose(rows["delta_v_m_s"], gain * np.abs(force).sum() * seconds / mass, rtol=1e-12)
    np.testing.assert_allclose(rows["impulse_n_s"], gain * np.abs(force).sum() * seconds, rtol=1e-12)
    np.testing.assert_allclose(rows["torque_impulse_n_m_s"], turn * torque * seconds, rtol=1e-12)
    np.testing.assert_allclose(rows["peak_force_n"], gain * 0.02, rtol=1e-12)
    assert rows["peak_force_command_n"].n_unique() == 1

    n = scenario.orbit.mean_motion
    system = np.zeros((7, 7))
    system[0:3, 3:6] = np.eye(3)
    system[3, [0, 4]], system[4, 3], system[5, 2] = (3 * n * n, 2 * n), -2 * n, -n * n
    for index in range(5):
        flight = result.replay(index)
        system[3:6, 6] = gain[index] * force / mass
        end = expm(system * seconds) @ [0.0, 5.0, 0.0, 0.0, 0.0, 0.0, 1.0]
        np.testing.assert_allclose(flight.history["position"][-1], end[0:3], rtol=0, atol=1e-10)
        np.testing.assert_allclose(flight.history["velocity"][-1], end[3:6], rtol=0, atol=1e-12)
        spun = turn[index] * torque * seconds / spin_inertia
        np.testing.assert_allclose(flight.history["chaser_rate"][-1], [0.0, 0.0, spun], rtol=0, atol=1e-12)


def test_a_gain_acts_on_what_the_limit_leaves(tmp_path: Path) -> None:
    raw = drifting([0.0, 5.0, 0.0], AT_REST)
    raw["actuators"] |= {"force_limit": 0.1}
    raw["laws"]["none"] = {"segments": [{"start": 0, "end": 60, "force": [0.3, 0.05, 0.0]}]}
    raw["dispersions"] = [{"field": "actuators.force_gain", "distribution": "uniform", "low": 0.5, "high": 1.5}]
    rows = detumble.campaign(validated(raw, "limited"), "none", 20, 0, tmp_path).runs.to_polars()
    np.testing.assert_allclose(rows["impulse_n_s"], rows["actuators.force_gain"] * 0.15 * 60.0, rtol=1e-12)
    assert rows["force_saturated_share"].to_list() == [1.0] * 20
