"""The least time of a translation to within its thresholds, from both sides, in continuous time.

From below: from t = 0 on, the direction that separates reach from goal at t proves t impossible and an interval after it
(`course`); the next direction is solved for at that interval's end (the reach is not nested: no time is skipped). Near the
bound this is Newton's method on the separation, from one side (Neustadt 1960; Eaton 1962).
From above: any transfer of the convex programme just after that (`transfer`).

A dwell asks for the thresholds from T - dwell to T: the lower bound is the first open time plus the dwell.
"""

from __future__ import annotations

import math

import numpy as np

from detumble.analysis.bounds.course import Course
from detumble.analysis.bounds.pursuit import Pursuit
from detumble.analysis.bounds.transfer import Bracket, Task, Transfer, pieces
from detumble.quaternions import Array
from detumble.states import POSITION, VELOCITY

STUCK = 1e-7  # share of the time by which a proof must advance
CLOSE = 1e-4  # gap that ends the search from above
TRIALS = 24  # transfers tried at most
REFINEMENTS = 4  # times that the pieces of a control are put where it switches
MARKS = 12  # earlier switching times kept
SOLVES = 200  # directions tried at most; the bound is proved wherever the search stops


def translation_bound(pursuit: Pursuit, start: Array) -> Bracket:
    """Least time, s, at which distance (and speed, if asked for) can hold, for any control within the limits.

    Args:
        pursuit: the chase.
        start: (20,) as `start_of` lays it out.

    Returns:
        Bracket in s: 0 for a start inside; inf when the flight is too short. `upper` aims at the aligned goal when there are
        grasp points, so its gap is then that of the widened thresholds. Without force limits 0 is approached but not
        reached: `upper` is one control period.
    """
    duration, dwell = pursuit.periods * pursuit.period, pursuit.dwell_ticks * pursuit.period
    opening, marks = first_open(pursuit, start, duration - dwell)
    if math.isinf(opening):
        return Bracket(math.inf, math.inf, None)
    lower = opening + dwell
    if lower == 0.0 and (at_once := Task.capture(pursuit, start, 0.0)[0].fly(np.zeros(1), np.empty((0, 3)))):
        return Bracket(0.0, 0.0, at_once)
    limited = bool(np.isfinite(pursuit.acceleration).all())
    best: Transfer | None = None
    upper, failed = math.inf, lower
    trial = lower * (1.0 + 0.2 * CLOSE) if lower > 0.0 else pursuit.period
    for _ in range(TRIALS):  # first at growing distances, then by bisection
        trial = min(trial, duration)
        found, marks = _attempt(pursuit, start, trial, marks)
        if found is not None:
            best, upper = found, trial
            if upper - lower <= CLOSE * lower or upper - failed <= 0.2 * CLOSE * upper or not (lower or limited):
                break
        elif best is None and trial == duration:
            break
        else:
            failed = trial
        trial = 0.5 * (failed + upper) if best else lower + 2.0 * (failed - lower) + CLOSE * lower
    return Bracket(lower, upper, best)


def first_open(pursuit: Pursuit, start: Array, end: float) -> tuple[float, Array]:
    """The time, s, up to which capture is proved impossible, inf when that is `end`; and switching times found on the way."""
    time, until = 0.0, min(end, _guess(pursuit, start))
    none = np.empty(0)
    if end <= 0.0:
        return (0.0 if Course(pursuit, start, pursuit.period).inside[0] and end == 0.0 else math.inf), none
    course = Course(pursuit, start, until)
    if course.inside[0]:
        return 0.0, none
    marks, refined = none, 0
    for _ in range(SOLVES):
        direction = _separate(pursuit, course, start, time, marks)
        if direction is None:
            break
        proved = course.impossible_until(direction, time)
        if time > 0.0:
            marks = np.concatenate((marks[-MARKS:], time - course.switches(direction, time, 0.0)))
        if proved > time * (1.0 + STUCK):
            time, refined = proved, 0
            if time >= end * (1.0 - 1e-12):
                return math.inf, marks
            if time >= until * (1.0 - 1e-12):
                until = min(end, 2.0 * until)
                course = Course(pursuit, start, until)
        elif until > 4.0 * time and until > 1e-9 * end:
            until = max(2.0 * time, until / 16.0)  # the cells are too wide for a time this short
            course = Course(pursuit, start, until)
        elif refined < REFINEMENTS:
            refined += 1
        else:
            break
    return time, marks


def _guess(pursuit: Pursuit, start: Array) -> float:
    """A time scale, s: what the double integrator would need, about."""
    limit = pursuit.acceleration[np.isfinite(pursuit.acceleration) & (pursuit.acceleration > 0.0)]
    if not len(limit):
        return math.inf
    far = float(np.linalg.norm(start[POSITION])) + float(np.linalg.norm(pursuit.goal))
    fast, least = float(np.linalg.norm(start[VELOCITY])), float(limit.min())
    return 2.0 * (math.sqrt(2.0 * far / least) + fast / least) + 1e-3


def _separate(pursuit: Pursuit, course: Course, start: Array, time: float, marks: Array) -> Array | None:
    """A direction that should separate reach and goal at a time, or None when they meet."""
    mask = np.tile(course.bounded, 2)
    if time == 0.0:
        near, slow = course.miss[0].copy(), course.miss[0].copy()
        near[3:], slow[:3] = 0.0, 0.0
        outside = bool(np.linalg.norm(near * mask) > course.radius)
        direction = (near if outside else slow) * mask
        return direction if direction.any() else None
    steering = Task.at(pursuit, start, time).steer(pieces(time, marks, pursuit.mean_motion), fuel=False)
    if steering is None or steering.slack <= 0.0 or not (steering.direction * mask).any():
        return None
    return steering.direction


def _attempt(pursuit: Pursuit, start: Array, time: float, marks: Array) -> tuple[Transfer | None, Array]:
    """A transfer that captures at a time, s, or None; with better switching times."""
    task, margin = Task.capture(pursuit, start, time)
    course = Course(pursuit, start, time)
    for _ in range(REFINEMENTS):
        grid = np.union1d(pieces(time, marks, pursuit.mean_motion), task.knots)
        steering = task.steer(grid, fuel=False, margin=margin)
        if steering is None:
            break
        if steering.slack < 0.0 and (found := task.fly(grid, steering.acceleration)) is not None:
            return found, marks
        marks = np.concatenate((marks[-MARKS:], time - course.switches(steering.direction, time, 0.0)))
    return None, marks
