"""Statistics of a campaign, from its shards in any order: counts only, so that the order has no effect, to the bit.

What is kept takes some ten megabytes however many runs there are. No interval assumes anything of the distribution.
"""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from detumble.campaigns.columns import SCALARS
from detumble.campaigns.statistics.convergence import Convergence, Prefixes
from detumble.campaigns.statistics.histograms import Histogram, LogHistogram, TickHistogram
from detumble.campaigns.statistics.summaries import Ecdf, Summary
from detumble.checking import choice
from detumble.failures import CAUSES, DIVERGED, NO_GAINS, cause
from detumble.intervals import Proportion
from detumble.scenario.accuracy import inaccurate
from detumble.scenario.step import integration_step, worst_body

if TYPE_CHECKING:
    from collections.abc import Sequence

    from detumble.intervals import Array
    from detumble.scenario.model import Scenario

TIMES = ("capture_time_s", "settling_time_s", "settled_time_s")
"""Counted exactly. `settled_time_s` is the sum of the first two: from the start of the flight to the stack at rest."""
EXTENTS = tuple(metric.key for metric in SCALARS if metric.unit != "s" and metric.kind != "whole")
"""All that is neither a time nor a tick, counted to a relative accuracy of 1e-4."""
SATURATED = ("force_saturated_share", "torque_saturated_share")


class Statistics:
    """Statistics of the runs so far.

    Args:
        control_period: s: times are whole multiples of it.
        confidence: of all intervals.
        step: s, of integration; None for the control period.
        inertia: kg m², of the most asymmetric body; by default a sphere.

    Attributes:
        confidence: as given.
        step: as given.
        inertia: as given.
        runs: counted so far.
        saturated_failures: failed runs whose force or torque command was over its limit for more than half of the time.
        fast_turns: runs in which a body turned too far in an integration step: see `scenario.accuracy.inaccurate`.
    """

    def __init__(
        self,
        control_period: float,
        confidence: float = 0.95,
        *,
        step: float | None = None,
        inertia: Sequence[float] = (1.0, 1.0, 1.0),
    ) -> None:
        self.confidence = confidence
        self.step = control_period if step is None else step
        self.inertia = inertia
        self.runs = 0
        self.saturated_failures = 0
        self.fast_turns = 0
        self._successes = 0
        self._causes: Counter[str] = Counter()
        self._histograms: dict[str, Histogram] = {name: TickHistogram(control_period) for name in TIMES}
        self._histograms |= {name: LogHistogram() for name in EXTENTS}
        self._prefixes = Prefixes(confidence)

    @classmethod
    def of(cls, scenario: Scenario) -> Statistics:
        """Begin the statistics of a scenario's campaign."""
        return cls(scenario.time.control_period, step=integration_step(scenario), inertia=worst_body(scenario)[0])

    def add(self, shard: pl.DataFrame) -> None:
        """Count the runs of one shard.

        Args:
            shard: at least one run, in order of index, columns as in `campaigns.columns`; what does not exist is null or NaN.

        Raises:
            ValueError: the shard was counted before, or is not what a campaign writes: its indices have gaps, its
                failures and causes disagree, a time is not a whole number of control periods.
        """
        index, success = shard["index"], shard["success"].to_numpy()
        first, runs, successes = int(index[0]), shard.height, int(np.count_nonzero(success))
        causes = Counter(shard["failure"].drop_nulls().to_list())
        if int(index[-1]) - first + 1 != runs:
            raise ValueError(f"the shard from run {first} on has gaps")
        if causes.total() != runs - successes:
            raise ValueError(
                f"of the shard from run {first} on {runs - successes} runs failed, {causes.total()} have a cause"
            )
        self._prefixes.add(first, success)
        rows = shard.with_columns(settled_time_s=pl.col("capture_time_s") + pl.col("settling_time_s"))
        for name, histogram in self._histograms.items():
            histogram.add(_existing(rows[name]))
        saturated = np.any([shard[name].fill_null(0.0).to_numpy() > 0.5 for name in SATURATED], axis=0)
        self.saturated_failures += int(np.count_nonzero(saturated & ~success))
        rate, end = (shard[name].fill_null(0.0).to_numpy() for name in ("largest_rate_rad_s", "end_time_s"))
        self.fast_turns += int(np.count_nonzero(inaccurate(self.inertia, rate, self.step, end)))
        self._causes += causes
        self._successes += successes
        self.runs += runs

    @property
    def success(self) -> Proportion:
        """Runs that captured, and settled where the bodies merge."""
        return Proportion.of(self._successes, self.runs, self.confidence)

    @property
    def captured(self) -> Proportion:
        """Runs that captured, settled or not."""
        return Proportion.of(self._histograms["capture_time_s"].count, self.runs, self.confidence)

    @property
    def captured_at_once(self) -> int:
        """Runs whose start was within every threshold: captured at t = 0."""
        times, counts = self._histograms["capture_time_s"].table()
        return int(counts[times == 0.0].sum())

    @property
    def broken_off(self) -> int:
        """Runs that could not be flown to their end: diverged, or without gains."""
        return sum(self._causes[str(cause(code))] for code in (DIVERGED, NO_GAINS))

    @property
    def failures(self) -> dict[str, Proportion]:
        """Causes of failure with their share of all runs: the most frequent first, equals in the order of the register."""
        order = sorted(self._causes, key=lambda cause: (-self._causes[cause], CAUSES.index(cause)))
        return {cause: Proportion.of(self._causes[cause], self.runs, self.confidence) for cause in order}

    def summary(self, name: str) -> Summary:
        """Summarise a quantity over the runs in which it exists.

        Args:
            name: one of `TIMES` or `EXTENTS`.
        """
        return Summary.of(self._histograms[choice("quantity", name, self._histograms)], self.confidence)

    def ecdf(self, name: str) -> Ecdf:
        """Give the distribution of a quantity over all runs: one in which it does not exist counts as infinite.

        Args:
            name: one of `TIMES` or `EXTENTS`.
        """
        return Ecdf.of(self._histograms[choice("quantity", name, self._histograms)], self.runs, self.confidence)

    def convergence(self) -> Convergence:
        """Follow the probability of success along the runs in order of index: see `Prefixes.curve`."""
        return self._prefixes.curve()

    def first_narrow_enough(self, half_width: float) -> int | None:
        """Find how many runs were enough for an interval of that half width: see `Prefixes.first_narrow_enough`."""
        return self._prefixes.first_narrow_enough(half_width)

    def to_json(self) -> dict[str, Any]:
        """Give everything but the curves as JSON takes it: None for what does not exist."""
        success, captured = self.success, self.captured
        return {
            "runs": self.runs,
            "captured": captured.count,
            **captured.to_json("captured_share"),
            **success.to_json("success"),
            **{name: self.summary(name).to_json() for name in (*TIMES, *EXTENTS)},
            "failures": {cause: failure.count for cause, failure in self.failures.items()},
            "saturated_failures": self.saturated_failures,
        }


def _existing(column: pl.Series) -> Array:
    """Take the numbers from a column that has null or NaN where there is none."""
    return column.drop_nulls().drop_nans().to_numpy()
