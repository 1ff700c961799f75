"""The workers of a Dask cluster fly the shards of a campaign; this process writes them. Rows are bitwise those of a local one."""

from __future__ import annotations

import logging
import multiprocessing
import signal
import socket
import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from detumble.campaigns.recipe import Recipe
from detumble.campaigns.runs.flying import Flown, fly_runs
from detumble.checking import instance
from detumble.errors import RequestError
from detumble.surroundings import check_dask
from detumble.version import __version__
from detumble.writing import reason

if TYPE_CHECKING:
    from collections.abc import Iterator

    from detumble.campaigns.runs.executor import PendingRuns

WORKER_LOSSES = 1000
"""Workers that may die over one shard before it is given up; Dask's own default is 3."""
_CONNECT_SECONDS = 30
_PORT = 8786
"""Dask's own, where an address names none."""
_KEPT = "the shards that are complete are kept, and --resume continues"
_QUIET = {"dashboard": False, "dashboard_address": "127.0.0.1:0"}
"""No dashboard, and no warning where another cluster uses its port."""
_OWN_SESSION = """
import os, signal
signal.signal(signal.SIGINT, signal.SIG_IGN)
if hasattr(os, "setsid"):
    if os.getsid(0) != os.getpid():  # Dask does this twice
        os.setsid()
    signal.pthread_sigmask(signal.SIG_SETMASK, [])
"""
"""Keeps from the workers the signals that a terminal or a job scheduler sends to all processes of a group: they end when this
process closes the cluster."""
_SETTINGS = {"distributed.scheduler.allowed-failures": WORKER_LOSSES, "distributed.worker.preload": [_OWN_SESSION]}


class DaskExecutor:
    """The workers of a Dask scheduler.

    Args:
        scheduler: its address; None starts one on this machine, bound to loopback, with `workers` workers.
        workers: processes to start, one thread each.
        backend: of the core on every worker; None takes the best that each has.

    Raises:
        RequestError: Dask is not installed, or the scheduler cannot be reached.
    """

    def __init__(self, scheduler: str | None, workers: int | None, backend: str | None) -> None:
        check_dask()
        try:
            import dask
            import distributed
        except ImportError:
            raise RequestError("Dask is not installed; install detumble[cluster]") from None
        self._backend = backend
        self._local: Any = None
        if scheduler is not None:
            _await(instance("scheduler", scheduler, str, "an address such as tcp://host:8786"))
        else:
            _check_children(workers)
            try:
                with dask.config.set(_SETTINGS), ThreadPoolExecutor(1, initializer=_block_signals) as starter:
                    self._local = starter.submit(
                        distributed.LocalCluster,
                        n_workers=workers,
                        threads_per_worker=1,
                        host="127.0.0.1",
                        silence_logs=50,
                        scheduler_kwargs=_QUIET,
                    ).result()
            except RuntimeError as error:  # Dask's workers begin by importing the script that is being run
                raise RequestError(
                    f"local_cluster {workers}: cannot be started: {error} In a script, fly the campaign beneath "
                    '`if __name__ == "__main__":`'
                ) from None
        logging.getLogger("distributed.client").setLevel(logging.CRITICAL)  # `_cluster_errors` gives one message
        try:
            self._client: Any = distributed.Client(  # type: ignore[no-untyped-call]  # it has no type hints
                self._local or scheduler, timeout=_CONNECT_SECONDS
            )
        except (OSError, ValueError) as error:
            raise RequestError(f"scheduler {scheduler}: cannot be reached: {error}") from None

    @property
    def ahead(self) -> int:
        """Three shards for each worker: one that is flown, one that waits, one whose rows are on their way."""
        with _cluster_errors():
            return 3 * max(1, len(self._client.nthreads()))

    def submit(self, recipe: Recipe, first: int, count: int) -> PendingRuns:
        """Submit runs to a worker; if it dies, another flies them."""
        key = f"{recipe.identity}-{first}-{count}-{self._backend}"
        return _DaskRuns(self._client.submit(fly_shard, recipe.to_dict(), first, count, self._backend, key=key))

    def completed_runs(self) -> int:
        """Give 0: nothing is known of unfinished shards."""
        return 0

    def about(self) -> dict[str, object]:
        """Give back end, number of workers and address of the scheduler."""
        workers = len(self._client.nthreads())
        return {
            "backend": self._backend or "each worker's best",
            "workers": workers,
            "address": self._client.scheduler.address,
        }

    def close(self) -> None:
        """Drop unfinished runs, and stop the workers that were started by this process."""
        self._client.close()
        if self._local:
            self._local.close()


def _check_children(workers: int | None) -> None:
    """Check that this process can start workers.

    Raises:
        RequestError: it is a worker of multiprocessing.Pool, or its current folder, in which workers start, is gone.
    """
    if multiprocessing.current_process().daemon:
        raise RequestError(
            f"local_cluster {workers}: a worker of multiprocessing.Pool can start no processes; fly with threads, or in a "
            "worker of concurrent.futures.ProcessPoolExecutor"
        )
    try:
        Path.cwd()
    except OSError as error:
        raise RequestError(f"local_cluster {workers}: the current folder cannot be used: {reason(error)}") from None


def _block_signals() -> None:
    """Block signals that end a process in this thread and in what it starts: a worker that is starting cannot handle them."""
    if hasattr(signal, "pthread_sigmask"):
        from multiprocessing import resource_tracker

        for _ in range(2):
            signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT, signal.SIGTERM, signal.SIGHUP))
            resource_tracker.ensure_running()  # starts with these blocked, and unblocks two of them in this thread


def _await(scheduler: str) -> None:
    """Wait until a scheduler answers: a Dask client that never connected may block the process when it is garbage-collected.

    Raises:
        RequestError: it does not answer within half a minute.
    """
    from distributed.comm.addressing import get_address_host_port

    if scheduler.startswith("inproc://"):  # in this very process
        return
    deadline = time.monotonic() + _CONNECT_SECONDS
    while True:
        try:
            host, port = get_address_host_port(scheduler)
            socket.create_connection((host, port or _PORT), timeout=_CONNECT_SECONDS).close()
            return
        except (OSError, OverflowError, ValueError) as error:
            if isinstance(error, ValueError | OverflowError) or time.monotonic() > deadline:
                raise RequestError(f"scheduler {scheduler}: cannot be reached: {error}") from None
            time.sleep(0.1)


@dataclass
class _DaskRuns:
    """Runs that were submitted to workers."""

    future: Any

    def result(self, timeout: float | None = None) -> Flown:
        """Wait for the runs, as in `PendingRuns`."""
        with _cluster_errors():
            flown: Flown = self.future.result(timeout)
        return flown


@contextmanager
def _cluster_errors() -> Iterator[None]:
    """Turn failures of the cluster into one message.

    Raises:
        RequestError: the scheduler is lost, or workers died over the same runs more often than it allows.
    """
    from distributed import KilledWorker
    from distributed.client import FutureCancelledError

    try:
        yield
    except TimeoutError:  # an OSError too, but no failure of the cluster
        raise
    except (OSError, FutureCancelledError):
        raise RequestError(f"the scheduler is lost; {_KEPT}") from None
    except KilledWorker:
        raise RequestError(f"workers died over the same runs again and again; {_KEPT}") from None


def fly_shard(recipe: dict[str, Any], first: int, count: int, backend: str | None) -> Flown:
    """Fly runs on a worker.

    Args:
        recipe: of the campaign, as `Recipe.to_dict` gives it.
        first: index of the first run.
        count: number of runs.
        backend: of the core.

    Raises:
        RequestError: this worker has another version of detumble, whose rows may differ.
    """
    if __version__ != recipe["version"]:
        raise RequestError(f"a worker has detumble {__version__}, the campaign {recipe['version']}: runs might differ")
    return fly_runs(Recipe(**recipe), first, count, backend=backend)
