"""The least time from capture until the stack is settled: lower bounds for every controller, before capture and after it.

Settled means within an angle of H and a rate relative to H, so |w| < e = n + rate there. The stack has moments J₁ ≤ J₂ ≤ J₃,
momentum h and the chaser's torque limits; symbols and relaxations are those of `turn`. From a rate w at capture, with a turn
of α still to be made, it takes at least

    momentum    (|h| - J₃ e) / ‖limit‖
    energy      (√(wᵀ I w) - √J₃ e) / max ‖I^(-1/2) τ‖
    turn        (2 atan(p/r) - atan(u₀/r) - atan(u₁/r)) / √(A c),   p²/r² + 1 = √((1 + u₀²/r²)(1 + u₁²/r²)) exp(c α),

r = √(A/c). The last is about u = |w| + n, which bounds the rate against H, for H turns too: |u'| ≤ A + c|w|² ≤ A + c u². It is
how long it takes to turn by α when u rises from u₀ = |w| + n to p and falls to u₁ = e + n as fast as that allows (∫u dt from
u₀ to p is ln((1 + p²/r²)/(1 + u₀²/r²)) / 2c); it gives no bound where p would be less than u₀ or u₁.

Any capture (`lower`): the chaser is within θ of the debris, its rate within a threshold of w_D, at any time of the flight:

    approximate             w = w_C, I = I_c + I_d:   |w_D| - rate ≤ |w| ≤ |w_D| + rate
    momentum conserving     |h| ≥ |I_c w_C + R I_d w_D| - μ|d||d'|,   J₃ ≤ J₃(I_c) + J₃(I_d) + μ|d|²   (parallel axes)

    |I_c w_C + R I_d w_D| = |(Rᵀ I_c R + I_d) w_D + Rᵀ I_c e_w|
                          ≥ |(I_c + I_d) w_D| - 2 sin(θ/2) (J₃ - J₁)(I_c) |w_D| - J₃(I_c) rate,

since Rᵀ I R - I = Rᵀ[I - m, R - 1] for any multiple m of the identity. The arm d ends at the goal, or where the thresholds let
it end; its rate d' in non-rotating axes is at most the speed threshold beyond the goal's own, plus n|d|. Without a speed
threshold the orbital term may cancel the tumble, and the bound is 0: some capture leaves the stack at rest.

From the matched capture (`matched`): chaser on the goal, moving and turning with it, axes aligned. Informative, no bound: a
capture that is off in the right direction needs less.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from detumble.analysis.bounds.pursuit import Pursuit, start_of
from detumble.analysis.bounds.tumble import tumble
from detumble.analysis.bounds.turn import CORNERS, REGULARISATION, Agility
from detumble.quaternions import Array, conjugate, multiply, rotate, rotation_angle
from detumble.states import DEBRIS_ATTITUDE, DEBRIS_RATE


@dataclass(frozen=True)
class Detumbling:
    """Least times from capture to settled, s.

    Attributes:
        lower: over every capture that the thresholds allow at any time of the flight: no controller is faster.
        matched: over the control ticks, from captures without any error. Not a bound of other captures.
    """

    lower: float
    matched: float


def detumble_bound(case: Mapping[str, Any], not_before: float = 0.0) -> Detumbling:
    """Bound the time from capture to settled of a plain case.

    Args:
        case: as `detumble.scenario.core.case` gives it.
        not_before: s, a time before which nothing can be captured; captures from then on are considered.
    """
    pursuit, row = Pursuit.of(case), start_of(case)
    attitude = row[DEBRIS_ATTITUDE] / np.linalg.norm(row[DEBRIS_ATTITUDE])
    attitudes, rates = tumble(pursuit.debris_inertia, attitude, row[DEBRIS_RATE], pursuit.period, pursuit.periods)
    count = not_before / pursuit.period
    first = min(pursuit.periods, max(0, math.floor(count + 1e-9 * max(1.0, count))))  # a whole number despite rounding
    rates = rates[first:]
    orbit_angle = pursuit.mean_motion * pursuit.period * np.arange(pursuit.periods + 1.0)
    against_lvlh = multiply(conjugate(pursuit.lvlh_turned(orbit_angle)), attitudes)[first:]  # q_HD
    left = rotation_angle(against_lvlh) - float(case["settled"]["angle"])
    slowest = pursuit.mean_motion + float(case["settled"]["rate"])
    return Detumbling(
        lower=_lower(case, pursuit, rates, left, slowest),
        matched=_matched(case, pursuit, against_lvlh, rates, left, slowest),
    )


def detumble_lower(momentum: Array, torque: Array, moment: Array, rate: Array) -> Array:
    """Bound the time that it takes to settle from the momentum at capture, by momentum alone; arguments broadcast.

    Args:
        momentum: (...) |h|, N m s: the metric `momentum_at_capture`.
        torque: (..., 3) largest torque given on each axis, N m.
        moment: (...) largest principal moment that the stack may have, kg m²; see `largest_moment`.
        rate: (...) largest |w| of a settled stack, rad/s: mean motion + threshold.

    Returns:
        (...) s.
    """
    least: Array = np.maximum(0.0, momentum - moment * rate) / np.linalg.norm(torque, axis=-1)
    return least


def largest_moment(case: Mapping[str, Any]) -> float:
    """Bound the principal moments of any stack that the case's thresholds allow, kg m²."""
    pursuit = Pursuit.of(case)
    if case["plan"]["transition"] != "momentum_conserving":
        return float(np.linalg.eigvalsh(pursuit.chaser_inertia + pursuit.debris_inertia)[-1])
    moments = (np.linalg.eigvalsh(inertia)[-1] for inertia in (pursuit.chaser_inertia, pursuit.debris_inertia))
    return float(sum(moments)) + _reduced_mass(case) * _arm(pursuit) ** 2


def _lower(case: Mapping[str, Any], pursuit: Pursuit, rates: Array, left: Array, slowest: float) -> float:
    """The least time over all captures, each tick representing half a period before and after it."""
    tumbling = Agility.of(pursuit.debris_inertia, np.zeros(3))
    speed, fastest = np.linalg.norm(rates, axis=1), tumbling.fastest_free(rates[0])
    half = 0.5 * pursuit.period
    bent = half * tumbling.bending * fastest**2  # what w_D changes in half a period
    stack = pursuit.chaser_inertia + pursuit.debris_inertia
    if case["plan"]["transition"] != "momentum_conserving":
        least, most = np.maximum(0.0, speed - bent - pursuit.rate), speed + bent + pursuit.rate
        still_left = left - pursuit.angle - half * (fastest + pursuit.mean_motion)
        moments = np.linalg.eigvalsh(stack)
        around = pursuit.rate + 2.0 * math.sin(0.5 * min(pursuit.angle, math.pi)) * (speed + bent) + bent
        momentum = np.maximum(moments[0] * least, np.linalg.norm(rates @ stack, axis=1) - moments[2] * around)
        energy = np.maximum(
            math.sqrt(moments[0]) * least,
            np.sqrt(np.einsum("ti,ij,tj->t", rates, stack, rates)) - math.sqrt(moments[2]) * around,
        )
        captured = _Stack(stack[None], momentum, energy, most, still_left)
        return float(_quickest(pursuit, captured, slowest).min())
    if not math.isfinite(pursuit.speed):
        return 0.0
    chaser = np.linalg.eigvalsh(pursuit.chaser_inertia)
    off = 2.0 * math.sin(0.5 * min(pursuit.angle, math.pi)) * (chaser[2] - chaser[0])
    whole = np.linalg.norm(rates @ stack, axis=1) - off * (speed + bent) - np.linalg.eigvalsh(stack)[2] * bent
    arm = _arm(pursuit)
    orbital = _reduced_mass(case) * arm * (pursuit.speed + pursuit.mean_motion * arm + _goal_speed(pursuit, fastest))
    momentum = whole - chaser[2] * pursuit.rate - orbital
    return float(detumble_lower(momentum, pursuit.torque, np.asarray(largest_moment(case)), np.asarray(slowest)).min())


def _matched(
    case: Mapping[str, Any], pursuit: Pursuit, against_lvlh: Array, rates: Array, left: Array, slowest: float
) -> float:
    """The least time over the ticks, for a chaser at the goal, aligned and moving with it."""
    inertia = (pursuit.chaser_inertia + pursuit.debris_inertia)[None]
    momentum = rates @ inertia[0]
    if case["plan"]["transition"] == "momentum_conserving":
        if pursuit.grasp_points is None:
            arm = rotate(conjugate(against_lvlh), pursuit.goal)  # in D, and C
            across = rotate(conjugate(against_lvlh), np.cross([0.0, 0.0, pursuit.mean_motion], pursuit.goal))
        else:
            arm = np.broadcast_to(pursuit.grasp_points[1] - pursuit.grasp_points[0], rates.shape)
            across = np.cross(rates, arm)
        mass = _reduced_mass(case)
        squares = (arm**2).sum(axis=1)[:, None, None] * np.eye(3) - arm[:, :, None] * arm[:, None, :]
        inertia = inertia + mass * squares
        momentum = momentum + mass * np.cross(arm, across)
    spin = np.linalg.solve(inertia, momentum[:, :, None])[..., 0]
    energy = np.sqrt((spin * momentum).sum(axis=1))
    captured = _Stack(inertia, np.linalg.norm(momentum, axis=1), energy, np.linalg.norm(spin, axis=1), left)
    return float(_quickest(pursuit, captured, slowest).min())


@dataclass(frozen=True)
class _Stack:
    """A stack at n possible captures.

    Attributes:
        inertia: (n, 3, 3) kg m², or one for all.
        momentum: (n,) |h| or less, N m s.
        energy: (n,) √(wᵀ I w) or less.
        rate: (n,) |w| or more, rad/s.
        left: (n,) rad still to be turned against H, or less.
    """

    inertia: Array
    momentum: Array
    energy: Array
    rate: Array
    left: Array


def _quickest(pursuit: Pursuit, stack: _Stack, slowest: float) -> Array:
    """Lower bounds (n,) of the time to settle, s, down to |w| ≤ slowest, rad/s."""
    torque, inertia, left = pursuit.torque, stack.inertia, stack.left
    if not np.isfinite(torque).all():
        return np.zeros(len(left))
    moments = np.linalg.eigvalsh(inertia)
    j1, j2, j3 = moments.T
    corners = CORNERS * torque
    spun = np.linalg.solve(inertia, np.broadcast_to(corners.T, (len(inertia), 3, 8)))
    direct = np.linalg.norm(spun, axis=1).max(axis=1) + REGULARISATION
    product = np.abs((j1 - j2) * (j2 - j3) * (j3 - j1)) / (j1 * j2 * j3)
    growth = product / (3.0 * math.sqrt(3.0)) + REGULARISATION
    by_momentum = (stack.momentum - j3 * slowest) / np.linalg.norm(torque)
    by_energy = (stack.energy - np.sqrt(j3) * slowest) / np.sqrt(np.einsum("ci,nic->nc", corners, spun).max(axis=1))
    scale, pace = np.sqrt(direct / growth), np.sqrt(direct * growth)
    first, last = (((rate + pursuit.mean_motion) / scale) ** 2 for rate in (stack.rate, slowest))
    # p²/r², written without the difference of numbers near 1
    peak = np.expm1(0.5 * (np.log1p(first) + np.log1p(last)) + growth * np.maximum(0.0, left))
    turned = (2.0 * np.arctan(np.sqrt(peak)) - np.arctan(np.sqrt(first)) - np.arctan(np.sqrt(last))) / pace
    counts = (left > 0.0) & (peak > np.maximum(first, last))
    least: Array = np.maximum.reduce((by_momentum, by_energy, np.where(counts, turned, 0.0), np.zeros(len(left))))
    return least


def _reduced_mass(case: Mapping[str, Any]) -> float:
    chaser, debris = float(case["chaser"]["mass"]), float(case["debris"]["mass"])
    return chaser * debris / (chaser + debris)


def _arm(pursuit: Pursuit) -> float:
    """The longest |d| at capture, m."""
    if pursuit.from_debris:
        return pursuit.distance
    if pursuit.grasp_points is None:
        return float(np.linalg.norm(pursuit.goal)) + pursuit.distance
    return float(sum(np.linalg.norm(point) for point in pursuit.grasp_points)) + pursuit.distance


def _goal_speed(pursuit: Pursuit, fastest: float) -> float:
    """The largest |v_des| in H, m/s: of a fixed goal none, of grasp points Ω_D × R p_D - Ω_C × R p_C."""
    if pursuit.grasp_points is None:
        return 0.0
    p_chaser, p_debris = (float(np.linalg.norm(point)) for point in pursuit.grasp_points)
    spin = fastest + pursuit.mean_motion
    return spin * p_debris + (spin + pursuit.rate) * p_chaser
