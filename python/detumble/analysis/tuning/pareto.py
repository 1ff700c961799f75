"""Time against Δv: the Pareto-optimal gains of a law.

One search after another minimises the augmented weighted Tchebycheff distance small (Steuer & Choo 1983),

    max(w f_t, (1 - w) f_v) + 0.01 (f_t + f_v),     f = (J - J_best) / (J_worst - J_best)

J being the cost of time and of Δv as `objective` has it, best and worst those of the front so far. The weights w go from the fast
end to the one of least Δv, after both ends themselves have been searched for; each search begins with the best candidate so far
by its own measure, and all share one budget. The front is taken from all candidates that any of them flew. One that succeeds in
too few starts is worse by any weight than all that succeed in enough.
"""

from __future__ import annotations

import time
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from detumble.analysis.tuning.evolution import STEP, minimise
from detumble.analysis.tuning.objective import Objective
from detumble.analysis.tuning.record import Record
from detumble.analysis.tuning.search import Search
from detumble.analysis.tuning.setting import SearchResult, Setting
from detumble.analysis.tuning.space import space_of
from detumble.checking import thread_count, whole
from detumble.scenario.files import given

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Mapping, Sequence

    from detumble.analysis.tuning.objective import Until
    from detumble.progress import Watcher
    from detumble.scenario.laws import Form
    from detumble.scenario.model import Scenario

Array = NDArray[np.float64]
NEAR = 0.1
"""Initial step of a search that begins with the best candidate of an earlier one."""


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
class Front(SearchResult):
    """The compromises that no candidate of the search beats in both time and Δv.

    Attributes:
        points: from the fastest to the one of least Δv; none where no candidate succeeds in enough of the starts.
    """

    points: tuple[Compromise, ...]

    def scenario(self, place: int) -> Scenario:
        """Give the scenario with the gains of one of the points."""
        point = self.points[place]
        reached = {"s": point.time, "m/s": point.delta_v}
        return self.setting.scenario(point.gains, point.success, reached, "pareto")

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
        return self.setting.to_json() | {
            "objective": "pareto",
            "time": self.objective.what,
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
    began, threads = time.perf_counter(), thread_count(threads)
    weights = whole("weights", weights, 2, 1000)  # both ends at least
    space = space_of(given(scenario), law, form=form, stack=stack, fixed=fixed)
    setting = Setting.of(
        space,
        (Objective(what, percentile, required, until), Objective("delta_v", percentile, required, until)),
        budget=budget,
        starts=starts,
        seed=seed,
        optimiser_seed=optimiser_seed,
        horizon=horizon,
    )
    objective = asdict(setting.objective) | {"what": f"pareto, {what}"}
    header = setting.header({"objective": objective, "budget": setting.budget, "weights": weights})
    with Record(record, header, resume=resume, budget=setting.budget) as written:
        search = Search(setting, written, threads, watcher)
        search.begin()
        _sweep(search, _order(weights))
    points = []
    for place in undominated(search.outcomes[:, :2], search.ceilings):
        duration, delta_v, success = search.outcomes[place].tolist()
        points.append(Compromise(duration, delta_v, success, search.gains(place)))
    return Front(setting=setting, seconds=time.perf_counter() - began, points=tuple(points))


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
    """The ends first, then from the fast one to the one of least Δv."""
    between = np.linspace(1.0, 0.0, weights)[1:-1]
    return [1.0, 0.0, *(float(weight) for weight in between)]


def _sweep(search: Search, weights: Sequence[float]) -> None:
    """Search by one weight after another; the first ones get what is left of a budget that cannot be shared evenly."""
    least, left = divmod(search.setting.budget - 1, len(weights))
    for index, weight in enumerate(weights):
        costs = search.outcomes[:, :2]
        measure = _measure(costs, search.ceilings, weight)
        minimise(
            lambda points, measure=measure: measure(search(points)[:, :2]),  # type: ignore[misc]  # binds this one
            search.points[int(np.argmin(measure(costs)))],
            least + (index < left),
            search.setting.optimiser_seed + index,
            step=STEP if index == 0 else NEAR,
        )


def _measure(costs: Array, ceilings: Array, weight: float) -> Callable[[Array], Array]:
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
        # more than any feasible candidate can have
        far = 2.0 * (ceilings / span).sum() + (costs / ceilings).sum(axis=1)
        return np.asarray(np.where(feasible, near, far))

    return distance
