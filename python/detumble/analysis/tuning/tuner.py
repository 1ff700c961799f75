"""Tuning: the gains of a law that make an objective least over the starts of a campaign, within a budget of evaluations."""

from __future__ import annotations

import time
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from detumble.analysis.trials import Trials
from detumble.analysis.tuning.flights import Flights, Setting, header
from detumble.analysis.tuning.gains import mean_acceleration
from detumble.analysis.tuning.objective import Objective
from detumble.analysis.tuning.provenance import told
from detumble.analysis.tuning.record import Record
from detumble.analysis.tuning.search import minimise
from detumble.analysis.tuning.space import space_of
from detumble.checking import MOST_SEED, flag, instance, whole
from detumble.compiled import check_gains
from detumble.errors import RequestError
from detumble.scenario.core import case
from detumble.scenario.files import given
from detumble.scenario.model import Scenario

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

    from detumble.analysis.tuning.flights import Watcher
    from detumble.scenario.laws import Form


@dataclass(frozen=True)
class Generation:
    """How a search stood after a generation.

    Attributes:
        evaluations: made so far, the first of the scenario's own gains.
        best: least cost so far.
        median: of the costs of this generation.
        success: share of the starts in which the best one so far succeeds.
    """

    evaluations: int
    best: float
    median: float
    success: float


@dataclass(frozen=True)
class Worth:
    """What gains are worth on some runs.

    Attributes:
        cost: s or m/s; see `objective`.
        success: share of the runs that succeed.
    """

    cost: float
    success: float


@dataclass(frozen=True)
class Tuned:
    """What a search found.

    Attributes:
        scenario: with the gains that were found and how that was done, everything else untouched.
        initial: the scenario as the first candidate flew it: form, stack's set and held gains as asked for.
        law: whose gains they are.
        objective: what was made small.
        gains: found, by path within the law's table; `translation.exponent` is TSMC's p/q.
        initial_gains: that the search began with; of one that differs from axis to axis the geometric mean.
        cost: of the gains found, s or m/s; more than the horizon (or the ceiling of Δv, see `objective`) if too few runs succeed.
        initial_cost: of those it began with.
        success: share of the training starts in which they succeed.
        initial_success: likewise.
        history: generation by generation.
        evaluations: that were made.
        starts, seed, optimiser_seed: of the search.
        horizon: s.
        seconds: that it took, on the wall.
    """

    scenario: Scenario
    initial: Scenario
    law: str
    objective: Objective
    gains: dict[str, float]
    initial_gains: dict[str, float]
    cost: float
    initial_cost: float
    success: float
    initial_success: float
    history: tuple[Generation, ...]
    evaluations: int
    starts: int
    seed: int
    optimiser_seed: int
    horizon: float
    seconds: float

    @property
    def feasible(self) -> bool:
        """Whether enough of the training starts succeed."""
        return self.success >= self.objective.required

    def to_json(self) -> dict[str, Any]:
        """Give all but scenario and history as JSON takes it."""
        return {
            "scenario": self.scenario.title,
            "law": self.law,
            "form": getattr(self.scenario.laws, self.law).form,
            "objective": self.objective.what,
            "statistic": self.objective.statistic,
            "required": self.objective.required,
            "until": self.objective.end(self.scenario),
            "unit": self.objective.unit,
            "horizon_s": self.horizon,
            "starts": self.starts,
            "seed": self.seed,
            "optimiser_seed": self.optimiser_seed,
            "evaluations": self.evaluations,
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
        objective: what is made small; None is the mean time to capture, with at least 95 % of the runs successful.
        horizon: s after which a run has failed; None as `analysis.tuning.horizon` has it.
        form: of the law; None as the scenario says.
        stack: search for own gains of the stack (True), or for one set that it flies too (False); None as the scenario has it.
        fixed: gains that are held, by path: `{"alpha": 0.3}`; None holds one at what the scenario says.
        record: file that keeps every evaluation; its folder exists.
        resume: go on with the record; the result is that of a search that was never stopped.
        threads: to use; None for all processors.
        watcher: is told how it gets on.

    Raises:
        RequestError: an argument makes no sense, or the record is of another search or in use.
        ScenarioError: the scenario cannot be flown.
    """
    began = time.perf_counter()
    scenario, resume = given(scenario), flag("resume", resume)
    objective = Objective() if objective is None else instance("objective", objective, Objective, "an Objective")
    setting = Setting(budget, starts, seed, seed if optimiser_seed is None else optimiser_seed, horizon, threads)
    space = space_of(scenario, law, form=form, stack=stack, fixed=fixed)
    objective.end(space.base)
    check_gains(scenario.title, case(space.base, law))
    horizon = setting.resolved(space.base)
    with Record(
        record, header(space, setting, horizon, {"objective": asdict(objective)}), resume=resume, budget=budget
    ) as written:
        flights = Flights(space, setting, (objective,), written, watcher, horizon=horizon)
        initial = flights.own()
        minimise(lambda points: flights(points)[:, 0], space.point(space.own), budget - 1, setting.optimiser_seed)
    winner = int(np.argmin(flights.outcomes[:, 0]))
    cost, success = (float(number) for number in flights.outcomes[winner])
    reached = {objective.unit: cost} if success >= objective.required else {}
    gains = space.values(flights.points[winner].tolist()) if winner else space.own
    return Tuned(
        scenario=told(space, gains if winner else {}, setting, objective, horizon, success, reached),
        initial=space.base,
        law=law,
        objective=objective,
        gains=dict(gains),
        initial_gains=dict(space.own),
        cost=cost,
        initial_cost=float(initial[0]),
        success=success,
        initial_success=float(initial[-1]),
        history=tuple(_history(flights)),
        evaluations=len(flights.points),
        starts=starts,
        seed=seed,
        optimiser_seed=setting.optimiser_seed,
        horizon=horizon,
        seconds=time.perf_counter() - began,
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
        RequestError: the seed is that of the search or none that a campaign takes, or there are no runs.
    """
    runs, seed = whole("runs", runs, 1, 10**9), whole("seed", seed, 0, MOST_SEED)
    if seed == tuned.seed:
        raise RequestError(f"seed {seed}: is that of the search; other runs are needed to judge it")
    objective = tuned.objective
    acceleration = mean_acceleration(tuned.initial)

    def worth(scenario: Scenario) -> Worth:
        trials = Trials(scenario, seed, 0, runs, tuned.horizon, objective.end(scenario))
        judged = objective.judge(trials.fly(tuned.law, threads=threads), objective.ceiling(tuned.horizon, acceleration))
        return Worth(float(judged.cost[0]), float(judged.share[0]))

    return worth(tuned.initial), worth(tuned.scenario)


def _history(flights: Flights) -> list[Generation]:
    costs, shares, history, first = flights.outcomes[:, 0], flights.outcomes[:, -1], [], 0
    for end in flights.generations:
        best = int(np.argmin(costs[:end]))
        median = float(np.median(costs[first:end]))
        history.append(Generation(end, float(costs[best]), median, float(shares[best])))
        first = end
    return history
