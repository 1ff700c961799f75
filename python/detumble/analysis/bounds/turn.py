"""Where a chaser under per-axis torque limits cannot point: relaxations of rigid-body rotation.

I w' + w × I w = τ, |τ_i| ≤ limit_i (body axes), J₁ ≤ J₂ ≤ J₃ the principal moments. Whatever the torque does:

    energy      d/dt √(wᵀ I w) ≤ max ‖I^(-1/2) τ‖,   |w| ≤ √(wᵀ I w) / √J₁
    momentum    d/dt |I w|     ≤ ‖limit‖,            |w| ≤ |I w| / J₁
    direct      d/dt |w|       ≤ A + c |w|²,         A = max ‖I⁻¹ τ‖,
                c = |(J₁-J₂)(J₂-J₃)(J₃-J₁)| / (J₁ J₂ J₃) / (3 √3)
                (w · I⁻¹(w × I w) = w₁ w₂ w₃ Σ (J_k - J_j)/J_i, and |w₁ w₂ w₃| ≤ |w|³/(3 √3))
    vector      |dW/dt|        ≤ A + b |w|²,         W the rate in N axes, b = max |J_j - J_k|/J_i / √3
                (W' = R w', and the three products w_j w_k of a unit vector have squares summing to at most 1/3)

The smallest of the first three bounds |w| from above at each time after the start, F(t); the same bounds run backwards from
the end, where |w| < |w_D(T)| + threshold, give B(T - t). The attitude turns at rate |w|, so

    angle(q_C(0), q_D(T)) - threshold ≤ ∫₀ᵀ |w| dt ≤ ∫₀ᵀ min(F(t), B(T - t)) dt,

a necessary condition, as are |W(T) - W_D(T)| < threshold through the vector bound, and |w_D(T)| ± threshold against the
bounds of |w|. (A turn about a fixed axis from rest to rest is no bound: torque limits are per axis, the ends are loose.)
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from detumble.quaternions import Array, conjugate, multiply, rotate, rotation_angle

if TYPE_CHECKING:
    from detumble.analysis.bounds.pursuit import Pursuit

CORNERS = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))  # of a box
REGULARISATION = 1e-12  # added to acceleration and growth, so that neither is zero; the bound stays a bound
ROUND_OFF = 1e-7  # rad and rad/s that a certificate must show


@dataclass(frozen=True)
class Agility:
    """Bounds of a rigid body's rate under per-axis torque limits; the symbols are the module's.

    Attributes:
        inertia: (3, 3) kg m².
        smallest, largest: J₁, J₃, kg m².
        energy: max ‖I^(-1/2) τ‖, rad/s² √(kg m²).
        momentum: ‖limit‖, N m.
        direct: A, rad/s².
        growth: c, no unit.
        bending: b, no unit.
    """

    inertia: Array
    smallest: float
    largest: float
    energy: float
    momentum: float
    direct: float
    growth: float
    bending: float

    @classmethod
    def of(cls, inertia: Array, torque: Array) -> Agility:
        """From the inertia (3, 3) kg m² and the limits (3,) N m; a convex function peaks on a corner of the box."""
        j1, j2, j3 = (float(moment) for moment in np.linalg.eigvalsh(inertia))
        limited = bool(np.isfinite(torque).all())
        corners = CORNERS * (torque if limited else 0.0)
        spun = np.linalg.solve(inertia, corners.T).T
        product = abs((j1 - j2) * (j2 - j3) * (j3 - j1)) / (j1 * j2 * j3)
        return cls(
            inertia=inertia,
            smallest=j1,
            largest=j3,
            energy=float(np.sqrt((corners * spun).sum(axis=1)).max()) if limited else math.inf,
            momentum=float(np.linalg.norm(torque)) if limited else math.inf,
            direct=float(np.linalg.norm(spun, axis=1).max()) if limited else math.inf,
            growth=product / (3.0 * np.sqrt(3.0)),
            bending=max((j3 - j2) / j1, (j3 - j1) / j2, (j2 - j1) / j3) / np.sqrt(3.0),
        )

    def ceilings(self, speed: float, energy: float, momentum: float, times: Array) -> Array:
        """The three upper bounds (3, n) of |w| at times (n,), each convex and rising; inf where one ends.

        Args:
            speed: |w|, rad/s, at time 0, or more.
            energy: √(wᵀ I w) at time 0, or more.
            momentum: |I w|, N m s, at time 0, or more.
            times: s.
        """
        # y' = A + c y²: y = r tan(atan(y₀/r) + √(A c) t), r = √(A/c)
        direct, growth = self.direct + REGULARISATION, self.growth + REGULARISATION
        scale = np.sqrt(direct / growth)
        phase = np.arctan(speed / scale) + np.sqrt(direct * growth) * times
        grown = scale * np.tan(np.minimum(phase, 1.57))
        return np.stack(
            (
                (energy + self.energy * times) / np.sqrt(self.smallest),
                (momentum + self.momentum * times) / self.smallest,
                np.where(phase < 1.57, grown, np.inf),
            )
        )

    def fastest_free(self, rate: Array) -> float:
        """The most |w|, rad/s, that a torque-free body ever has, from a rate (3,): energy and momentum stay."""
        energy, momentum = math.sqrt(rate @ self.inertia @ rate), float(np.linalg.norm(self.inertia @ rate))
        return min(energy / math.sqrt(self.smallest), momentum / self.smallest)

    def floor(self, rate: Array, times: Array) -> Array:
        """A lower bound (n,) of |w| at times (n,), from the rate (3,) rad/s at time 0: the same three, downwards."""
        direct, growth = self.direct + REGULARISATION, self.growth + REGULARISATION
        scale = np.sqrt(direct / growth)
        phase = np.arctan(np.linalg.norm(rate) / scale) - np.sqrt(direct * growth) * times
        energy = np.sqrt(rate @ self.inertia @ rate) - self.energy * times
        momentum = np.linalg.norm(self.inertia @ rate) - self.momentum * times
        bounds = (energy / np.sqrt(self.largest), momentum / self.largest, scale * np.tan(np.maximum(phase, 0.0)))
        lowest: Array = np.maximum(0.0, np.max(bounds, axis=0))
        return lowest


def excluded(
    pursuit: Pursuit, attitude: Array, rate: Array, target_attitudes: Array, target_rates: Array, first: int
) -> NDArray[np.bool_]:
    """Which ticks first … last no torque control can meet: (last - first + 1,).

    Args:
        pursuit: torque limits, thresholds and control period.
        attitude, rate: the chaser's (4,) body → N and (3,) rad/s body axes, at t = 0.
        target_attitudes, target_rates: the debris' (last + 1, 4) and (last + 1, 3), its own axes.
        first: first tick that is judged.
    """
    agility, period, rate_error = pursuit.agility, pursuit.period, pursuit.rate
    limited = np.isfinite(agility.momentum)
    if not limited:  # then only t = 0 can be out of reach
        agility = Agility.of(agility.inertia, np.zeros(3))
    times = period * np.arange(len(target_rates), dtype=np.float64)
    speed = float(np.linalg.norm(rate))
    rising = agility.ceilings(
        speed, float(np.sqrt(rate @ agility.inertia @ rate)), float(np.linalg.norm(agility.inertia @ rate)), times
    )
    wanted = np.linalg.norm(target_rates, axis=1)[first:]
    at_end = float(wanted.max()) + rate_error
    falling = agility.ceilings(at_end, np.sqrt(agility.largest) * at_end, agility.largest * at_end, times)

    # Each bound is convex, so its trapezoid is an upper bound of its integral over a cell, and so is the least of the
    # three. Both sequences of cells rise, and the best split of k cells between the two ends is the k smallest of all.
    cells = np.sort(np.concatenate((trapezoids(rising), trapezoids(falling)))) * period
    reach = np.concatenate(([0.0], np.cumsum(cells)))[first : len(times)]
    needed = angle_between(attitude, target_attitudes[first:]) - pursuit.angle

    bent = agility.direct + agility.bending * trapezoids(rising * rising)
    swing = np.concatenate(([0.0], np.cumsum(bent * period)))[first:]
    apart = np.linalg.norm(rotate(target_attitudes[first:], target_rates[first:]) - rotate(attitude, rate), axis=1)

    impossible: NDArray[np.bool_] = needed > reach + ROUND_OFF
    impossible |= apart - rate_error > swing + ROUND_OFF
    impossible |= wanted - rate_error > rising.min(axis=0)[first:] + ROUND_OFF
    impossible |= wanted + rate_error < agility.floor(rate, times[first:]) - ROUND_OFF
    if not limited:
        impossible[max(0, 1 - first) :] = False
    return impossible


def angle_between(attitude: Array, others: Array) -> Array:
    """Angles (...) rad between an attitude (4,) and others (..., 4), the short way round."""
    return rotation_angle(multiply(conjugate(attitude), others))


def trapezoids(curves: Array) -> Array:
    """Cell means (n - 1,) of the least of the convex curves (m, n), from above."""
    means: Array = (0.5 * (curves[:, :-1] + curves[:, 1:])).min(axis=0)
    return means
