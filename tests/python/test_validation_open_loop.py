"""Validation: open-loop segments against SciPy's DOP853 on equations written here, and the order of convergence.

The reference flies thirteen states of a chaser with products of inertia that spins at half a radian per second, about
an LVLH frame that is inclined at the start, segment by segment at rtol 1e-13.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

import detumble
from detumble.flight import Flight
from detumble.scenario import Scenario, with_settings

Array = NDArray[np.float64]
Segment = tuple[float, float, str, Sequence[float], Sequence[float]]

INERTIA = np.array([[0.1, 0.012, -0.007], [0.012, 0.09, 0.005], [-0.007, 0.005, 0.06]])
DEBRIS_INERTIA = np.array([[0.05, -0.006, 0.004], [-0.006, 0.055, 0.008], [0.004, 0.008, 0.08]])
MASS = 9.0
LVLH = np.array([0.8, 0.2, -0.4, 0.4])
ATTITUDE = np.array([0.7, -0.1, 0.5, 0.5])
DEBRIS_ATTITUDE = np.array([0.5, 0.5, -0.5, 0.5])
POSITION, VELOCITY, RATE = [-0.6, 12.0, 0.5], [0.02, 0.04, -0.03], [-0.2, 0.3, 0.35]
DEBRIS_RATE = [0.4, -0.25, 0.15]

SEGMENTS: list[Segment] = [
    (2.0, 7.0, "lvlh", (0.03, -0.02, 0.015), (0.0004, -0.0002, 0.0003)),
    (7.0, 20.5, "body", (0.01, 0.07, -0.005), (-0.0002, 0.0003, 0.0001)),
    (24.0, 24.5, "body", (-0.09, 0.0, 0.05), (0.006, -0.004, 0.008)),
    (24.5, 60.0, "lvlh", (0.001, -0.002, 0.003), (-0.0003, 0.0, 0.0001)),
]


def scenario_of(segments: Sequence[Segment], *settings: str, duration: float = 70.0, period: float = 0.5) -> Scenario:
    tables = [
        f"{{start = {start}, end = {end}, frame = '{frame}', force = {list(force)}, torque = {list(torque)}}}"
        for start, end, frame, force, torque in segments
    ]
    return with_settings(
        detumble.load("paper"),
        [
            f"time={{duration = {duration}, control_period = {period}, integration_step = 0.0125}}",
            f"orbit.lvlh_attitude={LVLH.tolist()}",
            f"chaser={{mass = {MASS}, inertia = {INERTIA.tolist()}, position = {POSITION}, velocity = {VELOCITY}, "
            f"attitude = {ATTITUDE.tolist()}, rate = {RATE}}}",
            f"debris={{mass = 5.0, inertia = {DEBRIS_INERTIA.tolist()}, attitude = {DEBRIS_ATTITUDE.tolist()}, "
            f"tumble_rate = {DEBRIS_RATE}}}",
            f"laws.none.segments=[{', '.join(tables)}]",
            *settings,
        ],
    )


# --- the reference: rotation matrices from quaternions, nothing shared with the core


def product(p: Array, q: Array) -> Array:
    scalar = p[0] * q[0] - p[1:] @ q[1:]
    return np.concatenate(([scalar], p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:])))


def matrix(q: Array) -> Array:
    w, v = q[0], q[1:]
    cross = np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
    return np.asarray(((w * w - v @ v) * np.eye(3) + 2.0 * np.outer(v, v) + 2.0 * w * cross) / (q @ q))


def turning(q: Array, w: Array) -> Array:
    return 0.5 * product(q, np.concatenate(([0.0], w)))


def reference(segments: Sequence[Segment], times: Array, n: float) -> tuple[Array, Array]:
    """Chaser (position, velocity, attitude, rate) and debris (attitude, rate) at `times`; the last of them ends the flight."""
    inverse, lvlh = np.linalg.inv(INERTIA), LVLH / np.linalg.norm(LVLH)

    def slope(t: float, y: Array, frame: str, force: Array, torque: Array) -> Array:
        r, v, q, w = y[:3], y[3:6], y[6:10], y[10:]
        half = 0.5 * n * t
        to_inertial = matrix(product(lvlh, np.array([np.cos(half), 0.0, 0.0, np.sin(half)])))
        body_to_lvlh = to_inertial.T @ matrix(q)
        pull, twist = (body_to_lvlh @ force, torque) if frame == "body" else (force, body_to_lvlh.T @ torque)
        natural = np.array([3.0 * n * n * r[0] + 2.0 * n * v[1], -2.0 * n * v[0], -n * n * r[2]])
        spin = inverse @ (twist - np.cross(w, INERTIA @ w))
        return np.concatenate((v, natural + pull / MASS, turning(q, w), spin))

    quiet: Segment = (0.0, 0.0, "lvlh", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    edges = sorted({0.0, float(times[-1]), *(edge for segment in segments for edge in segment[:2])})
    state = np.concatenate((POSITION, VELOCITY, ATTITUDE / np.linalg.norm(ATTITUDE), RATE))
    rows = [state[None, :]]
    for begin, end in pairwise(edges):
        _, _, frame, force, torque = next((s for s in segments if s[0] <= begin < s[1]), quiet)
        inside = times[(times > begin + 1e-9) & (times < end - 1e-9)]
        solved = solve_ivp(
            slope,
            (begin, end),
            state,
            "DOP853",
            [*inside, end],
            rtol=1e-13,
            atol=1e-15,
            args=(frame, np.array(force), np.array(torque)),
        )
        state = solved.y[:, -1]
        rows.append(solved.y.T)
    debris_inverse = np.linalg.inv(DEBRIS_INERTIA)
    debris = solve_ivp(
        lambda _, y: np.concatenate((turning(y[:4], y[4:]), -debris_inverse @ np.cross(y[4:], DEBRIS_INERTIA @ y[4:]))),
        (0.0, times[-1]),
        np.concatenate((DEBRIS_ATTITUDE / np.linalg.norm(DEBRIS_ATTITUDE), DEBRIS_RATE)),
        "DOP853",
        times,
        rtol=1e-13,
        atol=1e-15,
    )
    return np.concatenate(rows), debris.y.T


def angle(p: Array, q: Array) -> Array:
    """Angle between two series of attitudes, rad."""
    q = q / np.linalg.norm(q, axis=1, keepdims=True)
    short = np.minimum(np.linalg.norm(p - q, axis=1), np.linalg.norm(p + q, axis=1))
    return np.asarray(4.0 * np.arcsin(short / 2.0))


def differences(flight: Flight, segments: Sequence[Segment]) -> dict[str, float]:
    """Largest differences from the reference over the flight, by series."""
    flown = flight.history
    chaser, debris = reference(segments, flown["time"], flight.scenario.orbit.mean_motion)
    return {
        "position": float(np.abs(flown["position"] - chaser[:, :3]).max()),
        "velocity": float(np.abs(flown["velocity"] - chaser[:, 3:6]).max()),
        "attitude": float(angle(flown["chaser_attitude"], chaser[:, 6:10]).max()),
        "rate": float(np.abs(flown["chaser_rate"] - chaser[:, 10:]).max()),
        "debris attitude": float(angle(flown["debris_attitude"], debris[:, :4]).max()),
        "debris rate": float(np.abs(flown["debris_rate"] - debris[:, 4:]).max()),
    }


def test_validation_segments_in_both_frames_match_dop853() -> None:
    """Gaps between segments, and segments that touch, included; every tick."""
    found = differences(detumble.simulate(scenario_of(SEGMENTS), law="none"), SEGMENTS)
    assert max(found["position"], found["velocity"]) < 1e-10, found
    assert max(found["attitude"], found["debris attitude"]) < 1e-9, found
    assert max(found["rate"], found["debris rate"]) < 1e-10, found


@pytest.mark.parametrize("frame", ["lvlh", "body"])
@pytest.mark.parametrize("what", ["force", "torque"])
def test_validation_one_segment_for_the_whole_flight(frame: str, what: str) -> None:
    vector, zero = (0.05, -0.03, 0.02) if what == "force" else (2e-4, 1e-4, -3e-4), (0.0, 0.0, 0.0)
    segment: Segment = (0.0, 70.0, frame, *((vector, zero) if what == "force" else (zero, vector)))
    found = differences(detumble.simulate(scenario_of([segment]), law="none"), [segment])
    assert max(found["position"], found["velocity"]) < 1e-10, found
    assert found["attitude"] < 1e-9, found
    assert found["rate"] < 1e-10, found


def test_a_segment_begins_and_ends_at_its_ticks() -> None:
    """Period 0.3 s, where k times the period is no round number: the command holds from start up to, not at, end."""
    segments: list[Segment] = [
        (0.9, 2.1, "lvlh", (0.01, 0.0, 0.0), (0.0, 0.0, 0.0)),
        (2.1, 2.4, "body", (0.0, 0.02, 0.0), (0.0, 0.0, 0.0)),
    ]
    flight = detumble.simulate(scenario_of(segments, duration=3.0, period=0.3), law="none")
    assert flight.history["force"][:, 0].tolist() == [0.0] * 3 + [0.01] * 4 + [0.0] * 4
    assert flight.history["force"][:, 1].tolist() == [0.0] * 7 + [0.02] + [0.0] * 3
    assert differences(flight, segments)["position"] < 1e-11


@pytest.mark.parametrize("frame", ["lvlh", "body"])
@pytest.mark.parametrize("saturation", ["per_axis", "scaled"])
def test_validation_saturation_acts_in_the_axes_of_the_segment(frame: str, saturation: str) -> None:
    """Asked for far more than the limits, which differ by axis: what is flown is the limited vector, in the same axes."""
    force, torque = np.array([0.3, -0.05, 0.5]), np.array([-0.01, 0.0005, 0.002])
    force_limit, torque_limit = np.array([0.1, 0.08, 0.12]), np.array([0.001, 0.0012, 0.0008])
    if saturation == "per_axis":
        force_flown = np.clip(force, -force_limit, force_limit)
        torque_flown = np.clip(torque, -torque_limit, torque_limit)
    else:
        force_flown = force / np.max(np.abs(force) / force_limit)
        torque_flown = torque / np.max(np.abs(torque) / torque_limit)
    asked: Segment = (0.5, 30.0, frame, force.tolist(), torque.tolist())
    limits = (
        f"actuators={{force_limit = {force_limit.tolist()}, torque_limit = {torque_limit.tolist()}, "
        f"saturation = '{saturation}'}}"
    )
    flight = detumble.simulate(scenario_of([asked], limits, duration=30.0), law="none")
    during = flight.history["time"] < 29.75
    during[0] = False
    assert np.abs(flight.history["force"][during] - force_flown).max() < 1e-15
    assert np.abs(flight.history["force_command"][during] - force).max() == 0.0
    assert np.abs(flight.history["torque"][during] - torque_flown).max() < 1e-15
    found = differences(flight, [(0.5, 30.0, frame, force_flown.tolist(), torque_flown.tolist())])
    assert max(found["position"], found["velocity"]) < 1e-10, found
    assert found["attitude"] < 1e-9, found


@pytest.mark.parametrize("frame", ["none", "lvlh", "body"])
def test_order_of_convergence_of_a_whole_flight_is_four(frame: str) -> None:
    """A line through log(error) over log(step), at the end of a flight of 40 s that turns through 20 rad."""
    force, torque = (0.05, -0.03, 0.02), (2e-4, 1e-4, -3e-4)
    segments: list[Segment] = [] if frame == "none" else [(0.0, 40.0, frame, force, torque)]
    steps = np.array([0.4, 0.2, 0.1, 0.05])
    errors = []
    for step in steps:
        scenario = scenario_of(segments, f"time.integration_step={step}", duration=40.0, period=0.4)
        errors.append(differences(detumble.simulate(scenario, law="none"), segments))
    series = ["attitude", "rate", "debris attitude", "debris rate"] + (["position"] if frame == "body" else [])
    for name in series:
        order = np.polyfit(np.log(steps), np.log([error[name] for error in errors]), 1)[0]
        assert 3.85 < order < 4.15, (name, order, [error[name] for error in errors])
    if frame == "none":  # exact, whatever the step
        assert max(error["position"] for error in errors) < 1e-11


def test_validation_energy_momentum_and_norm_hold_in_a_fast_triaxial_tumble() -> None:
    """Ten minutes at half a radian per second, both bodies, products of inertia."""
    scenario = scenario_of([], duration=600.0)
    flown = detumble.simulate(scenario, law="none").history
    for body, inertia in (("chaser", INERTIA), ("debris", DEBRIS_INERTIA)):
        q, w = flown[f"{body}_attitude"], flown[f"{body}_rate"]
        energy = 0.5 * np.einsum("ti,ij,tj->t", w, inertia, w)
        momentum = np.array([matrix(a) @ inertia @ b for a, b in zip(q, w, strict=True)])
        assert np.abs(np.linalg.norm(q, axis=1) - 1.0).max() < 1e-14
        assert np.abs(energy / energy[0] - 1.0).max() < 1e-10
        assert np.abs(momentum - momentum[0]).max() < 1e-10 * np.linalg.norm(momentum[0])
