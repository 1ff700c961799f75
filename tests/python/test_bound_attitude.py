"""Bounds of the time that a slew takes: closed forms, torques flown by others, and laws that try to be sooner."""

from __future__ import annotations

import math
import sys
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

import chases
from chases import STILL
from detumble.analysis.bounds.attitude import earliest_attitude
from detumble.analysis.bounds.pursuit import Pursuit, start_of
from detumble.analysis.bounds.slew import attitude_bound, first_slew, fly, slew_at_tick
from detumble.analysis.bounds.tumble import tumble
from detumble.errors import RequestError
from detumble.quaternions import conjugate, multiply, rotate

BASE = replace(chases.BASE, debris_inertia=np.diag([0.05, 0.05, 0.08]), goal=np.zeros(3), periods=3000)
SPHERE = replace(BASE, chaser_inertia=0.1 * np.eye(3), torque=np.array([0.01, 0.0, 0.0]))
"""A sphere that can be turned about x alone, by 0.1 rad/s²."""
UNEVEN = np.array([[0.1, 0.02, 0.01], [0.02, 0.07, -0.01], [0.01, -0.01, 0.06]])


def start(q=STILL, w=(0, 0, 0), debris_q=STILL, debris_w=(0, 0, 0)):
    return chases.start(q=q, w=w, debris_q=debris_q, debris_w=debris_w)


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def random_start(rng, spin=0.05, tumble_rate=0.1):
    debris_w = unit(rng.standard_normal(3)) * rng.uniform(0.0, tumble_rate)
    return start(unit(rng.standard_normal(4)), spin * rng.standard_normal(3), unit(rng.standard_normal(4)), debris_w)


def about(axis, angle):
    return np.concatenate(([math.cos(angle / 2)], math.sin(angle / 2) * np.eye(3)[axis]))


def accelerate_then_brake(problem, angle, acceleration):
    """From rest through an angle less the threshold, to no more than the rate threshold."""
    peak = math.sqrt(acceleration * (angle - problem.angle) + 0.5 * problem.rate**2)
    return (2 * peak - problem.rate) / acceleration


def turned_by_matrices(problem, row, slew):
    """Where the torques lead, by rotation matrices and another integrator: angle and relative rate at the end."""
    inertia, debris = problem.chaser_inertia, problem.debris_inertia

    def cross(w):
        return np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])

    def slope(t, y, held):
        chaser, target, w, wd = y[:9].reshape(3, 3), y[9:18].reshape(3, 3), y[18:21], y[21:]
        spun = np.linalg.solve(inertia, held - cross(w) @ inertia @ w)
        return np.concatenate(
            (
                (chaser @ cross(w)).ravel(),
                (target @ cross(wd)).ravel(),
                spun,
                -np.linalg.solve(debris, cross(wd) @ debris @ wd),
            )
        )

    matrices = [Rotation.from_quat(np.roll(q, -1)).as_matrix().ravel() for q in (row[6:10], row[13:17])]
    y = np.concatenate((*matrices, row[10:13], row[17:20]))
    for begin, end, held in zip(slew.times[:-1], slew.times[1:], slew.torque, strict=True):
        y = solve_ivp(slope, (begin, end), y, "RK45", rtol=1e-9, atol=1e-11, args=(held,)).y[:, -1]
    relative = y[:9].reshape(3, 3).T @ y[9:18].reshape(3, 3)
    angle = Rotation.from_matrix(relative).magnitude()
    return angle, np.linalg.norm(y[18:21] - relative @ y[21:])


# --- closed forms


@pytest.mark.parametrize("angle", [0.5, 1.5, 3.0])
def test_sphere_with_torque_about_one_axis_is_bracketed_within_a_percent(angle):
    closed_form = accelerate_then_brake(SPHERE, angle, 0.1)
    bound = attitude_bound(SPHERE, start(debris_q=about(0, angle)))
    assert 0.999 * closed_form < bound.lower <= closed_form <= bound.upper < 1.01 * closed_form


@pytest.mark.parametrize(
    ("w", "debris_w", "change"),
    [((0, 0, 0), (0.5, 0, 0), 0.45), ((-0.5, 0, 0), (0.5, 0, 0), 0.95), ((0.4, 0, 0), (0, 0, 0), 0.35)],
)
def test_a_change_of_rate_takes_its_closed_form(w, debris_w, change):
    problem = replace(SPHERE, angle=math.pi)
    bound = attitude_bound(problem, start(w=w, debris_w=debris_w))
    assert 0.999 * change / 0.1 < bound.lower <= change / 0.1 <= bound.upper < 1.001 * change / 0.1


@pytest.mark.parametrize(("axis", "angle"), [(0, 1.0), (1, 2.0), (2, 0.8), (2, 2.5)])
def test_a_principal_axis_slew_of_the_paper_chaser_lies_above_the_lower_bound_and_not_below_the_upper_one(axis, angle):
    # about a principal axis nothing couples; other ways may be a little faster, and the programme finds none slower
    closed_form = accelerate_then_brake(BASE, angle, 0.01 / BASE.chaser_inertia[axis, axis])
    bound = attitude_bound(BASE, start(debris_q=about(axis, angle)))
    assert bound.lower <= bound.upper < 1.002 * closed_form
    assert bound.lower > 0.7 * closed_form


def test_a_debris_that_turns_into_view_needs_hardly_any_torque():
    # 115° off about z, closing at 0.04 rad/s, within the rate threshold all the time
    problem = replace(BASE, torque=np.full(3, 1e-12))
    bound = attitude_bound(problem, start(debris_q=about(2, -2.0), debris_w=(0, 0, 0.04)))
    meeting = (2.0 - BASE.angle) / 0.04  # and what the torque can do about it is below 1 µs
    assert 0.999 * meeting < bound.lower <= meeting
    assert meeting - 1e-6 < bound.upper < 1.01 * meeting


def test_a_start_inside_needs_no_time():
    bound = attitude_bound(BASE, start(debris_w=(0.02, 0, 0)))
    assert (bound.lower, bound.upper) == (0.0, 0.0)


def test_without_limits_a_control_period_is_enough():
    free = replace(BASE, torque=np.full(3, np.inf))
    bound = attitude_bound(free, start(debris_q=about(0, 3.0)))
    assert (bound.lower, bound.upper, bound.slew) == (0.0, BASE.period, None)


def test_a_flight_too_short_gives_infinity():
    bound = attitude_bound(replace(BASE, periods=20), start(debris_q=about(0, 3.0)))
    assert (bound.lower, bound.upper, bound.slew) == (math.inf, math.inf, None)


def test_a_dwell_is_waited_for():
    row = start(debris_q=about(0, 0.8), debris_w=(0.03, 0.02, 0))
    at_once, held = attitude_bound(BASE, row), attitude_bound(replace(BASE, dwell_ticks=10), row)
    assert held.lower == pytest.approx(at_once.lower + 1.0)
    assert at_once.upper + 1.0 <= held.upper + 1e-9 < at_once.upper + 1.5


# --- lower bounds


def test_twist_gains_no_more_than_the_area_that_the_axis_sweeps():
    # the lemma behind the bound, on paths of the z axis that cone and wander; a closed cone attains it
    rng = np.random.default_rng(0)
    steps, nearest = 200, 0.0
    for _ in range(60):
        time = np.arange(steps) / steps
        heading = rng.uniform(-20.0, 20.0) * time + rng.choice([0.0, 1.0]) * np.sin(3.0 * time)
        length = rng.uniform(0.2, 3.1)
        along = rng.choice([0.0, 1.0]) * rng.uniform(-8.0, 8.0)
        w = np.stack((length * np.cos(heading), length * np.sin(heading), np.full(steps, along)), axis=1)
        half = 0.5 * np.linalg.norm(w, axis=1, keepdims=True) / steps
        turns = np.hstack((np.cos(half), np.sin(half) * unit(w)))
        q, twists = STILL, [0.0]
        for turn in turns:
            q = multiply(q, turn)
            twists.append(2.0 * math.atan2(q[3], q[0]))
        gain = np.unwrap(twists, period=4.0 * math.pi)[-1] - along
        closed = length + 2.0 * math.atan2(math.hypot(q[1], q[2]), math.hypot(q[0], q[3]))
        area = 2.0 * math.pi - math.sqrt(4.0 * math.pi**2 - closed**2)
        assert abs(gain) <= area + 1e-6
        nearest = max(nearest, abs(gain) / area)
    assert nearest > 0.98


@pytest.mark.parametrize("inertia", [BASE.chaser_inertia, UNEVEN])
def test_what_some_torque_reaches_is_never_excluded_before_it_is_reached(inertia):
    # the debris is a sphere that arrives where random, mostly violent torques take the chaser, just then
    rng = np.random.default_rng(11)
    tightest = math.inf
    for _ in range(30):
        end = rng.uniform(1.0, 7.0)
        switches = np.sort(rng.uniform(0.0, end, 3))
        signs = np.sign(rng.standard_normal((4, 3)))
        signs[2:] = -signs[:2][::-1] if rng.random() < 0.7 else signs[2:]  # mostly brake again
        times = np.concatenate(([0.0], switches, [end]))
        row = random_start(rng, spin=rng.choice([0.0, 0.1, 0.3]))
        q, w = fly(inertia, row[6:10], row[10:13], times, 0.01 * signs)
        problem = replace(BASE, chaser_inertia=inertia, debris_inertia=np.eye(3), angle=0.02, rate=0.01)
        row[13:17] = tumble(np.eye(3), q[-1], -w[-1], end, 1)[0][1]
        row[17:20] = w[-1]
        found = earliest_attitude(problem, row)
        assert found <= end
        tightest = min(tightest, end / max(found, 1e-9))
    assert tightest < 1.2  # some of these are nearly as fast as can be


@pytest.mark.parametrize("inertia", [BASE.chaser_inertia, UNEVEN])
def test_laws_that_try_never_meet_a_tumbling_debris_before_the_bound(inertia):
    rng = np.random.default_rng(7)
    inverse, h, count = np.linalg.inv(inertia), 0.02, 60
    problem = replace(BASE, chaser_inertia=inertia)
    met_by_any = 0
    for _ in range(7):
        row = random_start(rng, spin=0.15, tumble_rate=0.3)
        bound = earliest_attitude(problem, row)
        targets, rates = tumble(BASE.debris_inertia, row[13:17], row[17:], h, 500)
        q, w = np.tile(row[6:10], (count, 1)), np.tile(row[10:13], (count, 1))
        kp, kd = 10 ** rng.uniform(-2, 2, (count, 1)), 10 ** rng.uniform(-2, 2, (count, 1))
        for tick in range(501):
            error = multiply(conjugate(targets[tick]), q)
            error *= np.sign(error[:, :1])
            relative = w - rotate(conjugate(error), rates[tick])
            met = (2 * np.arccos(np.minimum(error[:, 0], 1)) < problem.angle) & (
                np.linalg.norm(relative, axis=1) < problem.rate
            )
            if met.any():
                assert tick * h >= bound
                met_by_any += 1
                break
            torque = np.clip(-kp * error[:, 1:] - kd * relative, -0.01, 0.01)
            middle = w + 0.5 * h * (torque - np.cross(w, w @ inertia)) @ inverse
            w = w + h * (torque - np.cross(middle, middle @ inertia)) @ inverse
            half = np.linalg.norm(middle, axis=1, keepdims=True) * h / 2
            q = multiply(q, np.hstack((np.cos(half), np.sinc(half / np.pi) * h / 2 * middle)))
    assert met_by_any >= 4


def test_more_torque_or_wider_thresholds_never_take_longer():
    rng = np.random.default_rng(3)
    for _ in range(10):
        row = random_start(rng)
        bound = earliest_attitude(BASE, row)
        assert earliest_attitude(replace(BASE, torque=np.full(3, 0.015)), row) <= 1.001 * bound
        assert earliest_attitude(replace(BASE, angle=0.5, rate=0.08), row) <= 1.001 * bound


# --- upper bounds


@pytest.mark.parametrize("inertia", [BASE.chaser_inertia, UNEVEN])
def test_slews_do_what_they_say_when_flown_by_rotation_matrices(inertia):
    rng = np.random.default_rng(22)
    problem = replace(BASE, chaser_inertia=inertia)
    for _ in range(2):
        row = random_start(rng)
        bound = attitude_bound(problem, row)
        assert 0.0 < bound.lower <= bound.upper < 2.0 * bound.lower
        assert bound.slew.times[-1] == bound.upper
        assert (np.abs(bound.slew.torque) <= problem.torque).all()
        angle, rate = turned_by_matrices(problem, row, bound.slew)
        assert angle < problem.angle * (1 + 1e-7)
        assert rate < problem.rate * (1 + 1e-7)


def test_the_same_start_gives_the_same_bits():
    row = random_start(np.random.default_rng(2))
    one, two = (attitude_bound(BASE, row) for _ in range(2))
    assert (one.lower, one.upper) == (two.lower, two.upper)
    assert np.array_equal(one.slew.torque, two.slew.torque)


def test_no_slew_is_claimed_before_the_lower_bound():
    row = start(debris_q=about(0, 2.0))
    least = earliest_attitude(BASE, row)
    assert slew_at_tick(BASE, row, math.floor(least / BASE.period), least) is None
    assert slew_at_tick(replace(BASE, dwell_ticks=5), start(), 4, 0.0) is None


def test_a_dwell_longer_than_the_flight_leaves_no_attitude_to_hold():
    bound = attitude_bound(replace(BASE, periods=10, dwell_ticks=20), start())
    assert bound.lower == bound.upper == math.inf


def test_casadi_missing_is_reported(monkeypatch):
    monkeypatch.setitem(sys.modules, "casadi", None)
    with pytest.raises(RequestError, match=r"pip install 'detumble\[bounds\]'"):
        attitude_bound(BASE, start(debris_q=about(0, 1.0)))


@pytest.mark.parametrize(("dwell", "later"), [(0.0, 300), (0.5, 2)])
def test_the_simulator_flies_slews_into_the_thresholds(dwell, later):
    detumble, core = pytest.importorskip("detumble"), pytest.importorskip("detumble._core")
    assert core
    from detumble.scenario import with_settings
    from detumble.scenario.core import case

    turned = ["chaser.attitude=[0.5, 0.7, -0.4, 0.316]", "chaser.rate=[0.02, -0.05, 0.03]", f"capture.dwell={dwell}"]
    scenario = with_settings(detumble.load("paper"), [*turned, "time.duration=60.0"])
    plain = case(scenario, "none")
    pursuit, row = Pursuit.of(plain), start_of(plain)
    lead = earliest_attitude(pursuit, row)
    first = first_slew(pursuit, row, math.ceil(attitude_bound(pursuit, row).upper / pursuit.period - 1e-9))
    assert lead <= first.times[-1] < 1.5 * lead + 0.1
    for slew in (first, slew_at_tick(pursuit, row, len(first.torque) + later, lead)):
        tick = len(slew.torque)
        rows = [
            {"start": tick_ * 0.1, "end": (tick_ + 1) * 0.1, "frame": "body", "torque": tuple(torque)}
            for tick_, torque in enumerate(slew.torque.tolist())
        ]
        flown = detumble.simulate(with_segments(scenario, rows), law="none")
        dwelt = slice(tick - round(dwell / 0.1), tick + 1)
        assert (flown.history["angle_error"][dwelt] < pursuit.angle).all()
        assert (flown.history["rate_error"][dwelt] < pursuit.rate).all()
        assert flown.history["chaser_rate"][: tick + 1] == pytest.approx(slew.rate, abs=1e-6)


def with_segments(scenario, rows):
    """The scenario with an open loop."""
    from detumble.scenario.laws import OpenLoop

    scenario = scenario.model_copy(deep=True)
    scenario.laws.none = OpenLoop.model_validate({"segments": rows})
    return scenario
