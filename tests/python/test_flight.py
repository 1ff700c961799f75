"""A flight as Python gives it: dataset, events, file, repeatable by its recipe."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import detumble
from detumble.errors import RequestError
from detumble.scenario import Scenario, with_settings
from detumble.variables import VARIABLES

RUNAWAY = ["actuators.force_limit=inf", "laws.pd.translation={kp = 1e6, kd = 1e5}", "time.duration=60.0"]


def test_a_flight_is_a_dataset_with_units(short: Scenario) -> None:
    flight = detumble.simulate(short, law="prrl", seed=1)
    data = flight.data
    assert set(data.data_vars) == {variable.name for variable in VARIABLES}
    assert set(flight.history) == {"time", *data.data_vars}
    assert data.sizes == {"time": 601, "axis": 3, "quaternion": 4}
    for name in ("time", *data.data_vars):
        assert data[name].attrs["units"]
        assert data[name].attrs["long_name"]
    assert float(data.time[-1]) == pytest.approx(60.0)
    assert data.position.sel(axis="y").isel(time=0) == pytest.approx(short.chaser.position[1])


def test_events_agree_with_metrics_and_series(short: Scenario) -> None:
    flight = detumble.simulate(short, law="prrl")
    captured, settled = flight.event("captured"), flight.event("settled")
    assert captured is not None
    assert settled is not None
    assert captured.time == flight.metrics.capture_time
    assert settled.time == pytest.approx(captured.time + (flight.metrics.settling_time or 0.0))
    tick = int(np.argmax(flight.history["captured"]))
    assert flight.history["time"][tick] == pytest.approx(captured.time)
    assert captured.details["before"]["position"] == pytest.approx(flight.history["position"][tick])
    assert captured.details["stack_mass"] == pytest.approx(14.0)
    assert flight.warnings == ()


def test_the_same_recipe_gives_the_same_bits_and_another_seed_does_not(paper: Scenario) -> None:
    short = with_settings(paper, ["time.duration=30.0"])
    first, again, other = (detumble.simulate(short, seed=seed) for seed in (1, 1, 2))
    assert all(np.array_equal(first.history[name], again.history[name]) for name in first.history)
    assert not np.array_equal(first.history["position"], other.history["position"])
    assert not np.array_equal(first.history["position"], detumble.simulate(short, seed=1, index=1).history["position"])


def test_a_flight_comes_back_from_netcdf_and_can_be_flown_again(paper: Scenario, tmp_path: Path) -> None:
    short = with_settings(paper, ["time.duration=30.0"])
    flight = detumble.simulate(short, law="sosmc", seed=3)
    flight.to_netcdf(tmp_path / "flight.nc")
    back = detumble.read_netcdf(tmp_path / "flight.nc")
    assert back.data.identical(flight.data)
    assert (back.metrics, back.scenario, back.warnings) == (flight.metrics, flight.scenario, flight.warnings)
    assert back.events == flight.events
    again = detumble.simulate(back.scenario, back.law, back.seed, index=back.index, backend=back.backend)
    assert np.array_equal(again.history["torque"], flight.history["torque"])
    assert [path.name for path in tmp_path.iterdir()] == ["flight.nc"]


def test_what_is_no_flight_is_not_read(tmp_path: Path) -> None:
    (tmp_path / "x.nc").write_bytes(b"nothing")
    with pytest.raises(RequestError, match="cannot be read as NetCDF"):
        detumble.read_netcdf(tmp_path / "x.nc")
    with pytest.raises(RequestError, match="cannot be written"):
        detumble.simulate(with_settings(detumble.load("paper"), ["time.duration=1.0"])).to_netcdf(
            tmp_path / "no" / "x.nc"
        )


def test_editing_the_scenario_later_does_not_reach_the_flight(short: Scenario) -> None:
    scenario = short.model_copy(deep=True)
    flight = detumble.simulate(scenario)
    scenario.chaser.mass = 20.0
    assert flight.scenario.chaser.mass == 9.0


def test_a_start_inside_the_thresholds_is_a_capture_at_zero_with_a_warning(short: Scenario) -> None:
    inside = with_settings(short, ["capture.distance=100", "capture.angle_deg=180", "capture.rate=10"])
    flight = detumble.simulate(inside)
    assert flight.metrics.capture_time == 0.0
    assert "captured at t = 0" in flight.warnings[0]


def test_a_merge_is_recorded_in_lists_and_read_back_the_same(short: Scenario, tmp_path: Path) -> None:
    flight = detumble.simulate(short)
    flight.to_netcdf(tmp_path / "flight.nc")
    for told in (flight, detumble.read_netcdf(tmp_path / "flight.nc")):
        details = told.events[0].details
        assert details == flight.events[0].details
        for state in (details["before"], details["after"]):
            assert all(type(vector) is list for vector in state.values())
        assert [type(row) for row in details["stack_inertia"]] == [list] * 3


def test_a_body_that_turns_far_in_a_step_is_warned_of_with_a_step_that_would_do(short: Scenario) -> None:
    fast = with_settings(short, ["chaser.rate=[0,0,10]", "time.duration=1.0"])
    warning, hint = detumble.simulate(fast, law="none").warnings
    assert "if degrees were meant" in hint
    assert warning == (
        "a body turns at up to 10 rad/s, 0.5 rad in an integration step of 0.05 s: after 1 s its attitude may be off by "
        "more than can be estimated; with a step of 0.01 s it is off by less than 0.001 rad, and "
        'integration_step = "auto" aims at 1e-8 rad'
    )
    finer = with_settings(fast, ["time.integration_step=0.0099"])
    assert detumble.simulate(finer, law="none").warnings == (hint,)


def test_a_diverging_flight_is_reported_with_time_and_cause(paper: Scenario) -> None:
    flight = detumble.simulate(with_settings(paper, RUNAWAY), law="pd")
    event = flight.event("diverged")
    assert event is not None
    assert flight.diverged
    assert event.time == flight.metrics.diverged_time
    assert "last finite" in event.details["cause"]
    assert flight.history["time"][-1] < event.time
    for name in ("position", "velocity", "chaser_attitude", "chaser_rate"):
        assert np.isfinite(flight.history[name]).all()
    assert flight.warnings[0].startswith("diverged at ")


@pytest.mark.parametrize("seed", [-1, 2**64, 1.5, True, "1"])
def test_a_seed_is_a_whole_number(short: Scenario, seed: object) -> None:
    with pytest.raises(RequestError, match="must be a whole number from 0"):
        detumble.simulate(short, seed=seed)  # type: ignore[arg-type]  # that is the test


def test_an_unknown_back_end_is_refused(short: Scenario) -> None:
    with pytest.raises(RequestError, match=r"no back end 'portabel' on this machine; did you mean portable\?"):
        detumble.simulate(short, backend="portabel")
