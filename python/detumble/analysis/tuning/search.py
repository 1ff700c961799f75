"""A search in progress, for one objective or several: candidates fly in batches, and every evaluation is recorded."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from detumble.analysis.trials import Trials
from detumble.analysis.tuning.gains import mean_acceleration
from detumble.progress import Watcher

if TYPE_CHECKING:
    from detumble.analysis.trials import Results
    from detumble.analysis.tuning.record import Record
    from detumble.analysis.tuning.setting import Setting

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Generation:
    """State of a search after a generation.

    Attributes:
        evaluations: number of candidates so far; the first flew the scenario's own gains.
        best: least cost so far, of the first objective.
        median: of the costs of this generation.
        success: share of the starts in which the best candidate so far succeeds.
    """

    evaluations: int
    best: float
    median: float
    success: float


class Search:
    """Flies candidates, judges them and records the results.

    Args:
        setting: what is searched.
        record: of the evaluations.
        threads: to use; None for all processors. They do not affect the results.
        watcher: follows the progress.

    Attributes:
        ceilings: (m,) the most that a feasible candidate can cost, of each objective.
        points: (k, n) of all candidates so far; the first, the scenario's own gains, is given by its nearest point.
        outcomes: (k, m + 1): costs by the m objectives, and the share of successes.
        history: generation by generation.
    """

    def __init__(self, setting: Setting, record: Record, threads: int | None, watcher: Watcher | None) -> None:
        space, objectives = setting.space, setting.objectives
        self.setting = setting
        acceleration = mean_acceleration(space.base)
        self.ceilings = np.array([objective.ceiling(setting.horizon, acceleration) for objective in objectives])
        self.points = np.empty((0, len(space.tunables)))
        self.outcomes = np.empty((0, len(objectives) + 1))
        self.history: list[Generation] = []
        self._record, self._threads, self._watcher = record, threads, watcher or Watcher()
        end = setting.objective.end(space.base)
        self._trials = Trials(space.base, setting.seed, 0, setting.starts, setting.horizon, end)

    def begin(self) -> None:
        """Fly the first candidate: the scenario's own gains, unchanged."""
        self._watcher.begin(self.setting.budget)
        space, nothing = self.setting.space, np.empty((1, 0))
        outcome = self._record.known(nothing)
        if not len(outcome):
            outcome = self._judged(self._trials.fly(space.law, threads=self._threads))
            self._record.append(nothing, outcome)
        self._keep(space.point(space.own)[None, :], outcome)

    def __call__(self, points: Array) -> Array:
        """Fly candidates.

        Args:
            points: (k, n) of the unit cube.

        Returns:
            Outcomes (k, m + 1); recorded ones are not flown again.
        """
        space = self.setting.space
        outcomes = self._record.known(points).reshape(-1, self.outcomes.shape[1])
        rest = points[len(outcomes) :]
        if len(rest):
            new = self._judged(self._trials.fly(space.law, space.columns(rest), threads=self._threads))
            self._record.append(rest, new)
            outcomes = np.concatenate((outcomes, new))
        self._keep(points, outcomes)
        return outcomes

    def gains(self, candidate: int) -> dict[str, float]:
        """Give the gains of a candidate by path."""
        space = self.setting.space
        return space.values(self.points[candidate].tolist()) if candidate else dict(space.own)

    def _judged(self, results: Results) -> Array:
        pairs = zip(self.setting.objectives, self.ceilings, strict=True)
        judged = [objective.judge(results, float(ceiling)) for objective, ceiling in pairs]
        return np.column_stack([*(one.cost for one in judged), judged[0].share])

    def _keep(self, points: Array, outcomes: Array) -> None:
        self.points = np.concatenate((self.points, points))
        self.outcomes = np.concatenate((self.outcomes, outcomes))
        best = self.outcomes[np.argmin(self.outcomes[:, 0])]
        done, median = len(self.points), float(np.median(outcomes[:, 0]))
        self.history.append(Generation(done, float(best[0]), median, float(best[-1])))
        self._watcher.now(done, done, self.history[-1])
