"""The least Δv of a translation to within its thresholds by a given time, from both sides.

Δv = Σ over axes of ∫ |u| dt. Capture may come at any t ≤ T, so the lower bound must hold for all of them: it is the least, over
the cells of [0, T], of the best certificate known there (`course`, threshold 1). Each convex programme at some t (`transfer`)
gives a direction that is tight near t, and a transfer whose Δv bounds the answer from above; the next t is the cell of the
lowest bound, until the two agree: outer approximation, as in Kelley 1960, with one programme a cut.

With a dwell the thresholds must hold from T - dwell on, so the lower bound looks at t ≤ T - dwell.
"""

from __future__ import annotations

import math
from bisect import bisect

import numpy as np
from numpy.typing import NDArray

from detumble.analysis.bounds.course import Course
from detumble.analysis.bounds.pursuit import Pursuit
from detumble.analysis.bounds.soonest import first_open
from detumble.analysis.bounds.transfer import Bracket, Task, Transfer, pieces
from detumble.quaternions import Array

CLOSE = 1e-3  # relative gap at which the search ends
CUTS = 200  # programmes at most; the bounds hold wherever the search stops
REFINEMENTS = 4  # times that the pieces of a control are put where it switches
MARKS = 12  # earlier switching times kept
FINE, COARSE = 512, 192  # cells to start with
PARTS = 8  # that a cell is split into
NARROW = 1e-7  # cells narrower than this share of the time are left alone
LONG = 24  # cells of a run that is halved
COASTS = 16  # moments of free drift tried
FLOOR = 1e-9  # m/s: a smaller Δv counts as none


def delta_v_bound(pursuit: Pursuit, start: Array, within: float) -> Bracket:
    """Least Δv, m/s, to meet distance (and speed, if asked for) at some time up to `within`, s.

    Args:
        pursuit: the chase.
        start: (20,) as `start_of` lays it out.
        within: s.

    Returns:
        Bracket in m/s; inf when no control can capture in that time. `upper` aims at the
        aligned goal when there are grasp points.
    """
    return _bracket(pursuit, start, within, CLOSE, verified=True)


def delta_v_lower(pursuit: Pursuit, start: Array, within: float, close: float = 0.015) -> float:
    """A lower bound of the Δv, m/s, usually within the share `close` of the best one: for many starts.

    Args:
        pursuit: the chase.
        start: (20,) as `start_of` lays it out.
        within: s.
        close: relative gap at which the search ends.
    """
    return _bracket(pursuit, start, within, close, verified=False).lower


def _bracket(pursuit: Pursuit, start: Array, within: float, close: float, verified: bool) -> Bracket:
    dwell = pursuit.dwell_ticks * pursuit.period
    horizon = within - dwell
    if horizon <= 0.0:
        inside = horizon == 0.0 and Course(pursuit, start, pursuit.period).inside[0]
        return Bracket(0.0 if inside else math.inf, math.inf, None)
    course = Course(pursuit, start, horizon, FINE if verified else COARSE)
    if course.inside.any() and (coast := _coast(pursuit, start, course)) is not None:
        return Bracket(0.0, 0.0, coast)
    proof, search = _Proof(course), _Search(pursuit, start, course, close, verified)
    time: float | None = horizon
    for _ in range(CUTS):
        if time is None or (direction := search.cut(time, proof.near(time))) is None:
            break
        proof.add(direction, time)
        if time == horizon and math.isinf(search.upper) and math.isinf(first_open(pursuit, start, horizon)[0]):
            return Bracket(math.inf, math.inf, None)
        time = proof.next_time(search.wanted)
    return Bracket(proof.lower, search.upper, search.best)


class _Proof:
    """The best certificate known on each cell of a course."""

    def __init__(self, course: Course) -> None:
        self.course = course
        self.times: list[float] = []
        self.found: list[Array] = []  # at these times
        self.between: set[float] = set()  # where interpolation was tried
        self.directions: list[Array] = []  # all of them
        self.value = np.full(len(course.times) - 1, -math.inf)
        self.owner = np.zeros(len(self.value), dtype=np.int64)

    @property
    def lower(self) -> float:
        return max(0.0, float(self.value.min()))

    def near(self, time: float) -> Array | None:
        """The direction that serves best up to a time."""
        return self.directions[self.owner[self.course.cell(time)]] if self.directions else None

    def add(self, direction: Array, time: float) -> None:
        """Use a direction found for a time, s."""
        at = bisect(self.times, time)
        self.times.insert(at, time)
        self.found.insert(at, direction)
        self._use(direction, time)

    def next_time(self, wanted: float) -> float | None:
        """The next time at which to solve for a direction, s; None when the proof is as `wanted`, or cells are narrow enough.

        Before that, cheaper improvements are tried: directions interpolated between those found, and narrower cells.
        """
        while self.lower < wanted:
            cell = int(np.argmin(self.value))
            for time in self._ends(cell, self.value < wanted):
                if time > 0.0 and time not in self.between:
                    self.between.add(time)
                    self._interpolate(time)
                    break
                if time > 0.0 and time not in self.times:
                    return time
            else:
                if np.diff(self.course.times)[cell] < NARROW * self.course.times[-1]:
                    return None
                self._split(cell)
        return None

    def _ends(self, cell: int, open_cells: NDArray[np.bool_]) -> list[float]:
        """Candidate times for a direction in the run of open cells around one of them, s, the best first.

        A certificate is a tangent of the true curve, valid in the direction in which the curve rises, and no local minimum may
        be missed. So long runs are halved, and short ones are extended from the end beside the cells that are proved.
        """
        proved = np.flatnonzero(~open_cells)
        first = int(proved[proved < cell].max(initial=-1)) + 1
        end = int(proved[proved > cell].min(initial=len(open_cells)))
        outer = [end, first] if first == 0 else [first, end]
        nodes = [(first + end) // 2] if end - first > LONG else outer
        return [float(self.course.times[node]) for node in (*nodes, cell + 1, cell)]

    def _interpolate(self, time: float) -> None:
        at = bisect(self.times, time)
        if 0 < at < len(self.times):
            before, after = self.times[at - 1 : at + 1]
            share = (time - before) / (after - before)
            self._use((1.0 - share) * self.found[at - 1] + share * self.found[at], time)

    def _use(self, direction: Array, time: float) -> None:
        self.directions.append(self.course.scaled(direction, time))
        self._judge(len(self.directions) - 1)

    def _split(self, cell: int) -> None:
        self.course.split(cell, PARTS)
        self.value, self.owner = (
            np.insert(kept, cell, [kept[cell]] * (PARTS - 1)) for kept in (self.value, self.owner)
        )
        for index in np.unique(self.owner[max(0, cell - PARTS) : cell + 2 * PARTS]):
            self._judge(int(index))

    def _judge(self, index: int) -> None:
        value = np.min(self.course.certificate(self.directions[index], 1.0), axis=0)
        better = value > self.value
        self.value[better], self.owner[better] = value[better], index


def _coast(pursuit: Pursuit, start: Array, course: Course) -> Transfer | None:
    """Free drift to a node at which it is inside the thresholds, if that is a capture."""
    dwell = pursuit.dwell_ticks * pursuit.period
    for node in np.flatnonzero(course.inside)[:COASTS]:
        task, _ = Task.capture(pursuit, start, float(course.times[node]) + dwell)
        nodes = np.array([0.0, task.moments[-1]]) if task.moments[-1] > 0.0 else np.zeros(1)
        if (found := task.fly(nodes, np.zeros((len(nodes) - 1, 3)))) is not None:
            return found
    return None


class _Search:
    """The Δv of captures at single times.

    Attributes:
        upper: the least Δv so far, m/s; of a verified transfer, or only of a programme.
        best: the transfer.
    """

    def __init__(self, pursuit: Pursuit, start: Array, course: Course, close: float, verified: bool) -> None:
        self.pursuit, self.start, self.course, self.close, self.verified = pursuit, start, course, close, verified
        self.upper = math.inf
        self.best: Transfer | None = None

    @property
    def wanted(self) -> float:
        """The Δv to prove, m/s."""
        return self.upper if math.isinf(self.upper) else self.upper - max(self.close * self.upper, FLOOR)

    def cut(self, time: float, near: Array | None) -> Array | None:
        """A direction that is tight at a time, s; `near` is one for a nearby time, which gives approximate switching times."""
        course, task = self.course, Task.at(self.pursuit, self.start, time)
        direction, proved = near, -math.inf
        marks = np.empty(0)
        steering = None
        for _ in range(REFINEMENTS):
            marks = marks if direction is None else self._marks(marks, time, direction)
            steering = task.steer(pieces(time, marks, self.pursuit.mean_motion), fuel=True)
            if steering is None:
                break
            value = course.value(steering.direction, time)
            if value > proved:
                proved, direction = value, steering.direction
            if value >= min((1.0 - 0.25 * self.close) * steering.cost, self.upper):
                break
        if steering is not None and steering.slack <= 1e-6 * self.pursuit.distance and proved < self.upper:
            if self.verified:
                self._fly(time, direction, marks, proved)
            else:
                self.upper = min(self.upper, steering.cost)
        return direction if proved > -math.inf else None

    def _fly(self, time: float, direction: Array | None, marks: Array, proved: float) -> None:
        """Look for a transfer that captures at a time, s, at about the Δv that was proved to be needed then, m/s."""
        task, margin = Task.capture(self.pursuit, self.start, time + self.pursuit.dwell_ticks * self.pursuit.period)
        margin += 1e-7 * self.pursuit.distance + 1e-8 * float(np.linalg.norm(self.course.miss[:, :3], axis=1).max())
        capture = float(task.moments[-1])
        for _ in range(REFINEMENTS):
            marks = marks if direction is None else self._marks(marks, time, direction)
            grid = np.union1d(pieces(capture, marks, self.pursuit.mean_motion), task.knots)
            steering = task.steer(grid, fuel=True, margin=margin)
            if steering is None:
                break
            found = task.fly(grid, steering.acceleration)
            if found is not None and found.delta_v < self.upper:
                self.upper, self.best = found.delta_v, found
            if self.upper <= (1.0 + 0.25 * self.close) * proved:
                break
            direction = steering.direction if len(task.moments) == 1 else direction

    def _marks(self, marks: Array, time: float, direction: Array) -> Array:
        marked: Array = np.concatenate((marks[-MARKS:], time - self.course.switches(direction, time, 1.0)))
        return marked
