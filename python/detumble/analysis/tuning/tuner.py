"""Tuning: the gains of a law that minimise an objective over the starts of a campaign, within a budget of evaluations."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from detumble.analysis.trials import Trials
from detumble.analysis.tuning.evolution import minimise
from detumble.analysis.tuning.gains import mean_acceleration
from detumble.analysis.tuning.objective import Objective
from detumble.analysis.tuning.record import Record
from detumble.analysis.tuning.search import Generation, Search
from detumble.analysis.tuning.setting import SearchResult, Setting
from detumble.analysis.tuning.space import space_of
from detumble.checking import instance, seed_number, thread_count, whole
from detumble.errors import RequestError
from detumble.scenario.files import given
from detumble.scenario.model import Scenario

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

    from detumble.progress import Watcher
    from detumble.scenario.laws import Form


@dataclass(frozen=True)
class Worth:
    """Cost and success of gains on some runs.

    Attributes:
        cost: s or m/s; see `objective`.
        success: share of the runs that succeed.
    """

    cost: float
    success: float


@dataclass(frozen=True)
class Tuned(SearchResult):
    """Gains that a search for the least of one objective found.

    Attributes:
        scenario: with the gains found and how that was done, everything else untouched.
        gains: found, by path within the law's table; `translation.exponent` is TSMC's p/q.
        initial_gains: that the search began with; of one that differs from axis to axis the geometric mean.
        cost: of the gains found, s or m/s; more than the horizon (or the ceiling of Δv, see `objective`) if too few runs succeed.
        initial_cost: of those it began with.
        success: share of the training starts in which the gains found succeed.
        initial_success: of those it began with.
        history: generation by generation.
    """

    scenario: Scenario
    gains: dict[str, float]
    initial_gains: dict[str, float]
    cost: float
    initial_cost: float
    success: float
    initial_success: float
    history: tuple[Generation, ...]

    @property
    def feasible(self) -> bool:
        """Whether enough of the training starts succeed."""
        return self.success >= self.objective.required

    def to_json(self) -> dict[str, Any]:
        """Give all but scenario and history as JSON takes it."""
        return self.setting.to_json() | {
            "unit": self.objective.unit,
            "initial": {"gains": self.initial_gains, "cost": self.initial_cost, "success": self.initial_success},
            "tuned": {"gains": self.gains, "cost": self.cost, "success": self.success},
            "seconds": self.seconds,
        }


def tune(
    scenario: Scenario | str | os.PathLike[str],
    law: str,
    *,
    budget: int = 2000,
    starts: int = 256,
    seed: int = 0,
    optimiser_seed: int | None = None,
    objective: Objective | None = None,
    horizon: float | None = None,
    form: Form | None = None,
    stack: bool | None = None,
    fixed: Mapping[str, float | None] | None = None,
    record: str | os.PathLike[str] | None = None,
    resume: bool = False,
    threads: int | None = None,
    watcher: Watcher | None = None,
) -> Tuned:
    """Search for a law's gains.

    Every candidate flies runs 0 to `starts` - 1 of the campaign of that seed, through the same noise. The first is the scenario
    as it stands, so on these starts the result is never worse. The same arguments give the same bits, whatever the threads.

    Args:
        scenario: nominal case with its dispersions, or its name or file.
        law: one of `LAWS`; without gains in the scenario the search begins in the middle of their ranges.
        budget: number of candidates.
        starts: runs that each of them flies.
        seed: of those runs.
        optimiser_seed: of the search; None is the same.
        objective: what is minimised; None is the mean time to capture, with at least 95 % of the runs successful.
        horizon: s after which a run has failed; None as `analysis.tuning.horizon` has it.
        form: of the law; None as the scenario says.
        stack: search for own gains of the stack (True), or for one set that it flies too (False); None as the scenario has it.
        fixed: gains that are held, by path: `{"alpha": 0.3}`; None holds one at what the scenario says.
        record: file that keeps every evaluation; its folder exists.
        resume: continue the record; the result is that of a search that was never stopped.
        threads: to use; None for all processors.
        watcher: follows the progress; `found` of `Watcher.now` is the last `Generation`.

    Raises:
        RequestError: an argument makes no sense, or the record is of another search or in use.
        ScenarioError: the scenario cannot be flown.
    """
    began, threads = time.perf_counter(), thread_count(threads)
    objective = Objective() if objective is None else instance("objective", objective, Objective, "an Objective")
    space = space_of(given(scenario), law, form=form, stack=stack, fixed=fixed)
    setting = Setting.of(
        space,
        (objective,),
        budget=budget,
        starts=starts,
        seed=seed,
        optimiser_seed=optimiser_seed,
        horizon=horizon,
    )
    with Record(record, setting.header(), resume=resume, budget=setting.budget) as written:
        search = Search(setting, written, threads, watcher)
        search.begin()
        minimise(lambda points: search(points)[:, 0], search.points[0], setting.budget - 1, setting.optimiser_seed)
    winner = int(np.argmin(search.outcomes[:, 0]))
    (initial_cost, initial_success), (cost, success) = search.outcomes[[0, winner]].tolist()
    reached = {objective.unit: cost} if success >= objective.required else {}
    gains = search.gains(winner)
    return Tuned(
        setting=setting,
        seconds=time.perf_counter() - began,
        scenario=setting.scenario(gains if winner else {}, success, reached),
        gains=gains,
        initial_gains=search.gains(0),
        cost=cost,
        initial_cost=initial_cost,
        success=success,
        initial_success=initial_success,
        history=tuple(search.history),
    )


def held_out(tuned: Tuned, runs: int, seed: int, *, threads: int | None = None) -> tuple[Worth, Worth]:
    """Judge the gains that a search began with and those it found on runs that it has not seen.

    Args:
        tuned: what the search found.
        runs: how many, 0 to `runs` - 1 of another campaign.
        seed: of that campaign; not the search's own.
        threads: to use; None for all processors.

    Returns:
        Before, and after; by the search's own objective and horizon.

    Raises:
        RequestError: the seed is that of the search or no seed at all, or there are no runs.
    """
    runs, seed = whole("runs", runs, 1, 10**9), seed_number("seed", seed)
    if seed == tuned.seed:
        raise RequestError(f"seed {seed}: is that of the search; other runs are needed to judge it")
    objective = tuned.objective
    acceleration = mean_acceleration(tuned.initial)

    def worth(scenario: Scenario) -> Worth:
        trials = Trials(scenario, seed, 0, runs, tuned.horizon, objective.end(scenario))
        judged = objective.judge(trials.fly(tuned.law, threads=threads), objective.ceiling(tuned.horizon, acceleration))
        return Worth(float(judged.cost[0]), float(judged.share[0]))

    return worth(tuned.initial), worth(tuned.scenario)
