"""The interface of executors of shards: threads of this process, or the workers of a Dask cluster."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from detumble.campaigns.recipe import Recipe
    from detumble.campaigns.runs.flying import Flown


class PendingRuns(Protocol):
    """Runs that were submitted."""

    def result(self, timeout: float | None = None) -> Flown:
        """Wait for the runs.

        Args:
            timeout: s; None waits as long as it takes.

        Raises:
            TimeoutError: the runs are not finished by then.
        """
        ...


class ShardExecutor(Protocol):
    """Flies shards, several at a time. The rows do not depend on the executor."""

    @property
    def ahead(self) -> int:
        """Number of shards to submit ahead of the one that is awaited, so that no worker is idle."""
        ...

    def submit(self, recipe: Recipe, first: int, count: int) -> PendingRuns:
        """Submit runs `first` to `first + count - 1` of a campaign."""
        ...

    def completed_runs(self) -> int:
        """Count the completed runs of unfinished shards; 0 where that is not known."""
        ...

    def about(self) -> dict[str, object]:
        """Give back end and workers, for the manifest."""
        ...

    def close(self) -> None:
        """Stop unfinished runs and free the workers."""
        ...
