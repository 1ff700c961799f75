"""Paired tests of two laws. Both fly run i of one campaign, the same start and the same noise, so the runs make pairs (a_i, b_i).

Sign test (Conover, Practical Nonparametric Statistics, 3rd ed., 1999, §3.4): if neither tends to be lower, then of the pairs
that differ, lower and higher ones are equally likely, so with l lower, h higher and B ~ Binomial(l + h, ½)

    p = min(1, 2 P(B ≤ min(l, h))).

It is exact, assumes nothing about the distribution, and allows ties and values of +∞ for events that never happened. Of
successes it is the exact test of McNemar (Psychometrika 12, 1947). The size of the difference is the median of
a_i - b_i, 0 where the event happens in neither run, with an interval from order statistics.

The sign test shows which entry is ahead more often, not by how much: an entry that is ahead by little in most runs and fails in
a few may have the larger mean. So the statistic that entries are ordered by has a test of its own, of the value of each run in
the objective (`tuning.objective`; finite, the ceiling for a failed run):

    mean         Student's t of the differences a_i - b_i; asymptotic, the values being bounded
    percentile   with c that percentile of all values of both: if both have it there, as many a_i as b_i exceed c. Of the pairs
                 of which only one does, the sign test (as McNemar's); c being estimated, it is asymptotic too

Holm (Scandinavian Journal of Statistics 6, 1979): with the p-values of m tests in rising order, the k-th becomes
max_{j ≤ k} (m - j + 1) p_(j). Below 0.05 it is significant, and the chance that any test of the family finds a difference
where there is none is at most 0.05, however the tests depend on each other.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from detumble.campaigns.statistics.summaries import Quantile
from detumble.intervals import jsonable, quantile_ranks

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from detumble.intervals import Array

ROUND_OFF = 1e-9
"""Relative: sums of times that are the same number of control periods differ in their last bits."""


@dataclass(frozen=True)
class Difference:
    """Sign test of the pairs (a_i, b_i).

    Attributes:
        lower: pairs with a_i < b_i.
        higher: pairs with a_i > b_i.
        ties: pairs that are equal.
        median: of a_i - b_i, in their unit; None without pairs. Infinite where in most pairs only one of the two is finite.
        p: of the sign test, not adjusted.
    """

    lower: int
    higher: int
    ties: int
    median: Quantile | None
    p: float

    @classmethod
    def of(cls, a: Array, b: Array) -> Difference:
        """Compare pairs.

        Args:
            a: (n,) +inf for what never happened, not NaN.
            b: (n,) likewise, in the same order.
        """
        with np.errstate(invalid="ignore"):
            apart = np.abs(a - b) > ROUND_OFF * np.minimum(np.abs(a), np.abs(b))  # NaN of two infinities is not
            difference = np.where(apart, a - b, 0.0)
        lower, higher = int(np.count_nonzero(difference < 0.0)), int(np.count_nonzero(difference > 0.0))
        return cls(lower, higher, len(a) - lower - higher, quantile(difference, 0.5), sign_test(lower, higher))

    def to_json(self) -> dict[str, Any]:
        """Give it as JSON takes it."""
        middle = self.median or Quantile(math.nan, None, None)
        return {
            "lower": self.lower,
            "higher": self.higher,
            "ties": self.ties,
            "median_difference": jsonable(middle.value),
            "median_difference_ci": [jsonable(middle.low), jsonable(middle.high)],
            "p": self.p,
        }


@dataclass(frozen=True)
class Shift:
    """Difference of the objective's statistic between two entries.

    Attributes:
        value: the first less the second, in the objective's unit.
        p: of the test of the statistic, for itself.
    """

    value: float
    p: float

    @classmethod
    def of(cls, a: Array, b: Array, percentile: float | None) -> Shift:
        """Compare pairs.

        Args:
            a: (n,) values of the runs in the objective, finite.
            b: (n,) likewise, in the same order.
            percentile: the statistic, in (0, 100]; None is the mean.
        """
        if percentile is None:
            return cls(float(a.mean() - b.mean()), t_test(a - b))
        own, other, common = (quantile(values, percentile / 100.0) for values in (a, b, np.concatenate((a, b))))
        assert own is not None
        assert other is not None
        assert common is not None
        over, under = a > common.value * (1.0 + ROUND_OFF), b > common.value * (1.0 + ROUND_OFF)
        p = sign_test(int(np.count_nonzero(under & ~over)), int(np.count_nonzero(over & ~under)))
        return cls(own.value - other.value, p)


def t_test(differences: Array) -> float:
    """Give the two-sided p-value of Student's test that the mean of differences (n,) is zero; 1 where there are too few."""
    from scipy.special import stdtr  # type: ignore[import-untyped]  # scipy.stats would take fifty megabytes more

    count = len(differences)
    mean = float(differences.mean()) if count else 0.0
    if count < 2 or mean == 0.0:
        return 1.0
    error = float(differences.std(ddof=1)) / math.sqrt(count)
    return min(1.0, 2.0 * float(stdtr(count - 1, -abs(mean) / error))) if error > 0.0 else 0.0


def sign_test(lower: int, higher: int) -> float:
    """Give the exact two-sided p-value of so many pairs one way and so many the other; 1 without any."""
    from scipy.special import bdtr

    return min(1.0, 2.0 * float(bdtr(min(lower, higher), lower + higher, 0.5))) if lower + higher else 1.0


def holm(p: Array) -> Array:
    """Adjust the p-values (m,) of a family of tests by Holm; returns them (m,) in the same order, at most 1."""
    order = np.argsort(p, kind="stable")
    raised = np.maximum.accumulate(p[order] * np.arange(len(p), 0, -1))
    adjusted = np.empty(len(p))
    adjusted[order] = np.minimum(raised, 1.0)
    return adjusted


def quantile(values: Array, probability: float, confidence: float = 0.95) -> Quantile | None:
    """Estimate a quantile of the population that values were drawn from, with an interval from order statistics.

    Args:
        values: (n,) may be infinite, not NaN.
        probability: of the quantile, 0 to 1.
        confidence: of the interval.

    Returns:
        The smallest value that a share `probability` does not exceed; None of no values.
    """
    count = len(values)
    if not count:
        return None
    ranks = (max(1, math.ceil(count * probability - 1e-9)), *quantile_ranks(count, probability, confidence))
    known = [rank - 1 for rank in ranks if 1 <= rank <= count]
    ordered: NDArray[np.float64] = np.partition(values, known)
    middle, low, high = (float(ordered[rank - 1]) if 1 <= rank <= count else None for rank in ranks)
    assert middle is not None
    return Quantile(middle, low, high)
