"""Workload W as papers fly it: `scipy.integrate.solve_ivp` over one control period after another, one trajectory.

Vectors and adaptive steps, no code in common with the other peers' equations: against these tolerances the fixed step
of the others is measured.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.integrate import solve_ivp
from serve import serve
from w import Gains, Workload

if TYPE_CHECKING:
    from serve import Array, Fly

TOLERANCE = {"rtol": 1e-9, "atol": 1e-12}
"""Of a period; over 2400 of them well below the 1e-7 that agreement asks for."""


def cross(a: Array, b: Array) -> Array:
    """a × b; numpy's own takes ten times as long for one pair."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def product(p: Array, q: Array) -> Array:
    """p ⊗ q, scalar first."""
    scalar = p[0] * q[0] - p[1:] @ q[1:]
    return np.concatenate(([scalar], p[0] * q[1:] + q[0] * p[1:] + cross(p[1:], q[1:])))


def matrix(q: Array) -> Array:
    """Rotation matrix, body → N."""
    x, y, z = q[1:]
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + 2.0 * (q[0] * skew + skew @ skew)


class Flight:
    """The closed loop of one trajectory."""

    def __init__(self, w: Workload) -> None:
        self.w = w
        n = w.mean_motion
        self.hcw = np.zeros((3, 6))
        self.hcw[0, 0], self.hcw[0, 4], self.hcw[1, 3], self.hcw[2, 2] = 3 * n * n, 2 * n, -2 * n, -n * n
        self.goal = np.array(w.goal)
        self.chaser, self.debris = np.array(w.chaser_inertia), np.array(w.debris_inertia)

    def slope(self, _: float, y: Array, acceleration: Array, torque: Array) -> Array:
        """The derivative of the 20 states."""
        chaser_rate, debris_rate = y[10:13], y[17:20]
        return np.concatenate(
            (
                y[3:6],
                self.hcw @ y[:6] + acceleration,
                0.5 * product(y[6:10], np.concatenate(([0.0], chaser_rate))),
                (torque - cross(chaser_rate, self.chaser * chaser_rate)) / self.chaser,
                0.5 * product(y[13:17], np.concatenate(([0.0], debris_rate))),
                -cross(debris_rate, self.debris * debris_rate) / self.debris,
            )
        )

    def sliding(self, gains: Gains, e: Array, rate: Array) -> Array:
        """The acceleration that PRRL-SMC asks for, printed form."""
        s = rate + gains.slope * e
        return -gains.slope * rate - gains.gain * np.abs(s) ** gains.alpha * np.clip(s / gains.layer, -1.0, 1.0)

    def error(self, attitude: Array, y: Array, rate: Array) -> tuple[Array, Array]:
        """Quaternion of the chaser relative to the debris, and rate relative to it in chaser axes."""
        relative = product(y[13:17] * [1.0, -1.0, -1.0, -1.0], attitude)
        return relative, rate - matrix(relative).T @ y[17:20]

    def captured(self, y: Array) -> bool:
        """Whether all thresholds hold."""
        q, spin = self.error(y[6:10], y, y[10:13])
        return bool(
            np.linalg.norm(y[:3] - self.goal) < self.w.capture_distance
            and 2.0 * math.atan2(np.linalg.norm(q[1:]), abs(q[0])) < self.w.capture_angle
            and np.linalg.norm(spin) < self.w.capture_rate
        )

    def command(self, y: Array, z: Array) -> tuple[Array, Array]:
        """Acceleration and torque from what the sensors see; z are nine standard normals."""
        w = self.w
        position = y[:3] + w.position_sigma * z[:3]
        natural = self.hcw @ np.concatenate((position, y[3:6]))
        force = w.mass * (self.sliding(w.translation, position - self.goal, y[3:6]) - natural)
        attitude = product(y[6:10], np.concatenate(([1.0], 0.5 * w.attitude_sigma * z[3:6])))
        rate = y[10:13] + w.rate_sigma * z[6:]
        q, spin = self.error(attitude / np.linalg.norm(attitude), y, rate)
        tilt = np.copysign(1.0, q[0]) * q[1:]
        torque = self.chaser * self.sliding(w.rotation, tilt, spin) + cross(rate, self.chaser * rate)
        return np.clip(force, -w.force_limit, w.force_limit) / w.mass, np.clip(torque, -w.torque_limit, w.torque_limit)

    def fly(self, y: Array, generator: np.random.Generator | None) -> tuple[Array, float]:
        """Give the final state and the capture time, NaN where there was none."""
        w, time = self.w, math.nan
        for k in range(w.periods + 1):
            if math.isnan(time) and self.captured(y):
                time = k * w.period
            if k < w.periods:
                z = generator.standard_normal(9) if generator else np.zeros(9)
                y = solve_ivp(self.slope, (0.0, w.period), y, args=self.command(y, z), **TOLERANCE).y[:, -1]
                y[6:10] /= np.linalg.norm(y[6:10])
                y[13:17] /= np.linalg.norm(y[13:17])
        return y, time


def calls_of(case: dict[str, Any]) -> dict[str, Fly]:
    """Give what this peer flies."""
    flight = Flight(Workload.of(case))

    def call(starts: Array, noisy: bool, seed: int) -> dict[str, Array]:
        generator = np.random.default_rng(seed) if noisy else None
        flown = [flight.fly(start, generator) for start in starts]
        ends, times = zip(*flown, strict=True)
        return {"final_state": np.array(ends), "capture_time": np.array(times)}

    return {"w": call}


if __name__ == "__main__":
    serve(calls_of)
