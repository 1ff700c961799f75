"""Every pair of entries on common runs: tests of each metric, and the order that follows from them."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from detumble.analysis.comparing.paired import Difference, Shift, holm
from detumble.analysis.comparing.ranking import SHARE, SIGNIFICANT, Ranking, rank

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from detumble.analysis.comparing.judge import Runs
    from detumble.analysis.comparing.judged import Judged
    from detumble.intervals import Array


@dataclass(frozen=True)
class Metric:
    """A quantity in which pairs are tested; the smaller, the better.

    Attributes:
        title: for tables and figures.
        unit: after multiplication by the factor.
        decimals: of that number.
        factor: from the values to the unit.
        values: of runs, (n,); NaN where a run has none: only runs count in which both entries have one.
    """

    title: str
    unit: str
    decimals: int
    factor: float
    values: Callable[[Runs], Array]


METRICS = {
    "failed": Metric("share of runs that fail", "%", 2, 100.0, lambda runs: np.where(runs.succeeded, 0.0, 1.0)),
    "capture_time_s": Metric("capture time", "s", 2, 1.0, lambda runs: runs.capture_time),
    "settled_time_s": Metric("time until settled", "s", 2, 1.0, lambda runs: runs.settled_time),
    "delta_v_to_capture_m_s": Metric("Δv to capture", "m/s", 4, 1.0, lambda runs: runs["delta_v_to_capture"]),
    "delta_v_m_s": Metric("Δv", "m/s", 4, 1.0, lambda runs: np.where(runs.succeeded, runs["delta_v"], np.nan)),
}
OBJECTIVES = {
    "capture": "capture_time_s",
    "settling": "settled_time_s",
    "delta_v": "delta_v_to_capture_m_s",
    "delta_v_total": "delta_v_m_s",
}
"""The metric of each objective."""
STATISTIC = "statistic"
"""Name of the test of the objective's statistic among those of a pair."""


@dataclass(frozen=True)
class Pair:
    """Two entries on common runs.

    Attributes:
        places: of both among the entries.
        differences: by metric, see `METRICS`: the first less the second.
        shift: of the objective's statistic.
        adjusted: p-values by metric, and by `STATISTIC`, after Holm's adjustment over all pairs and tests.
    """

    places: tuple[int, int]
    differences: Mapping[str, Difference]
    shift: Shift
    adjusted: Mapping[str, float]

    def better(self, place: int, metric: str) -> bool:
        """Tell whether an entry of the pair is significantly better in a metric: in more runs than the other way round."""
        difference = self.differences[metric]
        ahead = difference.lower > difference.higher
        behind = difference.higher > difference.lower
        return self.adjusted[metric] < SIGNIFICANT and (ahead if place == self.places[0] else behind)


def pairs_of(entries: Sequence[Judged], percentile: float | None = None) -> tuple[Pair, ...]:
    """Test every pair of entries for every metric and for the objective's statistic, and adjust the p-values as one family.

    Args:
        entries: to be compared.
        percentile: the statistic; None is the mean.
    """
    places = list(itertools.combinations(range(len(entries)), 2))
    found = [_differences(entries[one].runs, entries[other].runs) for one, other in places]
    shifts = [Shift.of(entries[one].counted, entries[other].counted, percentile) for one, other in places]
    alone = [
        [*(difference.p for difference in differences.values()), shift.p]
        for differences, shift in zip(found, shifts, strict=True)
    ]
    adjusted = iter(holm(np.ravel(alone)).tolist())
    return tuple(
        Pair(pair, differences, shift, {name: next(adjusted) for name in (*differences, STATISTIC)})
        for pair, differences, shift in zip(places, found, shifts, strict=True)
    )


def _differences(one: Runs, other: Runs) -> dict[str, Difference]:
    found = {}
    for name, metric in METRICS.items():
        a, b = metric.values(one), metric.values(other)
        both = ~(np.isnan(a) | np.isnan(b))
        found[name] = Difference.of(a[both], b[both])
    return found


def ranking_of(entries: Sequence[Judged], pairs: Sequence[Pair], objective: str, period: float) -> Ranking:
    """Order entries by the rules of `ranking`.

    Args:
        entries: to be compared.
        pairs: of them.
        objective: that was minimised: a key of `OBJECTIVES`.
        period: s, of control.
    """
    found = {pair.places: pair for pair in pairs}

    def distinct(one: int, other: int) -> bool:
        pair = found[min(one, other), max(one, other)]
        a, b = entries[one], entries[other]
        if a.score.short or b.score.short:
            gained = a.verdict.success.share - b.verdict.success.share
            return gained >= SHARE and pair.better(one, "failed")
        enough = SHARE * a.score.value if objective.startswith("delta_v") else period * (1.0 - 1e-9)
        shown = pair.better(one, OBJECTIVES[objective]) and pair.adjusted[STATISTIC] < SIGNIFICANT
        return b.score.value - a.score.value >= enough and shown

    return rank([entry.scores for entry in entries], distinct)
