"""Result of a comparison: every entry on held-out runs, every pair of them, and their order."""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from detumble.analysis.comparing.paired import Difference, Shift, holm
from detumble.analysis.comparing.ranking import SHARE, SIGNIFICANT, Ranking, Score, rank
from detumble.results import results_folder
from detumble.writing import output_folder, write_text

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from detumble.analysis.comparing.entries import Entry
    from detumble.analysis.comparing.judge import Runs, Verdict
    from detumble.analysis.comparing.plan import Plan
    from detumble.analysis.comparing.ratios import Ratio
    from detumble.analysis.comparing.robustness import Curve
    from detumble.intervals import Array
    from detumble.scenario.model import Scenario

METRICS: dict[str, Callable[[Runs], Array]] = {
    "failed": lambda runs: np.where(runs.succeeded, 0.0, 1.0),
    "capture_time_s": lambda runs: runs.capture_time,
    "settled_time_s": lambda runs: runs.settled_time,
    "delta_v_to_capture_m_s": lambda runs: runs["delta_v_to_capture"],
    "delta_v_m_s": lambda runs: np.where(runs.succeeded, runs["delta_v"], np.nan),
}
"""Metrics that pairs are tested for, less is better in all; of Δv only runs count in which both entries have one."""
OBJECTIVES = {
    "capture": "capture_time_s",
    "settling": "settled_time_s",
    "delta_v": "delta_v_to_capture_m_s",
    "delta_v_total": "delta_v_m_s",
}
"""The metric of each objective."""
PLAN = "plan.json"
"""File of the folder that holds what is compared."""
FIGURES = tuple(f"figures/{name}.png" for name in ("capture-times", "pairs", "robustness"))
FILES = (PLAN, "comparison.json", "scenario.toml", "tuned/*.toml", *FIGURES)
"""Patterns of what a comparison writes, beside the records of its searches."""
STATISTIC = "statistic"
"""Name of the test of the objective's statistic among those of a pair."""


@dataclass(frozen=True)
class Tuning:
    """One set of gains of an entry.

    Attributes:
        optimiser_seed: of the search; None for gains that are flown as given.
        scenario: with these gains.
        gains: by path within the law's table, as found; empty as given.
        cost: on the training starts; None as given.
        training_success: share of the training starts; None as given.
        verdict: on the first held-out runs; None before they are flown.
        score: likewise.
    """

    optimiser_seed: int | None
    scenario: Scenario
    gains: Mapping[str, float]
    cost: float | None
    training_success: float | None
    verdict: Verdict | None = None
    score: Score | None = None

    def to_json(self) -> dict[str, Any]:
        """Give it as JSON takes it."""
        assert self.verdict is not None
        assert self.score is not None
        return {
            "optimiser_seed": self.optimiser_seed,
            "gains": dict(self.gains),
            "training_cost": self.cost,
            "training_success": self.training_success,
            "held_out_runs": self.verdict.success.runs,
            **self.verdict.success.to_json("success"),
            "short_of_required": self.score.short,
            "objective": None if self.score.short else self.score.value,
            "capture_time_s": self.verdict.figures["capture_time_s"].to_json(),
        }


@dataclass(frozen=True)
class Judged:
    """One entry and its results.

    Attributes:
        entry: law, form and name.
        tunings: all of its sets of gains, in the order of their seeds.
        chosen: place of the tuning of least training cost, which is judged.
        runs: the held-out runs of the chosen tuning.
        counted: (n,) value of each run in the objective, in its unit; the ceiling for a failed run.
        verdict: statistics of the runs.
        score: on all of the runs.
        ratios: `time`, `delta_v`, `settling`: see `ratios`.
        curves: robustness; empty where it was left out.
    """

    entry: Entry
    tunings: tuple[Tuning, ...]
    chosen: int
    runs: Runs
    counted: Array
    verdict: Verdict
    score: Score
    ratios: Mapping[str, Ratio] = field(default_factory=dict)
    curves: tuple[Curve, ...] = ()

    @property
    def tuning(self) -> Tuning:
        """The set of gains that is judged."""
        return self.tunings[self.chosen]

    @property
    def scores(self) -> list[Score]:
        """On held-out runs, one for each tuning: on all of them for the chosen one, on the first for the others."""
        others = [tuning.score for place, tuning in enumerate(self.tunings) if place != self.chosen]
        return [self.score, *(score for score in others if score is not None)]

    def to_json(self) -> dict[str, Any]:
        """Give it as JSON takes it."""
        return {
            "name": self.entry.name,
            "law": self.entry.law,
            "form": self.entry.form,
            "chosen_tuning": self.chosen,
            "short_of_required": self.score.short,
            "objective": None if self.score.short else self.score.value,
            **self.verdict.to_json(),
            "ratios": {name: ratio.to_json() for name, ratio in self.ratios.items()},
            "tunings": [tuning.to_json() for tuning in self.tunings],
            "robustness": {curve.sweep.key: curve.to_json() for curve in self.curves},
        }


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
        entries: judged.
        percentile: the statistic; None is the mean.
    """
    couples = list(itertools.combinations(range(len(entries)), 2))
    found = [_differences(entries[one].runs, entries[other].runs) for one, other in couples]
    shifts = [Shift.of(entries[one].counted, entries[other].counted, percentile) for one, other in couples]
    alone = [
        [*(difference.p for difference in differences.values()), shift.p]
        for differences, shift in zip(found, shifts, strict=True)
    ]
    adjusted = iter(holm(np.ravel(alone)).tolist())
    return tuple(
        Pair(places, differences, shift, {name: next(adjusted) for name in (*differences, STATISTIC)})
        for places, differences, shift in zip(couples, found, shifts, strict=True)
    )


def _differences(one: Runs, other: Runs) -> dict[str, Difference]:
    found = {}
    for name, values in METRICS.items():
        a, b = values(one), values(other)
        both = ~(np.isnan(a) | np.isnan(b))
        found[name] = Difference.of(a[both], b[both])
    return found


def ranking_of(entries: Sequence[Judged], pairs: Sequence[Pair], objective: str, period: float) -> Ranking:
    """Order entries by the rules of `ranking`.

    Args:
        entries: judged.
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
        """Draw all figures into a folder.

        Raises:
            RequestError: they cannot be written.
        """
        from detumble.show.compare import draw

        return draw(self, folder)
