"""The goal at given times: where the chaser must be, and how fast it may move there.

Without grasp points the goal is a fixed place in H, at rest. With them it is R_HD p_D - R_HC p_C, which depends on the chaser's
attitude. At capture that is within the angle threshold θ of the debris', R_HC = R_HD δR, |δR p - p| ≤ 2 sin(θ/2) |p|, so

    place = R_HD (p_D - p_C),  off by at most  spread = 2 sin(θ/2) |p_C|
    (with |p_C| smaller than that, p_C is left out of the place, and spread = |p_C|),
    velocity = Ω_D × place,    off by at most  |Ω_D| spread + (rate threshold) |p_C|,      Ω = w - w_H in H,

and a bound on any controller widens its thresholds by that; a trajectory that must capture aims at the exactly aligned goal.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from detumble.analysis.bounds.tumble import tumble
from detumble.analysis.bounds.turn import Agility
from detumble.quaternions import Array, conjugate, multiply, rotate

if TYPE_CHECKING:
    from detumble.analysis.bounds.pursuit import Pursuit


@dataclass(frozen=True)
class Goal:
    """A goal at k times, SI, in H.

    Attributes:
        state: (k, 6) place and velocity, m and m/s.
        radius: distance threshold, m.
        speed: (k,) speed threshold, m/s; inf where none is asked for.
    """

    state: Array
    radius: float
    speed: Array

    @classmethod
    def of(cls, pursuit: Pursuit, times: Array, tumbling: tuple[Array, Array] | None, aligned: bool = False) -> Goal:
        """The goal at the times (k,), s.

        Args:
            pursuit: the chase.
            times: s.
            tumbling: the debris' attitudes (k, 4) and rates (k, 3) then, as `tumble` gives them; unused without grasp points.
            aligned: the chaser's attitude is the debris', so no threshold is widened.
        """
        state, speed, radius = np.zeros((len(times), 6)), np.full(len(times), pursuit.speed), pursuit.distance
        if pursuit.grasp_points is None or tumbling is None:
            state[:, :3] = 0.0 if pursuit.from_debris else pursuit.goal
            return cls(state, radius, speed)
        attitudes, rates = tumbling
        arm, spread = (pursuit.grasp_points[1] - pursuit.grasp_points[0], 0.0) if aligned else _arm(pursuit)
        in_lvlh = multiply(conjugate(pursuit.lvlh_turned(pursuit.mean_motion * times)), attitudes)  # q_HD
        spin = rotate(in_lvlh, rates) - np.array([0.0, 0.0, pursuit.mean_motion])
        place = rotate(in_lvlh, arm)
        state[:, 3:] = np.cross(spin, place)
        if not aligned:
            length = float(np.linalg.norm(pursuit.grasp_points[0]))
            speed = speed + np.linalg.norm(spin, axis=1) * spread + pursuit.rate * length
        if not pursuit.from_debris:
            state[:, :3] = place
            radius += spread
        return cls(state, radius, speed)

    @classmethod
    def between(
        cls, pursuit: Pursuit, debris: Array, first: float, last: float, cells: int, aligned: bool = False
    ) -> Goal:
        """The goal at cells + 1 even times from `first` to `last`, s, for the debris' attitude and rate (7,) at t = 0."""
        times = np.linspace(first, last, cells + 1)
        if pursuit.grasp_points is None:
            return cls.of(pursuit, times, None)
        attitude, rate = debris[:4] / np.linalg.norm(debris[:4]), debris[4:]
        if first > 0.0:
            attitudes, rates = tumble(pursuit.debris_inertia, attitude, rate, first, 1)
            attitude, rate = attitudes[1], rates[1]
        tumbling = tumble(pursuit.debris_inertia, attitude, rate, (last - first) / max(cells, 1), cells)
        return cls.of(pursuit, times, tumbling, aligned)


def _arm(pursuit: Pursuit) -> tuple[Array, float]:
    """The arm in debris axes that the goal turns with, m, and the spread about it, m."""
    assert pursuit.grasp_points is not None
    p_chaser, p_debris = pursuit.grasp_points
    length = float(np.linalg.norm(p_chaser))
    opening = 2.0 * math.sin(min(pursuit.angle, math.pi) / 2.0)
    return (p_debris - p_chaser, opening * length) if opening < 1.0 else (p_debris, length)


@dataclass(frozen=True)
class GoalChange:
    """Rates of change of a goal, upper bounds for all times.

    Attributes:
        spin: |Ω_D|, rad/s.
        place: second derivative of the place, m/s².
        velocity: second derivative of its velocity, m/s³.
        speed: rate of change of the speed threshold, m/s².
    """

    spin: float
    place: float
    velocity: float
    speed: float

    @classmethod
    def of(cls, pursuit: Pursuit, rate: Array) -> GoalChange:
        """From the debris' rate (3,) rad/s at t = 0, its own axes.

        |w| ≤ √(wᵀ I w / J₁) and |I w| / J₁, both constant. In H, with b of `turn`, |w'| ≤ b |w|² and
        |w''| ≤ 2 (J₃/J₁) b |w|³ (differentiate I w' = I w × w), so Ω = R w - n z has
        |Ω| ≤ |w| + n,  |Ω'| ≤ b |w|² + n |w|,  |Ω''| ≤ b |w|³ (1 + 2 J₃/J₁) + 2 n b |w|² + n² |w|;  and p' = Ω × p gives
        |p''| ≤ (|Ω'| + |Ω|²) |p|,  |p'''| ≤ (|Ω''| + 3 |Ω| |Ω'| + |Ω|³) |p|.
        """
        if pursuit.grasp_points is None:
            return cls(0.0, 0.0, 0.0, 0.0)
        inertia, n = pursuit.debris_inertia, pursuit.mean_motion
        body = Agility.of(inertia, np.zeros(3))
        b, ratio = body.bending, body.largest / body.smallest
        w = min(math.sqrt(rate @ inertia @ rate / body.smallest), float(np.linalg.norm(inertia @ rate)) / body.smallest)
        spin = w + n
        first = b * w * w + n * w
        second = b * w**3 * (1.0 + 2.0 * ratio) + 2.0 * n * b * w * w + n * n * w
        arm, spread = _arm(pursuit)
        length = float(np.linalg.norm(arm))
        place = 0.0 if pursuit.from_debris else (first + spin * spin) * length
        return cls(spin, place, (second + 3.0 * spin * first + spin**3) * length, first * spread)
