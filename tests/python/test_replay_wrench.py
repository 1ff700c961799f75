"""The commands that a flight recorded give the same flight to the bit, without sensors and law."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import detumble
from detumble.compiled import core
from detumble.errors import RequestError
from detumble.flight import Flight
from detumble.scenario import LAWS, Scenario, with_settings
from pages import call

SEGMENTS = """laws.none.segments=[
    {start=1, end=4, frame="lvlh", force=[0.01,0,0], torque=[0,1e-4,0]},
    {start=4, end=8, frame="body", force=[0,0.02,0], torque=[1e-4,0,0]},
    {start=8, end=12, frame="command", force=[0,0,0.01], torque=[0,0,1e-4]},
    {start=12, end=15, frame="lvlh", force=[0.5,0,0]}]"""
CASES = {
    "approximate": ("paper", ["capture.transition=approximate"]),
    "conserving": ("paper", ["capture.transition=momentum_conserving", "actuators.saturation=scaled"]),
    "true stack": ("paper", ["capture.transition=momentum_conserving", "belief.stack=true"]),
    "grasp points": ("twelve_u", []),
    "two bodies": ("paper", ["capture.merge=false"]),
}


def same(one: Flight, other: Flight) -> bool:
    """Tell whether two flights are the same to the bit; NaN is NaN, and -0.0 is not 0.0."""
    series = all(one.history[name].tobytes() == other.history[name].tobytes() for name in one.history)
    return series and (one.metrics, one.events, one.warnings) == (other.metrics, other.events, other.warnings)


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("law", LAWS)
def test_a_closed_loop_flies_again(name: str, law: str) -> None:
    source, settings = CASES[name]
    flight = detumble.simulate(with_settings(detumble.load(source), ["time.duration=90.0", *settings]), law, seed=2)
    assert same(detumble.replay_wrench(flight), flight)


@pytest.mark.parametrize("backend", core().backends())
def test_on_every_back_end(paper: Scenario, backend: str) -> None:
    flight = detumble.simulate(with_settings(paper, ["time.duration=60.0"]), seed=2, backend=backend)
    again = detumble.replay_wrench(flight)
    assert again.backend == backend
    assert same(again, flight)


def test_open_loop_flies_again_in_the_axes_of_its_segments(paper: Scenario) -> None:
    flight = detumble.simulate(with_settings(paper, ["time.duration=20.0", " ".join(SEGMENTS.split("\n"))]), "none")
    assert same(detumble.replay_wrench(flight), flight)


def test_a_flight_that_diverged_flies_again_to_its_end(paper: Scenario) -> None:
    runaway = ["actuators.force_limit=inf", "laws.pd.translation={kp = 1e6, kd = 1e5}", "time.duration=60.0"]
    flight = detumble.simulate(with_settings(paper, runaway), "pd")
    assert flight.diverged
    assert same(detumble.replay_wrench(flight), flight)


def test_a_file_is_flown_again_from_the_command_line(paper: Scenario, tmp_path: Path) -> None:
    flight = detumble.simulate(with_settings(paper, ["time.duration=60.0"]), "tsmc", seed=4, index=3)
    flight.to_netcdf(tmp_path / "flight.nc")
    assert same(detumble.replay_wrench(tmp_path / "flight.nc"), flight)
    option = ["run", "--replay-wrench", str(tmp_path / "flight.nc")]
    code, printed = call([*option, "--json", "--out", str(tmp_path / "again")])
    told: dict[str, Any] = json.loads(printed[printed.index("{") : printed.rindex("}") + 1])
    assert code == 0
    assert (told["law"], told["seed"], told["index"]) == ("tsmc", 4, 3)
    assert told["capture_time_s"] == flight.metrics.capture_time
    assert same(detumble.read_netcdf(tmp_path / "again" / "flight.nc"), flight)
    for more in (["--seed", "1"], ["--law", "pd"], ["--set", "chaser.mass=12"], ["--index", "2"]):
        code, printed = call([*option, *more])
        assert (code, printed.strip()) == (
            2,
            "--replay-wrench: flies a flight as it was; neither law nor seed nor field can be set",
        )
    for more in (["paper"], ["--replay", "folder:1"]):
        code, printed = call([*option, *more])
        assert code == 2
        assert "needs one of a scenario, --replay DIR:INDEX and --replay-wrench FLIGHT.nc" in printed
    code, printed = call(["run", "--replay-wrench", str(tmp_path / "none.nc")])
    assert (code, "cannot be read as NetCDF" in printed) == (2, True)


def test_another_scenario_meets_the_same_commands(paper: Scenario) -> None:
    """Twice the force gain on half the force: what is flown again are commands, not what the actuators gave."""
    flight = detumble.simulate(with_settings(paper, ["time.duration=5.0"]))
    weak = with_settings(flight.scenario, ["actuators.force_gain=0.5"])
    again = detumble.replay_wrench(replace(flight, scenario=weak))
    assert np.array_equal(again.history["force_command"], flight.history["force_command"])
    assert again.history["force"] == pytest.approx(0.5 * flight.history["force"])


def test_a_flight_without_a_tick_is_refused(paper: Scenario) -> None:
    flight = detumble.simulate(with_settings(paper, ["time.duration=1.0"]))
    empty = replace(flight, history={name: values[:0] for name, values in flight.history.items()})
    with pytest.raises(RequestError, match="holds no tick"):
        detumble.replay_wrench(empty)


def test_the_command_frame_is_force_in_lvlh_and_torque_in_the_body(paper: Scenario) -> None:
    """Where the chaser is turned against H, each part does what its own frame does alone."""
    turned = with_settings(paper, ["time.duration=20.0", "chaser.attitude=[0.8,0.6,0,0]", "chaser.rate=[0,0,0]"])

    def flown(frame: str, wrench: str) -> Flight:
        segment = f'laws.none.segments=[{{start=0, end=20, frame="{frame}", {wrench}}}]'
        return detumble.simulate(with_settings(turned, [segment]), "none")

    both = flown("command", "force=[0.01,0.02,0], torque=[1e-4,0,2e-4]")
    pushed, spun = flown("lvlh", "force=[0.01,0.02,0]"), flown("body", "torque=[1e-4,0,2e-4]")
    assert np.array_equal(both.history["position"], pushed.history["position"])
    assert both.history["chaser_rate"] == pytest.approx(spun.history["chaser_rate"], abs=1e-15)
    assert both.history["chaser_attitude"] == pytest.approx(spun.history["chaser_attitude"], abs=1e-14)
    assert np.abs(both.history["chaser_rate"][-1]).max() > 0.01


def test_what_is_not_flown_of_an_open_loop_is_reported(paper: Scenario) -> None:
    segments = "laws.none.segments=[{start=0, end=5, force=[0.5,0,0]}, {start=5, end=30, torque=[0,0,0.02]}]"
    flight = detumble.simulate(
        with_settings(paper, ["time.duration=20.0", "time.integration_step=0.01", segments]), "none"
    )
    assert flight.warnings == (
        "the force commanded is over actuators.force_limit for 25 % of the time, and cut to it",
        "the torque commanded is over actuators.torque_limit for 75 % of the time, and cut to it",
        "laws.none.segments[1] ends at 30 s, after the flight (20 s): the rest is not flown",
    )
