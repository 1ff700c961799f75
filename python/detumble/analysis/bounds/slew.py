"""Slews that a chaser can fly: upper bounds of the time at which angle and relative rate hold, each with its torques.

A candidate comes from a simple law (`chase`) or, from there, from a nonlinear programme (`shooting`: a local optimum, begun
both ways round). It counts only if its torques, clipped to the limits and integrated once more through
I w' + w × I w = τ, q' = q ⊗ [0, w]/2 by DOP853 (rtol 1e-12) against the tumble in closed form, meet the thresholds strictly.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from detumble.analysis.bounds.attitude import Turn, earliest_attitude, excess
from detumble.analysis.bounds.chase import MOST_TURN, Motion, chase
from detumble.analysis.bounds.shooting import (
    KNOTS,
    SOONEST_INTERVALS,
    TIMED_INTERVALS,
    SlewTask,
    on_time,
    soonest,
)
from detumble.analysis.bounds.tumble import tumble
from detumble.quaternions import Array

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from detumble.analysis.bounds.pursuit import Pursuit

MARGINS = (1e-6, 1e-3)  # of the thresholds, kept in the programmes; the second if the first was lost in the integration
WIDENED = 1e-5  # a programme that widens the thresholds by more has found no slew
KEPT = 1e-7  # of the thresholds, at a tick, for plants that round differently
NEARLY = 1.05  # times the thresholds: up to this excess another programme is solved
CHASE_LONGEST = 200  # steps


@dataclass(frozen=True)
class Slew:
    """A turn with torques held between times, as integrated.

    Attributes:
        times: (n + 1,) s, from 0.
        torque: (n, 3) N m, chaser axes, constant from time to time.
        attitude: (n + 1, 4) chaser → N.
        rate: (n + 1, 3) rad/s, chaser axes.
    """

    times: Array
    torque: Array
    attitude: Array
    rate: Array


@dataclass(frozen=True)
class AttitudeBound:
    """The least time at which angle and relative rate hold lies between these, s.

    Attributes:
        lower: no torque is faster; inf where the flight is too short.
        upper: of the slew found; inf where none was found.
        slew: the slew found; None if there is none, or if no torque limit bounds it.
    """

    lower: float
    upper: float
    slew: Slew | None


def attitude_bound(pursuit: Pursuit, start: Array) -> AttitudeBound:
    """Bound the least time in which angle and relative rate can be brought below their thresholds.

    Without a dwell any real time counts. With one the upper bound is a control tick, the thresholds judged at ticks.

    Args:
        pursuit: limits, bodies and thresholds.
        start: (20,), as `pursuit.start_of` gives it.

    Raises:
        RequestError: CasADi is not installed.
    """
    lower = earliest_attitude(pursuit, start)
    if not np.isfinite(pursuit.torque).any():
        tick = max(0 if Turn(pursuit, start).met_at_once else 1, pursuit.dwell_ticks)
        return AttitudeBound(lower, pursuit.time_of(tick) if tick <= pursuit.periods else math.inf, None)
    if math.isinf(lower):
        return AttitudeBound(lower, math.inf, None)
    slew = _soonest(pursuit, start, lower)
    if pursuit.dwell_ticks:
        begin = float(slew.times[-1]) if slew else lower - pursuit.dwell_ticks * pursuit.period
        slew = first_slew(pursuit, start, math.ceil(begin / pursuit.period - 1e-9) + pursuit.dwell_ticks)
    return AttitudeBound(lower, float(slew.times[-1]) if slew else math.inf, slew)


def first_slew(pursuit: Pursuit, start: Array, from_tick: int) -> Slew | None:
    """Find the first tick from a given one on at which `slew_at_tick` succeeds; the step doubles after each failure.

    Args:
        pursuit: limits, bodies and thresholds.
        start: (20,), as `pursuit.start_of` gives it.
        from_tick: first tick asked for.

    Raises:
        RequestError: CasADi is not installed.
    """
    least = earliest_attitude(pursuit, start)
    if not math.isfinite(least):
        return None
    later = 0
    while from_tick + later <= pursuit.periods:
        slew = slew_at_tick(pursuit, start, from_tick + later, least)
        if slew:
            return slew
        later = max(later + 1, 2 * later)
    return None


def fly(inertia: Array, attitude: Array, rate: Array, times: Array, torque: Array) -> tuple[Array, Array]:
    """Turn a rigid body with torques held between times.

    Args:
        inertia: (3, 3) kg m².
        attitude: (4,) body → N at times[0].
        rate: (3,) rad/s there, body axes.
        times: (n + 1,) s.
        torque: (n, 3) N m, body axes.

    Returns:
        attitudes (n + 1, 4), rates (n + 1, 3) at all times.
    """
    from scipy.integrate import solve_ivp  # type: ignore[import-untyped]  # slow to import

    inverse = np.linalg.inv(inertia)
    rows = np.empty((len(times), 7))
    rows[0] = np.concatenate((attitude, rate))
    changes = np.flatnonzero((np.diff(torque, axis=0) != 0.0).any(axis=1)) + 1
    for first, last in zip((0, *changes), (*changes, len(torque)), strict=True):
        slope = _rotation(inertia.tolist(), inverse.tolist(), torque[first].tolist())
        span = times[first : last + 1]
        found = solve_ivp(slope, (span[0], span[-1]), rows[first], "DOP853", span, rtol=1e-12, atol=1e-14)
        rows[first + 1 : last + 1] = found.y.T[1:]
        rows[last, :4] /= np.linalg.norm(rows[last, :4])
    return rows[:, :4] / np.linalg.norm(rows[:, :4], axis=1, keepdims=True), rows[:, 4:]


def _rotation(
    inertia: list[list[float]], inverse: list[list[float]], torque: list[float]
) -> Callable[[float, Array], list[float]]:
    """The slope of (q, w) under a torque held, in plain floats: called thousands of times on seven numbers."""
    (a, b, c), (_, d, e), (_, _, f) = inertia
    tx, ty, tz = torque

    def slope(_: float, row: Array) -> list[float]:
        q0, q1, q2, q3, x, y, z = row.tolist()
        hx, hy, hz = a * x + b * y + c * z, b * x + d * y + e * z, c * x + e * y + f * z
        sx, sy, sz = tx - y * hz + z * hy, ty - z * hx + x * hz, tz - x * hy + y * hx
        return [
            -0.5 * (q1 * x + q2 * y + q3 * z),
            0.5 * (q0 * x + q2 * z - q3 * y),
            0.5 * (q0 * y + q3 * x - q1 * z),
            0.5 * (q0 * z + q1 * y - q2 * x),
            *(i * sx + j * sy + k * sz for i, j, k in inverse),
        ]

    return slope


def slew_at_tick(pursuit: Pursuit, start: Array, tick: int, least: float) -> Slew | None:
    """Find torques, held over control periods, with which angle and rate hold at a tick and the dwell before it.

    Args:
        pursuit: limits, bodies and thresholds.
        start: (20,), as `pursuit.start_of` gives it.
        tick: control tick, t = tick · period.
        least: bound of `earliest_attitude`, s.

    Returns:
        The slew with one row of torque for each period, or None if none was found (which proves nothing).

    Raises:
        RequestError: CasADi is not installed.
    """
    turn, limit = Turn(pursuit, start), _finite(pursuit)
    pursuit = replace(pursuit, angle=pursuit.angle * (1.0 - KEPT), rate=pursuit.rate * (1.0 - KEPT))
    if not max(pursuit.dwell_ticks, least / pursuit.period - 1e-9) <= tick <= pursuit.periods:
        return None
    if tick == 0:
        return Slew(np.zeros(1), np.empty((0, 3)), turn.attitude[None, :], turn.rate[None, :])
    # A slew much longer than the shortest begins late: until then the chaser turns freely, and no interval is spent on it.
    longest = 2 * math.ceil(least / pursuit.period) + pursuit.dwell_ticks
    for window in sorted({min(tick, max(longest, TIMED_INTERVALS)), tick}):
        slew = _within(pursuit, turn, limit, tick, window)
        if slew:
            return slew
    return None


def _within(pursuit: Pursuit, turn: Turn, limit: Array, tick: int, window: int) -> Slew | None:
    """A slew in the last `window` periods before a tick, if one is found."""
    group = math.ceil(window / CHASE_LONGEST)
    window -= window % group
    wait = (tick - window) * pursuit.period
    free = tumble(pursuit.chaser_inertia, turn.attitude, turn.rate, wait, 1)
    attitude, rate = free[0][-1], free[1][-1]
    debris = _tumble(pursuit, turn, pursuit.period, tick)
    ahead = debris[0][tick - window :], debris[1][tick - window :]
    counts = _counts(window, pursuit.dwell_ticks)
    ends = np.concatenate(([0], np.cumsum(counts)))

    def integrated(torque: Array, held: NDArray[np.int64]) -> Slew | None:
        rows = np.vstack((np.zeros((tick - window, 3)), np.repeat(torque, held, axis=0)))
        times = pursuit.period * np.arange(tick + 1, dtype=np.float64)
        attitudes, rates = fly(pursuit.chaser_inertia, turn.attitude, turn.rate, times, rows)
        dwell = slice(tick - pursuit.dwell_ticks, tick + 1)
        inside = excess(pursuit, attitudes[dwell], rates[dwell], debris[0][dwell], debris[1][dwell]) < 1.0
        return Slew(times, rows, attitudes, rates) if inside.all() else None

    stages = ahead[0][::group], ahead[1][::group]
    chases = chase(pursuit, limit, attitude, rate, stages, group * pursuit.period).nearest()
    for motion in chases:
        if excess(pursuit, motion.attitude[-1], motion.rate[-1], debris[0][-1], debris[1][-1]) < 1.0:
            slew = integrated(motion.torque, np.full(len(motion.torque), group))
            if slew:
                return slew

    judged = np.concatenate((ends[1:] > window - pursuit.dwell_ticks, [True]))
    durations = pursuit.period * counts.astype(np.float64)
    for motion in chases:
        guess = motion.resampled(durations)
        for margin in MARGINS:
            task = _task(pursuit, limit, margin)
            guess, widened = on_time(task, durations, (ahead[0][ends], ahead[1][ends]), judged, guess)
            if widened > WIDENED:
                break
            slew = integrated(guess.torque, counts)
            if slew:
                return slew
    return None


def _counts(window: int, dwell_ticks: int) -> NDArray[np.int64]:
    """Periods (TIMED_INTERVALS,) in each interval, none at first if there are too few, single ones in a short dwell."""
    single = min(dwell_ticks, TIMED_INTERVALS // 2, window)
    shared, over = divmod(window - single, TIMED_INTERVALS - single)
    groups = np.full(TIMED_INTERVALS - single, shared, dtype=np.int64)
    groups[len(groups) - over :] += 1
    return np.concatenate((groups, np.ones(single, dtype=np.int64)))


def _soonest(pursuit: Pursuit, start: Array, lower: float) -> Slew | None:
    """The shortest slew found that ends inside the thresholds, without regard to the dwell."""
    turn, limit = Turn(pursuit, start), _finite(pursuit)
    if turn.met_at_once:
        return Slew(np.zeros(1), np.empty((0, 3)), turn.attitude[None, :], turn.rate[None, :])
    last = pursuit.period * pursuit.periods
    best: Slew | None = None
    for guess in _first_guesses(pursuit, turn, limit, max(lower, 0.25 * pursuit.period)):
        horizon = min(last, 1.2 * guess.time)
        tumbling = _tumble(pursuit, turn, horizon / (KNOTS - 1), KNOTS - 1)
        found = guess.resampled(np.full(SOONEST_INTERVALS, guess.time / SOONEST_INTERVALS))
        for margin in MARGINS:
            found = soonest(_task(pursuit, limit, margin), horizon, tumbling, found)
            slew, over = _integrated(pursuit, turn, found)
            best = _sooner(best, slew, over)
            if not 1.0 <= over < NEARLY:
                break
        if best is None:
            best = _sooner(best, *_integrated(pursuit, turn, guess))
    return best


def _first_guesses(pursuit: Pursuit, turn: Turn, limit: Array, least: float) -> list[Motion]:
    """Chases that arrive, the quickest each way round; if none arrives soon, also the nearest after a short time."""
    last = pursuit.period * pursuit.periods
    speed = max(float(np.linalg.norm(turn.rate)), turn.fastest) + 1e-12
    near: list[Motion] = []
    horizon, reached = 5.0 * least, 0.0
    while reached < min(horizon, last):
        step = min(horizon / CHASE_LONGEST, MOST_TURN / speed)  # a longer step makes the law unstable
        steps = min(math.ceil(horizon / step), 4 * CHASE_LONGEST)
        chases = chase(pursuit, limit, turn.attitude, turn.rate, _tumble(pursuit, turn, step, steps), step)
        arriving = list(chases.arriving())
        if arriving:
            return arriving + near
        near, reached, horizon = near or chases.nearest()[:1], max(reached, steps * step), 4.0 * horizon
        if steps == 4 * CHASE_LONGEST:
            break
    return near if limit.any() else []


def _task(pursuit: Pursuit, limit: Array, margin: float) -> SlewTask:
    """The task of a programme with thresholds tightened by a share."""
    return SlewTask(pursuit.chaser_inertia, limit, pursuit.angle * (1.0 - margin), pursuit.rate * (1.0 - margin))


def _sooner(best: Slew | None, slew: Slew, over: float) -> Slew | None:
    """The shorter of two slews, the second only if it ends inside the thresholds: `over` is below 1."""
    if over >= 1.0 or (best and best.times[-1] <= slew.times[-1]):
        return best
    return slew


def _finite(pursuit: Pursuit) -> Array:
    """Limits (3,), N m; where there is none, what turns the largest moment once round in a control period."""
    ample = 8.0 * math.pi * pursuit.agility.largest / pursuit.period**2
    return np.where(np.isfinite(pursuit.torque), pursuit.torque, ample)


def _tumble(pursuit: Pursuit, turn: Turn, step: float, steps: int) -> tuple[Array, Array]:
    """The debris' attitudes (steps + 1, 4), of one continuous sign, and rates (steps + 1, 3)."""
    attitudes, rates = tumble(pursuit.debris_inertia, *turn.debris, step, steps)
    flips = np.sign((attitudes[1:] * attitudes[:-1]).sum(axis=1))
    return attitudes * np.cumprod(np.concatenate(([1.0], flips)))[:, None], rates


def _integrated(pursuit: Pursuit, turn: Turn, motion: Motion) -> tuple[Slew, float]:
    """The slew that a motion's torques give, and its excess over the thresholds at the end; inf after the flight."""
    times = np.linspace(0.0, motion.time, len(motion.torque) + 1)
    attitudes, rates = fly(pursuit.chaser_inertia, turn.attitude, turn.rate, times, motion.torque)
    debris = tumble(pursuit.debris_inertia, *turn.debris, motion.time, 1)
    over = float(excess(pursuit, attitudes[-1], rates[-1], debris[0][1], debris[1][1]))
    in_time = motion.time <= pursuit.period * pursuit.periods
    return Slew(times, motion.torque, attitudes, rates), over if in_time else math.inf
