"""Effect of the change of inertia at capture on each law: settling under the paper's transition and under conserved momentum.

`approximate` is the paper's: the stack keeps the chaser's state, the matrices add up. `momentum_conserving` is rigid and
inelastic. A law believes the plain sum of both matrices, or the true inertia of the stack.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from detumble.analysis.trials import Trials
from detumble.scenario import Scenario
from detumble.scenario.faults import validated

SEED = 29
CONDITIONS = {
    "approximate, plain sum believed": ("approximate", "design"),
    "momentum conserved, plain sum believed": ("momentum_conserving", "design"),
    "momentum conserved, true stack believed": ("momentum_conserving", "true"),
}


def fly(scenarios: Mapping[str, Scenario], runs: int) -> dict[str, Any]:
    """Fly each law until settled or the end.

    Args:
        scenarios: by law, with the gains to be flown.
        runs: of each law under each condition.

    Returns:
        By condition and law: share of captured runs that settle, and the median and 95th percentile of their settling
        times, s, runs that do not settle counting as infinite.
    """
    return {
        name: {law: _settling(_under(scenario, *condition), law, runs) for law, scenario in scenarios.items()}
        for name, condition in CONDITIONS.items()
    }


def _under(scenario: Scenario, transition: str, belief: str) -> Scenario:
    raw = scenario.to_dict()
    raw["capture"]["transition"] = transition
    raw["belief"] = {"stack": belief}
    return validated(raw, scenario.title)


def _settling(scenario: Scenario, law: str, runs: int) -> dict[str, float | None]:
    flown = Trials(scenario, SEED, 0, runs).fly(law)
    captured = np.isfinite(flown["capture_time"][0])
    settled = flown.succeeded[0][captured]
    times = np.where(settled, flown["settling_time"][0][captured], np.inf)
    median, late = np.quantile(times, (0.5, 0.95), method="inverted_cdf") if len(times) else (np.inf, np.inf)
    return {
        "captured": float(captured.mean()),
        "settled_of_captured": float(settled.mean()) if len(times) else None,
        "settling_median_s": float(median) if np.isfinite(median) else None,
        "settling_p95_s": float(late) if np.isfinite(late) else None,
    }
