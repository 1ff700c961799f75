"""Histograms that are extended value by value: they hold counts only, so the order of adding has no effect, to the bit.

Times are whole control periods, and are counted exactly. Everything else falls into bins of constant relative width, so
that each quantile is known to a relative accuracy that is fixed beforehand: the sketch of Masson, Rim & Lee (DDSketch,
PVLDB 12, 2019), with the piecewise linear bins of its authors' fast implementations. Those are the leading bits of the
number itself: no logarithm, so the same bins on every machine.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from detumble.compiled import tick_times

if TYPE_CHECKING:
    from numpy.typing import NDArray

Array: TypeAlias = "NDArray[np.float64]"
Counts: TypeAlias = "NDArray[np.int64]"

BITS = 13
"""Bits of the mantissa that distinguish bins: 2¹³ bins an octave, 64 kB."""
ACCURACY = 0.5 ** (BITS + 1)
"""Largest relative error of a value read back, 6.1e-5: a bin's value is its middle."""

_SHIFT = 52 - BITS
_BINS = 1 << BITS


class Histogram(ABC):
    """Counts of values, which are all at least 0.

    Attributes:
        count: of the values.
        smallest: of the values, exact; +inf of none.
        largest: of the values, exact; -inf of none.
    """

    def __init__(self) -> None:
        self.count = 0
        self.smallest = math.inf
        self.largest = -math.inf

    def add(self, values: Array) -> None:
        """Count values.

        Args:
            values: (n,) none of them NaN.

        Raises:
            ValueError: a value is negative or NaN, or not one that this histogram counts.
        """
        if not values.size:
            return
        if not np.all(values >= 0.0):
            raise ValueError("a histogram counts numbers from 0 on")
        values = values + 0.0  # takes the sign from -0.0, which would be another number to the bit
        values = self._counted(values)
        self.count += values.size
        self.smallest = min(self.smallest, float(values.min()))
        self.largest = max(self.largest, float(values.max()))

    @abstractmethod
    def table(self) -> tuple[Array, Counts]:
        """List what was counted.

        Returns:
            values (m,) ascending, and how often each was met (m,), never 0.
        """

    @abstractmethod
    def _counted(self, values: Array) -> Array:
        """Count values; gives them as the histogram represents them, (n,)."""


class TickHistogram(Histogram):
    """Times that are whole control periods, each counted for itself.

    Args:
        period: s, of control.
    """

    def __init__(self, period: float) -> None:
        super().__init__()
        self.period = period
        self._counts: Counts = np.zeros(0, np.int64)

    def _counted(self, values: Array) -> Array:
        periods = values / self.period
        ticks = np.rint(periods)
        # differences of times carry round-off; anything more is not a time of this loop
        if not np.all(np.isfinite(periods)) or np.any(np.abs(periods - ticks) > 1e-3):
            raise ValueError(f"times are whole control periods of {self.period} s")
        self._fold(np.bincount(ticks.astype(np.int64)))
        return tick_times(self.period, ticks)

    def _fold(self, counts: Counts) -> None:
        missing = counts.size - self._counts.size
        if missing > 0:
            self._counts = np.pad(self._counts, (0, missing))
        self._counts[: counts.size] += counts

    def table(self) -> tuple[Array, Counts]:
        """List the times met, exactly, and their counts."""
        ticks = np.flatnonzero(self._counts)
        return tick_times(self.period, ticks), self._counts[ticks]


class LogHistogram(Histogram):
    """Numbers of any magnitude, in bins no wider than twice `ACCURACY` of their value.

    Zero is counted as zero and infinity as infinity; only below 2.2e-308 is the accuracy lost. Memory grows by 64 kB
    for each factor of two that the values span.
    """

    def __init__(self) -> None:
        super().__init__()
        self._octaves: dict[int, Counts] = {}

    def _counted(self, values: Array) -> Array:
        keys = values.view(np.int64) >> _SHIFT
        octaves = keys >> BITS
        for octave in np.unique(octaves):
            self._fold(int(octave), np.bincount(keys[octaves == octave] & (_BINS - 1), minlength=_BINS))
        return values

    def _fold(self, octave: int, counts: Counts) -> None:
        if octave in self._octaves:
            self._octaves[octave] += counts
        else:
            self._octaves[octave] = counts.copy()

    def table(self) -> tuple[Array, Counts]:
        """List the middles of the bins met, and their counts."""
        octaves = sorted(self._octaves)
        counts = np.concatenate([self._octaves[octave] for octave in octaves] or [np.zeros(0, np.int64)])
        starts = np.repeat(np.array(octaves, np.int64) << BITS, _BINS)
        keys = starts + np.tile(np.arange(_BINS), len(octaves))
        keys, counts = keys[counts > 0], counts[counts > 0]
        values = ((keys << _SHIFT) | (1 << (_SHIFT - 1))).view(np.float64)
        values[keys == 0] = 0.0
        values[np.isnan(values)] = math.inf  # the middle of infinity's bin is no number
        return np.clip(values, self.smallest, self.largest), counts
