"""One entry of a comparison: its sets of gains, the one that is judged, and what its held-out runs give."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Mapping

    from detumble.analysis.comparing.entries import Entry
    from detumble.analysis.comparing.judge import Runs, Verdict
    from detumble.analysis.comparing.ranking import Score
    from detumble.analysis.comparing.ratios import Ratio
    from detumble.analysis.comparing.robustness import Curve
    from detumble.intervals import Array
    from detumble.scenario.model import Scenario


@dataclass(frozen=True)
class Tuning:
    """One set of gains of an entry.

    Attributes:
        optimiser_seed: of the search; None for gains that are flown as given.
        scenario: with these gains.
        gains: by path within the law's table, as found; empty as given.
        cost: on the training starts; None as given.
        training_success: share of the training starts; None as given.
        verdict: on the first held-out runs; None before they are flown.
        score: likewise.
    """

    optimiser_seed: int | None
    scenario: Scenario
    gains: Mapping[str, float]
    cost: float | None
    training_success: float | None
    verdict: Verdict | None = None
    score: Score | None = None

    def to_json(self) -> dict[str, Any]:
        """Give it as JSON takes it."""
        assert self.verdict is not None
        assert self.score is not None
        return {
            "optimiser_seed": self.optimiser_seed,
            "gains": dict(self.gains),
            "training_cost": self.cost,
            "training_success": self.training_success,
            "held_out_runs": self.verdict.success.runs,
            **self.verdict.success.to_json("success"),
            "short_of_required": self.score.short,
            "objective": None if self.score.short else self.score.value,
            "capture_time_s": self.verdict.figures["capture_time_s"].to_json(),
        }


@dataclass(frozen=True)
class Judged:
    """One entry and its results.

    Attributes:
        entry: law, form and name.
        tunings: all of its sets of gains, in the order of their seeds.
        chosen: place of the tuning of least training cost, which is judged.
        runs: the held-out runs of the chosen tuning.
        counted: (n,) value of each run in the objective, in its unit; the ceiling for a failed run.
        verdict: statistics of the runs.
        score: on all of the runs.
        ratios: `time`, `delta_v`, `settling`: see `ratios`.
        curves: robustness; empty where it was left out.
    """

    entry: Entry
    tunings: tuple[Tuning, ...]
    chosen: int
    runs: Runs
    counted: Array
    verdict: Verdict
    score: Score
    ratios: Mapping[str, Ratio] = field(default_factory=dict)
    curves: tuple[Curve, ...] = ()

    @property
    def tuning(self) -> Tuning:
        """The set of gains that is judged."""
        return self.tunings[self.chosen]

    @property
    def scores(self) -> list[Score]:
        """On held-out runs, one for each tuning: on all of them for the chosen one, on the first for the others."""
        others = [tuning.score for place, tuning in enumerate(self.tunings) if place != self.chosen]
        return [self.score, *(score for score in others if score is not None)]

    @property
    def times_over_least(self) -> Array:
        """Capture time over the lower bound of the run, (n,): +inf for a failed run, 1 where drift alone captures at t = 0."""
        time = self.runs.capture_time
        least = np.where(time == 0.0, 1.0, np.inf)
        ratio = self.ratios["time"].values
        return np.where(np.isnan(ratio) | np.isinf(time), least, ratio)

    def to_json(self) -> dict[str, Any]:
        """Give it as JSON takes it."""
        return {
            "name": self.entry.name,
            "law": self.entry.law,
            "form": self.entry.form,
            "chosen_tuning": self.chosen,
            "short_of_required": self.score.short,
            "objective": None if self.score.short else self.score.value,
            **self.verdict.to_json(),
            "ratios": {name: ratio.to_json() for name, ratio in self.ratios.items()},
            "tunings": [tuning.to_json() for tuning in self.tunings],
            "robustness": {curve.sweep.key: curve.to_json() for curve in self.curves},
        }
