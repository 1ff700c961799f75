"""The effect of α alone: PRRL-SMC with equal gains and any α, and with equal budgets and α held.

Exact reaching time from s0 at equal gain: |s0|^(1-α)/(K (1-α)) (SPEC of the law), so "closer to 0 is faster" holds only while
|s| < 1 and only at equal K. What counts for a user is each α with its own best gains.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from detumble.analysis.tuning.horizon import default_horizon
from detumble.analysis.tuning.tuner import tune
from detumble.scenario import Scenario
from detumble.show.style import look, new_figure, save, styled
from study.judging import judged

ALPHAS = (0.1, 0.3, 0.5, 0.7, 0.9)
TUNINGS = (1, 2, 3)
"""Seeds of the searches; several show the spread."""


def fly(scenario: Scenario, budget: int, starts: int, runs: int) -> dict[str, Any]:
    """Tune PRRL-SMC at each α with equal budgets, and judge on held-out runs; beside it the given gains with α changed.

    Args:
        scenario: with its dispersions.
        budget: evaluations of one search.
        starts: that each evaluation flies.
        runs: held out.

    Returns:
        For each α what the searches made small, on held-out runs: the mean capture time, s, failed runs at the horizon; and the
        share that succeeds. Of each search, and of the given gains.
    """
    horizon = default_horizon(scenario, TUNINGS[0])
    tuned = {
        alpha: [
            tune(
                scenario,
                "prrl",
                budget=budget,
                starts=starts,
                horizon=horizon,
                optimiser_seed=seed,
                fixed={"alpha": alpha},
            ).scenario
            for seed in TUNINGS
        ]
        for alpha in ALPHAS
    }
    return {
        "alpha": list(ALPHAS),
        "horizon_s": horizon,
        "tuned": [[judged(one, "prrl", runs, horizon) for one in tuned[alpha]] for alpha in ALPHAS],
        "given": [judged(_with(scenario, alpha), "prrl", runs, horizon) for alpha in ALPHAS],
    }


def _with(scenario: Scenario, alpha: float) -> Scenario:
    changed = scenario.model_copy(deep=True)
    assert changed.laws.prrl is not None
    changed.laws.prrl.alpha = alpha
    return changed


def draw(found: dict[str, Any], title: str, path: Path) -> list[Path]:
    """Plot the mean capture time over α: of every search, and of the given gains."""
    with styled():
        figure = new_figure(6.0, 3.4)
        axes = figure.subplots()
        alphas, style = found["alpha"], look("prrl")
        searches = np.array([[one["mean_s"] for one in row] for row in found["tuned"]])
        axes.plot(
            alphas,
            np.median(searches, axis=1),
            color=style.colour,
            marker=style.marker,
            label="tuned at this α, median of three searches",
        )
        axes.plot(
            np.repeat(alphas, searches.shape[1]),
            searches.ravel(),
            color=style.colour,
            linestyle="",
            marker="_",
            markersize=9,
            label="every search",
        )
        axes.plot(
            alphas,
            [one["mean_s"] for one in found["given"]],
            color="#404040",
            linestyle=(0, (4, 2)),
            marker="x",
            label="the given gains, only α changed",
        )
        axes.set(xlabel="α", ylabel="mean capture time [s]", xlim=(0.0, 1.0))
        axes.set_ylim(bottom=0.0)
        axes.legend()
        figure.suptitle(title)
        return save(figure, [path])
