"""The workers of a Dask cluster fly the shards; this process writes them. Rows are those of a local campaign, to the bit."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from detumble.campaigns.flying import Flown, fly_runs
from detumble.campaigns.recipe import Recipe
from detumble.compiled import core
from detumble.errors import RequestError

if TYPE_CHECKING:
    from detumble.campaigns.crews import Promise

WORKER_LOSSES = 1000
"""Workers that may die over one shard before it is given up; Dask's own default is 3."""
_CONNECT_SECONDS = 30
_QUIET = {"dashboard": False, "dashboard_address": "127.0.0.1:0"}
"""No dashboard, and no complaint where another cluster has its port."""
_SETTINGS = {
    "distributed.scheduler.allowed-failures": WORKER_LOSSES,
    # a terminal tells Ctrl-C to all processes; the workers end when this one closes the cluster
    "distributed.worker.preload": ["import signal\nsignal.signal(signal.SIGINT, signal.SIG_IGN)"],
}


class Cluster:
    """The workers of a Dask scheduler.

    Args:
        scheduler: its address; None starts one on this machine, bound to loopback, with `workers` workers.
        workers: processes to start, one thread each.
        backend: of the core on every worker; None takes the best that each has, `portable` if there is no better one here.

    Raises:
        RequestError: Dask is not installed, or the scheduler cannot be reached.
    """

    def __init__(self, scheduler: str | None, workers: int | None, backend: str | None) -> None:
        try:
            import dask
            import distributed
        except ImportError:
            raise RequestError("Dask is not installed; install detumble[cluster]") from None
        self._wide = backend != "portable" if backend else "avx2" in core().backends()
        self._backend = backend or (None if self._wide else "portable")
        self._local: Any = None
        if scheduler is None:
            try:
                with dask.config.set(_SETTINGS):
                    self._local = distributed.LocalCluster(  # type: ignore[no-untyped-call]  # Dask has no types here
                        n_workers=workers,
                        threads_per_worker=1,
                        host="127.0.0.1",
                        silence_logs=50,
                        scheduler_kwargs=_QUIET,
                    )
            except RuntimeError as error:  # Dask's workers begin by importing the script that is being run
                raise RequestError(
                    f"local_cluster {workers}: cannot be started: {error} In a script, fly the campaign beneath "
                    '`if __name__ == "__main__":`'
                ) from None
        try:
            self._client: Any = distributed.Client(  # type: ignore[no-untyped-call]  # likewise
                self._local or scheduler, timeout=_CONNECT_SECONDS
            )
        except (OSError, ValueError) as error:
            raise RequestError(f"scheduler {scheduler}: cannot be reached: {error}") from None

    @property
    def ahead(self) -> int:
        """Three shards for each worker: one that it flies, one that it has, one on its way back."""
        return 3 * max(1, len(self._client.nthreads()))

    def submit(self, recipe: Recipe, first: int, count: int) -> Promise:
        """Have runs flown by a worker; one that dies over them is replaced by another."""
        key = f"{recipe.identity}-{first}"
        promise: Promise = self._client.submit(
            fly_shard, recipe.to_dict(), first, count, self._backend, self._wide, key=key
        )
        return promise

    def landed(self) -> int:
        """Nothing is known of shards in progress."""
        return 0

    def about(self) -> dict[str, object]:
        """Tell who flies."""
        workers = len(self._client.nthreads())
        return {
            "backend": self._backend or "each worker's best",
            "workers": workers,
            "address": self._client.scheduler.address,
        }

    def close(self) -> None:
        """Drop what is not finished, and stop the workers that were started here."""
        self._client.close()
        if self._local:
            self._local.close()


def fly_shard(recipe: dict[str, Any], first: int, count: int, backend: str | None, wide: bool) -> Flown:
    """Fly runs on a worker.

    Args:
        recipe: of the campaign, as `Recipe.to_dict` gives it.
        first: index of the first run.
        count: number of runs.
        backend: of the core.
        wide: the rows are to be those of the wide back ends, to the bit.

    Raises:
        RequestError: this worker's rows would be others.
    """
    import detumble

    if detumble.__version__ != recipe["version"]:
        raise RequestError(
            f"a worker has detumble {detumble.__version__}, the campaign {recipe['version']}: runs might differ"
        )
    if wide and "avx2" not in core().backends():
        raise RequestError(
            "a worker's processor has no AVX2: its rows would differ in the last bits; use --backend portable throughout"
        )
    return fly_runs(Recipe(**recipe), first, count, backend=backend)
