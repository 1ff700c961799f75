"""The largest rate of the bodies that are integrated, and what is said of it."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import detumble
from detumble.flight import Flight
from detumble.scenario import Scenario, with_settings
from pages import call

TRIAXIAL = "debris.inertia=[0.05,0.06,0.08]"


def largest(flight: Flight, *names: str) -> float:
    return max(float(np.linalg.norm(flight.history[name], axis=1).max()) for name in names)


def test_it_is_that_of_chaser_stack_and_integrated_debris(short: Scenario) -> None:
    closed = detumble.simulate(with_settings(short, ["debris.tumble_rate=[0,0.3,0.8]", "time.duration=5.0"]), law="pd")
    assert closed.metrics.largest_rate == pytest.approx(largest(closed, "chaser_rate"), rel=1e-15)
    assert largest(closed, "debris_rate") > largest(closed, "chaser_rate")
    stepped = detumble.simulate(
        with_settings(short, ["debris.tumble_rate=[0,0.3,0.8]", "time.duration=5.0", TRIAXIAL]), law="pd"
    )
    assert stepped.metrics.largest_rate == pytest.approx(largest(stepped, "chaser_rate", "debris_rate"), rel=1e-15)
    merged = detumble.simulate(with_settings(short, ["capture.transition=momentum_conserving"]))
    assert merged.metrics.capture_time is not None
    assert merged.metrics.largest_rate == pytest.approx(largest(merged, "chaser_rate"), rel=1e-15)


def test_debris_in_closed_form_is_not_warned_of(short: Scenario) -> None:
    fast = with_settings(short, ["debris.tumble_rate=[0,0,10]", "time.duration=1.0"])
    assert detumble.simulate(fast, law="none").warnings == fast.warnings
    warning, *_ = detumble.simulate(with_settings(fast, [TRIAXIAL]), law="none").warnings
    assert warning.startswith("a body turns at up to 10 rad/s, 0.5 rad in an integration step of 0.05 s")


def test_a_flight_that_diverges_of_its_turn_says_so(paper: Scenario) -> None:
    """Debris that tumbles about its middle axis at 200 rad/s: ten radians a step."""
    settings = [TRIAXIAL, "debris.tumble_rate=[60,60,60]", "time.duration=600.0", "laws.pd.rotation.kd=1e3"]
    flight = detumble.simulate(with_settings(paper, [*settings, "actuators.torque_limit=inf"]), law="pd")
    event = flight.event("diverged")
    assert event is not None
    assert event.details["cause"].startswith("a body turned ")
    assert "rad in an integration step of 0.05 s, too far for its rotation to be integrated" in event.details["cause"]
    assert [warning.split(" ")[0] for warning in flight.warnings] == ["diverged", "a", "debris.tumble_rate:"]


def test_a_campaign_warns_of_fast_turns_and_of_starts_inside(short: Scenario, tmp_path: Path) -> None:
    settings = [
        "time.duration=2.0", "debris.inertia=[0.05,0.06,0.08]", "capture.angle_deg=180", "capture.distance=1e3",
        'dispersions=[{field="debris.tumble_rate", distribution="direction", low=1.0, high=3.0}]',
    ]  # fmt: skip
    fast = detumble.campaign(with_settings(short, settings), runs=50, seed=1, out=tmp_path / "fast")
    table = fast.runs.to_polars()
    count = int((table["largest_rate_rad_s"] * 0.05 > 0.1).sum())
    assert 10 < count < 50
    assert fast.statistics.fast_turns == count
    warning, hint = fast.warnings
    assert hint.startswith("debris.tumble_rate: draws reach 3 rad/s is 171.9 °/s")
    assert warning.startswith(f"in {count} of 50 runs a body turns at up to ")
    assert detumble.read_campaign(tmp_path / "fast").warnings == fast.warnings

    chosen = with_settings(short, [*settings, "capture.rate=2.0"])
    some = detumble.campaign(chosen, runs=50, seed=1)
    at_once = int((some.runs.to_polars()["capture_time_s"] == 0.0).sum())
    assert 5 < at_once < 45
    assert (
        some.warnings[0] == f"the start is already inside every threshold: captured at t = 0, in {at_once} of 50 runs"
    )

    with_settings(short, [*settings, "capture.rate=10"]).save(tmp_path / "inside.toml")
    code, printed = call(
        ["campaign", str(tmp_path / "inside.toml"), "--runs", "20", "--json", "--out", str(tmp_path / "in")]
    )
    told = json.loads(printed[printed.index("{") : printed.rindex("}") + 1])
    assert code == 0
    assert told["warnings"][0] == "the start is already inside every threshold: captured at t = 0, in every run"
    assert all(f"warning: {warning}" in printed for warning in told["warnings"])


def test_a_campaign_that_diverges_in_every_run_fails(paper: Scenario, tmp_path: Path) -> None:
    runaway = ["actuators.force_limit=inf", "laws.pd.translation={kp = 1e6, kd = 1e5}", "time.duration=30.0"]
    arguments = ["campaign", "paper", *runaway, "--law", "pd", "--runs", "5", "--out", str(tmp_path / "out")]
    code, printed = call(arguments)
    assert code == 1
    assert "diverged" in printed
