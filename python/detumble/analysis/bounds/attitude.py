"""The earliest real time at which angle and relative rate can hold: whole intervals of time excluded, not ticks.

Take an interval [t₀, t₁] of possible ends T and its middle t_m. The debris' attitude moves by no more than
(t₁ - t₀)/2 · max|w_D| from the middle, its rate by no more than (t₁ - t₀)/2 · b |w_D|² (`turn`: b), so the thresholds widen
by that; what the chaser can do grows with time, so t₁ is used for all. Besides the relaxations of `turn` there are those of
single body axes. With w' = I⁻¹(τ - w × I w) and |w_j| ≤ W_j, where (I⁻¹(w × I w))_i = wᵀ G_i w,

    |w_i(t) - w_i(0)| ≤ c_i(t),     c_i' = a_i + Σ_jk |G_i,jk| W_j W_k,     a_i = Σ_j |I⁻¹_ij| limit_j,     W = |w(0)| + c,

iterated from W_j = F, and the same backwards from the end, where w_C lies within ρ = rate + 2 sin(θ/2)|w_D| of w_D (own axes).

Swing and twist about a body axis d: the turn so far, as a quaternion (ε₀, ε), takes d through the angle s (swing) and has the
twist ψ = 2 atan2(d·ε, ε₀), for which, with w_⊥ the part of w normal to d,

    |s'| ≤ |w_⊥|,     ψ' = d·w + tan(s/2) × (the part of w_⊥ across the swing):

the second term is the rate at which the path of d on the unit sphere sweeps area about where it began (the Gauss-Bonnet
theorem; as for Euler's angles). Closed by the great circle back, that path is no longer than ℓ = ∫|w_⊥| + s and lies in a
hemisphere while ℓ < 2π, so that the isoperimetric inequality of the sphere, ℓ² ≥ A (4π - A) (Osserman, Bull. AMS 84, 1978),
bounds the area by A(ℓ) = 2π - √(4π² - ℓ²); loops that cross themselves split into simple ones, and √(A(4π - A)) is concave.
The last θ, from the chaser's to the debris' attitude, is flown as twist and swing in any mixture: it adds no more than
θ √(1 + A'(ℓ + θ)²). So, with L = ∫|w_⊥|, a time is excluded if for some d either s - θ > L, or no ψ + 2πk lies within

    [∫ min d·w - A(ℓ) - θ √(…),  ∫ max d·w + A(ℓ) + θ √(…)],     for L + θ < π.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from detumble.analysis.bounds.tumble import tumble
from detumble.analysis.bounds.turn import CORNERS, ROUND_OFF, Agility, angle_between, trapezoids
from detumble.quaternions import Array, conjugate, multiply, rotate, rotation_angle
from detumble.states import CHASER_ATTITUDE, CHASER_RATE, DEBRIS_ATTITUDE, DEBRIS_RATE

if TYPE_CHECKING:
    from detumble.analysis.bounds.pursuit import Pursuit

CELLS = 96  # of the time from the start to the end, in which rates are bounded
PASSES = 3  # of the bound of the gyroscopic coupling
RESOLUTION = 4e-4  # of the time: loss of the search
SHORTEST = 1e-5  # s
AXES = np.array([axis for axis in itertools.product((-1.0, 0.0, 1.0), repeat=3) if axis > (0.0, 0.0, 0.0)])
AXES /= np.linalg.norm(AXES, axis=1, keepdims=True)  # edges, face and body diagonals of the cube, each once
LEVI_CIVITA = np.cross(np.eye(3)[:, None, :], np.eye(3)[None, :, :])


def earliest_attitude(pursuit: Pursuit, start: Array) -> float:
    """A lower bound, s, of the time at which angle and relative rate have held for the dwell, whatever the torque does.

    Args:
        pursuit: limits, bodies and thresholds.
        start: (20,), as `pursuit.start_of` gives it.

    Returns:
        0 where they hold at the start or the torque is unlimited; inf where the flight is too short.
    """
    turn = Turn(pursuit, start)
    dwell, last = pursuit.dwell_ticks * pursuit.period, pursuit.periods * pursuit.period
    if turn.met_at_once or not np.isfinite(pursuit.torque).all():
        return dwell if dwell <= last else math.inf
    begin, step, certified = 0.0, pursuit.period, 0
    while begin + dwell < last:
        end = min(begin + step, last)
        if turn.excluded(begin, end):
            begin, certified = end, certified + 1
            step *= 2.0 if certified > 1 else 1.0
        elif step <= max(SHORTEST, RESOLUTION * begin):
            return begin + dwell
        else:
            step, certified = 0.5 * step, 0
    return math.inf


@dataclass(frozen=True)
class _End:
    """What the middle of an interval of ends requires, widened so that it holds for all of them.

    Attributes:
        turn: (4,) the debris' attitude, from the chaser's at the start.
        angle: θ, rad.
        rate: (3,) the debris', its own axes, rad/s.
        around: ρ, rad/s.
        length: of the interval, s.
    """

    turn: Array
    angle: float
    rate: Array
    around: float
    length: float


@dataclass(frozen=True)
class _Growth:
    """Bounds of the chaser's rate between start and end.

    Attributes:
        times: (CELLS + 1,) s.
        ahead: (CELLS + 1, 3) what the gyroscopic coupling adds from the start on, at the times.
        back: the same from the end backwards.
        fastest: (CELLS,) mean |w| in each cell.
    """

    times: Array
    ahead: Array
    back: Array
    fastest: Array


class Turn:
    """One start, and certificates that exclude intervals of time."""

    def __init__(self, pursuit: Pursuit, start: Array) -> None:
        self.pursuit, self.agility = pursuit, pursuit.agility
        self.attitude = start[CHASER_ATTITUDE] / np.linalg.norm(start[CHASER_ATTITUDE])
        self.rate = start[CHASER_RATE]
        self.debris = start[DEBRIS_ATTITUDE] / np.linalg.norm(start[DEBRIS_ATTITUDE]), start[DEBRIS_RATE]
        tumbling = Agility.of(pursuit.debris_inertia, np.zeros(3))
        self.fastest = tumbling.fastest_free(self.debris[1])
        self.bending = tumbling.bending * self.fastest**2
        inverse = np.linalg.inv(pursuit.chaser_inertia)
        coupling = np.einsum("il,lmn,nk->imk", inverse, LEVI_CIVITA, pursuit.chaser_inertia)
        self.coupling = np.abs(0.5 * (coupling + coupling.transpose(0, 2, 1)))
        self.drive = np.abs(inverse) @ pursuit.torque if np.isfinite(pursuit.torque).all() else np.full(3, np.inf)
        self.opening = 2.0 * math.sin(0.5 * min(pursuit.angle, math.pi))

    @property
    def met_at_once(self) -> bool:
        """Whether both thresholds hold at the start."""
        return bool(excess(self.pursuit, self.attitude, self.rate, *self.debris) < 1.0)

    def excluded(self, begin: float, end: float) -> bool:
        """Whether no torque can meet the thresholds at any time from begin to end, s."""
        half = 0.5 * (end - begin)
        attitudes, rates = tumble(self.pursuit.debris_inertia, *self.debris, begin + half, 1)
        attitude, rate = attitudes[1], rates[1]
        angle = self.pursuit.angle + half * self.fastest
        near = self.pursuit.rate + half * self.bending
        around = near + self.opening * (float(np.linalg.norm(rate)) + half * self.bending)

        times = np.linspace(0.0, end, CELLS + 1)
        rising = self._ceilings(self.rate, 0.0, times)
        falling = self._ceilings(rate, near, times)[:, ::-1]
        fastest = np.minimum(trapezoids(rising), trapezoids(falling))
        bent = self.agility.direct + self.agility.bending * fastest_squared(rising, falling)
        width = end / CELLS
        apart = np.linalg.norm(rotate(attitude, rate) - rotate(self.attitude, self.rate))
        turn = multiply(conjugate(self.attitude), attitude)
        if angle_between(self.attitude, attitude) - angle > width * fastest.sum() + ROUND_OFF:
            return True
        if apart - near > width * bent.sum() + ROUND_OFF:
            return True
        if np.linalg.norm(rate) - near > rising[:, -1].min() + ROUND_OFF:
            return True
        if np.linalg.norm(rate) + near < self.agility.floor(self.rate, times[-1:])[0] - ROUND_OFF:
            return True

        ahead = self._coupled(np.abs(self.rate), rising.min(axis=0), width)
        back = self._coupled(np.abs(rate) + around, falling.min(axis=0)[::-1], width)
        beyond = np.maximum(0.0, np.abs(rate - self.rate) - ahead[-1] - self.drive * end)
        if np.linalg.norm(beyond) > around + ROUND_OFF:
            return True
        return self._untwistable(_End(turn, angle, rate, around, 2.0 * half), _Growth(times, ahead, back, fastest))

    def _ceilings(self, rate: Array, near: float, times: Array) -> Array:
        """The bounds (3, n) of |w| at times (n,) after it was within `near` of a rate (3,)."""
        inertia, agility = self.agility.inertia, self.agility
        speed = float(np.linalg.norm(rate)) + near
        if near > 0.0:  # the rate is known in the debris' axes, not in the chaser's
            return agility.ceilings(speed, math.sqrt(agility.largest) * speed, agility.largest * speed, times)
        return agility.ceilings(speed, math.sqrt(rate @ inertia @ rate), float(np.linalg.norm(inertia @ rate)), times)

    def _coupled(self, first: Array, ceiling: Array, width: float) -> Array:
        """Bounds (CELLS + 1, 3) of what the gyroscopic torque adds to each |w_i|, |w_i| ≤ first (3,) at time 0."""
        driven = first + self.drive * width * np.arange(CELLS + 1)[:, None]
        added = np.zeros((CELLS + 1, 3))
        bound = np.repeat(ceiling[:, None], 3, axis=1)
        for _ in range(PASSES):
            later = bound[1:]  # the bound rises, so its value at the end of a cell holds for all of it
            added[1:] = width * np.cumsum(np.einsum("ijk,tj,tk->ti", self.coupling, later, later), axis=0)
            bound = np.minimum(bound, driven + added)
        return added

    def _untwistable(self, end: _End, growth: _Growth) -> bool:
        """Whether swing or twist about some body axis excludes the end, as the module says."""
        turn, angle, rate, around = end.turn, end.angle, end.rate, end.around
        times, ahead, back = growth.times, growth.ahead, growth.back
        width = times[1]
        norm = float(np.linalg.norm(turn[1:]))
        axes = np.vstack((AXES, turn[1:] / norm)) if norm > 0.0 else AXES
        reach = np.abs(axes @ np.linalg.inv(self.agility.inertia)) @ self.pursuit.torque
        push_ahead = times[:, None] * reach + ahead @ np.abs(axes).T
        push_back = (times[:, None] * reach + back @ np.abs(axes).T + around)[::-1]
        first, last = axes @ self.rate, axes @ rate
        most, least = (
            width * np.minimum(means(sign * first + push_ahead), means(sign * last + push_back)).sum(axis=0)
            + end.length * np.maximum(0.0, -np.minimum(sign * first, sign * last + around))
            for sign in (1.0, -1.0)
        )

        across_ahead = self._across(axes, self.rate, ahead + times[:, None] * self.drive)
        across_back = (self._across(axes, rate, back + times[:, None] * self.drive) + around)[::-1]
        across = np.minimum(np.minimum(means(across_ahead), means(across_back)), growth.fastest[:, None])
        length = width * across.sum(axis=0)
        along = axes @ turn[1:]
        swing = 2.0 * np.arctan2(np.linalg.norm(np.cross(axes, turn[1:]), axis=1), np.hypot(along, turn[0]))
        if (swing - angle > length + ROUND_OFF).any():
            return True
        axis_ok = length + angle < math.pi - ROUND_OFF
        if not axis_ok.any():
            return False
        closed = np.where(axis_ok, length + swing, 0.0)
        area = 2.0 * math.pi - np.sqrt(4.0 * math.pi**2 - closed**2)
        steepest = (closed + angle) / np.sqrt(np.maximum(1e-12, 4.0 * math.pi**2 - (closed + angle) ** 2))
        extra = area + angle * np.sqrt(1.0 + steepest**2) + ROUND_OFF
        twist = 2.0 * np.arctan2(along, turn[0])
        round_trips = np.ceil((-least - extra - twist) / (2.0 * math.pi))
        return bool((axis_ok & (twist + 2.0 * math.pi * round_trips > most + extra)).any())

    @staticmethod
    def _across(axes: Array, rate: Array, spread: Array) -> Array:
        """The largest |w_⊥| (n, axes) in the boxes rate ± spread (n, 3): convex, so it peaks on a corner."""
        corners = rate + CORNERS[:, None, :] * spread
        squares = (corners**2).sum(axis=-1, keepdims=True) - (corners @ axes.T) ** 2
        largest: Array = np.sqrt(np.maximum(0.0, squares.max(axis=0)))
        return largest


def excess(pursuit: Pursuit, attitude: Array, rate: Array, debris_attitude: Array, debris_rate: Array) -> Array:
    """Angle or relative rate over its threshold, the larger quotient (...): both hold where it is below 1.

    Args:
        pursuit: the thresholds.
        attitude: (..., 4) chaser → N.
        rate: (..., 3) chaser axes.
        debris_attitude: (..., 4) debris → N.
        debris_rate: (..., 3) debris axes.
    """
    turn = multiply(conjugate(attitude), debris_attitude)
    apart = rotation_angle(turn)
    relative = np.linalg.norm(rate - rotate(turn, debris_rate), axis=-1)
    larger: Array = np.maximum(apart / pursuit.angle, relative / pursuit.rate)
    return larger


def fastest_squared(rising: Array, falling: Array) -> Array:
    """Bounds (n - 1,) of the mean of |w|² in each cell, from curves (3, n) that bound |w|."""
    least: Array = np.minimum(trapezoids(rising**2), trapezoids(falling**2))
    return least


def means(curves: Array) -> Array:
    """Cell means (n - 1, axes) of convex curves (n, axes), from above."""
    return 0.5 * (curves[:-1] + curves[1:])
