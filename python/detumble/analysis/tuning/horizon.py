"""Default horizon of the flights of a search: long enough for all sensible gains, the same for every law.

    horizon = min(duration, 10 t + max(60 s, 10 d) + campaign.hold)

t is the median over the first training starts of the earliest time at which any controller under the limits could capture
(`detumble.analysis.bounds.earliest`), with nominal bodies and limits; d is the median of the least time that detumbling then
takes from a capture without error (`detumble.analysis.bounds.detumbling`), 0 where the bodies do not merge.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from detumble.analysis.bounds.detumbling import detumble_bound
from detumble.analysis.bounds.earliest import minimum_capture_times
from detumble.analysis.bounds.pursuit import Pursuit, start_of
from detumble.analysis.trials import Trials
from detumble.states import PARTS, parts_of

if TYPE_CHECKING:
    from detumble.quaternions import Array
    from detumble.scenario.model import Scenario

STARTS = 32
"""Number of starts that the median is taken over."""


def default_horizon(scenario: Scenario, seed: int, starts: int = STARTS) -> float:
    """Give the horizon, s, whole control periods; the scenario's duration where half of the starts cannot capture in it.

    Args:
        scenario: with its dispersions.
        seed: of the campaign that the starts are taken from.
        starts: number of them; only the first 32 are used.
    """
    trials = Trials(scenario, seed, 0, min(starts, STARTS))
    plain, columns = trials.nominal("none"), trials.columns("none")
    rows = np.tile(start_of(plain), (trials.count, 1))
    for name, place in PARTS.items():
        rows[:, place] = columns.get(f"start.{name}", rows[:, place])
    distinct = rows[:1] if (rows == rows[0]).all() else rows
    earliest = float(np.median(minimum_capture_times(Pursuit.of(plain), distinct)))
    settling = max(60.0, 10.0 * _detumbling(plain, distinct)) if scenario.capture.merge else 60.0
    wanted, period = 10.0 * earliest + settling + scenario.campaign.hold, scenario.time.control_period
    return scenario.time.duration if wanted >= scenario.time.duration else math.ceil(wanted / period) * period


def _detumbling(plain: dict[str, Any], starts: Array) -> float:
    """Give the median least time from a perfect capture to settled, s; 0 where nothing bounds it.

    Args:
        plain: nominal case.
        starts: (n, 20) rows of the bounds.
    """
    median = float(np.median([detumble_bound(plain | {"start": parts_of(row)}).matched for row in starts]))
    return median if math.isfinite(median) else 0.0
