"""Workload W in scalar Python compiled by Numba: RK4 with the period as step; threads share the trajectories."""

from __future__ import annotations

from math import cos
from typing import TYPE_CHECKING, Any

import numba
import numpy as np
from serve import serve, threads_asked
from w import Workload

if TYPE_CHECKING:
    from collections.abc import Sequence

    from serve import Array, Fly

GOLDEN = np.uint64(0x9E3779B97F4A7C15)
compiled = numba.njit(error_model="numpy", fastmath={"contract"})


@compiled
def cross(a0: float, a1: float, a2: float, b0: float, b1: float, b2: float) -> tuple[float, float, float]:
    """a × b."""
    return a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0


@compiled
def relative(c: Array, d: Array) -> tuple[float, float, float, float]:
    """q_D* ⊗ q_C."""
    return (
        d[0] * c[0] + d[1] * c[1] + d[2] * c[2] + d[3] * c[3],
        d[0] * c[1] - d[1] * c[0] - d[2] * c[3] + d[3] * c[2],
        d[0] * c[2] + d[1] * c[3] - d[2] * c[0] - d[3] * c[1],
        d[0] * c[3] - d[1] * c[2] + d[2] * c[1] - d[3] * c[0],
    )


@compiled
def seen_from(q: Sequence[float], u0: float, u1: float, u2: float) -> tuple[float, float, float]:
    """q* ⊗ u ⊗ q."""
    t0, t1, t2 = cross(q[1], q[2], q[3], u0, u1, u2)
    s0, s1, s2 = cross(q[1], q[2], q[3], t0, t1, t2)
    return u0 - 2.0 * q[0] * t0 + 2.0 * s0, u1 - 2.0 * q[0] * t1 + 2.0 * s1, u2 - 2.0 * q[0] * t2 + 2.0 * s2


@compiled
def clipped(x: float, limit: float) -> float:
    """Clip to ± limit."""
    return min(max(x, -limit), limit)


@compiled
def turning(y: Array, o: int, d: Array) -> None:
    """q' = q ⊗ (0, ω) / 2, of the quaternion at `o` with the rate behind it."""
    q0, q1, q2, q3, w0, w1, w2 = y[o], y[o + 1], y[o + 2], y[o + 3], y[o + 4], y[o + 5], y[o + 6]
    d[o] = -0.5 * (q1 * w0 + q2 * w1 + q3 * w2)
    d[o + 1] = 0.5 * (q0 * w0 + q2 * w2 - q3 * w1)
    d[o + 2] = 0.5 * (q0 * w1 + q3 * w0 - q1 * w2)
    d[o + 3] = 0.5 * (q0 * w2 + q1 * w1 - q2 * w0)


@compiled
def mixed(counter: np.uint64) -> np.uint64:
    """SplitMix64's output of one counter."""
    x = (counter ^ (counter >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    x = (x ^ (x >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return x ^ (x >> np.uint64(31))


@compiled
def normals(z: Array, counter: np.uint64) -> np.uint64:
    """Fill nine standard normals by Box and Muller's method; give the counter after them."""
    for i in range(0, 9, 2):
        a = mixed(counter)
        b = mixed(counter + GOLDEN)
        counter += GOLDEN + GOLDEN
        r = np.sqrt(-2.0 * np.log((np.float64(a >> np.uint64(11)) + 0.5) * 2.0**-53))
        turn = np.float64(b >> np.uint64(11)) * (2.0 * np.pi * 2.0**-53)
        z[i] = r * np.cos(turn)
        z[i + 1] = r * np.sin(turn)
    return counter


@compiled
def normalised(y: Array, o: int) -> None:
    """Give the quaternion at `o` unit length."""
    scale = 1.0 / np.sqrt(y[o] * y[o] + y[o + 1] * y[o + 1] + y[o + 2] * y[o + 2] + y[o + 3] * y[o + 3])
    for i in range(o, o + 4):
        y[i] *= scale


def calls_of(case: dict[str, Any]) -> dict[str, Fly]:
    """Give what this peer flies, W's numbers compiled in as constants."""
    numba.set_num_threads(threads_asked())
    w = Workload.of(case)
    n, mass, dt, periods = w.mean_motion, w.mass, w.period, w.periods
    g0, g1, g2 = w.goal
    a0, a1, a2 = w.chaser_inertia
    b0, b1, b2 = w.debris_inertia
    slope_r, gain_r, layer_r, alpha_r = (
        w.translation.slope,
        w.translation.gain,
        w.translation.layer,
        w.translation.alpha,
    )
    slope_w, gain_w, layer_w, alpha_w = w.rotation.slope, w.rotation.gain, w.rotation.layer, w.rotation.alpha
    force_limit, torque_limit = w.force_limit, w.torque_limit
    sigma_r, half_sigma_q, sigma_w = w.position_sigma, 0.5 * w.attitude_sigma, w.rate_sigma
    distance2, half_cosine, rate2 = w.capture_distance**2, cos(w.capture_angle / 2), w.capture_rate**2

    @compiled
    def slope(y: Array, f: Array, t: Array, d: Array) -> None:
        d[0], d[1], d[2] = y[3], y[4], y[5]
        d[3] = 3.0 * n * n * y[0] + 2.0 * n * y[4] + f[0]
        d[4] = -2.0 * n * y[3] + f[1]
        d[5] = -n * n * y[2] + f[2]
        turning(y, 6, d)
        d[10] = (t[0] - (a2 - a1) * y[11] * y[12]) / a0
        d[11] = (t[1] - (a0 - a2) * y[12] * y[10]) / a1
        d[12] = (t[2] - (a1 - a0) * y[10] * y[11]) / a2
        turning(y, 13, d)
        d[17] = -(b2 - b1) * y[18] * y[19] / b0
        d[18] = -(b0 - b2) * y[19] * y[17] / b1
        d[19] = -(b1 - b0) * y[17] * y[18] / b2

    @compiled
    def step(y: Array, f: Array, t: Array, k1: Array, k2: Array, k3: Array, k4: Array, x: Array) -> None:
        slope(y, f, t, k1)
        for i in range(20):
            x[i] = y[i] + 0.5 * dt * k1[i]
        slope(x, f, t, k2)
        for i in range(20):
            x[i] = y[i] + 0.5 * dt * k2[i]
        slope(x, f, t, k3)
        for i in range(20):
            x[i] = y[i] + dt * k3[i]
        slope(x, f, t, k4)
        for i in range(20):
            y[i] += dt / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i])
        normalised(y, 6)
        normalised(y, 13)

    @compiled
    def captured(y: Array) -> bool:
        q = relative(y[6:10], y[13:17])
        u0, u1, u2 = seen_from(q, y[17], y[18], y[19])
        e0, e1, e2 = y[10] - u0, y[11] - u1, y[12] - u2
        x0, x1, x2 = y[0] - g0, y[1] - g1, y[2] - g2
        return (
            x0 * x0 + x1 * x1 + x2 * x2 < distance2 and abs(q[0]) > half_cosine and e0 * e0 + e1 * e1 + e2 * e2 < rate2
        )

    @compiled
    def reaching(s: float, gain: float, alpha: float, layer: float) -> float:
        return gain * abs(s) ** alpha * clipped(s / layer, 1.0)

    @compiled
    def command(y: Array, z: Array, f: Array, t: Array, c: Array) -> None:
        r0, r1, r2 = y[0] + sigma_r * z[0], y[1] + sigma_r * z[1], y[2] + sigma_r * z[2]
        natural = (3.0 * n * n * r0 + 2.0 * n * y[4], -2.0 * n * y[3], -n * n * r2)
        e = (r0 - g0, r1 - g1, r2 - g2)
        for i in range(3):
            v = y[3 + i]
            a = -slope_r * v - reaching(v + slope_r * e[i], gain_r, alpha_r, layer_r)
            f[i] = clipped(mass * (a - natural[i]), force_limit) / mass
        p0, p1, p2 = half_sigma_q * z[3], half_sigma_q * z[4], half_sigma_q * z[5]
        c[0] = y[6] - y[7] * p0 - y[8] * p1 - y[9] * p2
        c[1] = y[7] + y[6] * p0 + y[8] * p2 - y[9] * p1
        c[2] = y[8] + y[6] * p1 + y[9] * p0 - y[7] * p2
        c[3] = y[9] + y[6] * p2 + y[7] * p1 - y[8] * p0
        normalised(c, 0)
        q = relative(c, y[13:17])
        short = 1.0 if q[0] >= 0.0 else -1.0
        u = seen_from(q, y[17], y[18], y[19])
        o = (y[10] + sigma_w * z[6], y[11] + sigma_w * z[7], y[12] + sigma_w * z[8])
        gyroscopic = ((a2 - a1) * o[1] * o[2], (a0 - a2) * o[2] * o[0], (a1 - a0) * o[0] * o[1])
        inertia = (a0, a1, a2)
        for i in range(3):
            rate = o[i] - u[i]
            a = -slope_w * rate - reaching(rate + slope_w * short * q[1 + i], gain_w, alpha_w, layer_w)
            t[i] = clipped(inertia[i] * a + gyroscopic[i], torque_limit)

    @numba.njit(parallel=True, error_model="numpy", fastmath={"contract"})
    def fly(starts: Array, noisy: bool, seed: int) -> tuple[Array, Array]:
        ends = starts.copy()
        times = np.full(len(starts), np.nan)
        for j in numba.prange(len(starts)):
            counter = mixed(
                np.uint64(seed) * GOLDEN + np.uint64(j)
            )  # noise does not depend on the thread that flies it
            y = ends[j]
            f, t, c, z, x = np.zeros(3), np.zeros(3), np.zeros(4), np.zeros(10), np.zeros(20)
            k1, k2, k3, k4 = np.zeros(20), np.zeros(20), np.zeros(20), np.zeros(20)
            for k in range(periods + 1):
                if np.isnan(times[j]) and captured(y):
                    times[j] = k * dt
                if k == periods:
                    break
                if noisy:
                    counter = normals(z, counter)
                command(y, z, f, t, c)
                step(y, f, t, k1, k2, k3, k4, x)
        return ends, times

    def call(starts: Array, noisy: bool, seed: int) -> dict[str, Array]:
        ends, times = fly(starts, noisy, seed)
        return {"final_state": ends, "capture_time": times}

    return {"w": call}


if __name__ == "__main__":
    serve(calls_of)
