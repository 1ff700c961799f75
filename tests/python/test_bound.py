"""The lower bound on capture time: closed forms, optimal controls found by others, and controls that try to beat it."""

import math
import time
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import linprog

import chases
from chases import A, N, start
from detumble.analysis.bounds.earliest import minimum_capture_time, minimum_capture_times, minimum_times
from detumble.analysis.bounds.pursuit import Pursuit, start_of
from detumble.analysis.bounds.translation import Reach
from detumble.analysis.bounds.tumble import tumble
from detumble.analysis.bounds.turn import excluded
from detumble.quaternions import conjugate, multiply, rotate

PERIOD = chases.BASE.period
BASE = replace(chases.BASE, debris_inertia=np.diag([0.05, 0.05, 0.08]), periods=3000)
FLAT = replace(BASE, mean_motion=0.0, goal=np.zeros(3))
"""No orbit: three double integrators."""


def first_tick(seconds):
    """The first control tick at or after a time."""
    return math.ceil(seconds / PERIOD - 1e-6) * PERIOD


def directions(rng, count, size):
    vectors = rng.standard_normal((count, size))
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def random_starts(rng, count, distance, drift=0.0, tumble_rate=0.1, spin=0.0):
    return np.hstack(
        (
            rng.uniform(-distance, distance, (count, 3)),
            drift * rng.standard_normal((count, 3)),
            directions(rng, count, 4),
            spin * rng.standard_normal((count, 3)),
            directions(rng, count, 4),
            directions(rng, count, 3) * rng.uniform(0.0, tumble_rate, (count, 1)),
        )
    )


def hcw_step(period=PERIOD, n=N):
    """Transition (6, 6) and input (6, 3) over one period, by the matrix exponential of the equations of motion."""
    motion = np.zeros((9, 9))
    motion[0:3, 3:6] = motion[3:6, 6:9] = np.eye(3)
    motion[3, 0], motion[3, 4], motion[4, 3], motion[5, 2] = 3 * n * n, 2 * n, -2 * n, -n * n
    step = expm(motion * period)
    return step[:6, :6], step[:6, 6:]


def best_zero_order_hold(problem, state, tick, count=400):
    """Whether piecewise constant forces meet distance and speed at a tick: a linear programme inside both balls."""
    drift, push = hcw_step(problem.period, problem.mean_motion)
    columns, free = [], state
    for _ in range(tick):
        columns.append(push if not columns else drift @ columns[-1])
        free = drift @ free
    spread = np.pi * (1.0 + 5.0**0.5) * np.arange(count)
    height = 1.0 - 2.0 * (np.arange(count) + 0.5) / count
    ball = np.stack((np.sqrt(1 - height**2) * np.cos(spread), np.sqrt(1 - height**2) * np.sin(spread), height))
    miss = free - np.concatenate((problem.goal, np.zeros(3)))
    reach = np.hstack(columns) * np.tile(problem.acceleration, tick)
    place = np.vstack((problem.distance * ball, np.zeros((3, count)), np.ones((1, count)), np.zeros((1, count))))
    timed = math.isfinite(problem.speed)
    pace = np.vstack((np.zeros((3, count)), min(problem.speed, 1.0) * ball, np.zeros((1, count)), np.ones((1, count))))
    rows = [0, 1, 2, 3, 4, 5, 6, 7] if timed else [0, 1, 2, 6]
    equal = np.hstack((np.vstack((reach, np.zeros((2, 3 * tick)))), -place, *([-pace] if timed else [])))
    right = np.concatenate((-miss, [-1.0, -1.0]))
    limits = [(-1, 1)] * (3 * tick) + [(0, None)] * (equal.shape[1] - 3 * tick)
    return linprog(np.zeros(equal.shape[1]), A_eq=equal[rows], b_eq=right[rows], bounds=limits).status == 0


def optimum(problem, state, lower):
    """The first tick, s, from a lower bound on at which the linear programme succeeds."""
    tick = round(lower / problem.period)
    while not best_zero_order_hold(problem, state, tick):
        tick += 1
    print(f"bound {lower:.1f} s, programme {tick * problem.period:.1f} s")
    return tick * problem.period


@pytest.mark.parametrize("gap", [0.6, 2.0, 19.5, 100.0])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_single_axis_from_rest_is_half_a_t_squared(gap, axis):
    r = np.zeros(3)
    r[axis] = -(gap + 0.5)
    assert minimum_times(FLAT, start(r)).translation == pytest.approx(first_tick(math.sqrt(2 * gap / A)))


@pytest.mark.parametrize("gap", [0.6, 2.0, 19.5])
@pytest.mark.parametrize("speed", [0.001, 0.02, 0.1])
def test_single_axis_with_a_speed_threshold_is_accelerate_then_brake(gap, speed):
    peak = math.sqrt(A * gap + 0.5 * speed * speed)
    closed_form = (2 * peak - speed) / A if speed < peak else math.sqrt(2 * gap / A)
    found = minimum_times(replace(FLAT, speed=speed), start((0, 0, gap + 0.5))).translation
    assert found == pytest.approx(first_tick(closed_form))


def test_diagonal_start_uses_all_three_axes():
    # (sqrt 3) s/2 - 0.5 is what ½ a t² per axis must cover along the diagonal
    gap = 4.0 - 0.5 / math.sqrt(3)
    assert minimum_times(FLAT, start((4, -4, 4))).translation == pytest.approx(first_tick(math.sqrt(2 * gap / A)))


def test_start_inside_the_thresholds_is_captured_at_once():
    assert minimum_times(BASE, start((0.1, 0.3, 0.2))).capture == 0.0


def test_open_window_that_closes_again_is_found():
    # inside from 0.5 s to 1.5 s, then out for as long as full thrust needs to bring it back: 1.5 - T + ½ a T² = 0
    passing = start((1.0, 0, 0), (-1.0, 0, 0))
    assert minimum_times(FLAT, passing).translation == pytest.approx(0.5)
    back = (1.0 + math.sqrt(1.0 - 3.0 * A)) / A
    held = minimum_times(replace(FLAT, dwell_ticks=20), passing).translation
    assert held == pytest.approx(first_tick(back) + 2.0)


def test_dwell_counts_whole_ticks_from_the_first_open_one():
    at_once = minimum_times(FLAT, start((3, 0, 0))).translation
    assert minimum_times(replace(FLAT, dwell_ticks=7), start((3, 0, 0))).translation == pytest.approx(at_once + 0.7)


def test_flight_too_short_gives_infinity():
    assert minimum_times(replace(FLAT, periods=100), start((20, 0, 0))).capture == math.inf


def test_no_limits_and_no_force():
    far = start((20, 5, -3), debris_q=(0, 1, 0, 0))
    free = replace(BASE, acceleration=np.full(3, np.inf), torque=np.full(3, np.inf))
    assert minimum_times(free, far).capture == PERIOD
    still = replace(BASE, acceleration=np.zeros(3), torque=np.zeros(3))
    assert minimum_times(still, far).translation == math.inf
    assert minimum_times(still, far).attitude == math.inf
    only_z = replace(FLAT, acceleration=np.array([np.inf, A, A]))
    assert minimum_times(only_z, start((50, 50, 2.5))).translation == pytest.approx(first_tick(math.sqrt(4 / A)))


def test_distance_from_the_debris_ignores_the_goal():
    problem = replace(FLAT, goal=np.array([0, 50.0, 0]), from_debris=True)
    assert minimum_times(problem, start((2.5, 0, 0))).translation == pytest.approx(first_tick(math.sqrt(4 / A)))


@pytest.mark.parametrize("axis", [0, 1])
def test_from_20_m_the_bound_lies_below_the_true_optimum_where_the_double_integrator_formula_does_not(axis):
    r = np.array([0.0, 0.3, 0.0])
    r[axis] += 20.0
    formula = math.sqrt(2 * 19.5 / A)
    bound = minimum_times(BASE, start(r)).translation
    best = optimum(BASE, start(r)[:6], bound)
    assert bound <= best <= 1.01 * bound
    assert best < formula - PERIOD


@pytest.mark.parametrize("speed", [math.inf, 0.03])
def test_bound_is_within_a_tick_or_a_percent_of_linear_programmes(speed):
    rng = np.random.default_rng(3)
    problem = replace(BASE, speed=speed)
    for row in random_starts(rng, 6, 8.0, drift=0.05):
        bound = minimum_times(problem, row).translation
        best = optimum(problem, row[:6], bound)
        assert bound <= best <= 1.01 * bound + PERIOD


def test_support_bounds_the_integral_and_its_point_is_reached():
    rng = np.random.default_rng(4)
    reach, ticks = Reach(N, np.array([A, 2 * A, 0.5 * A]), 1.0), 300
    reach.extend(ticks)
    fine = (np.arange(ticks * 200) + 0.5) / 200
    step = [expm_row(t) for t in (0.0, 37.0, 300.0)]
    assert reach.drift[[0, 37, 300]] == pytest.approx(np.array(step), abs=1e-10)
    s, c = np.sin(N * fine), np.cos(N * fine)
    zero = np.zeros_like(fine)
    rv = [[s / N, 2 * (1 - c) / N, zero], [-2 * (1 - c) / N, (4 * s - 3 * N * fine) / N, zero], [zero, zero, s / N]]
    vv = [[c, 2 * s, zero], [-2 * s, 4 * c - 3, zero], [zero, zero, c]]
    kernel = np.array(rv + vv)
    for _ in range(20):
        d = rng.standard_normal(6) * np.repeat([1.0, 100.0], 3)
        exact = np.abs(np.einsum("i,ijt->jt", d, kernel)).sum(axis=1) @ reach.acceleration / 200
        upper = reach.support(d, ticks, ticks)[0]
        assert exact - 1e-4 * exact / 200 <= upper <= exact * (1 + 1e-5) + 1e-9
        assert 0.999 * exact <= d @ reach.farthest(d, ticks) <= upper


def expm_row(seconds):
    return hcw_step(seconds)[0]


def test_random_controls_never_beat_the_bound():
    rng = np.random.default_rng(5)
    drift, push = hcw_step()
    for speed in (math.inf, 0.05):
        problem = replace(BASE, speed=speed)
        starts = random_starts(rng, 40, 1.5, drift=0.05)
        bounds = np.array([minimum_times(problem, row).translation for row in starts])
        state = np.repeat(starts[:, :6], 50, axis=0)
        limit = np.repeat(bounds, 50)
        # bang-bang towards the goal with random switching times and signs, and constants
        goal_side = -np.sign(state[:, :3] - problem.goal)
        switches = rng.uniform(0.0, 1.5, (len(state), 3)) * limit[:, None]
        level = np.where(rng.random((len(state), 3)) < 0.8, 1.0, rng.uniform(-1, 1, (len(state), 3)))
        for tick in range(round(float(limit.max()) / PERIOD)):
            inside = np.linalg.norm(state[:, :3] - problem.goal, axis=1) < problem.distance
            inside &= np.linalg.norm(state[:, 3:], axis=1) < problem.speed
            assert not (inside & (tick * PERIOD < limit - 1e-9)).any()
            force = A * level * np.where(tick * PERIOD < switches, goal_side, -goal_side)
            state = state @ drift.T + force @ push.T


def test_more_force_or_torque_never_takes_longer():
    rng = np.random.default_rng(6)
    starts = random_starts(rng, 30, 5.0, drift=0.02, spin=0.1)
    weak = minimum_capture_times(BASE, starts)
    strong = minimum_capture_times(replace(BASE, acceleration=np.full(3, 1.5 * A), torque=np.full(3, 0.02)), starts)
    assert (strong <= weak).all()
    assert (minimum_capture_times(replace(BASE, speed=0.05), starts) >= weak).all()
    assert (minimum_capture_times(replace(BASE, distance=0.3, angle=0.2, rate=0.03), starts) >= weak).all()


# --- attitude


def about_x(angle):
    return np.array([math.cos(angle / 2), math.sin(angle / 2), 0.0, 0.0])


@pytest.mark.parametrize("angle", [0.5, 1.5, 3.0])
def test_sphere_with_torque_about_one_axis_slews_in_its_closed_form(angle):
    problem = replace(BASE, chaser_inertia=0.1 * np.eye(3), torque=np.array([0.01, 0.0, 0.0]))
    peak = math.sqrt(0.1 * (angle - problem.angle) + 0.5 * problem.rate**2)
    closed_form = (2 * peak - problem.rate) / 0.1
    found = minimum_times(problem, start(debris_q=about_x(angle))).attitude
    assert first_tick(closed_form) - PERIOD <= found <= first_tick(closed_form)


def test_sphere_must_take_up_the_debris_rate():
    problem = replace(BASE, chaser_inertia=0.1 * np.eye(3), torque=np.array([0.01, 0.0, 0.0]), angle=math.pi)
    spun_up = minimum_times(problem, start(debris_w=(0, 0, 0.5))).attitude
    assert spun_up == pytest.approx(first_tick(0.45 / 0.1))
    reversed_spin = minimum_times(problem, start(w=(-0.5, 0, 0), debris_w=(0.5, 0, 0))).attitude
    assert reversed_spin == pytest.approx(first_tick(0.95 / 0.1))
    slowed = minimum_times(problem, start(w=(0, 0.5, 0))).attitude
    assert slowed == pytest.approx(first_tick(0.45 / 0.1))


@pytest.mark.parametrize("axis", [0, 2])
@pytest.mark.parametrize("angle", [1.0, 2.5])
def test_numeric_single_axis_slew_of_the_paper_chaser_does_not_beat_it(axis, angle):
    acceleration = 0.01 / BASE.chaser_inertia[axis, axis]
    peak = math.sqrt(acceleration * (angle - BASE.angle) + 0.5 * BASE.rate**2)
    slew = (2 * peak - BASE.rate) / acceleration
    q = np.zeros(4)
    q[0], q[1 + axis] = math.cos(angle / 2), math.sin(angle / 2)
    bound = minimum_times(BASE, start(debris_q=q)).attitude
    assert 0.5 * slew < bound <= first_tick(slew)


@pytest.mark.parametrize(
    "inertia", [np.diag([0.1, 0.1, 0.05]), np.array([[0.1, 0.02, 0.01], [0.02, 0.07, -0.01], [0.01, -0.01, 0.06]])]
)
def test_torques_that_try_never_meet_a_tumbling_debris_before_the_bound(inertia):
    rng = np.random.default_rng(7)
    limit = 0.01
    pursuit = replace(BASE, chaser_inertia=inertia, torque=np.full(3, limit), angle=0.35, rate=0.05)
    inverse, substeps, ticks = np.linalg.inv(inertia), 4, 150
    h = PERIOD / substeps
    earliest = []
    for _ in range(12):
        row = random_starts(rng, 1, 1.0, tumble_rate=0.3, spin=0.15)[0]
        targets, rates = tumble(BASE.debris_inertia, row[13:17], row[17:], PERIOD, ticks)
        shut = excluded(pursuit, row[6:10], row[10:13], targets, rates, 0)
        # 60 laws at once: PD on the error with random, mostly violent gains, saturated per axis
        q, w = np.tile(row[6:10], (60, 1)), np.tile(row[10:13], (60, 1))
        kp, kd = 10 ** rng.uniform(-2, 2, (60, 1)), 10 ** rng.uniform(-2, 2, (60, 1))
        for tick in range(ticks + 1):
            error = multiply(conjugate(targets[tick]), q)
            error *= np.sign(error[:, :1])
            relative = w - rotate(conjugate(error), rates[tick])
            met = (2 * np.arccos(np.minimum(error[:, 0], 1)) < 0.35) & (np.linalg.norm(relative, axis=1) < 0.05)
            assert not (shut[tick] and met.any())
            if met.any():
                earliest.append((tick, int(np.argmin(shut))))
                break
            torque = np.clip(-kp * error[:, 1:] - kd * relative, -limit, limit)
            for _ in range(substeps):
                middle = w + 0.5 * h * (torque - np.cross(w, w @ inertia)) @ inverse
                w = w + h * (torque - np.cross(middle, middle @ inertia)) @ inverse
                half = np.linalg.norm(middle, axis=1, keepdims=True) * h / 2
                q = multiply(q, np.hstack((np.cos(half), np.sinc(half / np.pi) * h / 2 * middle)))
    assert len(earliest) >= 8
    assert all(first <= met for met, first in earliest)


# --- grasp points


def test_grasp_goal_moves_with_the_tumble():
    # debris turns about z in an empty sky; its point is 2 m out, the chaser's own at its centre
    problem = replace(FLAT, grasp_points=(np.zeros(3), np.array([2.0, 0, 0])), angle=math.pi, rate=10.0)
    spin, ticks = 0.04, np.arange(1000)
    seconds = ticks * PERIOD
    goal = 2.0 * np.stack((np.cos(spin * seconds), np.sin(spin * seconds)), axis=1)
    left = np.maximum(np.abs(np.array([-3.0, 1.0]) - goal) - 0.5 * A * seconds[:, None] ** 2, 0.0)
    expected = ticks[np.linalg.norm(left, axis=1) <= 0.5][0] * PERIOD
    assert minimum_times(problem, start((-3, 1, 0), debris_w=(0, 0, spin))).translation == pytest.approx(expected)


def test_chaser_grasp_point_only_widens_the_threshold():
    arms = (np.array([0.3, 0, 0]), np.array([0, 0.4, 0]))
    problem = replace(FLAT, grasp_points=arms)
    gap = 5.4 - 0.3 * math.sin(math.radians(10)) * 2 - 0.5
    # goal (-0.3, 0.4, 0) when aligned; seen along y the x offset is free to remove
    found = minimum_times(problem, start((-0.3, -5.0, 0))).translation
    assert found == pytest.approx(first_tick(math.sqrt(2 * gap / A)))


# --- as used


def test_no_law_beats_the_minimum_time_in_1000_random_starts():
    detumble, core = pytest.importorskip("detumble"), pytest.importorskip("detumble._core")
    from detumble.scenario.core import case
    from detumble.workload import start_columns

    scenario = detumble.load("paper")
    starts = random_starts(np.random.default_rng(8), 1000, 1.5, drift=0.02, tumble_rate=0.05)
    pursuit = Pursuit.of(case(scenario, "none"))
    bounds = minimum_capture_times(pursuit, starts)
    assert np.isfinite(bounds).all()
    columns = start_columns(starts)
    for law in detumble.LAWS:
        flown = core.fly_many(case(scenario, law), columns, len(starts), seed=1, threads=2)["capture_time"]
        assert np.isfinite(flown).any()
        assert not (flown < bounds - 1e-9).any()
    lead = minimum_capture_time(scenario)
    assert 0.0 < lead <= 1e-9 + min(detumble.simulate(scenario, law).metrics.capture_time for law in detumble.LAWS)
    assert lead == minimum_capture_times(pursuit, start_of(case(scenario, "none"))[None, :])[0]


def test_actuators_that_give_more_than_their_limit_move_the_bound():
    detumble = pytest.importorskip("detumble")
    from detumble.scenario.core import case

    scenario = detumble.load("paper")
    nominal = Pursuit.of(case(scenario, "none"))
    scenario.actuators.force_gain = (3.0, 2.0, 1.0)
    scenario.actuators.torque_gain = 0.5
    strong = Pursuit.of(case(scenario, "none"))
    assert np.allclose(strong.acceleration, nominal.acceleration * [3.0, 2.0, 1.0], rtol=1e-15)
    assert np.allclose(strong.torque, 0.5 * nominal.torque, rtol=1e-15)
    scenario.actuators.force_gain = scenario.actuators.torque_gain = 3.0
    scenario.laws.prrl.translation.slope = 0.5
    scenario.laws.prrl.translation.gain = 1.0
    assert minimum_capture_time(scenario) <= detumble.simulate(scenario, "prrl").metrics.capture_time + 1e-9


def test_a_start_costs_milliseconds():
    starts = random_starts(np.random.default_rng(9), 60, 2.0)
    minimum_capture_times(BASE, starts[:5])
    began = time.process_time()
    minimum_capture_times(BASE, starts)
    each = (time.process_time() - began) / len(starts)
    print(f"\n{1e3 * each:.2f} ms per start")
    assert each < 0.02
