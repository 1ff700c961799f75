"""The earliest control tick at which any controller under the limits could capture.

A tick is excluded when a certificate proves that some threshold cannot hold there: a separating direction for
position (and speed, if asked for), in `translation`, or a relaxation of the rotation, in `turn`. Ticks are certified
one after another from t = 0: what is reachable at one time need not be reachable later, so no tick is skipped and there is no
bisection. With a dwell, every tick of it must be open.

The answer is a lower bound for any law, with or without noise, on the plant of SPEC: HCW, rigid bodies, torque-free
debris, ideal actuators limited per axis (a vector scaled into the box is in the box). Certificates must hold with a
margin (1e-9 of the lengths, 1e-7 rad and rad/s), so that round-off cannot make the bound too high.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from detumble.analysis.bounds.goal import Goal
from detumble.analysis.bounds.pursuit import Pursuit, check_undisturbed, start_of
from detumble.analysis.bounds.translation import Approach
from detumble.analysis.bounds.tumble import tumble
from detumble.analysis.bounds.turn import excluded
from detumble.quaternions import Array

if TYPE_CHECKING:
    from detumble.scenario.model import Scenario

FIRST_HORIZON = 256  # ticks examined first


@dataclass(frozen=True)
class MinimumTimes:
    """Lower bounds from one start, s, inf where the flight is too short.

    Attributes:
        capture: all thresholds at once.
        translation: distance and speed alone.
        attitude: angle and relative rate alone.
    """

    capture: float
    translation: float
    attitude: float


def minimum_capture_time(scenario: Scenario) -> float:
    """Give the earliest time, s, at which any controller could capture in this scenario; inf if not within its duration.

    Raises:
        ScenarioError: the scenario contradicts itself, or a disturbance acts.
    """
    from detumble.scenario.core import case

    check_undisturbed(scenario)
    plain = case(scenario, "none")
    return minimum_times(Pursuit.of(plain), start_of(plain)).capture


def minimum_capture_times(pursuit: Pursuit, starts: Array) -> Array:
    """Lower bounds (n,) of the capture time, s, from each row of starts (n, 20), laid out as in `start_of`."""
    chases = (_Chase(pursuit, start) for start in starts)
    return np.array([chase.earliest(chase.next_open) for chase in chases])


def minimum_times(pursuit: Pursuit, start: Array) -> MinimumTimes:
    """Lower bounds from one start (20,): of capture, and of each half by itself."""
    chase = _Chase(pursuit, start)
    return MinimumTimes(
        capture=chase.earliest(chase.next_open),
        translation=chase.earliest(chase.next_in_position),
        attitude=chase.earliest(chase.next_in_attitude),
    )


class _Chase:
    """One start: finds the ticks that no certificate excludes, with a horizon that grows on demand."""

    def __init__(self, pursuit: Pursuit, start: Array) -> None:
        self.pursuit = pursuit
        self.state, self.attitude, self.rate, self.debris = np.split(start, [6, 10, 13])
        self.attitude = self.attitude / np.linalg.norm(self.attitude)
        self.attitudes, self.rates = np.empty((0, 4)), np.empty((0, 3))
        self.approach: Approach | None = None
        self.closed = np.empty(0, dtype=np.bool_)

    def earliest(self, following: Callable[[int], int]) -> float:
        """The end, s, of the first run of open ticks that is long enough for the dwell.

        Args:
            following: first open tick from a given one on; beyond the last tick if there is none.
        """
        tick, last, run = 0, -2, 0
        while (tick := following(tick)) <= self.pursuit.periods:
            run = run + 1 if tick == last + 1 else 1
            if run > self.pursuit.dwell_ticks:
                return self.pursuit.time_of(tick)
            last, tick = tick, tick + 1
        return math.inf

    def next_open(self, tick: int) -> int:
        """The first tick from this one on that neither half excludes."""
        while tick <= self.pursuit.periods:
            placed = self.next_in_position(tick)
            tick = self.next_in_attitude(placed)
            if tick == placed:
                break
        return tick

    def next_in_position(self, tick: int) -> int:
        """The first tick from this one on at which distance and speed are not excluded."""
        while tick <= self.pursuit.periods:
            if self.approach is None or tick >= len(self.approach.miss):
                self.approach = self._approach(self._horizon(tick))
            tick = self.approach.first_open(tick)
            if tick < len(self.approach.miss):
                break
        return tick

    def next_in_attitude(self, tick: int) -> int:
        """The first tick from this one on at which angle and relative rate are not excluded."""
        while tick <= self.pursuit.periods:
            if tick >= len(self.closed):
                self._close(self._horizon(tick))
            still_open = np.flatnonzero(~self.closed[tick:])
            if len(still_open):
                return tick + int(still_open[0])
            tick = len(self.closed)
        return tick

    def _horizon(self, tick: int) -> int:
        return min(self.pursuit.periods, max(FIRST_HORIZON, 2 * tick))

    def _tumble(self, ticks: int) -> tuple[Array, Array]:
        """The debris' attitudes (ticks + 1, 4) and rates (ticks + 1, 3)."""
        if ticks >= len(self.rates):
            attitude = self.debris[:4] / np.linalg.norm(self.debris[:4])
            self.attitudes, self.rates = tumble(
                self.pursuit.debris_inertia, attitude, self.debris[4:], self.pursuit.period, ticks
            )
        return self.attitudes[: ticks + 1], self.rates[: ticks + 1]

    def _close(self, ticks: int) -> None:
        """Judge the attitude of all ticks up to this one."""
        shut = excluded(self.pursuit, self.attitude, self.rate, *self._tumble(ticks), first=len(self.closed))
        self.closed = np.concatenate((self.closed, shut))

    def _approach(self, ticks: int) -> Approach:
        """The translation up to this tick: free drift against the goal, fixed or moving with the tumble."""
        pursuit, count = self.pursuit, ticks + 1
        pursuit.reach.extend(ticks)
        times = pursuit.period * np.arange(count, dtype=np.float64)
        goal = Goal.of(pursuit, times, None if pursuit.grasp_points is None else self._tumble(ticks))
        miss = pursuit.reach.drift[:count] @ self.state - goal.state
        approach = Approach(pursuit.reach, miss, np.full(count, goal.radius), goal.speed)
        if self.approach:
            approach.last, approach.useful = self.approach.last, self.approach.useful
        return approach
