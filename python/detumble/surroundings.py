"""Conditions that libraries need of the process and its environment, and do not report themselves.

Polars works with threads. A process that is forked from one in which they run has none, and would wait for them without end.
`import detumble` registers hooks on fork, so that a child detects this however it was forked, and whatever polars was used for.
"""

from __future__ import annotations

import os
import sys

lost = False
"""Whether the threads of polars were left behind in the process that this one was forked from."""
_running = False


def check_polars() -> None:
    """Check that polars can use its threads, before it needs them.

    Raises:
        RequestError: they were left behind in a fork, or the environment asks for a number of them that cannot be.
    """
    from detumble.errors import RequestError

    if lost:
        raise RequestError(
            "this process was forked from one in which polars is at work, whose threads do not come along: campaigns can be "
            'used in it if it is started by "spawn" or "forkserver" (multiprocessing.get_context, mp_context)'
        )
    for name in ("POLARS_MAX_THREADS", "POLARS_ASYNC_THREAD_COUNT"):
        number = os.environ.get(name, "1")
        if not (number.isascii() and number.isdecimal() and len(number) <= 4 and int(number)):
            raise RequestError(f"{name} {number!r}: must be a whole number from 1 to 9999, or not set at all")


def check_dask() -> None:
    """Make sure, before xarray looks for Dask, that it can be imported if it is there.

    Raises:
        RequestError: its configuration cannot be read.
    """
    from detumble.errors import RequestError

    try:
        import dask  # noqa: F401  # to see whether it can be
    except ImportError:
        pass
    except Exception as error:  # of any kind: it lets through what its reader of YAML raises
        why = str(error).partition("\n")[0].rstrip(":")
        raise RequestError(f"Dask cannot read its configuration (DASK_CONFIG, ~/.config/dask): {why}") from None


def available_threads() -> int:
    """Count the processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _runs_in(process: int | str) -> bool:
    """Look for the threads of polars, as far as the system tells the names of threads."""
    if "polars" not in sys.modules:
        return False
    from contextlib import suppress
    from pathlib import Path

    names = []
    for name in Path(f"/proc/{process}/task").glob("*/comm"):
        with suppress(OSError):  # a thread that has just ended
            names.append(name.read_text(errors="replace"))
    workers = ("tokio-rt-worker", *(f"polars-{digit}" for digit in range(10)))
    return any(name.startswith(workers) for name in names)


def _is_fork() -> bool:
    """Whether this process is a fork of its parent: then both have the same auxiliary vector of the system."""
    from pathlib import Path

    try:
        return Path("/proc/self/auxv").read_bytes() == Path(f"/proc/{os.getppid()}/auxv").read_bytes()
    except OSError:
        return False


def _note_threads() -> None:
    global _running
    _running = _runs_in("self")


def _note_loss() -> None:
    global lost
    lost = lost or _running


if hasattr(os, "register_at_fork"):
    os.register_at_fork(before=_note_threads, after_in_child=_note_loss)
    # a child whose parent never imported detumble
    lost = not _runs_in("self") and _runs_in(os.getppid()) and _is_fork()
