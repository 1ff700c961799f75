"""Least time and least Δv of the translation: closed forms, linear programmes, controls that try to beat them, flown proofs."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq, linprog
from scipy.spatial import ConvexHull

from chases import (
    BASE,
    DELTA_V_GAP,
    FLAT,
    STILL,
    TIME_GAP,
    A,
    N,
    assert_captures,
    assert_delta_v,
    assert_time,
    flown,
    motion,
    random_starts,
    start,
)
from detumble.analysis.bounds.commanded import reach_at_tick
from detumble.analysis.bounds.course import Course
from detumble.analysis.bounds.fuel import delta_v_bound, delta_v_lower
from detumble.analysis.bounds.soonest import translation_bound
from detumble.analysis.bounds.tumble import tumble
from detumble.quaternions import conjugate, multiply, rotate

# --- time, closed forms


@pytest.mark.parametrize("gap", [0.01, 0.6, 19.5, 100.0])
@pytest.mark.parametrize("axis", [0, 2])
def test_single_axis_from_rest_is_half_a_t_squared(gap, axis):
    r = np.zeros(3)
    r[axis] = -(gap + 0.5)
    assert_time(FLAT, start(r), math.sqrt(2 * gap / A))


@pytest.mark.parametrize("drift", [-0.1, 0.02, 0.1])
def test_drift_along_the_axis_helps_or_delays(drift):
    assert_time(FLAT, start((5.5, 0, 0), (drift, 0, 0)), (drift + math.sqrt(drift * drift + 2 * A * 5.0)) / A)


@pytest.mark.parametrize("gap", [0.6, 19.5])
@pytest.mark.parametrize("speed", [0.001, 0.02, 0.1])
def test_single_axis_with_a_speed_threshold_is_accelerate_then_brake(gap, speed):
    peak = math.sqrt(A * gap + 0.5 * speed * speed)
    assert_time(replace(FLAT, speed=speed), start((0, 0, gap + 0.5)), (2 * peak - speed) / A)


def test_tiny_thresholds_are_nearly_rest_to_rest():
    tight = replace(FLAT, distance=1e-3, speed=1e-4)
    peak = math.sqrt(A * (10.0 - 1e-3) + 0.5e-8)
    assert_time(tight, start((10.0, 0, 0)), (2 * peak - 1e-4) / A)
    assert translation_bound(tight, start((10.0, 0, 0))).upper == pytest.approx(2 * math.sqrt(10.0 / A), rel=1e-3)


def test_window_that_closes_again_opens_at_the_entry():
    # inside from 0.5 s to 1.5 s; full thrust along the way opens it a little earlier
    passing = start((1.0, 0, 0), (-1.0, 0, 0))
    assert_time(FLAT, passing, (-1.0 + math.sqrt(1.0 + A)) / A)
    assert translation_bound(replace(FLAT, acceleration=np.zeros(3)), passing).lower == pytest.approx(0.5, rel=1e-6)


def test_goal_that_moves_is_met_where_it_will_be():
    # debris turns about z in an empty sky; its point is 2 m out, the chaser's own at its centre
    spin, row = 0.04, start((-3, 1, 0), debris_w=(0, 0, 0.04))
    problem = replace(FLAT, grasp_points=(np.zeros(3), np.array([2.0, 0, 0])))

    def left(t):
        goal = 2.0 * np.array([math.cos(spin * t), math.sin(spin * t)])
        return np.linalg.norm(np.maximum(np.abs(row[:2] - goal) - 0.5 * A * t * t, 0.0)) - 0.5

    grid = np.arange(0.0, 100.0, 0.5)
    after = next(k for k, t in enumerate(grid) if left(t) <= 0.0)
    expected = brentq(left, grid[after - 1], grid[after])
    bound = translation_bound(problem, row)
    assert bound.lower <= expected * (1 + 1e-9) <= bound.upper * (1 + 2e-9)
    assert bound.upper - bound.lower <= TIME_GAP * expected
    angle = spin * bound.upper
    place, velocity = np.array([math.cos(angle), math.sin(angle), 0]), np.array([-math.sin(angle), math.cos(angle), 0])
    assert_captures(problem, row, bound.transfer, np.concatenate((2 * place, 2 * spin * velocity)))


# --- Δv, closed forms


@pytest.mark.parametrize(
    ("gap", "drift", "within"), [(2.0, 0.0, 20.0), (19.5, 0.0, 120.0), (5.0, 0.05, 90.0), (19.5, 0.0, 600.0)]
)
def test_least_delta_v_is_one_burn_then_coasting(gap, drift, within):
    # the goal is passed at T: gap + drift T = J T - J²/(2 a), J the speed given
    spent = A * within - math.sqrt((A * within) ** 2 - 2 * A * (gap + drift * within))
    assert_delta_v(FLAT, start((gap + 0.5, 0, 0), (drift, 0, 0)), within, spent)


@pytest.mark.parametrize("speed", [0.001, 0.03])
def test_least_delta_v_with_a_speed_threshold_is_burn_coast_brake(speed):
    gap, within = 5.0, 60.0
    peak = brentq(lambda v: v * within - v * v / (2 * A) - (v - speed) ** 2 / (2 * A) - gap, speed, A * within / 2)
    assert_delta_v(replace(FLAT, speed=speed), start((0, gap + 0.5, 0)), within, 2 * peak - speed)


def test_without_force_limit_an_impulse_does_it():
    free = replace(FLAT, acceleration=np.array([np.inf, A, A]))
    assert_delta_v(free, start((6.5, 0, 0)), 50.0, 6.0 / 50.0)


def test_free_drift_into_the_thresholds_costs_nothing():
    passing = start((5.0, 0, 0), (-0.1, 0, 0))
    bound = delta_v_bound(FLAT, passing, 60.0)
    assert bound.lower == bound.upper == 0.0
    assert not bound.transfer.acceleration.any()
    assert_captures(FLAT, passing, bound.transfer)
    assert delta_v_bound(FLAT, passing, 40.0).lower > 0.0
    assert delta_v_lower(FLAT, passing, 60.0) == 0.0


def test_more_time_never_costs_more():
    row = start((4.0, -3.0, 1.0), (0.02, 0.01, -0.01))
    costs = [delta_v_bound(BASE, row, within) for within in (40.0, 80.0, 160.0, 600.0)]
    assert all(later.lower <= sooner.upper for sooner, later in itertools.pairwise(costs))
    assert costs[-1].upper < costs[0].lower


# --- linear programmes, written apart


def polytope(count=300):
    """Directions (count, 3), and how far in from the unit sphere the polytope {d · x ≤ 1} must shrink to lie inside it."""
    height = 1.0 - 2.0 * (np.arange(count) + 0.5) / count
    turn = math.pi * (1.0 + math.sqrt(5.0)) * np.arange(count)
    flat = np.sqrt(1.0 - height**2)
    directions = np.stack((flat * np.cos(turn), flat * np.sin(turn), height), axis=1)
    return directions, float(np.abs(ConvexHull(directions).equations[:, -1]).min())


def programme(problem, state, seconds, fuel, cells=50):
    """Δv (or 0) of forces held over equal cells that meet both thresholds at a time; inf if there are none."""
    drift, gain = motion(problem.mean_motion)(seconds / cells)
    columns, free = [], state
    for _ in range(cells):
        columns.insert(0, gain if not columns else drift @ columns[0])
        free = drift @ free
    reach = np.hstack(columns)
    miss = free - np.concatenate((problem.goal, np.zeros(3)))
    faces, inner = polytope()
    rows, right = faces @ reach[:3], inner * problem.distance - faces @ miss[:3]
    if math.isfinite(problem.speed):
        rows, right = np.vstack((rows, faces @ reach[3:])), np.append(right, inner * problem.speed - faces @ miss[3:])
    both = np.hstack((rows, -rows))
    limits = [(0.0, limit) for limit in np.tile(problem.acceleration, 2 * cells)]
    cost = np.full(6 * cells, seconds / cells if fuel else 0.0)
    found = linprog(cost, A_ub=both, b_ub=right, bounds=limits, method="highs")
    return float(found.fun) if found.status == 0 else math.inf


@pytest.mark.parametrize("speed", [math.inf, 0.03])
def test_linear_programmes_capture_just_after_the_least_time_and_never_before(speed):
    problem = replace(BASE, speed=speed)
    for row in random_starts(np.random.default_rng(3), 5, 15.0, 0.1):
        bound = translation_bound(problem, row)
        assert bound.lower <= bound.upper <= (1 + TIME_GAP) * bound.lower
        assert math.isfinite(programme(problem, row[:6], 1.01 * bound.upper, fuel=False))
        for share in (0.5, 0.9, 0.999):
            assert math.isinf(programme(problem, row[:6], share * bound.lower, fuel=False))


@pytest.mark.parametrize("speed", [math.inf, 0.03])
def test_linear_programmes_spend_as_much_and_never_less(speed):
    problem = replace(BASE, speed=speed)
    for row in random_starts(np.random.default_rng(4), 4, 6.0, 0.04):
        within = 2.0 * translation_bound(problem, row).upper
        bound = delta_v_bound(problem, row, within)
        times = (*np.linspace(0.55, 1.0, 6) * within, bound.transfer.times[-1])
        spent = [programme(problem, row[:6], seconds, fuel=True) for seconds in times]
        assert bound.lower <= min(spent) * (1 + 1e-9)
        assert min(spent) <= 1.01 * bound.upper


# --- proofs and trajectories


@pytest.mark.parametrize("speed", [math.inf, 0.03])
@pytest.mark.parametrize("distance", [3.0, 50.0])
def test_bounds_from_both_sides_meet_and_the_transfers_fly(speed, distance):
    problem = replace(BASE, speed=speed)
    for turn, row in enumerate(random_starts(np.random.default_rng(5), 8, distance, 0.1)):
        soonest = translation_bound(problem, row)
        assert soonest.lower <= soonest.upper <= (1 + TIME_GAP) * soonest.lower
        assert_captures(problem, row, soonest.transfer)
        within = (1.3 * soonest.upper, 600.0)[turn % 2]
        least = delta_v_bound(problem, row, within)
        assert least.lower <= least.upper <= least.lower + DELTA_V_GAP * least.upper
        assert least.transfer.times[-1] <= within
        assert_captures(problem, row, least.transfer)
        assert math.isinf(delta_v_bound(problem, row, 0.99 * soonest.lower).lower) or soonest.lower == 0.0


def test_controls_that_try_never_beat_either_bound():
    rng = np.random.default_rng(6)
    over, closest = motion(), []
    for speed in (math.inf, 0.05):
        problem = replace(BASE, speed=speed)
        for row in random_starts(rng, 8, 4.0, 0.05):
            soonest = translation_bound(problem, row).lower
            within = 1.5 * soonest
            least = delta_v_lower(problem, row, within)
            step, tries = within / 300, 400
            drift, gain = over(step)
            # half of them burn towards the goal, coast and brake; half switch at random
            side = -np.sign(row[:3] - problem.goal)
            burn = (
                np.abs(row[:3] - problem.goal)
                / (A * within)
                * rng.uniform(0.5, 2.0, (tries, 1))
                * rng.uniform(0.7, 1.3, (tries, 3))
            )
            brake = within * rng.uniform(0.4, 1.0, (tries, 1))
            flips = rng.uniform(0.0, 1.2 * within, (tries, 3))
            state, spent = np.tile(row[:6], (tries, 1)), np.zeros(tries)
            for k in range(301):
                miss = state - np.concatenate((problem.goal, np.zeros(3)))
                met = (np.linalg.norm(miss[:, :3], axis=1) < problem.distance) & (
                    np.linalg.norm(miss[:, 3:], axis=1) < speed
                )
                assert not met.any() or k * step >= soonest
                assert (spent[met] >= least).all()
                if met.any():
                    closest.append(min(k * step / soonest, *(spent[met] / max(least, 1e-9))))
                t = k * step
                sparing = np.where(t < burn, A * side, np.where((t > brake) & (t < brake + burn), -A * side, 0.0))
                violent = np.where(t < flips, A * side, -A * side)
                push = np.where((np.arange(tries) % 2 == 0)[:, None], sparing, violent)
                spent += np.abs(push).sum(axis=1) * step
                state = state @ drift.T + push @ gain.T
    assert min(closest) < 1.1  # some came near


@pytest.mark.parametrize("threshold", [0.0, 1.0])
def test_certificates_hold_between_the_nodes_and_lose_little(threshold):
    grasping = replace(BASE, speed=0.05, grasp_points=(np.array([0.1, 0, 0.05]), np.array([0.0, 0.4, 0.1])))
    row = start((3.0, -4.0, 1.0), (0.02, 0.05, -0.03), debris_w=(0.02, 0.3, 0.05))
    until, fine = 80.0, 8000
    course = Course(grasping, row, until, cells=800)
    h = until / fine
    drift, _ = motion()(h)
    powers = [np.eye(6)]
    for _ in range(fine):
        powers.append(drift @ powers[-1])
    powers, times = np.array(powers), np.linspace(0.0, until, fine + 1)
    attitudes, rates = tumble(grasping.debris_inertia, STILL, row[17:], h, fine)
    half = 0.5 * N * times
    back = np.stack((np.cos(half), 0 * half, 0 * half, -np.sin(half)), axis=1)
    in_lvlh = multiply(back, attitudes)
    p_chaser, p_debris = grasping.grasp_points
    place = rotate(in_lvlh, p_debris - p_chaser)
    spin = rotate(in_lvlh, rates) - np.array([0, 0, N])
    miss = powers @ row[:6] - np.hstack((place, np.cross(spin, place)))
    spread = 2 * math.sin(grasping.angle / 2) * np.linalg.norm(p_chaser)
    speed = grasping.speed + np.linalg.norm(spin, axis=1) * spread + grasping.rate * np.linalg.norm(p_chaser)
    rng = np.random.default_rng(7)
    for _ in range(20):
        d = rng.standard_normal(6) * np.repeat([0.05, 1.0], 3)
        over = np.maximum(np.abs(np.einsum("kis,i->ks", powers[:, :, 3:], d)) - threshold, 0.0) @ grasping.acceleration
        push = np.concatenate(([0.0], np.cumsum(0.5 * h * (over[1:] + over[:-1]))))
        value = miss @ d - push - np.linalg.norm(d[:3]) * (grasping.distance + spread) - np.linalg.norm(d[3:]) * speed
        left, right = course.certificate(d, threshold)
        share = np.arange(10) / 10
        proved = (left[:, None] * (1 - share) + right[:, None] * share).ravel()
        assert (proved <= value[:-1] + 1e-7).all()
        assert (value[:-1] - proved).max() < 0.01


def test_same_start_same_bits():
    row = start((4.0, -3.0, 1.0), (0.02, 0.01, -0.01))
    first = translation_bound(BASE, row), delta_v_bound(BASE, row, 60.0)
    translation_bound(FLAT, start((9, 0, 0)))
    again = translation_bound(BASE, row), delta_v_bound(BASE, row, 60.0)
    for one, other in zip(first, again, strict=True):
        assert (one.lower, one.upper) == (other.lower, other.upper)
        assert (one.transfer.acceleration == other.transfer.acceleration).all()


# --- edges


def test_start_inside_needs_no_time_and_no_delta_v():
    row = start((0.1, 0.3, 0.2))
    assert (translation_bound(BASE, row).lower, translation_bound(BASE, row).upper) == (0.0, 0.0)
    assert (delta_v_bound(BASE, row, 10.0).lower, delta_v_bound(BASE, row, 10.0).upper) == (0.0, 0.0)


def test_flight_too_short_or_without_force_gives_infinity():
    far = start((20, 5, -3))
    for problem in (replace(BASE, periods=100), replace(BASE, acceleration=np.zeros(3))):
        bound = translation_bound(problem, far)
        assert (bound.lower, bound.upper, bound.transfer) == (math.inf, math.inf, None)
    assert delta_v_bound(BASE, far, 10.0).lower == delta_v_bound(BASE, far, 10.0).upper == math.inf
    assert delta_v_lower(BASE, far, 10.0) == math.inf


def test_without_force_limits_no_time_is_too_short():
    bound = translation_bound(replace(BASE, acceleration=np.full(3, np.inf)), start((20, 5, -3)))
    assert (bound.lower, bound.upper) == (0.0, BASE.period)


def test_axis_without_force_is_reached_through_the_orbit():
    problem, row = replace(BASE, acceleration=np.array([0.0, A, A])), start((2, 3, -3), (-0.02, 0, 0))
    bound = translation_bound(problem, row)
    assert bound.lower <= bound.upper <= (1 + TIME_GAP) * bound.lower
    assert_captures(problem, row, bound.transfer)


def test_distance_from_the_debris_ignores_the_goal():
    problem = replace(FLAT, goal=np.array([0, 50.0, 0]), from_debris=True)
    bound = translation_bound(problem, start((2.5, 0, 0)))
    assert bound.lower <= math.sqrt(4 / A) <= bound.upper <= (1 + TIME_GAP) * bound.lower


def test_dwell_keeps_the_thresholds_all_the_while():
    problem, row = replace(BASE, speed=0.03, dwell_ticks=50), start((8, 3, -1))
    bound, least = translation_bound(problem, row), delta_v_bound(problem, row, 80.0)
    assert bound.lower == pytest.approx(translation_bound(replace(problem, dwell_ticks=0), row).lower + 5.0, rel=1e-6)
    assert least.lower <= least.upper
    for transfer in (bound.transfer, least.transfer):
        assert_captures(problem, row, transfer)
        states = flown(problem, row, transfer)
        held = transfer.times >= transfer.times[-1] - 5.0 - 1e-9
        assert held.sum() > 8
        assert (np.linalg.norm(states[held, :3] - problem.goal, axis=1) < problem.distance).all()
        assert (np.linalg.norm(states[held, 3:], axis=1) < problem.speed).all()


# --- on control ticks


@pytest.mark.parametrize("dwell", [0, 7])
def test_commands_held_over_control_periods_capture_at_the_tick(dwell):
    problem, row = replace(BASE, speed=0.05, dwell_ticks=dwell), start((5, -3, 1), (0.05, 0, -0.02))
    tick = math.ceil(translation_bound(problem, row).upper / problem.period) + 1
    transfer = reach_at_tick(problem, row, tick)
    assert transfer.times[-1] == pytest.approx(tick * problem.period)
    assert_captures(problem, row, transfer)
    ticks = transfer.times / problem.period
    assert np.abs(ticks - np.round(ticks)).max() < 1e-9
    late = flown(problem, row, transfer)[-dwell - 1 :]
    assert (np.linalg.norm(late[:, :3] - problem.goal, axis=1) < problem.distance).all()
    assert (np.linalg.norm(late[:, 3:], axis=1) < problem.speed).all()
    soonest = translation_bound(problem, row).lower
    assert reach_at_tick(problem, row, math.floor(soonest / problem.period) - 1) is None


def test_long_flights_hold_commands_over_several_periods():
    row = start((40, -30, 10))
    problem = replace(BASE, speed=0.05)
    tick = math.ceil(1.001 * translation_bound(problem, row).upper / problem.period)
    transfer = reach_at_tick(problem, row, tick)
    assert tick > 800
    assert_captures(problem, row, transfer)
    ticks = transfer.times / problem.period
    assert np.abs(ticks - np.round(ticks)).max() < 1e-9


def test_commands_reach_the_place_they_are_given():
    goal = np.array([1.0, -2.0, 0.5, 0.02, 0.0, -0.01])
    problem, row = replace(BASE, distance=0.01, speed=0.001), start((3, 2, 1))
    transfer = reach_at_tick(problem, row, 400, goal[:3], goal[3:])
    assert_captures(problem, row, transfer, goal)
    assert reach_at_tick(problem, row, 10, goal[:3], goal[3:]) is None


def test_grasp_points_are_met_by_an_aligned_chaser():
    problem = replace(BASE, distance=0.05, speed=0.02, grasp_points=(np.array([0.1, 0, 0]), np.array([0.0, 0.3, 0.0])))
    row = start((5, 3, 1), debris_w=(0.01, 0.05, 0.02))
    bound = translation_bound(problem, row)
    assert 0.0 < bound.lower <= bound.upper < 1.1 * bound.lower
    attitudes, rates = tumble(problem.debris_inertia, STILL, row[17:], bound.upper, 1)
    half = 0.5 * N * bound.upper
    in_lvlh = multiply(conjugate(np.array([math.cos(half), 0, 0, math.sin(half)])), attitudes[1])
    place = rotate(in_lvlh, np.array([-0.1, 0.3, 0.0]))
    velocity = np.cross(rotate(in_lvlh, rates[1]) - np.array([0, 0, N]), place)
    assert_captures(problem, row, bound.transfer, np.concatenate((place, velocity)))
