"""The least time from capture to settled: closed forms, captures drawn at random, and every law."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

detumble = pytest.importorskip("detumble")
core = pytest.importorskip("detumble._core")

from detumble.analysis.bounds.detumbling import detumble_bound, detumble_lower, largest_moment  # noqa: E402  # needs the core
from detumble.analysis.bounds.pursuit import Pursuit, start_of  # noqa: E402
from detumble.analysis.bounds.tumble import tumble  # noqa: E402
from detumble.scenario import with_settings  # noqa: E402
from detumble.scenario.core import case  # noqa: E402
from detumble.workload import start_columns  # noqa: E402

FAST = ["debris.tumble_rate=[0.3, -0.1, 0.2]"]
KEPT = ['capture.transition="momentum_conserving"', "capture.speed=0.001"]
SPHERES = [
    "chaser.inertia=[0.1, 0.1, 0.1]",
    "debris.inertia=[0.05, 0.05, 0.05]",
    "actuators.torque_limit=[0.01, 1e-9, 1e-9]",
]


def plain(settings, name="paper"):
    return case(with_settings(detumble.load(name), [*settings, "sensors={}"]), "pd")


def slowest(numbers):
    """The largest rate, rad/s, of a settled stack."""
    return numbers["orbit"]["mean_motion"] + numbers["settled"]["rate"]


def test_a_sphere_that_spins_about_its_torque_axis_stops_in_its_closed_form():
    numbers = plain([*SPHERES, "debris.tumble_rate=[0.4, 0, 0]", "settled.angle_deg=180"])
    bound = detumble_bound(numbers)
    assert bound.matched == pytest.approx(0.15 * (0.4 - slowest(numbers)) / 0.01, rel=1e-6)
    # no capture leaves less than the rate threshold off
    assert bound.lower == pytest.approx(0.15 * (0.4 - 0.05 - slowest(numbers)) / 0.01, rel=1e-6)


@pytest.mark.parametrize("angle", [0.6, 1.5, 2.8])
def test_a_sphere_at_rest_turns_to_the_orbit_frame_in_its_closed_form(angle):
    q = [math.cos(angle / 2), math.sin(angle / 2), 0.0, 0.0]
    numbers = plain(
        [*SPHERES, "debris.tumble_rate=[0, 0, 0]", f"debris.attitude={q}", "orbit={radius=1e9}", "time.duration=10.0"]
    )
    acceleration, left = 0.01 / 0.15, angle - numbers["settled"]["angle"]
    peak = math.sqrt(acceleration * left + 0.5 * slowest(numbers) ** 2)
    assert detumble_bound(numbers).matched == pytest.approx((2 * peak - slowest(numbers)) / acceleration, rel=1e-5)


def test_the_turning_of_the_orbit_frame_helps_a_stack_to_align():
    # a sphere at rest in N, H coming its way at n: it pushes against H and brakes to the rate that counts as settled
    radius, strength = 1e6, 2.3  # torque over moment, in n²
    n = math.sqrt(3.986004418e14 / radius**3)
    settled, angle = 1.01 * n, 0.9 + math.radians(2.0)
    torque, q = strength * n * n * 0.15, [math.cos(angle / 2), 0.0, 0.0, math.sin(angle / 2)]
    numbers = plain(
        [*SPHERES[:2], f"orbit={{radius={radius}}}", f"actuators.torque_limit=[1e-12, 1e-12, {torque}]",
         "debris.tumble_rate=[0, 0, 0]", f"debris.attitude={q}", f"settled={{angle_deg=2.0, rate={settled}}}",
         "time.duration=0.1"]
    )  # fmt: skip
    peak = n * math.sqrt(0.9 * strength + 0.5 * (1.0 + 1.01**2))
    assert 0.0 <= detumble_bound(numbers).matched < (2.0 * peak - n - settled) / (strength * n * n)


def test_momentum_alone_is_the_impulse_it_takes():
    momentum, torque = np.array([0.001, 0.05, 0.1]), np.array([0.01, 0.02, 0.02])
    found = detumble_lower(momentum, torque, np.array(0.5), np.array(0.006))
    assert found == pytest.approx([0.0, 0.047 / 0.03, 0.097 / 0.03])


def test_without_a_speed_threshold_the_orbital_term_may_cancel_the_tumble():
    assert detumble_bound(plain([*FAST, KEPT[0]])).lower == 0.0
    assert detumble_bound(plain([*FAST, *KEPT])).lower > 1.0


def test_later_captures_are_no_looser():
    numbers = plain([], "far_tumble")
    early, late = detumble_bound(numbers), detumble_bound(numbers, not_before=50.0)
    assert late.lower >= early.lower
    assert late.matched >= early.matched


@pytest.mark.parametrize("name", ["paper", "far_tumble", "twelve_u"])
@pytest.mark.parametrize("extra", [[], FAST, [*FAST, *KEPT]])
def test_no_admissible_capture_leaves_less_to_do(name, extra):
    # captures drawn within the thresholds; the stack by the merge's own definition; what stops it, momentum at least
    numbers = plain(extra, name)
    pursuit, row, bound = Pursuit.of(numbers), start_of(numbers), detumble_bound(numbers)
    attitudes, rates = tumble(pursuit.debris_inertia, row[13:17], row[17:], pursuit.period, 1000)
    mass = (
        numbers["chaser"]["mass"] * numbers["debris"]["mass"] / (numbers["chaser"]["mass"] + numbers["debris"]["mass"])
    )
    spin_of_h = np.array([0.0, 0.0, pursuit.mean_motion])
    rng = np.random.default_rng(5)

    def within(radius):
        vector = rng.standard_normal(3)
        return vector / np.linalg.norm(vector) * radius * rng.choice([1.0, rng.random()])

    for tick in rng.integers(0, 1000, 300):
        to_debris = Rotation.from_rotvec(within(pursuit.angle)).as_matrix()  # D → C
        w_d = to_debris @ rates[tick]
        w_c = w_d + within(pursuit.rate)
        d_inertia = to_debris @ pursuit.debris_inertia @ to_debris.T
        if numbers["plan"]["transition"] != "momentum_conserving":
            inertia = pursuit.chaser_inertia + pursuit.debris_inertia
            momentum = inertia @ w_c
        else:
            to_n = Rotation.from_quat(np.roll(attitudes[tick], -1)).as_matrix() @ to_debris.T
            angle = pursuit.mean_motion * tick * pursuit.period
            to_h = Rotation.from_rotvec([0, 0, -angle]).as_matrix() @ to_n  # H is N at t = 0 in these scenarios
            goal, velocity = pursuit.goal, np.zeros(3)
            if pursuit.grasp_points is not None:
                p_c, p_d = pursuit.grasp_points[0], to_debris @ pursuit.grasp_points[1]
                h_spin = to_h.T @ spin_of_h
                goal = to_h @ (p_d - p_c)
                velocity = to_h @ (np.cross(w_d - h_spin, p_d) - np.cross(w_c - h_spin, p_c))
            r = goal + within(pursuit.distance)
            v = velocity + within(min(pursuit.speed, 10.0))
            arm, across = to_h.T @ r, to_h.T @ (v + np.cross(spin_of_h, r))
            inertia = pursuit.chaser_inertia + d_inertia + mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
            momentum = pursuit.chaser_inertia @ w_c + d_inertia @ w_d + mass * np.cross(arm, across)
        largest = np.linalg.eigvalsh(inertia)[-1]
        assert largest <= largest_moment(numbers) * (1 + 1e-12)
        # any stop is an impulse of at least |h|, less what a settled stack keeps, on at most the longest torque
        upper = (np.linalg.norm(momentum) + largest * slowest(numbers)) / pursuit.torque.min()
        turn = 2 * math.sqrt(2 * math.pi * largest / pursuit.torque.min())
        assert bound.lower <= upper + turn
        by_momentum = np.linalg.norm(momentum) - largest_moment(numbers) * slowest(numbers)
        if numbers["plan"]["transition"] == "momentum_conserving":  # this is then the very relaxation
            assert bound.lower <= max(0.0, by_momentum / np.linalg.norm(pursuit.torque)) + 1e-12


@pytest.mark.parametrize("name", ["paper", "far_tumble", "twelve_u"])
@pytest.mark.parametrize("extra", [[], FAST, [*FAST, *KEPT], [*FAST, 'capture.transition="approximate"']])
def test_no_law_settles_sooner(name, extra):
    numbers = plain(extra, name)
    bound = detumble_bound(numbers)
    for law in detumble.LAWS:
        flown = detumble.simulate(with_settings(detumble.load(name), extra), law, seed=1).metrics
        if flown.settling_time is None:
            continue
        own = detumble_lower(
            np.array(flown.momentum_at_capture), np.array(numbers["actuators"]["torque"]),
            np.array(largest_moment(numbers)), np.array(slowest(numbers)),
        )  # fmt: skip
        assert flown.settling_time >= max(bound.lower, float(own))
        assert flown.settling_time >= detumble_bound(numbers, not_before=flown.capture_time).lower


@pytest.mark.parametrize("name", ["paper", "far_tumble"])
def test_no_run_of_many_settles_sooner_than_its_momentum_lets_it(name):
    scenario = detumble.load(name)
    numbers = case(scenario, "prrl")
    rng = np.random.default_rng(6)
    count = 300
    starts = np.repeat(start_of(numbers)[None, :], count, axis=0)
    starts[:, :3] += rng.uniform(-0.3, 0.3, (count, 3))
    starts[:, 17:] = rng.uniform(-0.15, 0.15, (count, 3))
    flown = core.fly_many(numbers, start_columns(starts), count, seed=1)
    settled = np.isfinite(flown["settling_time"])
    assert settled.sum() > 50
    least = detumble_lower(
        flown["momentum_at_capture"], np.array(numbers["actuators"]["torque"]),
        np.array(largest_moment(numbers)), np.array(slowest(numbers)),
    )  # fmt: skip
    assert least[settled].max() > 1.0
    assert (flown["settling_time"][settled] >= least[settled]).all()


def test_a_label_of_a_tick_begins_at_that_tick():
    numbers = case(detumble.load("paper"), "none")
    for tick in (3, 56, 76, 999):  # 5.6 / 0.1 is less than 56
        here, before = (detumble_bound(numbers, float(f"{(tick - less) / 10}")).matched for less in (0, 1))
        assert here == detumble_bound(numbers, (tick + 0.5) * 0.1).matched
        assert here >= before
