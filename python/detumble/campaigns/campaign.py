"""A campaign from its recipe to its result: each shard is flown, written and counted."""

from __future__ import annotations

import atexit
import os
import platform
import shutil
import time
from collections import deque
from contextlib import closing, contextmanager
from pathlib import Path
from tempfile import mkdtemp
from typing import TYPE_CHECKING, Any

import polars as pl

from detumble.campaigns.recipe import SHARD, Recipe, arithmetic
from detumble.campaigns.result import CampaignResult, Effort
from detumble.campaigns.runs.threads import ThreadExecutor
from detumble.campaigns.statistics.running import Statistics
from detumble.campaigns.store.campaign_folder import Store
from detumble.campaigns.store.shard import frame_of
from detumble.checking import flag, met, plain, seed_number, thread_count, whole
from detumble.compiled import check_gains, checked_backend
from detumble.errors import RequestError
from detumble.progress import Watcher
from detumble.scenario.core import case
from detumble.scenario.files import given
from detumble.surroundings import check_polars
from detumble.writing import named_folder, reason

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from detumble.campaigns.runs.executor import PendingRuns, ShardExecutor
    from detumble.campaigns.runs.flying import Flown
    from detumble.scenario.model import Scenario

_REPORT_INTERVAL = 0.1
"""Seconds between two reports of progress."""


def campaign(
    scenario: Scenario | str | os.PathLike[str],
    law: str | None = None,
    runs: int = 1000,
    seed: int = 0,
    out: str | os.PathLike[str] | None = None,
    *,
    threads: int | None = None,
    scheduler: str | None = None,
    local_cluster: int | None = None,
    resume: bool = False,
    until_ci: float | None = None,
    backend: str | None = None,
    shard: int = SHARD,
    watcher: Watcher | None = None,
) -> CampaignResult:
    """Fly a scenario many times, each run with its own draws of what the scenario disperses and its own sensor noise.

    Args:
        scenario: a scenario, or what `load` takes.
        law: one of `LAWS`, or `none` for open loop; None is the only one that the scenario has gains for, else `prrl`.
        runs: how many; of a campaign that is continued at least those that it has. Run i is the same run whatever their number.
        seed: of all random numbers, 0 to 2^64 - 1.
        out: folder for the runs; None keeps them in a temporary one as long as the process lives.
        threads: of this process; None uses all processors.
        scheduler: address of a Dask scheduler whose workers fly instead.
        local_cluster: number of Dask workers to start on this machine instead.
        resume: continue the campaign that the folder holds.
        until_ci: stop once the half width of the 95 % interval of the success probability is no more than this.
        backend: `portable`, `avx2`, `avx512`; None takes the core's choice. Rows of the last two are the same.
        shard: runs that are flown, written and, after a break, kept as one. Rows do not depend on it.
        watcher: follows the progress; `found` of `Watcher.now` are the statistics so far.

    Returns:
        Statistics, and the runs to be read back.

    Raises:
        ScenarioError: the scenario cannot be flown.
        RequestError: an argument cannot be used, the folder is not writable, or holds another campaign; polars
            cannot work in this process (`surroundings`).
    """
    scenario, resume = given(scenario), flag("resume", resume)
    check_polars()
    law = scenario.laws.default if law is None else law
    runs, seed, shard = (
        whole("runs", runs, 1, 10**12),
        seed_number("seed", seed),
        whole("shard", shard, 1, 10**6),
    )
    threads = thread_count(threads)
    local_cluster = None if local_cluster is None else whole("local_cluster", local_cluster, 1, 4096)
    until_ci = None if until_ci is None else _half_width(until_ci)
    if sum(given is not None for given in (threads, local_cluster, scheduler)) > 1:
        raise RequestError("threads, scheduler and local_cluster: at most one of them says who flies")
    check_gains(scenario.title, case(scenario, law))
    recipe = Recipe(scenario.to_toml(), law, seed, shard=shard, arithmetic=arithmetic(checked_backend(backend)))
    watcher = watcher or Watcher()
    executor = _executor(threads, scheduler, local_cluster, backend)
    with closing(executor), _folder(out) as folder:
        about = executor.about() | {"machine": platform.machine(), "system": platform.platform()}
        with Store.create(folder, recipe, runs, about=about, resume=resume) as store:
            runs = max(runs, store.stored_runs())  # what is there already is counted too
            statistics, effort = _fly(store, executor, runs, until_ci, watcher)
        if out is None:
            atexit.register(shutil.rmtree, folder, ignore_errors=True)
        return CampaignResult(Store.open(folder), statistics, effort)


def _half_width(value: Any) -> float:
    number = plain(value)
    if isinstance(number, bool) or not isinstance(number, int | float) or not 0.0 < number < 0.5:
        raise RequestError(f"until_ci {met(value)}: must lie between 0 and 0.5, a half width of a probability")
    return float(number)


def _executor(
    threads: int | None, scheduler: str | None, local_cluster: int | None, backend: str | None
) -> ShardExecutor:
    if scheduler is None and local_cluster is None:
        return ThreadExecutor(threads, checked_backend(backend))
    from detumble.campaigns.runs.cluster import DaskExecutor

    return DaskExecutor(scheduler, local_cluster, backend)


@contextmanager
def _folder(out: str | os.PathLike[str] | None) -> Iterator[Path]:
    """Give the folder of the runs; a temporary one is removed if the campaign fails."""
    if out is not None:
        yield named_folder(out, "out")
        return
    try:
        temporary = Path(mkdtemp(prefix="detumble-"))
    except OSError as error:
        raise RequestError(
            f"the runs need a folder: no temporary one can be made ({reason(error)}); give `out`"
        ) from None
    try:
        yield temporary
    except BaseException:
        shutil.rmtree(temporary, ignore_errors=True)
        raise


def _fly(
    store: Store, executor: ShardExecutor, runs: int, until_ci: float | None, watcher: Watcher
) -> tuple[Statistics, Effort]:
    """Fly the missing shards; shards are written and counted in order, so a campaign has no gap up to its last run."""
    statistics = Statistics.of(store.recipe.parsed)
    effort = Effort()
    began = time.perf_counter()
    watcher.begin(runs)

    def report() -> None:
        completed = executor.completed_runs()
        watcher.now(statistics.runs + completed, effort.flown + completed, statistics)

    for index, work in _in_order(store, executor, runs, watcher):
        if isinstance(work, pl.DataFrame):
            rows = work
        else:
            flown = _awaited(work, report)
            rows = frame_of(flown.columns)
            store.write(index, rows)
            effort.count(rows.height, flown.ticks, flown.lane_ticks)
        statistics.add(rows)
        report()
        if until_ci is not None and statistics.first_narrow_enough(until_ci) is not None:
            break
    effort.seconds = time.perf_counter() - began
    return statistics, effort


def _in_order(
    store: Store, executor: ShardExecutor, runs: int, watcher: Watcher
) -> Iterator[tuple[int, PendingRuns | pl.DataFrame]]:
    """Give each shard in order: its rows if the folder has them, else the pending runs; a few are submitted ahead."""
    recipe = store.recipe
    ahead: deque[tuple[int, PendingRuns | pl.DataFrame]] = deque()
    for index in range(recipe.shards(runs)):
        span = recipe.runs_of(index, runs)
        rows = store.find(index, len(span), watcher.remark)
        ahead.append((index, executor.submit(recipe, span.start, len(span)) if rows is None else rows))
        if len(ahead) >= executor.ahead:
            yield ahead.popleft()
    yield from ahead


def _awaited(work: PendingRuns, report: Callable[[], None]) -> Flown:
    while True:
        try:
            return work.result(_REPORT_INTERVAL)
        except TimeoutError:
            report()
