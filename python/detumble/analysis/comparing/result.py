"""Result of a comparison: every entry on held-out runs, every pair of them, and their order."""

from __future__ import annotations

import itertools
import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from detumble.analysis.comparing.pairs import METRICS, OBJECTIVES, STATISTIC
from detumble.analysis.comparing.ranking import SIGNIFICANT
from detumble.results import results_folder
from detumble.writing import output_folder, write_text

if TYPE_CHECKING:
    from pathlib import Path

    from detumble.analysis.comparing.judged import Judged
    from detumble.analysis.comparing.pairs import Pair
    from detumble.analysis.comparing.plan import Plan
    from detumble.analysis.comparing.ranking import Ranking
    from detumble.intervals import Array
    from detumble.scenario.model import Scenario
    from detumble.show.compare import Matrix, Sheet, SweepCurves

PLAN = "plan.json"
"""Name of the file that says what is compared."""
FIGURES = tuple(f"figures/{name}.png" for name in ("capture-times", "pairs", "robustness"))
FILES = (PLAN, "comparison.json", "scenario.toml", "tuned/*.toml", *FIGURES)
"""Patterns of what a comparison writes, beside the records of its searches."""


@dataclass(frozen=True)
class Comparison:
    """Result of a comparison.

    Attributes:
        scenario: that was given.
        plan: how the entries were compared.
        entries: in the order given.
        bounds: (runs,) s, lower bound of the capture time of each held-out run.
        pairs: of all entries, by place.
        ranking: the order, by place.
    """

    scenario: Scenario
    plan: Plan
    entries: tuple[Judged, ...]
    bounds: Array
    pairs: tuple[Pair, ...]
    ranking: Ranking

    @property
    def ordered(self) -> list[int]:
        """Places of the entries, best first; of those that tie, the better score first."""
        ranks = self.ranking.ranks
        return sorted(range(len(self.entries)), key=lambda place: (ranks[place], self.entries[place].score, place))

    @property
    def broken(self) -> list[str]:
        """Runs that beat a bound which no controller can beat, in words; empty as long as bounds and core are right."""
        return [
            f"{judged.entry.name}: run {ratio.broken[0]} of seed {self.plan.held_out} beats its {name} bound"
            + (f", and {len(ratio.broken) - 1} more do" if len(ratio.broken) > 1 else "")
            for judged in self.entries
            for name, ratio in judged.ratios.items()
            if ratio.broken
        ]

    def pair(self, one: int, other: int) -> Pair:
        """Give the pair of two entries by their places, in either order."""
        return next(pair for pair in self.pairs if set(pair.places) == {one, other})

    def to_json(self) -> dict[str, Any]:
        """Give everything in one object, as `detumble compare --json` prints it."""
        names = [judged.entry.name for judged in self.entries]
        order = self.ordered
        return {
            "scenario": self.scenario.title,
            **self.plan.to_json(),
            "entries": [judged.to_json() for judged in self.entries],
            "ranking": [
                {
                    "name": names[place],
                    "rank": self.ranking.ranks[place],
                    "ties": self.ranking.letters[place],
                    "above": [names[other] for other in order if self.ranking.above[place, other]],
                }
                for place in order
            ],
            "pairs": [
                {
                    "a": names[pair.places[0]],
                    "b": names[pair.places[1]],
                    **{
                        name: {**difference.to_json(), "p_holm": pair.adjusted[name]}
                        for name, difference in pair.differences.items()
                    },
                    STATISTIC: {
                        "difference": pair.shift.value,
                        "p": pair.shift.p,
                        "p_holm": pair.adjusted[STATISTIC],
                    },
                }
                for pair in self.pairs
            ],
            "bounds_broken": self.broken,
        }

    def save(self, folder: Path) -> list[Path]:
        """Write `comparison.json`, the scenario, and for each entry a scenario file with its gains into `tuned`.

        Returns:
            The files.

        Raises:
            RequestError: they cannot be written.
        """
        texts = {folder / "comparison.json": json.dumps(self.to_json(), indent=2, allow_nan=False) + "\n"}
        texts[folder / "scenario.toml"] = self.scenario.to_toml()
        for judged in self.entries:
            texts[folder / "tuned" / f"{judged.entry.file}.toml"] = judged.tuning.scenario.to_toml()
        with results_folder(folder, FILES), output_folder(folder / "tuned"):
            for path, text in texts.items():
                write_text(path, text)
        return list(texts)

    def figures(self, folder: Path) -> list[Path]:
        """Write all figures into a folder.

        Raises:
            RequestError: they cannot be written.
        """
        from detumble.show.compare import CaptureTimes, Pairs, write_pictures

        best_first = [self.entries[place] for place in self.ordered]
        times = CaptureTimes(
            [judged.runs.capture_time for judged in best_first],
            [judged.times_over_least for judged in best_first],
            self.bounds,
        )
        above = self.ranking.above[np.ix_(self.ordered, self.ordered)]
        pairs = Pairs([self._matrix(OBJECTIVES[self.plan.objective.what]), self._matrix("failed")], above, SIGNIFICANT)
        return write_pictures(folder, self._sheet(), times, pairs, self._sweeps() if self.plan.robust else [])

    def _sheet(self) -> Sheet:
        """Give headline and entries of the pictures, the best first."""
        from detumble.show.campaign.frame import Caption, counted
        from detumble.show.compare import Sheet, looks_of

        plan, objective = self.plan, self.plan.objective
        budget, starts = counted(plan.budget, "evaluation"), counted(plan.starts, "start")
        searched = f"{counted(plan.tunings, 'tuning')} each of {budget} on {starts}"
        gains = "gains as given" if plan.as_given else searched
        goal = f"{objective.statistic} of {objective.meaning}, success at least {100 * objective.required:g} %"
        looks = looks_of([(judged.entry.name, judged.entry.law, judged.entry.form) for judged in self.entries])
        return Sheet(
            Caption(self.scenario.title, "", plan.runs, plan.judging),
            f"{goal}   ·   {gains}",
            [looks[place] for place in self.ordered],
            [self.ranking.ranks[place] for place in self.ordered],
            [self.ranking.letters[place] for place in self.ordered],
        )

    def _matrix(self, name: str) -> Matrix:
        """Give every entry against every other in a metric, row less column, the best first."""
        from detumble.show.compare import Matrix

        order, metric, count = self.ordered, METRICS[name], len(self.entries)
        values, better = np.full((count, count), np.nan), np.zeros((count, count), np.bool_)
        for row, column in itertools.permutations(range(count), 2):
            pair = self.pair(order[row], order[column])
            difference = pair.differences[name]
            value = difference.median.value if difference.median else np.nan
            if name == "failed":  # the median of successes and failures says nothing
                runs = difference.lower + difference.higher + difference.ties
                value = (difference.higher - difference.lower) / max(1, runs)
            values[row, column] = value * (1.0 if pair.places[0] == order[row] else -1.0) * metric.factor
            better[row, column] = pair.better(order[row], name)
        title = f"{metric.title}: median of row less column [{metric.unit}]"
        return Matrix(
            title if name != "failed" else "failures: row less column [% of runs]", metric.decimals, values, better
        )

    def _sweeps(self) -> list[SweepCurves]:
        """Give success and median capture time along each sweep, the best entry first."""
        from detumble.show.compare import SweepCurves

        found = []
        for place, first in enumerate(self.entries[0].curves):
            sweep, rows = first.sweep, [self.entries[entry].curves[place].verdicts for entry in self.ordered]
            medians = [[verdict.figures["capture_time_s"].median for verdict in row] for row in rows]
            found.append(
                SweepCurves(
                    sweep.label,
                    sweep.own,
                    sweep.values,
                    sweep.key != "belief",
                    min(self.plan.robust, self.plan.runs),
                    np.array([[100.0 * verdict.success.share for verdict in row] for row in rows]),
                    np.array([[median.value if median else np.nan for median in row] for row in medians]),
                )
            )
        return found
