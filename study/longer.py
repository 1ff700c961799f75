"""Effect of the search budget on the ranking: the two best laws as printed, dispersed case, five times the budget."""

from __future__ import annotations

from typing import Any

from detumble.analysis.tuning.horizon import default_horizon
from detumble.analysis.tuning.tuner import tune
from detumble.scenario import Scenario
from study.judging import judged

LAWS = ("tsmc", "prrl")
SEEDS = (11, 12, 13)
"""Seeds of the searches; the starts are those of the comparison."""


def fly(scenario: Scenario, budget: int, starts: int, runs: int) -> dict[str, Any]:
    """Tune each law from each seed and judge it on held-out runs.

    Args:
        scenario: with its dispersions.
        budget: evaluations of one search.
        starts: that each evaluation flies.
        runs: held out.

    Returns:
        By law, a list over the seeds: cost and success on the training starts, and what `judged` gives.
    """
    horizon = default_horizon(scenario, 0)
    found: dict[str, Any] = {law: [] for law in LAWS}
    for law in LAWS:
        for seed in SEEDS:
            best = tune(
                scenario, law, budget=budget, starts=starts, horizon=horizon, optimiser_seed=seed, form="printed"
            )
            trained = {"training_cost_s": best.cost, "training_success": best.success}
            found[law].append(trained | judged(best.scenario, law, runs, horizon))
    return found
