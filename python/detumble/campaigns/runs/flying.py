"""Runs of a campaign, from its recipe to the rows of its table. The rows do not depend on where and how they are flown."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from detumble.campaigns.columns import END_TIME, FAILURE, INDEX, SCALARS, SUCCEEDED, drawn_table
from detumble.campaigns.recipe import WIDE, arithmetic
from detumble.campaigns.runs.draws import draw, drawn_scenario
from detumble.campaigns.runs.overlay import overlay
from detumble.checking import whole
from detumble.compiled import core
from detumble.errors import RequestError, ScenarioError
from detumble.failures import CODES, SUCCESS, cause
from detumble.scenario.core import case

if TYPE_CHECKING:
    from collections.abc import Callable

    from detumble.campaigns.recipe import Recipe
    from detumble.flight import Flight

_CAUSES = np.full(max(CODES) + 1, None, dtype=object)
_CAUSES[list(CODES)] = [cause(code) for code in CODES]


@dataclass(frozen=True)
class Flown:
    """Runs that were flown.

    Attributes:
        columns: rows of the table, in order of index.
        ticks: control ticks in these runs.
        lane_ticks: ticks that the lanes flew meanwhile, idle ones included.
    """

    columns: dict[str, Any]
    ticks: int
    lane_ticks: int


def fly_runs(
    recipe: Recipe,
    first: int,
    count: int,
    *,
    threads: int = 1,
    backend: str | None = None,
    progress: Callable[[int], None] | None = None,
) -> Flown:
    """Fly runs `first` to `first + count - 1` of a campaign.

    Args:
        recipe: of the campaign.
        first: index of the first run.
        count: number of runs.
        threads: to use.
        backend: `portable`, `avx2`, `avx512`; None takes the core's choice.
        progress: called repeatedly with the number of completed runs; an exception that it raises stops the work.

    Raises:
        ScenarioError: the scenario cannot be flown.
        RequestError: rows of this back end differ in their last bits from the campaign's.
    """
    backend = suitable(recipe, backend)
    scenario = recipe.parsed
    nominal = case(scenario, recipe.law, until_the_end=False)
    drawn = draw(scenario, recipe.seed, first, count)
    differing = overlay(scenario, recipe.law, drawn)
    try:
        flown = core().fly_many(
            nominal,
            differing,
            count,
            seed=recipe.seed,
            first_index=first,
            threads=threads,
            backend=backend,
            progress=progress,
        )
    except ValueError as error:
        raise ScenarioError(scenario.title, problem=str(error)) from None

    columns: dict[str, Any] = {INDEX.name: np.arange(first, first + count, dtype=np.uint64)}
    columns |= drawn_table(drawn)
    columns[SUCCEEDED.name] = flown["failure"] == SUCCESS
    columns[FAILURE.name] = _CAUSES[flown["failure"]].tolist()
    columns[END_TIME.name] = flown["end_time"]
    columns |= {metric.key: flown[metric.name] for metric in SCALARS}
    return Flown(columns, flown["ticks"], flown["lane_ticks"])


def fly_again(recipe: Recipe, index: int, *, backend: str | None = None) -> Flight:
    """Fly one run of a campaign again, bit for bit, and keep its full history.

    Args:
        recipe: of the campaign.
        index: of the run.
        backend: as in `fly_runs`.

    Returns:
        The flight; its scenario holds the drawn values.

    Raises:
        ScenarioError: the scenario cannot be flown.
        RequestError: rows of this back end differ in their last bits from the campaign's.
    """
    from detumble.simulation import Setup, fly_case

    backend = suitable(recipe, backend)
    scenario = recipe.parsed
    differing = overlay(scenario, recipe.law, draw(scenario, recipe.seed, index, 1))
    core_case = case(scenario, recipe.law, until_the_end=False)
    for path, row in differing.items():
        _put(core_case, path, row[0].tolist())
    own = drawn_scenario(scenario, recipe.seed, index)
    return fly_case(Setup(own, recipe.law, recipe.seed, index, backend), core_case, list(differing))


def suitable(recipe: Recipe, backend: str | None) -> str | None:
    """Give a back end whose rows are bitwise those of the campaign; None leaves the choice among several to the core.

    Raises:
        RequestError: the rows of the given back end differ, or this machine has no suitable one.
    """
    if backend is not None and arithmetic(backend) != recipe.arithmetic:
        raise RequestError(
            f"backend {backend}: its rows would differ in the last bits from those of this campaign ({recipe.arithmetic})"
        )
    if recipe.arithmetic == "wide" and WIDE not in core().backends():
        raise RequestError(
            "this processor has no AVX2: its rows would differ in the last bits; use --backend portable throughout"
        )
    return "portable" if recipe.arithmetic == "portable" else backend


def _put(table: dict[str, Any], path: str, row: list[float]) -> None:
    *parents, name = path.split(".")
    for parent in parents:
        table = table[parent]
    if name.endswith("inertia"):
        table[name] = [row[0:3], row[3:6], row[6:9]]
    else:
        table[name] = row if isinstance(table[name], list) else row[0]


def checked_index(index: int, runs: int) -> int:
    """Check that a campaign has a run.

    Raises:
        RequestError: it has no such run.
    """
    return whole("run", index, 0, runs - 1, f"the campaign has runs 0 to {runs - 1}")
