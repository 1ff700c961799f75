"""Who flies the shards of a campaign: this process, or the workers of a Dask cluster. One interface, the same rows."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Protocol

from detumble.campaigns.runs.flying import Flown, fly_runs
from detumble.surroundings import available_threads

if TYPE_CHECKING:
    from detumble.campaigns.runs.recipe import Recipe


class Promise(Protocol):
    """Runs that are being flown."""

    def result(self, timeout: float | None = None) -> Flown:
        """Wait for them; TimeoutError when that takes longer than `timeout` seconds."""
        ...


class Crew(Protocol):
    """Flies shards, several at a time."""

    @property
    def ahead(self) -> int:
        """Shards to have in hand at once, so that nobody waits."""
        ...

    def submit(self, recipe: Recipe, first: int, count: int) -> Promise:
        """Have runs flown."""
        ...

    def landed(self) -> int:
        """Count the runs landed of shards that are not finished yet, as far as that is known."""
        ...

    def about(self) -> dict[str, object]:
        """Tell who flies, for the manifest."""
        ...

    def close(self) -> None:
        """Break off what is still flying, and let the workers go."""
        ...


class Stopped(Exception):
    """The work was broken off."""


class Threads:
    """The threads of this process: one shard flies while the one before is written.

    Args:
        threads: to use; None for as many as this process may use.
        backend: of the core.
    """

    def __init__(self, threads: int | None, backend: str | None) -> None:
        self.threads = threads or available_threads()
        self.backend = backend
        self._pool = ThreadPoolExecutor(1, thread_name_prefix="shard")
        self._stopping = False
        self._landed = 0

    @property
    def ahead(self) -> int:
        """One shard flies while the one before is written."""
        return 2

    def submit(self, recipe: Recipe, first: int, count: int) -> Promise:
        """Have runs flown once those before them are."""
        return self._pool.submit(self._fly, recipe, first, count)

    def _fly(self, recipe: Recipe, first: int, count: int) -> Flown:
        try:
            self._glance(0)
            return fly_runs(recipe, first, count, threads=self.threads, backend=self.backend, progress=self._glance)
        finally:
            self._landed = 0

    def _glance(self, landed: int) -> None:
        self._landed = landed
        if self._stopping:
            raise Stopped

    def landed(self) -> int:
        """Count the runs landed of the shard that flies."""
        return self._landed

    def about(self) -> dict[str, object]:
        """Tell who flies."""
        from detumble.compiled import core

        return {"backend": self.backend or core().backends()[-1], "threads": self.threads}

    def close(self) -> None:
        """Break off what is still flying."""
        self._stopping = True
        self._pool.shutdown(wait=True, cancel_futures=True)
