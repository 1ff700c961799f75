"""An entry on runs that it was not tuned on: results run by run, and their statistics.

A run that failed (never captured, or not settled where the bodies merge) has the capture time +∞ and the settled time +∞, so
that quantiles are those of the whole population, and an entry whose slow runs fail is not ranked as fast. What else exists
only after a capture, such as Δv to capture and the settling time, is summarised over the runs that have it, with their
number.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from detumble.analysis.comparing.paired import quantile
from detumble.analysis.trials import Results, Trials
from detumble.campaigns.recipe import SHARD
from detumble.campaigns.statistics.summaries import Quantile
from detumble.failures import SUCCESS, cause
from detumble.intervals import Proportion, jsonable

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from detumble.intervals import Array

KEPT = (
    "capture_time",
    "settling_time",
    "delta_v_to_capture",
    "delta_v",
    "momentum_at_capture",
    "force_saturated_share",
    "torque_saturated_share",
    "force_chattering",
    "torque_chattering",
)
"""Of the core's summary of a run."""


@dataclass(frozen=True)
class Runs:
    """Results of one entry, run by run from the first on.

    Attributes:
        failure: (n,) the core's code of why a run failed, see `detumble.failures`.
        columns: by name of the core's summary, see `KEPT`: (n,) SI, NaN where the event did not happen.
    """

    failure: NDArray[np.uint8]
    columns: Mapping[str, Array]

    def __len__(self) -> int:
        return len(self.failure)

    def __getitem__(self, column: str) -> Array:
        return self.columns[column]

    def first(self, count: int) -> Runs:
        """Give the first runs."""
        return Runs(self.failure[:count], {name: values[:count] for name, values in self.columns.items()})

    def results(self) -> Results:
        """Give them as the results of a trial of one candidate."""
        return Results(self.failure[None], {name: values[None] for name, values in self.columns.items()})

    @property
    def succeeded(self) -> NDArray[np.bool_]:
        """(n,) which runs captured, and settled where the bodies merge."""
        good: NDArray[np.bool_] = self.failure == SUCCESS
        return good

    @property
    def capture_time(self) -> Array:
        """(n,) s, +inf for a run that failed."""
        return np.where(self.succeeded, self["capture_time"], np.inf)

    @property
    def settled_time(self) -> Array:
        """(n,) s from the start until the stack has settled, +inf where it never has, or the run failed."""
        time = self["capture_time"] + self["settling_time"]
        return np.where(self.succeeded & ~np.isnan(time), time, np.inf)


def fly(trials: Trials, law: str, *, threads: int | None = None, progress: Callable[[int], None] | None = None) -> Runs:
    """Fly runs, one shard at a time.

    Args:
        trials: the runs, from the first of a campaign on, of a scenario with the gains of the entry.
        law: one of `LAWS`.
        threads: to use; None for all processors.
        progress: called repeatedly with the number of runs done; an exception that it raises ends the work.

    Raises:
        ScenarioError: the scenario cannot be flown.
    """
    failures: list[NDArray[np.uint8]] = []
    columns: dict[str, list[Array]] = {name: [] for name in KEPT}
    for first in range(0, trials.count, SHARD):
        shard = replace(trials, first=first, count=min(SHARD, trials.count - first))
        report = (lambda count, first=first: progress(first + count)) if progress else None
        results = shard.fly(law, threads=threads, progress=report)
        failures.append(results.failure[0])
        for name, parts in columns.items():
            parts.append(results[name][0])
    return Runs(np.concatenate(failures), {name: np.concatenate(parts) for name, parts in columns.items()})


@dataclass(frozen=True)
class Figures:
    """A quantity over the runs that have it, or, with +∞ for those that do not, over all.

    Attributes:
        count: runs in which it happened.
        low: 5 % quantile, with its interval.
        median: likewise.
        high: 95 % quantile, likewise.
    """

    count: int
    low: Quantile | None
    median: Quantile | None
    high: Quantile | None

    @classmethod
    def of(cls, values: Array) -> Figures:
        """Summarise values (n,); NaN is left out, infinity is not."""
        known = values[~np.isnan(values)]
        five, half, most = (quantile(known, share) for share in (0.05, 0.5, 0.95))
        return cls(int(np.isfinite(known).sum()), five, half, most)

    def to_json(self) -> dict[str, Any]:
        """Give them as JSON takes them; what is infinite or unknown is None."""
        named = {"p05": self.low, "p50": self.median, "p95": self.high}
        return {
            "count": self.count,
            **{name: jsonable(found.value if found else None) for name, found in named.items()},
            **{
                f"{name}_ci": [jsonable(found.low), jsonable(found.high)] if found else [None, None]
                for name, found in named.items()
            },
        }


QUANTITIES: dict[str, Callable[[Runs], Array]] = {
    "capture_time_s": lambda runs: runs.capture_time,
    "settling_time_s": lambda runs: runs["settling_time"],
    "settled_time_s": lambda runs: runs.settled_time,
    "delta_v_to_capture_m_s": lambda runs: runs["delta_v_to_capture"],
    "delta_v_m_s": lambda runs: runs["delta_v"],
    "force_saturated_share": lambda runs: runs["force_saturated_share"],
    "torque_saturated_share": lambda runs: runs["torque_saturated_share"],
    "force_chattering_n_per_s": lambda runs: runs["force_chattering"],
    "torque_chattering_n_m_per_s": lambda runs: runs["torque_chattering"],
}
"""Quantities reported of an entry, each as a function of its runs."""


@dataclass(frozen=True)
class Verdict:
    """Statistics of the runs of an entry.

    Attributes:
        success: runs that captured, and settled where the bodies merge.
        captured: runs that captured.
        figures: by name, see `QUANTITIES`.
        failures: runs by cause, the most frequent first.
    """

    success: Proportion
    captured: Proportion
    figures: Mapping[str, Figures]
    failures: Mapping[str, int] = field(default_factory=dict)

    @classmethod
    def of(cls, runs: Runs) -> Verdict:
        """Judge runs."""
        codes, counts = np.unique(runs.failure[~runs.succeeded], return_counts=True)
        order = np.argsort(-counts, kind="stable")
        return cls(
            success=Proportion.of(int(runs.succeeded.sum()), len(runs)),
            captured=Proportion.of(int(np.isfinite(runs["capture_time"]).sum()), len(runs)),
            figures={name: Figures.of(quantity(runs)) for name, quantity in QUANTITIES.items()},
            failures={str(cause(int(codes[place]))): int(counts[place]) for place in order},
        )

    def to_json(self) -> dict[str, Any]:
        """Give it as JSON takes it."""
        return {
            "runs": self.success.runs,
            **self.success.to_json("success"),
            **self.captured.to_json("captured_share"),
            **{name: figures.to_json() for name, figures in self.figures.items()},
            "failures": dict(self.failures),
        }
