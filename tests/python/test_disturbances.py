"""Disturbances in a scenario: absent they change nothing, present they act on both bodies, may be dispersed, and stop bounds."""

from __future__ import annotations

import math

import numpy as np
import pytest

import detumble
from detumble.analysis.bounds.earliest import minimum_capture_time
from detumble.analysis.bounds.runs import capture_bounds
from detumble.analysis.comparing import Plan, compare
from detumble.analysis.comparing.report import text_of
from detumble.analysis.trials import Trials
from detumble.campaigns.runs.overlay import overlay
from detumble.errors import ScenarioError
from detumble.scenario import Scenario, from_toml, with_settings
from detumble.scenario.step import integration_step

QUIET = "sensors={}"
DRIFT = """
title = "side by side"
[time]
duration = {duration}
control_period = {period}
[orbit]
radius = 7071e3
[chaser]
mass = 9.0
inertia = [0.1, 0.1, 0.05]
position = [0.0, 0.0, 0.0]
[debris]
mass = 4.0
inertia = [0.05, 0.05, 0.08]
tumble_rate = [0.0, 0.0, 0.0]
[disturbances.constant]
"""


def drifting(loads: str, period: float = 1.0, periods: int = 100) -> Scenario:
    return from_toml(DRIFT.format(duration=period * periods, period=period) + loads)


def test_differential_drag_drifts_as_published() -> None:
    """x = 4 pi a/n^2 and y = -6 pi^2 a/n^2 after one orbit from rest, a along the track."""
    n = drifting("").orbit.mean_motion
    periods = 6000
    scenario = drifting(f"chaser_force = [0.0, {9.0 * 1e-8}, 0.0]", 2.0 * math.pi / n / periods, periods)
    end = detumble.simulate(scenario, "none").history["position"][-1]
    expected = [4.0 * math.pi * 1e-8 / n**2, -6.0 * math.pi**2 * 1e-8 / n**2, 0.0]
    np.testing.assert_allclose(end, expected, rtol=1e-9, atol=1e-9)


def test_the_same_acceleration_of_both_bodies_is_no_relative_motion() -> None:
    scenario = drifting("chaser_force = [0.009, -0.018, 0.027]\ndebris_force = [0.004, -0.008, 0.012]")
    assert np.abs(detumble.simulate(scenario, "none").history["position"]).max() < 1e-12


def test_a_torque_in_body_axes_spins_its_body_alone() -> None:
    scenario = drifting('axes = "body"\ndebris_torque = [0.0, 0.0, 8e-5]')
    history = detumble.simulate(scenario, "none").history
    np.testing.assert_allclose(history["debris_rate"][-1], [0.0, 0.0, 0.1], rtol=1e-12)
    assert not history["chaser_rate"].any()


def test_the_stack_carries_the_load_of_the_debris() -> None:
    """PD has no integral: a torque held in H turns the stack away until kp eps = tau, by an angle of 2 tau / kp.

    Undisturbed it rests at 2 kd n / kp about the same axis, as it brakes the turning of H.
    """
    loads = "disturbances.constant={debris_torque=[0.0, 0.0, 2e-5]}"
    paper = with_settings(
        detumble.load("paper"), ["time.duration=1000.0", "capture.transition=momentum_conserving", QUIET]
    )
    free, pushed = (detumble.simulate(one, "pd").metrics for one in (paper, with_settings(paper, [loads])))
    assert free.final_pointing is not None
    assert pushed.final_pointing is not None
    assert free.final_pointing == pytest.approx(2.0 * 0.08 * paper.orbit.mean_motion / 0.04, rel=1e-3)
    assert abs(pushed.final_pointing - free.final_pointing) == pytest.approx(2.0 * 2e-5 / 0.04, rel=1e-3)


def test_loads_are_dispersed_like_any_field() -> None:
    given = ["disturbances.constant={chaser_force=[0.0, 0.0, 0.0]}", "time.duration=30.0"]
    raw = with_settings(detumble.load("paper"), given).to_dict()
    raw["dispersions"] = [
        {"field": "disturbances.constant.chaser_force", "distribution": "normal", "sigma": 0.01},
    ]
    scenario = Scenario.model_validate(raw)
    result = detumble.campaign(scenario, "prrl", runs=8, seed=3)
    table = result.runs.to_polars()
    assert table["disturbances.constant.chaser_force.x"].n_unique() == 8
    assert table["delta_v_m_s"].n_unique() == 8
    drawn = {"disturbances.constant.chaser_force": np.ones((2, 3))}
    assert list(overlay(scenario, "prrl", drawn)) == ["disturbances.constant.chaser_force"]


def test_bounds_refuse_in_words() -> None:
    scenario = with_settings(detumble.load("paper"), ["disturbances.constant={chaser_force=[0.0, 0.001, 0.0]}"])
    for call in (detumble.bound, minimum_capture_time, lambda one: capture_bounds(Trials(one, 0, 0, 2))):
        with pytest.raises(
            ScenarioError, match=r"disturbances\.constant.*acts; bounds hold only where no disturbance does"
        ):
            call(scenario)


def test_a_comparison_goes_on_without_ratios() -> None:
    scenario = with_settings(
        detumble.load("paper"),
        ["disturbances.constant={chaser_force=[0.0, 0.001, 0.0]}", "time.duration=60.0", "campaign.hold=10.0"],
    )
    plan = Plan(as_given=True, runs=20, robust=0)
    compared = compare(scenario, plan=plan)
    assert "No ratios to bounds: disturbances act (constant)" in text_of(compared)
    assert compared.to_json()["entries"]


def test_disturbed_debris_is_integrated_even_if_it_is_a_symmetric_top() -> None:
    """Its rate counts among those met, and the step is chosen for it."""
    changes = [
        "debris.inertia=[0.05, 0.05, 0.08]", "debris.tumble_rate=[0.3, 0.2, 0.5]", "chaser.inertia=[0.1, 0.1, 0.1]",
        "capture.merge=false", "time.duration=600.0", "time.control_period=10.0", "time.integration_step=auto", QUIET,
    ]  # fmt: skip
    free = with_settings(detumble.load("paper"), changes)
    disturbed = with_settings(free, ["disturbances.gravity_gradient=true"])
    assert integration_step(disturbed) < integration_step(free)
    flight = detumble.simulate(disturbed, "none")
    fine = detumble.simulate(with_settings(disturbed, ["time.integration_step=0.01"]), "none")
    assert flight.metrics.largest_rate == pytest.approx(math.hypot(0.3, 0.2, 0.5), rel=1e-3)
    for name in ("debris_attitude", "debris_rate"):
        assert np.abs(flight.history[name] - fine.history[name]).max() < 1e-7
