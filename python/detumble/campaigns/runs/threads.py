"""The threads of this process fly the shards of a campaign."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

from detumble.campaigns.runs.flying import Flown, fly_runs
from detumble.compiled import core
from detumble.surroundings import available_threads

if TYPE_CHECKING:
    from detumble.campaigns.recipe import Recipe
    from detumble.campaigns.runs.executor import PendingRuns


class Stopped(Exception):
    """The executor was closed while runs were flown."""


class ThreadExecutor:
    """Threads of this process: one shard is flown while the one before is written.

    Args:
        threads: number of threads; None for one on each processor that this process may use.
        backend: of the core; None takes the core's choice.
    """

    ahead = 2

    def __init__(self, threads: int | None, backend: str | None) -> None:
        self.threads = threads or available_threads()
        self.backend = backend
        self._pool = ThreadPoolExecutor(1, thread_name_prefix="shard")
        self._stopping = False
        self._completed = 0

    def submit(self, recipe: Recipe, first: int, count: int) -> PendingRuns:
        """Submit runs; they are flown after those submitted before."""
        return self._pool.submit(self._fly, recipe, first, count)

    def _fly(self, recipe: Recipe, first: int, count: int) -> Flown:
        try:
            self._progress(0)
            return fly_runs(recipe, first, count, threads=self.threads, backend=self.backend, progress=self._progress)
        finally:
            self._completed = 0

    def _progress(self, completed: int) -> None:
        self._completed = completed
        if self._stopping:
            raise Stopped

    def completed_runs(self) -> int:
        """Count the completed runs of the shard that is being flown."""
        return self._completed

    def about(self) -> dict[str, object]:
        """Give back end and number of threads."""
        return {"backend": self.backend or core().backends()[-1], "threads": self.threads}

    def close(self) -> None:
        """Stop the runs that are being flown, and drop those that are not."""
        self._stopping = True
        self._pool.shutdown(wait=True, cancel_futures=True)
