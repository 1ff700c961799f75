"""Tuned gains in a scenario, and beside them how they were found."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from detumble.scenario.faults import validated
from detumble.version import __version__

if TYPE_CHECKING:
    from collections.abc import Mapping

    from detumble.analysis.tuning.objective import Objective
    from detumble.analysis.tuning.setting import Setting
    from detumble.analysis.tuning.space import Space
    from detumble.scenario.model import Scenario

REACHED = {"s": "time_s", "m/s": "delta_v_m_s"}
"""Where what was reached stands, by its unit."""


def told(
    space: Space,
    gains: Mapping[str, float],
    setting: Setting,
    objective: Objective,
    horizon: float,
    success: float,
    reached: Mapping[str, float],
    what: str = "",
) -> Scenario:
    """Give the scenario with the gains found, and `[laws.LAW.tuned]`.

    Args:
        space: what was searched.
        gains: found, by path; none leaves the scenario's own.
        setting: of the search.
        objective: by which costs were counted.
        horizon: s.
        success: share of the training starts that succeed.
        reached: cost by its unit; empty where too few succeed.
        what: was made small; empty for what the objective says.
    """
    raw = space.scenario(gains).to_dict()
    provenance: dict[str, Any] = {
        "objective": what or objective.what,
        "statistic": objective.statistic,
        "success": success,
        "required": objective.required,
        "until": objective.end(space.base),
        "horizon_s": horizon,
        "starts": setting.starts,
        "seed": setting.seed,
        "optimiser_seed": setting.optimiser_seed,
        "evaluations": setting.budget,
        "version": __version__,
    }
    raw["laws"][space.law]["tuned"] = provenance | {REACHED[unit]: cost for unit, cost in reached.items()}
    return validated(raw, space.base.title)
