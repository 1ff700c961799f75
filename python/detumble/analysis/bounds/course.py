"""Certificates over whole intervals of time: what no control can do at any time between two nodes, not only at them.

For a direction d = (d_r, d_v), a threshold c, and a start with miss(t) = Φ(t) X(0) - goal(t),

    value(t) = d · miss(t) - R |d_r| - S |d_v| - Σ_j a_j ∫₀ᵗ (|d · K_j(s)| - c)₊ ds.

c = 0: value(t) > 0 proves that t is impossible (`translation`).
c = 1: value(t) is a lower bound of the Δv = Σ_j ∫ |u_j| of every control that captures at t. For X(t) - goal(t) in the two
balls d · (X - goal) ≤ R |d_r| + S |d_v|, and with f_j(s) = d · K_j(s) and |u_j| ≤ a_j

    d · miss - R |d_r| - S |d_v| ≤ -Σ_j ∫ f_j u_j ≤ Σ_j ∫ |u_j| + Σ_j ∫ (|f_j| - 1) |u_j| ≤ Δv + Σ_j a_j ∫ (|f_j| - 1)₊.

An axis without limit must have |f_j| ≤ c.

Between nodes a distance h apart, with chords of all curves, errors are bounded by second derivatives: |f_j - chord| ≤ M_j h²/8,
so ∫ (|f_j| - c)₊ exceeds that of the chord by at most M_j h³/12; and value(t) lies above its own chord less B h²/8 with
B ≥ |d · miss''| + Σ_j a_j |f_j'| (the last for axes whose |f_j| can exceed c in the cell), |f_j'| ≤ |Δf_j|/h + M_j h.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from detumble.analysis.bounds.goal import Goal, GoalChange
from detumble.analysis.bounds.hcw import drift_bend, hcw, kernel_bend
from detumble.analysis.bounds.translation import ROUND_OFF
from detumble.quaternions import Array
from detumble.states import DEBRIS, DEBRIS_RATE, TRANSLATION

if TYPE_CHECKING:
    from detumble.analysis.bounds.pursuit import Pursuit

ORBIT_ANGLE, DEBRIS_ANGLE = 0.02, 0.05  # rad turned in a cell at most


@lru_cache(maxsize=8)
def _nodes(mean_motion: float, until: float, cells: int) -> tuple[Array, Array]:
    """Φ and K at even times: the same for all chases in one orbit."""
    drift, kernel, _ = hcw(mean_motion, np.linspace(0.0, until, cells + 1))
    drift.flags.writeable = kernel.flags.writeable = False
    return drift, kernel


class Course:
    """One start and its goal over an interval of time.

    Args:
        pursuit: the chase.
        start: (20,) as `start_of` lays it out.
        until: end of the interval, s, more than 0.
        cells: that it is divided into, or more where the orbit or the debris turns fast.

    Attributes:
        times: (k + 1,) s, even until cells are split.
        miss: (k + 1, 6) free drift less the goal, m and m/s.
        inside: (k + 1,) whether free drift is within the thresholds.
        timed: whether there is a speed threshold.
    """

    def __init__(self, pursuit: Pursuit, start: Array, until: float, cells: int = 256) -> None:
        goal_change = GoalChange.of(pursuit, start[DEBRIS_RATE])
        n, turned = pursuit.mean_motion, until * max(pursuit.mean_motion / ORBIT_ANGLE, goal_change.spin / DEBRIS_ANGLE)
        cells = max(cells, int(np.ceil(turned)))
        self.pursuit, self.start = pursuit, start
        self.mean_motion, self.acceleration, self.bounded = n, pursuit.acceleration, pursuit.reach.bounded
        self.drift_bend, self.goal_change = drift_bend(n, start[TRANSLATION]), goal_change
        self.timed = bool(np.isfinite(pursuit.speed))
        drift, kernel = _nodes(n, until, cells)
        goal = Goal.between(pursuit, start[DEBRIS], 0.0, until, cells)
        self.radius = goal.radius
        self._place(np.linspace(0.0, until, cells + 1), kernel, self._miss(drift, goal), goal.speed)

    def _miss(self, drift: Array, goal: Goal) -> Array:
        missed: Array = np.einsum("kij,j->ki", drift, self.start[TRANSLATION]) - goal.state
        return missed

    def _place(self, times: Array, kernel: Array, miss: Array, speed: Array) -> None:
        self.times, self.kernel, self.miss = times, kernel, miss
        self.speed = speed if self.timed else np.zeros(len(times))
        distance, velocity = (np.linalg.norm(part, axis=1) for part in (miss[:, :3], miss[:, 3:]))
        self.inside = distance < self.radius
        if self.timed:
            self.inside &= velocity < speed
        self.slack_position = ROUND_OFF * (1.0 + distance + self.radius)
        self.slack_velocity = ROUND_OFF * (1.0 + velocity + self.speed)

    def split(self, cell: int, parts: int) -> None:
        """Insert nodes into a cell, so that it becomes `parts` cells."""
        first, last = float(self.times[cell]), float(self.times[cell + 1])
        times = np.linspace(first, last, parts + 1)[1:-1]
        drift, kernel, _ = hcw(self.mean_motion, times)
        whole = Goal.between(self.pursuit, self.start[DEBRIS], first, last, parts)
        goal = Goal(whole.state[1:-1], whole.radius, whole.speed[1:-1])

        def put(old: Array, new: Array) -> Array:
            return np.concatenate((old[: cell + 1], new, old[cell + 1 :]))

        miss = self._miss(drift, goal)
        self._place(put(self.times, times), put(self.kernel, kernel), put(self.miss, miss), put(self.speed, goal.speed))

    def certificate(self, direction: Array, threshold: float) -> tuple[Array, Array]:
        """Lower bounds of value(t) on each cell: at its two ends (k,), (k,); linear between them is a bound as well.

        Args:
            direction: d (6,), 1/m and s/m times the unit of the value.
            threshold: c.
        """
        d = direction if self.timed else np.concatenate((direction[:3], np.zeros(3)))
        if threshold == 0.0:
            d = d * np.tile(self.bounded, 2)
        free = np.isinf(self.acceleration)
        limit = np.where(free, 0.0, self.acceleration)
        h, bend = np.diff(self.times)[:, None], kernel_bend(self.mean_motion, d)
        f = np.einsum("kjs,s->kj", self.kernel, d)
        over = f - np.clip(f, -threshold, threshold)
        left, right = over[:-1], over[1:]
        # the mean of (|chord| - c)₊: trapezoid where the chord stays on one side, else by its antiderivative
        crossing = (left * right < 0.0) | ((left == 0.0) != (right == 0.0))
        mean = 0.5 * (np.abs(left) + np.abs(right))
        change = np.diff(f, axis=0)
        np.divide(right * np.abs(right) - left * np.abs(left), 2.0 * change, out=mean, where=crossing)
        peak = np.maximum(np.abs(f[:-1]), np.abs(f[1:])) + bend * h * h / 8.0
        active = peak > threshold
        spent = h * (mean + active * (bend * h * h / 12.0))
        value = np.einsum("ks,s->k", self.miss, d)
        value[1:] -= np.cumsum((spent * limit).sum(axis=1))
        turn, pace = float(np.linalg.norm(d[:3])), float(np.linalg.norm(d[3:]))
        value -= turn * (self.radius + self.slack_position) + pace * (self.speed + self.slack_velocity)

        slope = np.where(active, np.abs(change) / h + bend * h, 0.0)
        drifting = np.abs(d) @ self.drift_bend + turn * self.goal_change.place + pace * self.goal_change.velocity
        h = h[:, 0]
        sag = (drifting + (slope * limit).sum(axis=1)) * (h * h / 8.0) + pace * self.goal_change.speed * (0.5 * h)
        low_left, low_right = value[:-1] - sag, value[1:] - sag
        if threshold > 0.0 and free.any():
            forbidden = np.logical_or.accumulate((peak[:, free] > threshold).any(axis=1))
            low_left[forbidden] = low_right[forbidden] = -np.inf
        return low_left, low_right

    def cell(self, time: float) -> int:
        """The index of the cell that ends at a time or contains it."""
        return max(0, int(np.searchsorted(self.times, time)) - 1)

    def value(self, direction: Array, time: float) -> float:
        """The certificate of Δv, m/s, at a time that is a node."""
        return float(self.certificate(self.scaled(direction, time), 1.0)[1][self.cell(time)])

    def scaled(self, direction: Array, time: float) -> Array:
        """The direction scaled down until |d · K_j| ≤ 1 on axes without limit, up to a time, s."""
        free = np.isinf(self.acceleration)
        if not free.any():
            return direction
        f = np.einsum("kjs,s->kj", self.kernel[: self.cell(time) + 2], direction)[:, free]
        bend = kernel_bend(self.mean_motion, direction)[free] * float(np.diff(self.times).max()) ** 2 / 8.0
        return direction / max(1.0, (1.0 + 1e-12) * float((np.abs(f) + bend).max()))

    def impossible_until(self, direction: Array, time: float) -> float:
        """The end, s, of the interval from `time` on that d proves impossible; `time` itself if d proves nothing there."""
        left, right = self.certificate(direction, 0.0)
        cell = int(np.clip(np.searchsorted(self.times, time, side="right") - 1, 0, len(left) - 1))
        share = float(np.clip((time - self.times[cell]) / (self.times[cell + 1] - self.times[cell]), 0.0, 1.0))
        left[cell] += share * (right[cell] - left[cell])  # from here on, only the rest of this cell counts
        failed = (left[cell:] <= 0.0) | (right[cell:] <= 0.0)
        if not failed.any():
            return float(self.times[-1])
        last = cell + int(np.argmax(failed))
        begin, end = max(time, float(self.times[last])), float(self.times[last + 1])
        if left[last] <= 0.0:
            return begin
        return begin + (1.0 - 1e-9) * (end - begin) * float(left[last] / (left[last] - right[last]))

    def switches(self, direction: Array, until: float, threshold: float) -> Array:
        """Times s before capture at `until`, s, at which some |d · K_j(s)| crosses the threshold, approximately; unordered."""
        last = int(np.searchsorted(self.times, until)) + 1
        f = np.einsum("kjs,s->kj", self.kernel[: last + 1], direction)
        found = [_crossings(self.times[: last + 1], f - level) for level in {threshold, -threshold}]
        times = np.concatenate(found)
        return times[times < until]


def _crossings(times: Array, curves: Array) -> Array:
    """Where the curves (k, 3) pass zero, by chords."""
    cell, axis = np.nonzero(curves[:-1] * curves[1:] < 0.0)
    left, right = curves[cell, axis], curves[cell + 1, axis]
    roots: Array = times[cell] + (times[cell + 1] - times[cell]) * left / (left - right)
    return roots
