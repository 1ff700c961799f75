"""Convergence of the estimated probability of success, in order of index, and the run at which it is accurate enough."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from detumble.intervals import clopper_pearson

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from detumble.intervals import Array

PREFIXES = 50
"""Most ends of shards in a curve of convergence."""


class Convergence(NamedTuple):
    """The probability of success as it was known after the first n runs.

    Attributes:
        runs: (m,) n, ascending.
        share: (m,) estimate.
        low: (m,) lower end of its exact interval, each for itself.
        high: (m,) upper end.
    """

    runs: NDArray[np.int64]
    share: Array
    low: Array
    high: Array


class Prefixes:
    """Successes among the first n runs of a campaign, for each n at which a shard ends.

    Shards may come in any order: what counts is the part from run 0 on that has no gap.

    Args:
        confidence: of the intervals.
    """

    def __init__(self, confidence: float) -> None:
        self.confidence = confidence
        self._shards: dict[int, tuple[int, int]] = {}  # index of the first run: runs, successes
        self._opening: list[tuple[int, int]] = []  # runs, successes after 1, 2, 4, … runs of the first shard
        self._ends: list[tuple[int, int]] = []  # runs, successes after each shard of the part without a gap
        self._half_widths: list[float] = []  # of the interval at each of these ends

    def add(self, first: int, success: NDArray[np.bool_]) -> None:
        """Take a shard.

        Args:
            first: index of its first run.
            success: (n,) of its runs, in order of index.

        Raises:
            ValueError: it was taken before.
        """
        self._check({first})
        reached = np.cumsum(success)
        self._shards[first] = (len(reached), int(reached[-1]))
        if first == 0:
            self._opening = [(1 << k, int(reached[(1 << k) - 1])) for k in range(len(reached).bit_length())]
        self._extend()

    def first_narrow_enough(self, half_width: float) -> int | None:
        """Find where a campaign that flies until the interval is narrow enough ends.

        The answer depends on the runs up to that end alone: neither on the order in which shards came, nor on how many
        more there are.

        The interval at that end is made as if the length had been fixed beforehand, though the runs themselves chose it.
        That costs little, as Clopper and Pearson's intervals are conservative: with shards of 16 384 runs and
        nominal 95 %, probabilities from 0.5 to 0.9999 and half widths that take 1 to 12 shards, they cover 93.8 to 99.0 %
        (exactly, by summing over all outcomes; a test repeats it).

        Args:
            half_width: of the interval of the probability of success, 0 to 0.5.

        Returns:
            Number of runs up to the first end of a shard at which the interval is no wider; None if there is none yet.
        """
        narrow = np.flatnonzero(np.array(self._half_widths) <= half_width)
        return self._ends[int(narrow[0])][0] if narrow.size else None

    def curve(self) -> Convergence:
        """Give the convergence: at 1, 2, 4, … runs of the first shard, and at about `PREFIXES` ends of shards.

        Returns:
            The curve up to the end of the part without a gap; empty while run 0 is missing.
        """
        count = len(self._ends)
        chosen = np.unique(np.geomspace(1, count, PREFIXES).round().astype(int)) - 1 if count else ()
        points = sorted({*self._opening, *(self._ends[index] for index in chosen)})
        runs, successes = np.array(points, np.int64).reshape(-1, 2).T
        return Convergence(runs, successes / runs, *clopper_pearson(successes, runs, self.confidence))

    def _check(self, starts: Iterable[int]) -> None:
        twice = self._shards.keys() & set(starts)
        if twice:
            raise ValueError(f"the shard from run {min(twice)} on was counted before")

    def _extend(self) -> None:
        known = len(self._half_widths)
        runs, successes = self._ends[-1] if self._ends else (0, 0)
        while runs in self._shards:
            more, succeeded = self._shards[runs]
            runs, successes = runs + more, successes + succeeded
            self._ends.append((runs, successes))
        if len(self._ends) > known:
            total, good = np.array(self._ends[known:]).T
            low, high = clopper_pearson(good, total, self.confidence)
            self._half_widths += (0.5 * (high - low)).tolist()
