"""Free rotation of a rigid body in closed form: Jacobi's elliptic functions for the rate, one quadrature for the attitude.

With moments A < B < C (or A > B > C), L² ≥ 2 E B (or ≤), rate ω in these axes and φ(0) from the start:

    ω1 = a cn u, ω2 = b sn u, ω3 = c dn u,   u = p (t + t0)

L stays in N, so the attitude is a turn about L, by ψ, after the shortest turn of the body's L onto it: 3-1-3 Euler angles with

    ψ' = L (2 E - C ω3²) / (L² - C² ω3²)

Its integral is a number of whole periods (trapezoidal rule, exact to rounding for a periodic function) and a rest (Gauss).
Not within rounding of the separatrix, where the period is infinite.
Source: Landau & Lifshitz, *Mechanics*, §37.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ellipj, ellipk, ellipkinc

Array = NDArray[np.float64]
POINTS = 8192
"""Of the quadratures; long thin bodies need many, as ψ' has narrow peaks."""


def rotation(inertia: ArrayLike, rate: ArrayLike, time: float) -> tuple[Array, Array]:
    """Give the turn and the rate of a free body after a time.

    Args:
        inertia: tensor (3, 3), kg m².
        rate: at the start, body axes (3,), rad/s.
        time: s.

    Returns:
        Rotation matrix body at the end -> body at the start (3, 3), and the rate at the end, body axes (3,).
    """
    tensor, w = np.array(inertia, float), np.array(rate, float)
    momentum = tensor @ w
    if np.linalg.norm(np.cross(w, momentum)) <= 1e-15 * np.linalg.norm(w) * np.linalg.norm(momentum):
        return about(w, np.linalg.norm(w) * time), w
    moments, axes = np.linalg.eigh(tensor)
    size, energy2 = float(np.linalg.norm(momentum)), float(w @ momentum)
    if size**2 < energy2 * moments[1]:
        moments, axes = moments[::-1], axes[:, ::-1]
    axes = axes * np.array([1.0, 1.0, np.linalg.det(axes)])
    (a, b, c), (w1, w2, w3) = moments, axes.T @ w
    short, long = energy2 * c - size**2, size**2 - energy2 * a
    amplitude = np.sqrt([short / (a * (c - a)), short / (b * (c - b)), long / (c * (c - a))])
    amplitude[1:] *= np.copysign(1.0, [w3 * (c - b), w3])
    p, m = np.sqrt((c - b) * long / (a * b * c)), (b - a) * short / ((c - b) * long)
    start = ellipkinc(np.arctan2(w2 / amplitude[1], w1 / amplitude[0]), m)

    def rates(u: Array) -> Array:
        sn, cn, dn, _ = ellipj(u, m)
        return amplitude * np.stack([cn, sn, dn], axis=-1)

    def turning(u: Array) -> Array:
        w3 = rates(u)[..., 2]
        return np.asarray(size * (energy2 - c * w3**2) / (size**2 - (c * w3) ** 2) / p)

    half = 2.0 * float(ellipk(m))  # a period of dn
    periods, rest = divmod(p * time, half)
    mean = turning(start + half * np.arange(POINTS) / POINTS).mean()
    nodes, weights = np.polynomial.legendre.leggauss(16)
    panel = rest / (POINTS // 16)
    inner = start + panel * (np.arange(POINTS // 16)[:, None] + 0.5 * (nodes + 1.0))
    turned = periods * half * mean + 0.5 * panel * (turning(inner) @ weights).sum()
    end = rates(np.asarray(start + (p * time) % (2.0 * half)))

    def frame(rate: Array) -> Array:
        """Axes whose third is L, in body axes; the first is normal to L and to axis 3."""
        third = moments * rate / size
        first = np.cross([0.0, 0.0, 1.0], third)
        first /= np.linalg.norm(first)
        return np.stack([first, np.cross(third, first), third])

    turn = frame(axes.T @ w).T @ about([0.0, 0.0, 1.0], turned) @ frame(end)
    return axes @ turn @ axes.T, axes @ end


def about(axis: ArrayLike, angle: float) -> Array:
    """Give the rotation matrix about an axis (3,) by an angle, rad."""
    x, y, z = np.array(axis, float) / (np.linalg.norm(axis) or 1.0)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross)


def matrix(quaternion: ArrayLike) -> Array:
    """Give the rotation matrix of a unit quaternion, scalar first (4,)."""
    scalar, *vector = np.array(quaternion, float)
    return about(vector, 2.0 * np.arctan2(np.linalg.norm(vector), scalar))
