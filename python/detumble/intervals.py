"""Intervals for shares, quantiles and distribution functions that assume nothing about the distribution."""

from __future__ import annotations

import math
from bisect import bisect_left
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from detumble.checking import real, whole

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

Array: TypeAlias = "NDArray[np.float64]"


def clopper_pearson(successes: ArrayLike, runs: ArrayLike, confidence: float = 0.95) -> tuple[Array, Array]:
    """Give the exact interval of a probability (Clopper & Pearson, Biometrika 26, 1934): both tails are binomial sums.

    It covers the true probability with at least the confidence, whatever that probability is.

    Args:
        successes: counts, any shape.
        runs: counts, the same shape; 0 gives the interval from 0 to 1.
        confidence: 0 to 1.

    Returns:
        lower and upper ends, each of that shape.
    """
    from scipy.special import betainccinv, betaincinv  # type: ignore[import-untyped]  # slow to import

    k, n = np.broadcast_arrays(np.asarray(successes, np.float64), np.asarray(runs, np.float64))
    tail = 0.5 * (1.0 - confidence)
    low = np.where(k == 0, 0.0, betaincinv(np.maximum(k, 1.0), n - k + 1.0, tail))
    high = np.where(k == n, 1.0, betainccinv(k + 1.0, np.maximum(n - k, 1.0), tail))
    return low, high


@dataclass(frozen=True)
class Proportion:
    """A count of runs, and what it says about the probability.

    Attributes:
        count: runs that have the property.
        runs: all runs.
        share: estimate of the probability; NaN of no runs.
        low: lower end of its exact interval.
        high: upper end.
    """

    count: int
    runs: int
    share: float
    low: float
    high: float

    @classmethod
    def of(cls, count: int, runs: int, confidence: float = 0.95) -> Proportion:
        """Count `count` of `runs`, with the interval of Clopper and Pearson.

        Raises:
            RequestError: these are no such counts, or the confidence lies not between 0 and 1.
        """
        runs = whole("runs", runs, 0, 2**63)
        count = whole("count", count, 0, runs)
        confidence = real("confidence", confidence, above=0.0, below=1.0)
        low, high = clopper_pearson(count, runs, confidence)
        return cls(count, runs, count / runs if runs else math.nan, float(low), float(high))

    @property
    def half_width(self) -> float:
        """Half the width of the interval."""
        return 0.5 * (self.high - self.low)

    def to_json(self, name: str) -> dict[str, Any]:
        """Give share and interval as JSON takes them, under `name` and `name_ci`."""
        return {name: jsonable(self.share), f"{name}_ci": [self.low, self.high]}


def quantile_ranks(runs: int, probability: float, confidence: float = 0.95) -> tuple[int, int]:
    """Say between which order statistics a quantile lies (David & Nagaraja, Order Statistics, 2003, §7.1).

    The number B of values below the quantile is binomial, so the l-th smallest value lies above it when B < l, and the
    u-th below it when B ≥ u. Each happens with at most half of what the confidence leaves. Of a discrete
    distribution, the interval with its ends covers no less.

    Args:
        runs: values drawn.
        probability: of the quantile, 0 to 1.
        confidence: 0 to 1.

    Returns:
        Ranks l and u counted from 1. l = 0 and u = runs + 1 are no value: too few were drawn to bound that side.
    """
    from scipy.special import bdtr, bdtrc  # scipy.stats would take fifty megabytes more

    tail, counts = 0.5 * (1.0 - confidence), range(runs + 1)
    low = bisect_left(counts, tail, key=lambda count: float(bdtr(count, runs, probability)))
    high = bisect_left(counts, -tail, key=lambda count: -float(bdtrc(count, runs, probability)))
    return low, high + 1


def dkw_half_width(runs: int, confidence: float = 0.95) -> float:
    """Give the half width of a band that holds a whole distribution function at once.

    P(sup |F_n - F| > ε) ≤ 2 exp(-2 n ε²) (Dvoretzky, Kiefer & Wolfowitz 1956, with the constant of Massart, Annals of
    Probability 18, 1990). It holds for any distribution, also one with mass at "never".

    Args:
        runs: values drawn, those that are "never" included.
        confidence: 0 to 1.

    Returns:
        ε, at most 1.
    """
    return min(1.0, math.sqrt(math.log(2.0 / (1.0 - confidence)) / (2.0 * runs))) if runs else 1.0


def jsonable(number: float | None) -> Any:
    """Give a number as JSON takes it: None for what is not finite."""
    return number if number is not None and math.isfinite(number) else None
