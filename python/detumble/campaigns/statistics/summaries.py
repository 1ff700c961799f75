"""What a histogram says of a quantity: quantiles with their intervals, moments, the distribution function."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from detumble.intervals import dkw_half_width, jsonable, quantile_ranks

if TYPE_CHECKING:
    from detumble.campaigns.statistics.histograms import Histogram
    from detumble.intervals import Array

PERCENTS = (5, 25, 50, 75, 95, 99)
CURVE = 2000
"""Most points of an empirical distribution function."""


@dataclass(frozen=True)
class Quantile:
    """A quantile: the smallest value met that so many percent of the runs do not exceed.

    Attributes:
        value: estimate.
        low: lower end of its interval, an order statistic; None where too few runs bound it.
        high: upper end, likewise.
    """

    value: float
    low: float | None
    high: float | None


@dataclass(frozen=True)
class Summary:
    """A quantity over the runs in which it exists. Units are the quantity's own; None where no run has it.

    Mean and deviation come from the same counts as the quantiles: of times they are exact but for round-off, of all else
    the mean is off by at most `histograms.ACCURACY` of itself and the deviation by that share of the root mean square.

    Attributes:
        count: runs in which it exists.
        smallest: exact.
        largest: exact.
        mean: None too where a run made it infinite.
        deviation: standard deviation, from n - 1; None too of a single run.
        quantiles: by percent, see `PERCENTS`; empty where no run has it.
    """

    count: int
    smallest: float | None = None
    largest: float | None = None
    mean: float | None = None
    deviation: float | None = None
    quantiles: dict[int, Quantile] = field(default_factory=dict)

    @classmethod
    def of(cls, histogram: Histogram, confidence: float) -> Summary:
        """Summarise what a histogram counted."""
        count = histogram.count
        if count == 0:
            return cls(0)
        values, counts = histogram.table()
        below = np.cumsum(counts)

        def ranked(rank: int) -> float | None:
            return float(values[np.searchsorted(below, rank)]) if 1 <= rank <= count else None

        quantiles = {}
        for percent in PERCENTS:
            low, high = quantile_ranks(count, percent / 100, confidence)
            middle = float(
                values[np.searchsorted(below, -(-count * percent // 100))]
            )  # whole numbers: no rounding of ranks
            quantiles[percent] = Quantile(middle, ranked(low), ranked(high))
        mean = deviation = None
        if math.isfinite(histogram.largest):
            scale = histogram.largest or 1.0  # squares of a diverging flight's commands would overflow
            shares = values / scale
            middle = math.fsum(shares * counts) / count
            mean = scale * middle
            if count > 1:
                deviation = scale * math.sqrt(math.fsum((shares - middle) ** 2 * counts) / (count - 1))
        return cls(count, histogram.smallest, histogram.largest, mean, deviation, quantiles)

    def to_json(self) -> dict[str, Any]:
        """Give the summary as JSON takes it: None for what does not exist or is not finite."""
        nothing = Quantile(math.nan, None, None)
        named = {f"p{percent:02}": self.quantiles.get(percent, nothing) for percent in PERCENTS}
        moments = {"min": self.smallest, "max": self.largest, "mean": self.mean, "std": self.deviation}
        return {
            "count": self.count,
            **{name: jsonable(quantile.value) for name, quantile in named.items()},
            **{name: jsonable(moment) for name, moment in moments.items()},
            **{f"{name}_ci": [jsonable(quantile.low), jsonable(quantile.high)] for name, quantile in named.items()},
        }


class Ecdf(NamedTuple):
    """Empirical distribution function over all runs, those without a value included: it may end below 1.

    Attributes:
        values: (m,) ascending, in the quantity's unit.
        fraction: (m,) share of all runs with a value up to this one.
        low: (m,) lower edge of a band that holds the whole true function at once (Dvoretzky, Kiefer, Wolfowitz, Massart).
        high: (m,) upper edge.
    """

    values: Array
    fraction: Array
    low: Array
    high: Array

    @classmethod
    def of(cls, histogram: Histogram, runs: int, confidence: float) -> Ecdf:
        """Give the function of what a histogram counted.

        Args:
            histogram: of the runs in which the quantity exists.
            runs: all runs.
            confidence: of the band as a whole.

        Returns:
            At most `CURVE` points: half of them evenly spaced in probability, half in value, so that no point of the
            curve moves visibly in either direction.
        """
        values, counts = histogram.table()
        below = np.cumsum(counts)
        if values.size > CURVE:
            levels = np.linspace(0, int(below[-1]), CURVE // 2)
            places = np.linspace(values[0], values[np.isfinite(values)][-1], CURVE // 2)
            kept = np.union1d(np.searchsorted(below, levels), np.searchsorted(values, places))
            values, below = values[kept], below[kept]
        fraction = below / max(runs, 1)
        reach = dkw_half_width(runs, confidence)
        return cls(values, fraction, np.maximum(fraction - reach, 0.0), np.minimum(fraction + reach, 1.0))
