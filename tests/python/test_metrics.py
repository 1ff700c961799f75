"""Known answers for each metric: flights whose every number can be written down by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

import detumble
from detumble.flight import Flight
from detumble.metrics import METRICS, Metrics
from detumble.scenario import Scenario, with_settings


@pytest.fixture(scope="module")
def open_loop(short: Scenario) -> Flight:
    """Ten seconds: 2 s of force along x, then 3 s of three axes and a torque; limits 0.1 N, 0.01 N m."""
    segments = """laws.none.segments=[
        {start = 0, end = 2, force = [0.05, 0, 0]},
        {start = 2, end = 5, force = [-0.2, 0.04, 0.02], torque = [0.02, -0.005, 0]}]"""
    scenario = with_settings(short, ["time.duration=10.0", " ".join(segments.split("\n"))])
    return detumble.simulate(scenario, law="none")


def test_impulse_is_the_integral_of_what_was_flown(open_loop: Flight) -> None:
    metrics = open_loop.metrics
    by_axis = (0.05 * 2 + 0.1 * 3, 0.04 * 3, 0.02 * 3)
    assert metrics.impulse_axes == pytest.approx(by_axis)
    assert metrics.impulse == pytest.approx(sum(by_axis))
    assert metrics.delta_v_axes == pytest.approx(tuple(part / 9.0 for part in by_axis))
    assert metrics.delta_v == pytest.approx(sum(by_axis) / 9.0)
    assert metrics.torque_impulse_axes == pytest.approx((0.03, 0.015, 0.0))
    assert metrics.torque_impulse == pytest.approx(0.045)


def test_peaks_tell_asked_from_flown(open_loop: Flight) -> None:
    metrics = open_loop.metrics
    assert (metrics.peak_force_command, metrics.peak_force) == (0.2, 0.1)
    assert (metrics.peak_torque_command, metrics.peak_torque) == (0.02, 0.01)


def test_saturated_share_counts_time_over_a_limit(open_loop: Flight) -> None:
    assert open_loop.metrics.force_saturated_share == pytest.approx(0.3)
    assert open_loop.metrics.torque_saturated_share == pytest.approx(0.3)


def test_chattering_is_total_variation_per_second(open_loop: Flight) -> None:
    # what is asked for: on at 0 is no change; 0.05 -> -0.2 and two axes on; all three off
    assert open_loop.metrics.force_chattering == pytest.approx((0.25 + 0.04 + 0.02 + 0.2 + 0.04 + 0.02) / 10.0)
    assert open_loop.metrics.torque_chattering == pytest.approx(2 * (0.02 + 0.005) / 10.0)


def test_what_did_not_happen_is_none(open_loop: Flight) -> None:
    metrics = open_loop.metrics
    assert metrics.capture_time is metrics.settling_time is metrics.diverged_time is metrics.capture_rate is None
    assert metrics.final_rate is metrics.delta_v_to_capture is metrics.momentum_at_capture is None


def test_capture_is_at_the_first_tick_inside(short: Scenario) -> None:
    """Drift along y at 0.05 m/s from 1 m, a goal far off the gradient: inside 0.5 m after 10 s, within HCW's small bend."""
    settings = [
        "chaser.position=[0, 1, 0]", "chaser.velocity=[0, -0.05, 0]", "debris.tumble_rate=[0, 0, 0.02]",
        "chaser.rate=[0, 0, 0.05]", "debris.attitude=[1, 0, 0, 0]", "chaser.attitude=[1, 0, 0, 0]",
        "goal.position=[0, 0, 0]", "capture.angle_deg=179", "capture.merge=false", "time.duration=20.0",
    ]  # fmt: skip
    flight = detumble.simulate(with_settings(short, settings), law="none")
    metrics, distance = flight.metrics, flight.history["distance"]
    first = int(np.argmax(distance < 0.5))
    assert metrics.capture_time == pytest.approx(flight.history["time"][first])
    assert metrics.capture_time == pytest.approx(10.0, abs=0.2)
    assert metrics.capture_distance == pytest.approx(distance[first], rel=1e-12)
    assert metrics.capture_rate == pytest.approx(0.03, rel=1e-9)
    assert metrics.capture_angle == pytest.approx(0.03 * metrics.capture_time, rel=1e-9)
    assert metrics.capture_speed == pytest.approx(np.linalg.norm(flight.history["velocity"][first]), rel=1e-12)
    assert metrics.delta_v_to_capture == 0.0


def test_settling_counts_from_capture_to_the_last_entry(short: Scenario) -> None:
    flight = detumble.simulate(short, law="prrl")
    metrics, history = flight.metrics, flight.history
    inside = (history["angle_error"] < math.radians(5.0)) & (history["rate_error"] < 0.005)
    first = len(inside) - int(np.argmin(inside[::-1]))
    assert metrics.capture_time is not None
    assert metrics.settling_time == pytest.approx(history["time"][first] - metrics.capture_time)
    assert metrics.final_rate == pytest.approx(history["rate_error"][-1], rel=1e-9)
    assert metrics.final_pointing == pytest.approx(history["angle_error"][-1], rel=1e-9)


def test_momentum_is_that_of_the_stack(short: Scenario) -> None:
    flight = detumble.simulate(short, law="prrl")
    event = flight.event("captured")
    assert event is not None
    inertia = np.array(event.details["stack_inertia"])
    assert flight.metrics.momentum_at_capture == pytest.approx(np.linalg.norm(inertia @ event.details["after"]["rate"]))
    final = np.linalg.norm(inertia @ flight.history["chaser_rate"][-1])
    assert flight.metrics.final_momentum == pytest.approx(final, rel=1e-9)


def test_each_metric_has_a_card_and_a_name_with_its_unit(open_loop: Flight) -> None:
    stored = open_loop.metrics.to_json()
    assert list(stored) == [metric.key for metric in METRICS]
    assert {"capture_time_s", "settling_time_s", "delta_v_m_s", "final_pointing_rad"} <= set(stored)
    assert all(metric.definition and metric.label for metric in METRICS)
    assert Metrics.from_json(stored) == open_loop.metrics
