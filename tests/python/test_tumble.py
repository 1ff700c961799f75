"""Torque-free tumble in closed form, against an integrator and its own invariants."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from detumble.analysis.bounds.tumble import tumble
from detumble.quaternions import conjugate, multiply, rotate

STILL = np.array([1.0, 0.0, 0.0, 0.0])


def integrated(inertia, attitude, rate, times):
    inverse = np.linalg.inv(inertia)

    def slope(_, state):
        w = state[4:]
        turning = 0.5 * multiply(state[:4], np.concatenate(([0.0], w)))
        return np.concatenate((turning, -inverse @ np.cross(w, inertia @ w)))

    found = solve_ivp(
        slope, (0.0, times[-1]), np.concatenate((attitude, rate)), "DOP853", times, rtol=1e-12, atol=1e-14
    )
    return found.y[:4].T, found.y[4:].T


def angle_between(p, q):
    turn = multiply(conjugate(p), q)
    return 2.0 * np.arctan2(np.linalg.norm(turn[:, 1:], axis=1), np.abs(turn[:, 0]))


def random_body(rng):
    moments = np.sort(rng.uniform(0.02, 0.1, 3))
    moments[2] = min(moments[2], moments[0] + moments[1])
    axes, _ = np.linalg.qr(rng.standard_normal((3, 3)))
    attitude = rng.standard_normal(4)
    return axes @ np.diag(moments) @ axes.T, attitude / np.linalg.norm(attitude)


def test_validation_random_tumbles_match_an_eighth_order_integrator():
    rng = np.random.default_rng(0)
    for _ in range(12):
        inertia, attitude = random_body(rng)
        rate = rng.standard_normal(3) * rng.choice([0.01, 0.1, 1.0])
        attitudes, rates = tumble(inertia, attitude, rate, 0.1, 600)
        expected, expected_rates = integrated(inertia, attitude, rate, np.arange(601) * 0.1)
        assert angle_between(attitudes, expected).max() < 1e-9
        assert np.abs(rates - expected_rates).max() < 1e-10 * max(1.0, np.abs(rate).max())


@pytest.mark.parametrize("moments", [(5, 5, 8), (3, 5, 5), (8, 5, 5), (5, 5, 5), (3, 5, 6), (5, 3, 6), (6, 5, 3)])
@pytest.mark.parametrize(
    "rate",
    [(0, 0, 0), (0.1, 0, 0), (0, -0.1, 0), (0, 0, 0.1), (0, 0.2, 0.3), (0.1, 0, -0.3), (-0.2, 0.1, 0), (0.1, 0.2, 0.3)],
)
def test_validation_degenerate_tumbles_match_an_integrator(moments, rate):
    inertia, rate = 0.01 * np.diag(np.array(moments, float)), np.array(rate, float)
    attitudes, rates = tumble(inertia, STILL, rate, 0.1, 300)
    expected, expected_rates = integrated(inertia, STILL, rate, np.arange(301) * 0.1)
    assert angle_between(attitudes, expected).max() < 1e-9
    assert np.abs(rates - expected_rates).max() < 1e-10


@pytest.mark.parametrize("nudge", [0.0, 1e-9, 1e-5, 1e-3])
def test_spin_about_the_middle_axis_keeps_energy_momentum_and_its_own_kinematics(nudge):
    inertia, rate = np.diag([0.03, 0.05, 0.06]), np.array([nudge, 0.2, 0.0])
    attitudes, rates = tumble(inertia, STILL, rate, 0.1, 6000)
    energy = np.einsum("ti,ij,tj->t", rates, inertia, rates)
    momentum = rotate(attitudes, rates @ inertia)
    assert np.ptp(energy) < 1e-9 * energy[0]
    assert np.abs(momentum - momentum[0]).max() < 1e-9
    middle = 0.5 * (rates[1:] + rates[:-1])
    turned = multiply(conjugate(attitudes[:-1]), attitudes[1:])
    assert np.abs(20.0 * turned[:, 1:] - middle).max() < 1e-4


def test_rotate_and_multiply_agree_on_composition():
    rng = np.random.default_rng(1)
    p, q = (x / np.linalg.norm(x) for x in rng.standard_normal((2, 4)))
    v = rng.standard_normal(3)
    assert rotate(multiply(p, q), v) == pytest.approx(rotate(p, rotate(q, v)), abs=1e-14)
