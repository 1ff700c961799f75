"""Candidates of a search flown from the training starts, all of one generation in one batch, each evaluation on record."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from detumble.analysis.trials import Trials
from detumble.analysis.tuning.gains import mean_acceleration
from detumble.analysis.tuning.horizon import default_horizon
from detumble.campaigns.recipe import arithmetic
from detumble.checking import MOST_SEED, real, wholes
from detumble.version import __version__

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from detumble.analysis.trials import Results
    from detumble.analysis.tuning.objective import Objective
    from detumble.analysis.tuning.record import Record
    from detumble.analysis.tuning.space import Space
    from detumble.scenario.model import Scenario

Array = NDArray[np.float64]


class Watcher(Protocol):
    """Is told how a search gets on."""

    def begin(self, budget: int) -> None:
        """So many evaluations will be made."""
        ...

    def now(self, done: int, cost: float, share: float) -> None:
        """So many are made; the best candidate so far costs `cost`, and succeeds in a share of the starts."""
        ...


@dataclass(frozen=True)
class Setting:
    """What every candidate of a search meets.

    Attributes:
        starts: runs 0 to starts - 1 of the campaign.
        seed: of that campaign.
        horizon: s; None finds one, see `horizon`.
        optimiser_seed: of the search itself.
        budget: evaluations; one is one candidate flown from all starts.
        threads: to use; None for all processors. They do not reach the results.
    """

    budget: int
    starts: int
    seed: int
    optimiser_seed: int
    horizon: float | None
    threads: int | None = None

    def __post_init__(self) -> None:
        """Refuse what makes no sense.

        Raises:
            RequestError: naming the argument.
        """
        wholes(self, budget=(1, 10**9), starts=(1, 10**6), seed=(0, MOST_SEED), optimiser_seed=(0, MOST_SEED))
        if self.threads is not None:
            wholes(self, threads=(1, 4096))
        if self.horizon is not None:
            object.__setattr__(self, "horizon", real("horizon", self.horizon, above=0.0, unit="s"))

    def resolved(self, scenario: Scenario) -> float:
        """Give the horizon, s: at most the scenario's duration."""
        found = default_horizon(scenario, self.seed, self.starts) if self.horizon is None else self.horizon
        return float(min(found, scenario.time.duration))


class Flights:
    """Flies candidates and judges them by one or several objectives that agree on what a success is.

    Args:
        space: the gains that are searched for.
        setting: what every candidate meets.
        objectives: by which costs are counted.
        record: of the evaluations.
        watcher: is told after each generation.

    Attributes:
        horizon: s.
        ceilings: the most that a feasible candidate can cost, of each objective.
        points: (k, n) of all candidates so far; the first, the scenario's own gains, stands there by its nearest point.
        outcomes: (k, m + 1): costs by the m objectives, and the share of successes.
        generations: how many candidates were judged after each generation.
    """

    def __init__(
        self,
        space: Space,
        setting: Setting,
        objectives: Sequence[Objective],
        record: Record,
        watcher: Watcher | None = None,
        *,
        horizon: float,
    ) -> None:
        self.space = space
        self.horizon = horizon
        self.objectives = objectives
        acceleration = mean_acceleration(space.base)
        self.ceilings = np.array([objective.ceiling(horizon, acceleration) for objective in objectives])
        self.points = np.empty((0, len(space.tunables)))
        self.outcomes = np.empty((0, len(objectives) + 1))
        self.generations: list[int] = []
        self._record = record
        self._threads = setting.threads
        self._watcher = watcher
        end = objectives[0].end(space.base)
        self._trials = Trials(space.base, setting.seed, 0, setting.starts, horizon, end)
        if watcher:
            watcher.begin(setting.budget)

    def own(self) -> Array:
        """Fly the scenario's own gains, as they stand there; gives their outcome (m + 1,)."""
        outcome = self._record.known(np.empty((1, 0)))
        if not len(outcome):
            outcome = self._judged(self._trials.fly(self.space.law, threads=self._threads))
            self._record.append(np.empty((1, 0)), outcome)
        self._keep(self.space.point(self.space.own)[None, :], outcome)
        own: Array = outcome[0]
        return own

    def __call__(self, points: Array) -> Array:
        """Fly candidates.

        Args:
            points: (k, n) of the unit cube.

        Returns:
            Outcomes (k, m + 1), those on record as they are there.
        """
        outcomes = self._record.known(points).reshape(-1, len(self.objectives) + 1)
        rest = points[len(outcomes) :]
        if len(rest):
            flown = self._trials.fly(self.space.law, self.space.columns(rest), threads=self._threads)
            new = self._judged(flown)
            self._record.append(rest, new)
            outcomes = np.concatenate((outcomes, new))
        self._keep(points, outcomes)
        return outcomes

    def _judged(self, results: Results) -> Array:
        pairs = zip(self.objectives, self.ceilings, strict=True)
        judged = [objective.judge(results, float(ceiling)) for objective, ceiling in pairs]
        return np.column_stack([*(one.cost for one in judged), judged[0].share])

    def _keep(self, points: Array, outcomes: Array) -> None:
        self.points = np.concatenate((self.points, points))
        self.outcomes = np.concatenate((self.outcomes, outcomes))
        self.generations.append(len(self.points))
        if self._watcher:
            best = self.outcomes[np.argmin(self.outcomes[:, 0])]
            self._watcher.now(len(self.points), float(best[0]), float(best[-1]))


def header(space: Space, setting: Setting, horizon: float, about: Mapping[str, Any]) -> dict[str, Any]:
    """Say what is searched, for the record: all that reaches the outcomes, and the order in which they are asked for."""
    import hashlib
    from importlib.metadata import version

    return {
        "law": space.law,
        "gains": [tunable.path for tunable in space.tunables],
        "scenario": hashlib.sha256(space.base.to_toml().encode()).hexdigest(),
        **about,
        "starts": setting.starts,
        "seed": setting.seed,
        "optimiser_seed": setting.optimiser_seed,
        "horizon_s": horizon,
        "detumble": __version__,
        "cma": version("cma"),
        "numpy": np.__version__,
        "arithmetic": arithmetic(None),
    }
