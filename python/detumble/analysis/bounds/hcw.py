"""Hill-Clohessy-Wiltshire motion in closed form: free drift, response to acceleration, bounds of second derivatives.

State X = (r, v) in H, acceleration u(t) held or varying in H axes:

    X(t) = Φ(t) X(0) + ∫₀ᵗ K(s) u(t - s) ds,     K = [Φ_rv; Φ_vv]   (6 x 3).

Clohessy & Wiltshire 1960, in the form of e.g. Vallado, Fundamentals of Astrodynamics, §6.8. Mean motion 0 gives the double
integrator, without a special case. K is stored transposed, (3, 6): one row of states for each control axis.
"""

from __future__ import annotations

import numpy as np

from detumble.quaternions import Array


def _entire(x: Array) -> tuple[Array, Array, Array]:
    """sin x / x, (1 - cos x) / x², (x - sin x) / x³, without cancellation and defined at 0."""
    safe = np.where(np.abs(x) < 0.5, 1.0, x)
    square = x * x
    series = np.polynomial.polynomial.polyval(
        np.minimum(square, 0.25), [1 / 6, -1 / 120, 1 / 5040, -1 / 362880, 1 / 39916800, -1 / 6227020800]
    )
    cubic = np.where(np.abs(x) < 0.5, series, (safe - np.sin(safe)) / safe**3)
    return np.sinc(x / np.pi), 0.5 * np.sinc(0.5 * x / np.pi) ** 2, cubic


def hcw(mean_motion: float, times: Array) -> tuple[Array, Array, Array]:
    """Φ, K and ∫₀ᵗ K at each time.

    Args:
        mean_motion: n, rad/s.
        times: (k,) s, not negative.

    Returns:
        Φ (k, 6, 6), K (k, 3, 6) and its integral (k, 3, 6), s, m and m/s.
    """
    n, t = mean_motion, times
    x = n * t
    s1, c2, s3 = _entire(x)
    one, zero = np.ones_like(t), np.zeros_like(t)
    sine, cosine, versine = n * t * s1, np.cos(x), x * x * c2  # n · (sin x)/n, cos x, 1 - cos x
    rr = [[4 - 3 * cosine, zero, zero], [-6 * x**3 * s3, one, zero], [zero, zero, cosine]]
    rv = [[t * s1, 2 * t * x * c2, zero], [-2 * t * x * c2, t * (4 * s1 - 3), zero], [zero, zero, t * s1]]
    vr = [[3 * n * sine, zero, zero], [-6 * n * versine, zero, zero], [zero, zero, -n * sine]]
    vv = [[cosine, 2 * sine, zero], [-2 * sine, 4 * cosine - 3, zero], [zero, zero, cosine]]
    # ∫ Φ_rv; and ∫ Φ_vv = Φ_rv
    once, coupled = t * t * c2, 2 * t * t * x * s3
    area = [[once, coupled, zero], [-coupled, 4 * once - 1.5 * t * t, zero], [zero, zero, once]]

    def stack(upper: list[list[Array]], lower: list[list[Array]]) -> Array:
        return np.moveaxis(np.array(upper + lower), -1, 0)

    def per_axis(upper: list[list[Array]], lower: list[list[Array]]) -> Array:
        return np.ascontiguousarray(np.moveaxis(stack(upper, lower), -1, 1))

    drift = np.concatenate((stack(rr, vr), stack(rv, vv)), axis=-1)
    return drift, per_axis(rv, vv), per_axis(area, rv)


def kernel_bend(mean_motion: float, direction: Array) -> Array:
    """Upper bounds (3,) of |d²/ds² d · K_j(s)| over all s, per control axis, for d (6,)."""
    n, (x, y, z, vx, vy, vz) = mean_motion, np.abs(direction)
    along_x = n * (x + 2 * y) + n * n * (vx + 2 * vy)
    along_y = n * (2 * x + 4 * y) + n * n * (2 * vx + 4 * vy)
    return np.array([along_x, along_y, n * z + n * n * vz])


def drift_bend(mean_motion: float, state: Array) -> Array:
    """Upper bounds (6,) of |d²/dt² Φ(t) X| over all t, m/s² and m/s³, for a state X (6,)."""
    n, (x, _, z, vx, vy, vz) = mean_motion, np.abs(state)
    place = n * np.array([3 * n * x + vx + 2 * vy, 6 * n * x + 2 * vx + 4 * vy, n * z + vz])
    return np.concatenate((place, n * place))


def held(mean_motion: float, state: Array, times: Array, acceleration: Array) -> Array:
    """States (k + 1, 6) at the times of an acceleration held between them: exact.

    Args:
        mean_motion: rad/s.
        state: (6,) at times[0], m and m/s in H.
        times: (k + 1,) s, rising.
        acceleration: (k, 3) m/s² in H, from each time to the next.
    """
    drift, _, area = hcw(mean_motion, np.diff(times))
    pushed = np.einsum("kj,kjs->ks", acceleration, area)
    states = [state]
    for step, push in zip(drift, pushed, strict=True):
        states.append(step @ states[-1] + push)
    return np.array(states)
