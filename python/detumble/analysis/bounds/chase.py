"""A simple law that turns a chaser to the debris: an initial guess for the nonlinear programmes.

It aims at the debris along the axis n of the error, φ away (or the long way round): it demands the relative rate
-n min(√(2 η a φ), φ/4h), a the largest acceleration along n, and the torque that reaches it in two steps h, with the tumble's
own acceleration fed forward.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from detumble.analysis.bounds.attitude import excess
from detumble.quaternions import Array, conjugate, multiply, rotate

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from detumble.analysis.bounds.pursuit import Pursuit

STYLES = np.array([(way, share, scaled) for way in (1.0, -1.0) for share in (0.9, 0.5) for scaled in (1.0, 0.0)])
"""Variants of the law: short or long way round, η, demand scaled into the limits or clipped."""

MOST_TURN = 0.3  # rad in one integration step


@dataclass(frozen=True)
class Motion:
    """A turn under torques held over n intervals.

    Attributes:
        time: s, of its end; chases have equal intervals.
        torque: (n, 3) N m.
        attitude: (n + 1, 4).
        rate: (n + 1, 3) rad/s.
    """

    time: float
    torque: Array
    attitude: Array
    rate: Array

    def resampled(self, durations: Array) -> Motion:
        """The same from equal intervals on others (m,), whose durations add up to its own, some perhaps zero."""
        old = np.linspace(0.0, self.time, len(self.torque) + 1)
        new = np.concatenate(([0.0], np.cumsum(durations)))
        impulse = np.vstack((np.zeros(3), np.cumsum(self.torque * np.diff(old)[:, None], axis=0)))

        def at(rows: Array) -> Array:
            return np.stack([np.interp(new, old, column) for column in rows.T], axis=1)

        attitude = at(self.attitude)
        return Motion(
            self.time,
            np.diff(at(impulse), axis=0) / np.maximum(durations, 1e-12)[:, None],
            attitude / np.linalg.norm(attitude, axis=1, keepdims=True),
            at(self.rate),
        )


@dataclass(frozen=True)
class Chases:
    """The law in each of its `STYLES`, s of them.

    Attributes:
        step: s.
        torque: (n, s, 3) N m.
        attitude: (n + 1, s, 4).
        rate: (n + 1, s, 3) rad/s.
        excess: (n + 1, s) angle or relative rate over its threshold, the larger quotient.
    """

    step: float
    torque: Array
    attitude: Array
    rate: Array
    excess: Array

    def until(self, count: int, style: int) -> Motion:
        """The first steps in one style."""
        kept = slice(count + 1)
        return Motion(count * self.step, self.torque[:count, style], self.attitude[kept, style], self.rate[kept, style])

    def arriving(self) -> Iterator[Motion]:
        """The first to be inside the thresholds, by a thousandth of them, each way round; those that never are, are left out."""
        inside = self.excess < 0.999
        arrival = np.where(inside.any(axis=0), np.argmax(inside, axis=0), len(inside))
        for styles in _by_way():
            style = int(styles[np.argmin(arrival[styles])])
            if 0 < arrival[style] < len(inside):
                yield self.until(int(arrival[style]), style)

    def nearest(self) -> list[Motion]:
        """The one that ends nearest to the thresholds each way round, the nearer first."""
        last = self.excess[-1]
        best = sorted(
            (int(styles[np.argmin(last[styles])]) for styles in _by_way()), key=lambda style: float(last[style])
        )
        return [self.until(len(self.torque), style) for style in best]


def _by_way() -> Iterator[NDArray[np.intp]]:
    """Styles of the short way round, then of the long one."""
    return (np.flatnonzero(STYLES[:, 0] == way) for way in (1.0, -1.0))


def chase(
    pursuit: Pursuit, limit: Array, attitude: Array, rate: Array, tumbling: tuple[Array, Array], step: float
) -> Chases:
    """Fly the simple law in each of its `STYLES`, by classical Runge-Kutta steps.

    Args:
        pursuit: for inertias and thresholds.
        limit: (3,) N m, finite.
        attitude: (4,) the chaser's at first.
        rate: (3,) likewise.
        tumbling: the debris' attitudes (n + 1, 4) and rates (n + 1, 3).
        step: s.
    """
    inertia, steps = pursuit.chaser_inertia, len(tumbling[1]) - 1
    inverse = np.linalg.inv(inertia)
    way, share, scaled = STYLES.T[:, :, None]
    q, w = np.tile(attitude, (len(STYLES), 1)), np.tile(rate, (len(STYLES), 1))
    side = way * math.copysign(1.0, float(tumbling[0][0] @ attitude))
    attitudes, rates = np.empty((steps + 1, *q.shape)), np.empty((steps + 1, *w.shape))
    torques = np.empty((steps, *w.shape))
    attitudes[0], rates[0] = q, w
    strength = np.maximum(np.linalg.inv(inertia).diagonal() * limit, 1e-12)
    pushed = np.linalg.solve(pursuit.debris_inertia, np.cross(tumbling[1] @ pursuit.debris_inertia, tumbling[1]).T).T

    def slope(q: Array, w: Array, torque: Array) -> tuple[Array, Array]:
        turning = 0.5 * multiply(q, np.concatenate((np.zeros((len(w), 1)), w), axis=1))
        return turning, (torque - np.cross(w, w @ inertia)) @ inverse

    for k in range(steps):
        error = side * multiply(conjugate(tumbling[0][k]), q)
        back = conjugate(error)
        spin = rotate(back, tumbling[1][k])
        relative = w - spin
        sine = np.linalg.norm(error[:, 1:], axis=1, keepdims=True)
        axis = error[:, 1:] / np.maximum(sine, 1e-12)
        away = 2.0 * np.arctan2(sine, error[:, :1])
        along = (strength / np.maximum(np.abs(axis), 1e-9)).min(axis=1, keepdims=True)
        wanted = -axis * np.minimum(np.sqrt(2.0 * share * along * away), 0.25 * away / step)
        change = (wanted - relative) / (2.0 * step) + rotate(back, pushed[k]) - np.cross(relative, spin)
        demand = change @ inertia + np.cross(w, w @ inertia)
        over = np.maximum(1.0, (np.abs(demand) / np.maximum(limit, 1e-12)).max(axis=1, keepdims=True))
        torque = np.clip(np.where(scaled > 0.0, demand / over, demand), -limit, limit)
        parts = 1 + int(step * float(np.abs(w).max()) / MOST_TURN)
        h = step / parts
        for _ in range(parts):
            q1, w1 = slope(q, w, torque)
            q2, w2 = slope(q + 0.5 * h * q1, w + 0.5 * h * w1, torque)
            q3, w3 = slope(q + 0.5 * h * q2, w + 0.5 * h * w2, torque)
            q4, w4 = slope(q + h * q3, w + h * w3, torque)
            q = q + h / 6.0 * (q1 + 2.0 * q2 + 2.0 * q3 + q4)
            q /= np.linalg.norm(q, axis=1, keepdims=True)
            w = w + h / 6.0 * (w1 + 2.0 * w2 + 2.0 * w3 + w4)
        attitudes[k + 1], rates[k + 1], torques[k] = q, w, torque
    targets = tumbling[0][:, None, :], tumbling[1][:, None, :]
    return Chases(step, torques, attitudes, rates, excess(pursuit, attitudes, rates, *targets))
