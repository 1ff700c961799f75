"""Where a chaser under per-axis force limits cannot be: Hill-Clohessy-Wiltshire reach and its certificates.

State X = (r, v) in H, acceleration |u_j| ≤ a_j, m/s², Φ and K as in `hcw`. For any direction d = (d_r, d_v), capture at
time T needs X(T) - goal in a ball of radius R in position times one of radius S in velocity, so T is impossible when, with ρ
the support function of the reach,

    d · (Φ(T) X(0) - goal(T)) - ρ(T, d) - R |d_r| - S |d_v| > 0,     ρ(T, d) = Σ_j a_j ∫₀ᵀ |d · K_j(s)| ds.

Any d that satisfies this proves it, however it was found. ρ is bounded from above: on a cell of width h the function
f = d · K_j differs from its chord by at most M h²/8, M ≥ |f''|, so ∫|f| ≤ ∫|chord| + M h³/12. The excess is
of order n h²/T relative to ρ: 1e-8 for h = 0.1 s.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy.optimize import nnls  # type: ignore[import-untyped]

from detumble.analysis.bounds.hcw import hcw, kernel_bend
from detumble.quaternions import Array

ROUND_OFF = 1e-9  # relative margin that a certificate must show
ROUNDS = 60  # directions tried at one tick at most
GOOD_ENOUGH = 0.7  # share of the greatest separation at which a direction is accepted: it is used at the next ticks too


@lru_cache(maxsize=4)
def _tables(mean_motion: float, period: float, ticks: int) -> tuple[Array, Array, Array]:
    """Φ (ticks + 1, 6, 6) and K (ticks + 1, 3, 6) at the ticks, ∫ K (ticks, 3, 6) over each cell: whatever the limits are."""
    drift, kernel, area = hcw(mean_motion, period * np.arange(ticks + 1, dtype=np.float64))
    tables = drift, kernel, np.diff(area, axis=0)
    for table in tables:
        table.flags.writeable = False
    return tables


class Reach:
    """Reach of per-axis accelerations in the HCW motion, tabulated at the control ticks.

    Args:
        mean_motion: n, rad/s (0 gives the double integrator).
        acceleration: (3,) limits in H, m/s²; may be 0 or inf.
        period: control period, s.
    """

    def __init__(self, mean_motion: float, acceleration: Array, period: float) -> None:
        self.mean_motion, self.period = mean_motion, period
        free = np.isinf(acceleration)
        if free[0] or free[1]:  # x and y are coupled: one without limit frees both
            free[:2] = True
        self.bounded = ~free
        self.acceleration = np.where(free, 0.0, acceleration)
        self._tabulate(64)

    def _tabulate(self, ticks: int) -> None:
        self.ticks = ticks
        self.drift, self.kernel, self.push = _tables(self.mean_motion, self.period, ticks)

    def extend(self, ticks: int) -> None:
        """Make the tables cover t = 0 … ticks · period."""
        if ticks > self.ticks:
            self._tabulate(1 << (ticks - 1).bit_length())  # a power of two, so that chases with other limits share it

    def support(self, direction: Array, first: int, last: int) -> Array:
        """Upper bounds of ρ(t_k, d) for k = first … last, for d (6,); rigorous but for round-off."""
        f = np.abs(values := self._values(direction, last))
        left, right = f[:-1], f[1:]
        total = left + right
        # ∫|chord| / h is the mean of both ends, or, when the sign changes, (f₀² + f₁²) / (2 (|f₀| + |f₁|))
        crossing = values[:-1] * values[1:] < 0.0
        area = np.divide(left * left + right * right, total, out=total.copy(), where=crossing)
        h = self.period
        excess = h**3 / 12.0 * float(kernel_bend(self.mean_motion, direction) @ self.acceleration)
        cells = 0.5 * h * (area @ self.acceleration) + excess
        reached = np.concatenate(([0.0], np.cumsum(cells)))
        bounds: Array = reached[first:]
        return bounds

    def farthest(self, direction: Array, tick: int) -> Array:
        """A point (6,) that zero-order-hold controls reach at t_k, nearly the farthest along d."""
        f = self._values(direction, tick)
        size = np.abs(f)
        total = size[:-1] + size[1:]
        mean_sign = np.divide(f[:-1] + f[1:], total, out=np.zeros_like(total), where=total > 0.0)
        point: Array = (mean_sign * self.acceleration).ravel() @ self.push[:tick].reshape(-1, 6)
        return point

    def _values(self, direction: Array, tick: int) -> Array:
        """d · K_j(t_k), k = 0 … tick: (tick + 1, 3)."""
        values: Array = (self.kernel[: tick + 1].reshape(-1, 6) @ direction).reshape(-1, 3)
        return values


class Approach:
    """One start against one goal: which control ticks no translation control can meet.

    Args:
        reach: the limits.
        miss: (ticks + 1, 6) Φ(t_k) X(0) - goal(t_k), m and m/s.
        radius: (ticks + 1,) R, m.
        speed: (ticks + 1,) S, m/s, inf where no speed is asked for.
    """

    def __init__(self, reach: Reach, miss: Array, radius: Array, speed: Array) -> None:
        self.reach = reach
        self.mask = np.tile(reach.bounded, 2).astype(np.float64)
        self.timed = bool(np.isfinite(speed).all())  # the velocity counts too
        if not self.timed:
            self.mask[3:] = 0.0
        self.miss, self.radius, self.speed = miss, radius, speed if self.timed else np.zeros_like(speed)
        self.last: Array | None = None
        self.useful: list[Array] = []  # directions that made up the last separating one
        distance = np.linalg.norm(miss[:, :3], axis=1)
        velocity = np.linalg.norm(miss[:, 3:], axis=1)
        self.slack_position = ROUND_OFF * (1.0 + distance + radius)
        self.slack_velocity = ROUND_OFF * (1.0 + velocity + self.speed)
        near = distance[0] <= radius[0] + self.slack_position[0]
        slow = not self.timed or velocity[0] <= speed[0] + self.slack_velocity[0]
        self.starts_inside = bool(near and slow)

    def first_open(self, tick: int) -> int:
        """The first tick from `tick` on that is not proved impossible; len(miss) if there is none."""
        end = len(self.miss)
        if tick == 0:
            if self.starts_inside:
                return 0
            tick = 1
        while tick < end:
            ahead = min(end, 2 * tick + 64)
            reached = self._proved_until(self._guess(tick), tick, ahead)
            if reached == tick and self.last is not None:
                reached = self._proved_until(self.last, tick, ahead)
            if reached == tick:
                direction = self._separate(tick)
                if direction is None:
                    return tick
                self.last = direction
                reached = self._proved_until(direction, tick, ahead)
                if reached == tick:
                    return tick
            tick = reached
        return end

    def _guess(self, tick: int) -> Array:
        """The double integrator's answer: the part of the miss that ½ a T² leaves, axis by axis."""
        time = tick * self.reach.period
        miss = self.miss[tick, :3] * self.mask[:3]
        left = np.sign(miss) * np.maximum(np.abs(miss) - 0.5 * self.reach.acceleration * time * time, 0.0)
        return np.concatenate((left if left.any() else miss, np.zeros(3)))

    def _proved_until(self, direction: Array, tick: int, end: int) -> int:
        """The first tick in [tick, end) for which d is no proof, or end."""
        if not direction.any():
            return tick
        span = slice(tick, end)
        margin = self.miss[span] @ direction - self.reach.support(direction, tick, end - 1)
        margin -= float(np.linalg.norm(direction[:3])) * (self.radius[span] + self.slack_position[span])
        margin -= float(np.linalg.norm(direction[3:])) * (self.speed[span] + self.slack_velocity[span])
        failed = margin <= 0.0
        return tick + int(np.argmax(failed)) if failed.any() else end

    def _separate(self, tick: int) -> Array | None:
        """A direction that should separate reach and goal at t_k, or None when they meet.

        Fully corrective Frank-Wolfe for the point of least norm of {miss - reach - balls}: each round adds the
        farthest point against the present direction, and finds the least-norm mixture of all points so far.
        Velocities are scaled by T/2, so that both halves weigh in metres.
        """
        scale = self.mask * np.repeat([1.0, 0.5 * tick * self.reach.period], 3)
        directions = [d for d in (*self.useful, self._guess(tick) * self.mask) if d.any()]
        if not directions:
            return None
        points = [(self.miss[tick] - self._farthest(d, tick)) * scale for d in directions]
        for _ in range(ROUNDS):
            columns = np.array(points).T
            size = max(float(np.abs(columns).max()), 1e-12)
            # min |P w|² over mixtures w is non-negative least squares of [P; 1] w ≈ (0, 1), up to a factor
            weights, _ = nnls(np.vstack((columns / size, np.ones(len(points)))), np.array([0.0] * 6 + [1.0]))
            nearest = columns @ (weights / weights.sum())
            self.useful = [d for d, weight in zip(directions, weights, strict=True) if weight > 0.0]
            if float(np.linalg.norm(nearest)) < 1e-10 * size:
                return None
            directions.append(nearest * scale)
            points.append((self.miss[tick] - self._farthest(directions[-1], tick)) * scale)
            # no point lies nearer than (nearest · point)/|nearest|: stop once d is close to the best
            if float(nearest @ points[-1]) >= GOOD_ENOUGH * float(nearest @ nearest):
                break
        return directions[-1]

    def _farthest(self, direction: Array, tick: int) -> Array:
        point = self.reach.farthest(direction, tick)
        for part, radius in ((slice(0, 3), self.radius[tick]), (slice(3, 6), self.speed[tick])):
            length = float(np.linalg.norm(direction[part]))
            if length > 0.0:
                point[part] += radius * direction[part] / length
        return point
