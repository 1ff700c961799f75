"""Feasible transfers: a piecewise constant control from a convex programme, verified by exact integration.

With u = a ∘ x held over each piece, X(T) = Φ(T) X(0) + Σ_k P_k u_k is linear in u, P_k = ∫ K over the piece as seen from T.
Capture at T asks for two balls, so with a slack e (m) on both this is a second-order cone programme:

    |r(T) - place| ≤ R + e,   (T/2) |v(T) - velocity| ≤ (T/2) S + e,   |x| ≤ 1,
    time: minimise e;   fuel: minimise Σ |u_k| Δ_k + price · e, e ≥ 0.

The multipliers of the balls are the direction d of `course`, the best one for this grid of pieces (Boyd & Vandenberghe,
Convex Optimization, §5.9); the programme need not be exact, since the certificate checks d and the integration checks u.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from detumble.analysis.bounds.goal import Goal, GoalChange
from detumble.analysis.bounds.hcw import hcw, held
from detumble.quaternions import Array
from detumble.states import DEBRIS, DEBRIS_RATE, TRANSLATION

if TYPE_CHECKING:
    from detumble.analysis.bounds.pursuit import Pursuit

CHECKS = 4  # moments of the dwell that are verified for each that the programme has
LOOKS = 40  # moments in the programme at most: its work grows as their cube
PIECES, MOST_PIECES = 16, 160  # of a control, besides those at its switches: for each radian of the orbit
PRICE = 100.0  # of the slack, Δv · T per metre


@dataclass(frozen=True)
class Transfer:
    """A control held between times, and the motion it gives.

    Attributes:
        times: (k + 1,) s from the start to capture.
        acceleration: (k, 3) m/s² in H, from each time to the next.
        states: (k + 1, 6) m and m/s in H.
    """

    times: Array
    acceleration: Array
    states: Array

    @property
    def delta_v(self) -> float:
        """Σ over axes of ∫ |u|, m/s."""
        return float(np.abs(self.acceleration).sum(axis=1) @ np.diff(self.times))


@dataclass(frozen=True)
class Bracket:
    """A lower bound for every controller, and a value that one controller reaches.

    Attributes:
        lower: proved; inf when capture is impossible within the flight.
        upper: of `transfer`; inf when none was found.
        transfer: the trajectory behind `upper`.
    """

    lower: float
    upper: float
    transfer: Transfer | None


@dataclass(frozen=True)
class Steering:
    """Solution of the programme.

    Attributes:
        acceleration: (k, 3) m/s², within the limits.
        cost: the least value of the programme: e, m; or Δv with the price of the slack, m/s.
        slack: e, m.
        direction: d (6,), from the multipliers of the last moment asked for.
    """

    acceleration: Array
    cost: float
    slack: float
    direction: Array


@dataclass(frozen=True)
class Task:
    """What a transfer must do.

    Attributes:
        mean_motion: rad/s.
        state: (6,) at t = 0.
        limit: (3,) m/s², may be 0 or inf.
        moments: (m,) s, rising: when the thresholds must hold.
        goal: the goal at these moments.
        stride: the programme has every so many of them; the verification has all.
    """

    mean_motion: float
    state: Array
    limit: Array
    moments: Array
    goal: Goal
    stride: int = 1

    @classmethod
    def at(cls, pursuit: Pursuit, start: Array, time: float) -> Task:
        """Being within the thresholds at a time, s, widened as much as the chaser's attitude allows, as bounds need it."""
        goal = Goal.between(pursuit, start[DEBRIS], time, time, 0)
        return cls(pursuit.mean_motion, start[TRANSLATION], pursuit.acceleration, np.array([time]), goal)

    @classmethod
    def capture(cls, pursuit: Pursuit, start: Array, time: float) -> tuple[Task, float]:
        """Capture at a time, s, with the thresholds held over the dwell before it, at the aligned goal.

        Returns:
            The task, and the margin, m, by which to tighten it: between two moments δ apart of the dwell the motion
            leaves its chord by about |acceleration| δ²/8.
        """
        dwell = min(time, pursuit.dwell_ticks * pursuit.period)
        strength = float(np.linalg.norm(pursuit.acceleration[np.isfinite(pursuit.acceleration)]))
        strength += GoalChange.of(pursuit, start[DEBRIS_RATE]).place
        cells, margin = 0, 0.0
        if dwell > 0.0:
            cells = int(np.clip(np.ceil(dwell * np.sqrt(strength / (0.08 * pursuit.distance))), 8, LOOKS))
            margin = min(strength * (dwell / cells) ** 2 / 8.0, 0.5 * pursuit.distance)
        goal = Goal.between(pursuit, start[DEBRIS], time - dwell, time, CHECKS * cells, aligned=True)
        moments = np.linspace(time - dwell, time, CHECKS * cells + 1)
        return cls(pursuit.mean_motion, start[TRANSLATION], pursuit.acceleration, moments, goal, CHECKS), margin

    @property
    def knots(self) -> Array:
        """The moments that the programme has, s."""
        return self.moments[:: self.stride]

    def steer(self, nodes: Array, fuel: bool, margin: float = 0.0) -> Steering | None:
        """Solve the programme with the control held between the nodes (k + 1,), s; None when the solver fails.

        The thresholds are `margin`, m, tighter than asked for (and 2 margin / T, m/s).
        """
        import clarabel  # type: ignore[import-untyped]  # has no annotations

        widths, end = np.diff(nodes), float(self.moments[-1])
        count, half = 3 * len(widths), 0.5 * end
        drift, _, _ = hcw(self.mean_motion, self.knots)
        miss = drift @ self.state - self.goal.state[:: self.stride]
        speed = self.goal.speed[:: self.stride]
        timed = bool(np.isfinite(self.goal.speed).all())
        size = max(float(np.abs(miss[:, :3]).max()), self.goal.radius, half * float(np.abs(miss[:, 3:]).max()) * timed)
        unit = np.where(np.isinf(self.limit), 4.0 * size / end**2, self.limit)
        push = self._push(nodes) * (np.tile(unit, len(widths)) / size)[:, None, None]

        columns = count * (2 if fuel else 1) + 1  # x, for fuel w ≥ |x|, and e / size
        entries, right = _box(np.flatnonzero(np.tile(np.isfinite(self.limit), len(widths))), count, fuel)
        first = sum(len(part) for part in right)
        cones: list[Any] = [clarabel.NonnegativeConeT(first)]
        halves = ((slice(0, 3), 1.0), (slice(3, 6), half)) if timed else ((slice(0, 3), 1.0),)
        for at, moment in enumerate(miss):
            for part, weight in halves:
                radius = self.goal.radius if part.start == 0 else weight * float(speed[at])
                entries.append((first, columns - 1, -1.0))
                entries.append((first + 1 + np.arange(3), np.arange(count)[:, None], -weight * push[:, at, part]))
                right.append(np.concatenate(([radius - margin], weight * moment[part])) / size)
                cones.append(clarabel.SecondOrderConeT(4))
                first += 4
        cost = np.zeros(columns)
        worth = 1.0
        if fuel:
            worth = float(size / end)  # m/s that the cost counts in
            cost[count:-1] = np.outer(widths, unit).ravel() / worth
        cost[-1] = PRICE * size / (end * worth) if fuel else 1.0

        solution = _solve(cost, _sparse(entries, first, columns), np.concatenate(right), cones)
        if solution is None:
            return None
        x, z = solution
        share = x[:count].reshape(-1, 3)
        share = np.where(np.isfinite(self.limit), np.clip(share, -1.0, 1.0), share)
        direction = np.zeros(6)
        for (part, weight), multipliers in zip(halves, z[-4 * len(halves) :].reshape(-1, 4), strict=True):
            direction[part] = -multipliers[1:] * weight * worth / size
        return Steering(share * unit, float(cost @ x) * worth * (1.0 if fuel else size), float(x[-1]) * size, direction)

    def fly(self, nodes: Array, acceleration: Array) -> Transfer | None:
        """The exact motion under a control (k, 3) held between the nodes, or None if a threshold does not hold, strictly."""
        times = np.union1d(nodes, self.moments)
        control = acceleration[np.searchsorted(nodes, times[:-1], side="right") - 1]
        states = held(self.mean_motion, self.state, times, control)
        miss = states[np.searchsorted(times, self.moments)] - self.goal.state
        near = np.linalg.norm(miss[:, :3], axis=1) < self.goal.radius
        slow = np.linalg.norm(miss[:, 3:], axis=1) < self.goal.speed
        return Transfer(times, control, states) if bool((near & slow).all()) else None

    def _push(self, nodes: Array) -> Array:
        """What a unit acceleration on each piece and axis adds to the state at each knot: (3 k, m, 6)."""
        ago = np.maximum(self.knots[:, None] - nodes, 0.0)
        _, _, area = hcw(self.mean_motion, ago.ravel())
        push = -np.diff(area.reshape(len(ago), len(nodes), 3, 6), axis=1)
        return np.moveaxis(push, 0, 2).reshape(-1, len(ago), 6)


def _box(limited: NDArray[np.intp], count: int, fuel: bool) -> tuple[list[tuple[Any, Any, Any]], list[Array]]:
    """Entries and right-hand sides of |x| ≤ 1 where limited; for fuel, of |x| ≤ w, w ≤ 1 where limited, e ≥ 0."""
    each, box = np.arange(count), np.arange(len(limited))
    if not fuel:
        return [(box, limited, 1.0), (len(box) + box, limited, -1.0)], [np.ones(2 * len(box))]
    entries: list[tuple[Any, Any, Any]] = [(each, each, 1.0), (each, each + count, -1.0)]
    entries += [(each + count, each, -1.0), (each + count, each + count, -1.0)]
    entries += [(2 * count + box, count + limited, 1.0), (2 * count + len(box), 2 * count, -1.0)]
    return entries, [np.zeros(2 * count), np.ones(len(box)), np.zeros(1)]


def _sparse(entries: list[tuple[Any, Any, Any]], rows: int, columns: int) -> Any:
    """The matrix with the values of (row, column, value), each broadcast."""
    from scipy import sparse  # type: ignore[import-untyped]  # has no annotations

    row, column, value = (
        np.concatenate([np.ravel(part) for part in parts])
        for parts in zip(*(np.broadcast_arrays(*entry) for entry in entries), strict=True)
    )
    return sparse.csc_matrix((value, (row, column)), shape=(rows, columns))


def _solve(cost: Array, rows: Any, right: Array, cones: list[Any]) -> tuple[Array, Array] | None:
    """Primal and dual solution of min cost · x, right - rows x in the cones; None if the solver fails."""
    import clarabel
    from scipy import sparse

    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_iter = 100
    settings.direct_solve_method = "qdldl"  # one thread: the same bits everywhere
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-9
    still = sparse.csc_matrix((len(cost), len(cost)))
    found = clarabel.DefaultSolver(still, cost, rows, right, cones, settings).solve()
    # the slack makes every programme feasible, and callers verify a solution that is not quite converged
    x, z = np.array(found.x), np.array(found.z)
    return (x, z) if np.isfinite(x).all() and np.isfinite(z).all() else None


def pieces(until: float, marks: Array, mean_motion: float) -> Array:
    """Nodes from 0 to `until`, s: dense at both ends, denser the longer the orbit part, and at the marks, s."""
    count = min(MOST_PIECES, PIECES + int(PIECES * mean_motion * until))
    even = 0.5 * until * (1.0 - np.cos(np.pi * np.arange(1, count) / count))
    inner = np.sort(np.concatenate((even, marks)))
    inner = inner[(inner > 1e-5 * until) & (inner < (1.0 - 1e-5) * until)]
    apart = np.diff(inner, prepend=0.0) > 1e-6 * until
    return np.concatenate(([0.0], inner[apart], [until]))
