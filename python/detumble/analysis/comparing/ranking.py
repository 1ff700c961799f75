"""A partial order of entries that contains only what the runs show.

A score orders entries: those whose success reaches the required share come before those that do not; among the former the
objective's statistic decides, among the latter the share of failures. An entry was tuned several times, which gives it a
score for each tuning, all on held-out runs. A is above B when all of this holds:

1. every tuning of A has a better score than every tuning of B. Between equally good entries with k tunings each, chance
   does that in a share 2 / C(2k, k) of the pairs: one of ten for k = 3, one of 126 for k = 5;
2. the paired tests of what puts A first are significant in the same direction after Holm's adjustment over all pairs and
   tests: when both reach the required success, that A is ahead in more runs, and that the objective's statistic itself differs
   (see `paired`); else that of success;
3. the difference is large enough to matter: at least one control period of time, 0.5 % of runs, or 0.5 % of Δv.

The scores of an entry make an interval, and by the first rule A is above B only if its interval lies wholly before B's. So
the order has no cycle. Where A is above B and B above C, A is above C too, by consequence. Entries neither above nor below each
other tie: no difference was shown, which does not prove that they are equal. The rank of an entry is one more than the number
of those above it, and entries that share a letter tie.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

SIGNIFICANT = 0.05
SHARE = 0.005
"""Least useful difference: of a share of runs, and of Δv relative to the smaller one."""


@dataclass(frozen=True, order=True)
class Score:
    """How well one tuning did on held-out runs; smaller is better.

    Attributes:
        short: fewer runs succeeded than required.
        value: the objective's statistic, or, if short, the share of runs that failed.
    """

    short: bool
    value: float

    @classmethod
    def of(cls, success: float, required: float, statistic: float) -> Score:
        """Score a share of successes and the objective's statistic."""
        return cls(True, 1.0 - success) if success < required else cls(False, statistic)


@dataclass(frozen=True)
class Ranking:
    """A partial order of entries.

    Attributes:
        above: (n, n) whether the entry of the row is above that of the column.
        ranks: one more than the number of entries above each.
        letters: for each, the groups of ties that it belongs to: entries with a common letter tie.
    """

    above: NDArray[np.bool_]
    ranks: tuple[int, ...]
    letters: tuple[str, ...]


def rank(scores: Sequence[Sequence[Score]], distinct: Callable[[int, int], bool]) -> Ranking:
    """Order entries.

    Args:
        scores: of each entry, one for each tuning.
        distinct: whether the first entry was shown to be better than the second by enough (2. and 3. above).
    """
    count = len(scores)
    above = np.zeros((count, count), np.bool_)
    for one, other in itertools.permutations(range(count), 2):
        above[one, other] = max(scores[one]) < min(scores[other]) and distinct(one, other)
    for middle in range(count):  # transitive closure (Warshall)
        above |= np.outer(above[:, middle], above[middle])
    ranks = tuple(int(count) + 1 for count in above.sum(axis=0))
    return Ranking(above, ranks, _letters(above, ranks))


def _letters(above: NDArray[np.bool_], ranks: Sequence[int]) -> tuple[str, ...]:
    """Name the maximal groups of entries that tie pairwise, the better groups first."""
    ties = ~(above | above.T)
    groups: list[set[int]] = []

    def grow(group: set[int], candidates: set[int], done: set[int]) -> None:  # Bron & Kerbosch, CACM 16 (1973)
        if not candidates and not done:
            groups.append(group)
        for entry in sorted(candidates):
            tied = {other for other in range(len(ranks)) if ties[entry, other] and other != entry}
            grow(group | {entry}, candidates & tied, done & tied)
            candidates = candidates - {entry}
            done = done | {entry}

    grow(set(), set(range(len(ranks))), set())
    groups.sort(key=lambda group: sorted((ranks[entry], entry) for entry in group))
    names = [_name(place) for place in range(len(groups))]
    return tuple(
        "".join(name for name, group in zip(names, groups, strict=True) if entry in group)
        for entry in range(len(ranks))
    )


def _name(place: int) -> str:
    """Letter the groups a to z, then a1 to z1."""
    again, letter = divmod(place, 26)
    return chr(ord("a") + letter) + (str(again) if again else "")
