"""Torque-free rotation of a rigid body, in closed form, at evenly spaced times.

Principal axes i, j, k, with j the middle moment and k the axis about which the polhode circulates
(the largest moment when |h|² ≥ 2 E J_j, else the smallest). Euler's equations are then solved by

    w_i = A_i cn(u, m),   w_j = A_j sn(u, m),   w_k = A_k dn(u, m),   u = λ t + u_0

(Landau & Lifshitz, Mechanics, §37; amplitudes written as sums, so nothing cancels). The angular momentum is
fixed in N, so only the angle φ about it is left: with p(t) the shortest rotation from ĥ to e = ± the k axis (body axes),

    q(t) = q_NE ⊗ exp(φ e / 2) ⊗ p(t),     φ' = (2 E/|h| + w·e) / (1 + ĥ·e),

smooth because ĥ·e > 0; φ is summed by Gauss-Legendre. On the separatrix (unstable spin about the middle axis)
the elliptic functions lose their period, and the motion is integrated instead (DOP853, 1e-12).
"""

from __future__ import annotations

import math

import numpy as np
from scipy.special import ellipj, ellipkinc  # type: ignore[import-untyped]

from detumble.quaternions import Array, conjugate, multiply

SEPARATRIX = 1e-8  # closer to it than this, 1 - m has too few digits left
CELL_ANGLE = 0.1  # rad turned in one quadrature cell: three nodes leave 1e-13


def tumble(inertia: Array, attitude: Array, rate: Array, period: float, ticks: int) -> tuple[Array, Array]:
    """Attitude and rate of a torque-free body at t = 0, period, …, ticks · period.

    Args:
        inertia: (3, 3) kg m², body axes.
        attitude: (4,) body → N at t = 0, unit norm.
        rate: (3,) rad/s at t = 0, body axes.
        period: s between two rows.
        ticks: rows after the first.

    Returns:
        attitudes (ticks + 1, 4), rates (ticks + 1, 3) in body axes.
    """
    moments, axes = np.linalg.eigh(inertia)
    axes[:, 2] *= math.copysign(1.0, float(np.linalg.det(axes)))
    squared = (axes.T @ rate) ** 2
    # |h|² - 2 E J_j, as a difference of two terms that cannot cancel within themselves
    excess = moments[2] * (moments[2] - moments[1]) * squared[2] - moments[0] * (moments[1] - moments[0]) * squared[0]
    order, parity = ((0, 1, 2), 1.0) if excess >= 0.0 and moments[2] > moments[1] else ((2, 1, 0), -1.0)
    frame = axes[:, order]
    ji, jj, jk = (float(moments[axis]) for axis in order)
    wi, wj, wk = (float(component) for component in frame.T @ rate)
    if jk in (ji, jj):  # a sphere, or a symmetric body turning about an axis across its own
        return _steady(attitude, rate, period, ticks)

    ratio = jj * (jk - jj) / (ji * (jk - ji))
    ai = math.copysign(math.sqrt(wi * wi + ratio * wj * wj), wi)
    aj = abs(ai) / math.sqrt(ratio)
    ak = math.copysign(math.sqrt(wk * wk + jj * (jj - ji) / (jk * (jk - ji)) * wj * wj), wk)
    if ai == 0.0 or ak == 0.0:
        return _steady(attitude, rate, period, ticks)
    m = min(1.0, (jj - ji) * ji * ai * ai / ((jk - jj) * jk * ak * ak))
    if 1.0 - m < SEPARATRIX:
        return _integrated(inertia, attitude, rate, period, ticks)
    pace = parity * math.copysign(1.0, (jk - ji) * ai * ak) * math.sqrt((jk - jj) * (jk - ji) / (ji * jj)) * abs(ak)
    start = float(ellipkinc(math.atan2(wj / aj, wi / ai), m))

    cells = max(1, math.ceil((abs(ai) + aj + abs(ak)) * period / CELL_ANGLE))
    width = period / cells
    nodes, weights = np.polynomial.legendre.leggauss(3)
    _, _, inner, _ = ellipj(pace * (np.arange(ticks * cells)[:, None] + 0.5 * (nodes + 1.0)) * width + start, m)
    momentum = math.sqrt((ji * wi) ** 2 + (jj * wj) ** 2 + (jk * wk) ** 2)
    along = (ji * wi * wi + jj * wj * wj + jk * wk * wk) / momentum  # 2 E / |h|
    slope = (along + abs(ak) * inner) / (1.0 + jk * abs(ak) / momentum * inner)
    steps = 0.5 * width * (slope @ weights).reshape(ticks, cells).sum(axis=1)
    half = 0.5 * np.concatenate(([0.0], np.cumsum(steps)))

    sn, cn, dn, _ = ellipj(pace * np.arange(ticks + 1) * period + start, m)
    principal = np.stack((ai * cn, aj * sn, ak * dn), axis=-1)
    axis = math.copysign(1.0, ak) * frame[:, 2]
    heading = (principal * np.array([ji, jj, jk])) @ frame.T / momentum
    swing = np.concatenate((1.0 + (heading @ axis)[:, None], np.cross(heading, axis)), axis=-1)
    swing /= np.linalg.norm(swing, axis=-1, keepdims=True)
    twist = np.concatenate((np.cos(half)[:, None], np.sin(half)[:, None] * axis), axis=-1)
    origin = multiply(attitude, conjugate(swing[0]))
    return multiply(origin, multiply(twist, swing)), principal @ frame.T


def _steady(attitude: Array, rate: Array, period: float, ticks: int) -> tuple[Array, Array]:
    """Rotation at constant body rate: q(t) = q(0) ⊗ exp(w t / 2)."""
    half = 0.5 * np.arange(ticks + 1)[:, None] * period
    speed = float(np.linalg.norm(rate))
    axis = rate / speed if speed > 0.0 else rate
    turned = np.concatenate((np.cos(speed * half), np.sin(speed * half) * axis), axis=-1)
    return multiply(attitude, turned), np.tile(rate, (ticks + 1, 1))


def _integrated(inertia: Array, attitude: Array, rate: Array, period: float, ticks: int) -> tuple[Array, Array]:
    """The same motion by an eighth-order Runge-Kutta method, for the neighbourhood of the separatrix."""
    from scipy.integrate import solve_ivp  # type: ignore[import-untyped]  # slow to import, rarely needed

    inverse = np.linalg.inv(inertia)

    def slope(_: float, state: Array) -> Array:
        q, w = state[:4], state[4:]
        turning = 0.5 * multiply(q, np.concatenate(([0.0], w)))
        return np.concatenate((turning, -inverse @ np.cross(w, inertia @ w)))

    times = np.arange(ticks + 1) * period
    state = np.concatenate((attitude, rate))
    if ticks == 0:
        return attitude[None, :], rate[None, :]
    found = solve_ivp(slope, (0.0, times[-1]), state, "DOP853", times, rtol=1e-12, atol=1e-14).y.T
    return found[:, :4] / np.linalg.norm(found[:, :4], axis=-1, keepdims=True), found[:, 4:]
