"""Time against Δv: the gains of a law that are not beaten in both.

One search after another makes the augmented weighted Tchebycheff distance small (Steuer & Choo 1983),

    max(w f_t, (1 - w) f_v) + 0.01 (f_t + f_v),     f = (J - J_best) / (J_worst - J_best)

J being the cost of time and of Δv as `objective` has it, best and worst those of the front so far. The weights w go from the fast
end to the frugal one, after both ends themselves have been searched for; each search begins with the best candidate so far by
its own measure, and all share one budget. The front is taken from all candidates that any of them flew. One that succeeds in too
few starts is worse by any weight than all that succeed in enough.
"""

from __future__ import annotations

import time
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from detumble.analysis.tuning.flights import Flights, Setting, header
from detumble.analysis.tuning.objective import Objective
from detumble.analysis.tuning.provenance import told
from detumble.analysis.tuning.record import Record
from detumble.analysis.tuning.search import STEP, minimise
from detumble.analysis.tuning.space import space_of
from detumble.checking import flag, whole
from detumble.compiled import check_gains
from detumble.scenario.core import case
from detumble.scenario.files import given
from detumble.scenario.model import Scenario

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping, Sequence

    from detumble.analysis.tuning.flights import Watcher
    from detumble.analysis.tuning.objective import Until
    from detumble.analysis.tuning.space import Space
    from detumble.scenario.laws import Form

Array = NDArray[np.float64]
NEAR = 0.1
"""Step of a search that begins with its neighbour's best."""


@dataclass(frozen=True)
class Compromise:
    """One point of a front.

    Attributes:
        time: s.
        delta_v: to capture, m/s.
        success: share of the training starts.
        gains: by path within the law's table.
    """

    time: float
    delta_v: float
    success: float
    gains: dict[str, float]


@dataclass(frozen=True)
class Front:
    """The compromises that no candidate of the search beats in both time and Δv.

    Attributes:
        points: from the fastest to the most frugal; none where no candidate succeeds in enough of the starts.
        law: whose gains they are.
        objective: of the time; that of Δv differs in nothing else.
        initial: the scenario as the first candidate flew it.
        evaluations, starts, seed, optimiser_seed: of the search.
        horizon: s.
        seconds: that it took, on the wall.
    """

    points: tuple[Compromise, ...]
    law: str
    objective: Objective
    initial: Scenario
    evaluations: int
    starts: int
    seed: int
    optimiser_seed: int
    horizon: float
    seconds: float
    _space: Space
    _setting: Setting

    def scenario(self, place: int) -> Scenario:
        """Give the scenario with the gains of one of the points."""
        point = self.points[place]
        reached = {"s": point.time, "m/s": point.delta_v}
        return told(
            self._space, point.gains, self._setting, self.objective, self.horizon, point.success, reached, "pareto"
        )

    def spread(self, count: int) -> list[int]:
        """Choose some of the points, evenly along the front by its length, both ends among them."""
        if len(self.points) <= count:
            return list(range(len(self.points)))
        place = np.array([[point.time, point.delta_v] for point in self.points])
        steps = np.linalg.norm(np.diff(place / np.ptp(place, axis=0), axis=0), axis=1)
        along = np.concatenate(([0.0], np.cumsum(steps)))
        wanted = np.linspace(0.0, along[-1], count)
        return sorted({int(np.argmin(np.abs(along - at))) for at in wanted})

    def rows(self) -> list[dict[str, float]]:
        """Give the front as a table: a row for each point, its gains under their paths."""
        return [
            {"time_s": point.time, "delta_v_m_s": point.delta_v, "success": point.success, **point.gains}
            for point in self.points
        ]

    def to_json(self) -> dict[str, Any]:
        """Give the front as JSON takes it."""
        return {
            "scenario": self.initial.title,
            "law": self.law,
            "form": getattr(self.initial.laws, self.law).form,
            "objective": "pareto",
            "time": self.objective.what,
            "statistic": self.objective.statistic,
            "required": self.objective.required,
            "until": self.objective.end(self.initial),
            "horizon_s": self.horizon,
            "starts": self.starts,
            "seed": self.seed,
            "optimiser_seed": self.optimiser_seed,
            "evaluations": self.evaluations,
            "front": self.rows(),
            "seconds": self.seconds,
        }


def pareto_front(
    scenario: Scenario | str | os.PathLike[str],
    law: str,
    *,
    budget: int = 4000,
    weights: int = 9,
    starts: int = 256,
    seed: int = 0,
    optimiser_seed: int | None = None,
    what: Literal["capture", "settling"] = "capture",
    percentile: float | None = None,
    required: float = 0.95,
    until: Until | None = None,
    horizon: float | None = None,
    form: Form | None = None,
    stack: bool | None = None,
    fixed: Mapping[str, float | None] | None = None,
    record: str | os.PathLike[str] | None = None,
    resume: bool = False,
    threads: int | None = None,
    watcher: Watcher | None = None,
) -> Front:
    """Search for the compromises between time and Δv to capture that a law's gains allow.

    Args:
        budget: number of candidates in all.
        weights: searches that share it, both ends among them; at least 2.
        what: the time: `capture`, or `settling`, from the start until settled.
        percentile, required, until: as of `Objective`, for time and Δv alike.
        scenario, law, starts, seed, optimiser_seed, horizon, form, stack, fixed, record, resume, threads, watcher: as of `tune`.

    Raises:
        RequestError: an argument makes no sense, or the record is of another search or in use.
        ScenarioError: the scenario cannot be flown.
    """
    began = time.perf_counter()
    weights = whole("weights", weights, 2, 1000)  # both ends at least
    scenario, resume = given(scenario), flag("resume", resume)
    setting = Setting(budget, starts, seed, seed if optimiser_seed is None else optimiser_seed, horizon, threads)
    space = space_of(scenario, law, form=form, stack=stack, fixed=fixed)
    objectives = (Objective(what, percentile, required, until), Objective("delta_v", percentile, required, until))
    objectives[0].end(space.base)
    check_gains(scenario.title, case(space.base, law))
    horizon = setting.resolved(space.base)
    about = {"objective": asdict(objectives[0]) | {"what": f"pareto, {what}"}, "budget": budget, "weights": weights}
    with Record(record, header(space, setting, horizon, about), resume=resume, budget=budget) as written:
        flights = Flights(space, setting, objectives, written, watcher, horizon=horizon)
        flights.own()
        _sweep(flights, budget - 1, setting.optimiser_seed, _order(weights))
    best = [
        Compromise(
            time=float(flights.outcomes[place, 0]),
            delta_v=float(flights.outcomes[place, 1]),
            success=float(flights.outcomes[place, 2]),
            gains=space.values(flights.points[place].tolist()) if place else dict(space.own),
        )
        for place in undominated(flights.outcomes[:, :2], flights.ceilings)
    ]
    return Front(
        points=tuple(best),
        law=law,
        objective=objectives[0],
        initial=space.base,
        evaluations=len(flights.points),
        starts=starts,
        seed=seed,
        optimiser_seed=setting.optimiser_seed,
        horizon=horizon,
        seconds=time.perf_counter() - began,
        _space=space,
        _setting=setting,
    )


def undominated(costs: Array, ceilings: Array) -> list[int]:
    """Find the feasible candidates that no other beats in both costs.

    Args:
        costs: (k, 2).
        ceilings: (2,): more is infeasible.

    Returns:
        Their places, the fastest first; of equal ones the first.
    """
    feasible = np.flatnonzero((costs <= ceilings).all(axis=1))
    front: list[int] = []
    for place in feasible[np.lexsort((feasible, costs[feasible, 1], costs[feasible, 0]))]:
        if not front or costs[place, 1] < costs[front[-1], 1]:
            front.append(int(place))
    return front


def _order(weights: int) -> Sequence[float]:
    """The ends first, then from the fast one to the frugal one."""
    between = np.linspace(1.0, 0.0, weights)[1:-1]
    return [1.0, 0.0, *(float(weight) for weight in between)]


def _sweep(flights: Flights, budget: int, seed: int, weights: Sequence[float]) -> None:
    for number, weight in enumerate(weights):
        share = budget // len(weights) + (number < budget % len(weights))
        measure = _measure(flights.outcomes[:, :2], flights.ceilings, weight)
        so_far = measure(flights.outcomes[:, :2])
        start = flights.points[int(np.argmin(so_far))]
        minimise(
            lambda points, measure=measure: measure(flights(points)[:, :2]),  # type: ignore[misc]  # binds this one
            start,
            share,
            seed + number,
            step=STEP if number == 0 else NEAR,
        )


def _measure(costs: Array, ceilings: Array, weight: float) -> Any:
    """Give the distance of costs (k, 2) by one weight, as a function; shape (k,)."""
    front = costs[undominated(costs, ceilings)]
    best = front.min(axis=0) if len(front) else np.zeros(2)
    span = np.ptp(front, axis=0) if len(front) else np.zeros(2)
    span = np.where(span > 0.0, span, ceilings)
    weights = np.array([weight, 1.0 - weight])

    def distance(costs: Array) -> Array:
        scaled = (costs - best) / span
        near = (weights * scaled).max(axis=1) + 0.01 * scaled.sum(axis=1)
        feasible = (costs <= ceilings).all(axis=1)
        # beyond anything that a feasible candidate can come to
        far = 2.0 * (ceilings / span).sum() + (costs / ceilings).sum(axis=1)
        return np.asarray(np.where(feasible, near, far))

    return distance
