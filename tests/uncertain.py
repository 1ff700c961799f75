"""Campaigns of short flights that end in every way: the scenario, and what tests ask of a campaign's rows."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import detumble
from detumble.campaigns.result import CampaignResult
from detumble.campaigns.store.shard import digest
from detumble.scenario import Scenario
from detumble.scenario.faults import validated

DISPERSIONS = [
    {"field": "chaser.mass", "distribution": "normal", "relative": 0.05},
    {"field": "chaser.position", "distribution": "normal", "sigma": 0.3},
    {"field": "debris.tumble_rate", "distribution": "direction", "low": 0.01, "high": 0.2},
    {"field": "debris.attitude", "distribution": "attitude"},
    {"field": "chaser.inertia", "distribution": "inertia", "relative": 0.1, "axes_sigma": 0.05},
    {"field": "debris.inertia", "distribution": "inertia", "relative": 0.1, "axes_sigma": 0.05},
    {"field": "actuators.force_gain", "distribution": "uniform", "low": 0.8, "high": 1.1},
    {"field": "actuators.torque_gain", "distribution": "log_uniform", "low": 0.3, "high": 1.1},
    {"field": "sensors.position_sigma", "distribution": "log_uniform", "low": 1e-4, "high": 1e-2},
    {"field": "laws.pd.translation.kp", "distribution": "log_uniform", "low": 0.05, "high": 1e4},
]
"""Sigmas and inertias among them, which decide how all flights of a campaign are computed."""


def uncertain() -> Scenario:
    """Give the paper's case cut to a minute, hard to capture; under PD some gains are so high that flights diverge."""
    raw = detumble.load("paper").to_dict()
    raw["time"]["duration"] = 60.0
    raw["capture"] |= {"speed": 0.08, "dwell": 0.5}
    raw["campaign"] = {"end": "settled", "hold": 5.0}
    raw["actuators"]["force_limit"] = math.inf
    raw["laws"]["none"] = {
        "segments": [{"start": 1.0, "end": 9.0, "force": [0.001, -0.02, 0.0], "torque": [0, 0, 1e-3]}]
    }
    raw["dispersions"] = DISPERSIONS
    return validated(raw, "uncertain")


def flown(out: Path, law: str = "pd", runs: int = 400, seed: int = 3, **how: Any) -> CampaignResult:
    """Fly it, in shards of a hundred unless told otherwise."""
    return detumble.campaign(uncertain(), law, runs, seed, out, **{"shard": 100, **how})


def rows_digest(result: CampaignResult) -> str:
    """Hash all rows, bit by bit."""
    return digest(result.runs.to_polars())
