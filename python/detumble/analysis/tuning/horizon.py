"""How long the flights of a search last: long enough that no sensible gains are cut off, the same for every law.

    horizon = min(duration, 10 t + 60 s + campaign.hold)

t is the median over the first training starts of the earliest time at which any controller under the limits could capture
(`detumble.analysis.bounds.earliest`), with nominal bodies and limits.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from detumble.analysis.bounds.earliest import minimum_capture_times
from detumble.analysis.bounds.pursuit import Pursuit, start_of
from detumble.analysis.trials import Trials

if TYPE_CHECKING:
    from detumble.scenario.model import Scenario

STARTS = 32
"""Starts that the median is taken over."""
_PLACES = {
    "position": 0,
    "velocity": 3,
    "chaser_attitude": 6,
    "chaser_rate": 10,
    "debris_attitude": 13,
    "debris_rate": 17,
}
"""Where the parts of a start stand in a row of the bounds."""


def default_horizon(scenario: Scenario, seed: int, starts: int = STARTS) -> float:
    """Give the horizon, s, whole control periods; the scenario's duration where half of the starts cannot capture in it.

    Args:
        scenario: with its dispersions.
        seed: of the campaign that the starts are taken from.
        starts: how many there are; the first 32 are looked at.
    """
    trials = Trials(scenario, seed, 0, min(starts, STARTS))
    plain, columns = trials.nominal("none"), trials.columns("none")
    rows = np.tile(start_of(plain), (trials.count, 1))
    for name, place in _PLACES.items():
        values = columns.get(f"start.{name}")
        if values is not None:
            rows[:, place : place + values.shape[1]] = values
    distinct = rows[:1] if (rows == rows[0]).all() else rows
    earliest = float(np.median(minimum_capture_times(Pursuit.of(plain), distinct)))
    wanted, period = 10.0 * earliest + 60.0 + scenario.campaign.hold, scenario.time.control_period
    return scenario.time.duration if wanted >= scenario.time.duration else math.ceil(wanted / period) * period
