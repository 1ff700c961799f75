"""Workload W by components: every quantity a tuple of scalars, or of arrays with one entry a trajectory.

Written once for array libraries that work element by element (`xp`: numpy, jax.numpy); RK4 with the period as step.
"""

from __future__ import annotations

from math import cos
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from w import Gains, Workload

Vector = tuple[Any, ...]


def cross(a: Vector, b: Vector) -> Vector:
    """a × b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def dot(a: Vector, b: Vector) -> Any:
    """a · b."""
    return sum(x * y for x, y in zip(a, b, strict=True))


def after_turn(q: Vector, p: Vector) -> Vector:
    """q ⊗ (0, p)."""
    c = cross(q[1:], p)
    return (-dot(q[1:], p), *(q[0] * p[i] + c[i] for i in range(3)))


def relative(c: Vector, d: Vector) -> Vector:
    """q_D* ⊗ q_C."""
    x = cross(d[1:], c[1:])
    return (dot(c, d), *(d[0] * c[1 + i] - c[0] * d[1 + i] - x[i] for i in range(3)))


def seen_from(q: Vector, u: Vector) -> Vector:
    """q* ⊗ u ⊗ q."""
    t = cross(q[1:], u)
    s = cross(q[1:], t)
    return tuple(u[i] + 2.0 * (s[i] - q[0] * t[i]) for i in range(3))


def gyroscopic(inertia: Vector, w: Vector) -> Vector:
    """ω × (I ω), principal axes."""
    a, b, c = inertia
    return (c - b) * w[1] * w[2], (a - c) * w[2] * w[0], (b - a) * w[0] * w[1]


class Equations:
    """W's equations over one array library.

    Args:
        w: the numbers.
        xp: numpy or jax.numpy.
    """

    def __init__(self, w: Workload, xp: Any) -> None:
        self.w, self.xp = w, xp

    def natural(self, r: Vector, v: Vector) -> Vector:
        """Acceleration of Hill, Clohessy and Wiltshire."""
        n = self.w.mean_motion
        return 3.0 * n * n * r[0] + 2.0 * n * v[1], -2.0 * n * v[0], -n * n * r[2]

    def clipped(self, x: Any, limit: float) -> Any:
        """Clip to ± limit."""
        return self.xp.minimum(self.xp.maximum(x, -limit), limit)

    def normalised(self, q: Vector) -> Vector:
        """Unit quaternion."""
        scale = 1.0 / self.xp.sqrt(dot(q, q))
        return tuple(scale * x for x in q)

    def slope(self, y: Vector, acceleration: Vector, torque: Vector) -> Vector:
        """The derivative of the 20 states."""
        w = self.w
        v, rate, tumble = y[3:6], y[10:13], y[17:20]
        natural = self.natural(y[0:3], v)
        chaser, debris = gyroscopic(w.chaser_inertia, rate), gyroscopic(w.debris_inertia, tumble)
        return (
            *v,
            *(natural[i] + acceleration[i] for i in range(3)),
            *(0.5 * x for x in after_turn(y[6:10], rate)),
            *((torque[i] - chaser[i]) / w.chaser_inertia[i] for i in range(3)),
            *(0.5 * x for x in after_turn(y[13:17], tumble)),
            *(-debris[i] / w.debris_inertia[i] for i in range(3)),
        )

    def step(self, y: Vector, acceleration: Vector, torque: Vector) -> Vector:
        """One period by RK4."""
        dt = self.w.period

        def ahead(k: Vector, share: float) -> Vector:
            return tuple(a + share * dt * b for a, b in zip(y, k, strict=True))

        k1 = self.slope(y, acceleration, torque)
        k2 = self.slope(ahead(k1, 0.5), acceleration, torque)
        k3 = self.slope(ahead(k2, 0.5), acceleration, torque)
        k4 = self.slope(ahead(k3, 1.0), acceleration, torque)
        end = tuple(y[i] + dt / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]) for i in range(20))
        return (*end[:6], *self.normalised(end[6:10]), *end[10:13], *self.normalised(end[13:17]), *end[17:])

    def captured(self, y: Vector) -> Any:
        """Whether all thresholds hold."""
        w = self.w
        q = relative(y[6:10], y[13:17])
        apart = tuple(y[i] - w.goal[i] for i in range(3))
        target = seen_from(q, y[17:20])
        spin = tuple(y[10 + i] - target[i] for i in range(3))
        near = dot(apart, apart) < w.capture_distance**2
        aligned = abs(q[0]) > cos(w.capture_angle / 2.0)
        return near & aligned & (dot(spin, spin) < w.capture_rate**2)

    def reaching(self, s: Any, gains: Gains) -> Any:
        """K |s|^α sat(s/φ), the printed form; exp and log are quicker than a power."""
        return gains.gain * self.xp.exp(gains.alpha * self.xp.log(abs(s))) * self.clipped(s / gains.layer, 1.0)

    def command(self, y: Vector, z: Vector) -> tuple[Vector, Vector]:
        """Acceleration and torque from what the sensors see.

        Args:
            y: the 20 states.
            z: nine standard normals: position, attitude, rate.
        """
        w = self.w
        r = tuple(y[i] + w.position_sigma * z[i] for i in range(3))
        v = y[3:6]
        natural = self.natural(r, v)
        gains = w.translation
        asked = tuple(
            -gains.slope * v[i] - self.reaching(v[i] + gains.slope * (r[i] - w.goal[i]), gains) - natural[i]
            for i in range(3)
        )
        acceleration = tuple(self.clipped(w.mass * a, w.force_limit) / w.mass for a in asked)

        tilt = after_turn(y[6:10], tuple(0.5 * w.attitude_sigma * x for x in z[3:6]))
        q = relative(self.normalised(tuple(y[6 + i] + tilt[i] for i in range(4))), y[13:17])
        short = self.xp.where(q[0] >= 0.0, 1.0, -1.0)
        target = seen_from(q, y[17:20])
        rate = tuple(y[10 + i] + w.rate_sigma * z[6 + i] for i in range(3))
        cancel = gyroscopic(w.chaser_inertia, rate)
        gains = w.rotation
        torque = []
        for i in range(3):
            e = rate[i] - target[i]
            a = -gains.slope * e - self.reaching(e + gains.slope * short * q[1 + i], gains)
            torque.append(self.clipped(w.chaser_inertia[i] * a + cancel[i], w.torque_limit))
        return acceleration, tuple(torque)
