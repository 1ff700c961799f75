"""Chases for the tests of bounds: the paper's, in its orbit and without one; motion written apart; what a transfer must do."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

from detumble.analysis.bounds.fuel import delta_v_bound, delta_v_lower
from detumble.analysis.bounds.pursuit import Pursuit
from detumble.analysis.bounds.soonest import translation_bound

N = math.sqrt(3.986004418e14 / 7071e3**3)
A = 0.1 / 9.0
STILL = np.array([1.0, 0.0, 0.0, 0.0])
BASE = Pursuit(
    mean_motion=N,
    lvlh_attitude=STILL,
    acceleration=np.full(3, A),
    torque=np.full(3, 0.01),
    chaser_inertia=np.diag([0.1, 0.1, 0.05]),
    debris_inertia=np.diag([0.05, 0.06, 0.08]),
    goal=np.array([0.0, 0.3, 0.0]),
    grasp_points=None,
    from_debris=False,
    distance=0.5,
    angle=math.radians(20.0),
    rate=0.05,
    speed=math.inf,
    period=0.1,
    periods=6000,
    dwell_ticks=0,
)
FLAT = replace(BASE, mean_motion=0.0, goal=np.zeros(3))
"""No orbit: three double integrators."""
TIME_GAP, DELTA_V_GAP = 1e-3, 5e-3


def start(r=(0, 0, 0), v=(0, 0, 0), q=STILL, w=(0, 0, 0), debris_q=STILL, debris_w=(0, 0, 0)):
    return np.concatenate([np.array(part, float) for part in (r, v, q, w, debris_q, debris_w)])


def random_starts(rng, count, distance, drift):
    away = rng.standard_normal((count, 3))
    away *= (rng.uniform(0.2, 1.0, count) * distance / np.linalg.norm(away, axis=1))[:, None]
    return [start(r, v) for r, v in zip(away, drift * rng.uniform(-1, 1, (count, 3)), strict=True)]


def motion(n=N):
    """Transition and input of the equations of motion, by the matrix exponential."""
    rates = np.zeros((9, 9))
    rates[0:3, 3:6] = rates[3:6, 6:9] = np.eye(3)
    rates[3, 0], rates[3, 4], rates[4, 3], rates[5, 2] = 3 * n * n, 2 * n, -2 * n, -n * n

    def over(seconds):
        step = expm(rates * seconds)
        return step[:6, :6], step[:6, 6:]

    return over


def flown(pursuit, row, transfer):
    """The states at the transfer's times."""
    over, state = motion(pursuit.mean_motion), row[:6]
    states = [state]
    for width, push in zip(np.diff(transfer.times), transfer.acceleration, strict=True):
        drift, gain = over(width)
        state = drift @ state + gain @ push
        states.append(state)
    return np.array(states)


def assert_captures(pursuit, row, transfer, goal=None):
    """The transfer keeps to the limits, moves as it says, and ends within the thresholds."""
    goal = np.concatenate((pursuit.goal, np.zeros(3))) if goal is None else goal
    assert (np.abs(transfer.acceleration) <= pursuit.acceleration).all()
    states = flown(pursuit, row, transfer)
    assert np.abs(states - transfer.states).max() < 1e-9 * (1.0 + np.abs(states).max())
    miss = states[-1] - goal
    assert np.linalg.norm(miss[:3]) < pursuit.distance
    assert np.linalg.norm(miss[3:]) < pursuit.speed
    spent = sum(np.abs(u).sum() * h for u, h in zip(transfer.acceleration, np.diff(transfer.times), strict=True))
    assert transfer.delta_v == pytest.approx(spent, rel=1e-12, abs=1e-15)


def assert_time(pursuit, row, expected):
    bound = translation_bound(pursuit, row)
    assert bound.lower <= expected * (1 + 1e-9) <= bound.upper * (1 + 2e-9)
    assert bound.upper - bound.lower <= TIME_GAP * expected
    assert bound.transfer.times[-1] == bound.upper
    assert_captures(pursuit, row, bound.transfer)


def assert_delta_v(pursuit, row, within, expected):
    bound = delta_v_bound(pursuit, row, within)
    assert bound.lower <= expected * (1 + 1e-9) <= bound.upper * (1 + 2e-9)
    assert bound.upper - bound.lower <= DELTA_V_GAP * expected
    assert bound.transfer.times[-1] <= within
    assert bound.transfer.delta_v == bound.upper
    assert_captures(pursuit, row, bound.transfer)
    assert 0.97 * expected <= delta_v_lower(pursuit, row, within) <= expected * (1 + 1e-9)
