"""Judging gains in the smaller parts of the study: on runs of a seed that no search has used."""

from __future__ import annotations

import numpy as np

from detumble.analysis.trials import Trials
from detumble.scenario import Scenario

HELD_OUT = 101
"""Seed of these runs."""


def judged(scenario: Scenario, law: str, runs: int, horizon: float) -> dict[str, float]:
    """Fly held-out runs until settled: mean and median capture time, s, failed runs at the horizon, and the success."""
    flown = Trials(scenario, HELD_OUT, 0, runs, horizon=horizon).fly(law)
    times = np.where(flown.succeeded[0], flown["capture_time"][0], horizon)
    return {
        "mean_s": float(times.mean()),
        "median_s": float(np.median(times)),
        "success": float(flown.succeeded.mean()),
    }
