"""Capture of the translation at a control tick, by commands held over each control period: what a simulated law could command."""

from __future__ import annotations

import numpy as np

from detumble.analysis.bounds.course import Course
from detumble.analysis.bounds.goal import Goal
from detumble.analysis.bounds.pursuit import Pursuit
from detumble.analysis.bounds.transfer import Task, Transfer
from detumble.quaternions import Array
from detumble.states import DEBRIS, TRANSLATION

COMMANDS = 400  # a flight of more periods holds its commands over several of them


def reach_at_tick(
    pursuit: Pursuit, start: Array, tick: int, goal_place: Array | None = None, goal_velocity: Array | None = None
) -> Transfer | None:
    """A transfer within the thresholds at a tick and at those of the dwell before it, strictly, or None.

    Args:
        pursuit: the chase.
        start: (20,) as `start_of` lays it out.
        tick: control periods from the start.
        goal_place: (3,) or (dwell_ticks + 1, 3), m in H: instead of the chase's own goal (for grasp points, the aligned one).
        goal_velocity: the same for its velocity, m/s.

    Returns:
        A control that changes at control ticks only, and its motion.
    """
    period, dwell = pursuit.period, pursuit.dwell_ticks
    if tick < dwell:
        return None
    moments = period * np.arange(tick - dwell, tick + 1, dtype=np.float64)
    goal = Goal.between(pursuit, start[DEBRIS], period * (tick - dwell), period * tick, dwell, aligned=True)
    if goal_place is not None:
        goal.state[:, :3] = goal_place
    if goal_velocity is not None:
        goal.state[:, 3:] = goal_velocity
    task = Task(pursuit.mean_motion, start[TRANSLATION], pursuit.acceleration, moments, goal)
    if tick == 0:
        return task.fly(np.zeros(1), np.empty((0, 3)))
    group = -(-tick // COMMANDS)
    ticks = np.append(np.arange(0, tick, group), tick)
    for _ in range(2):
        steering = task.steer(period * ticks, fuel=False)
        if steering is None:
            return None
        if steering.slack < 0.0 or group == 1:
            return task.fly(period * ticks, steering.acceleration)
        # single periods around the switching times of the control
        switches = (
            tick - Course(pursuit, start, period * tick).switches(steering.direction, period * tick, 0.0) / period
        )
        ticks = np.union1d(ticks, np.concatenate((np.floor(switches), np.ceil(switches))).astype(np.int64))
        ticks = ticks[(ticks >= 0) & (ticks <= tick)]
    return None
