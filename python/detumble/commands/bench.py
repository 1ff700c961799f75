"""`detumble bench`: how fast this machine flies workload W, and how much of its arithmetic that uses."""

from __future__ import annotations

import os
import statistics
import time
from typing import TYPE_CHECKING, Any

from detumble.commands.arguments import AsJson
from detumble.commands.printing import print_json, remark
from detumble.tables import table

if TYPE_CHECKING:
    from collections.abc import Callable

REPEATS = 5
SECONDS = 0.4
"""Length of one timed repeat, s: long compared with a scheduler's time slice."""


def bench(as_json: AsJson = False) -> None:
    """Measure how many trajectory-steps of workload W this machine flies a second."""
    from detumble.compiled import core
    from detumble.workload import FLOP_PER_STEP

    names = core().backends()
    threads = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    rates = {}
    for name in names:
        remark(f"flying workload W on one core, {name} ...")
        rates[name] = _steps_per_second(name, 1)
    best = max(rates, key=lambda name: rates[name])
    remark(f"flying workload W on {threads} cores, {best} ...")
    everything = _steps_per_second(best, threads)
    peak = max(_fma_flops(name) for name in names)
    share = rates[best] * FLOP_PER_STEP / peak
    if as_json:
        print_json(
            {
                "backends": {name: {"steps_per_s": rate} for name, rate in rates.items()},
                "all_cores_steps_per_s": everything,
                "cores": threads,
                "fma_peak_flops": peak,
                "fma_peak_share": share,
            }
        )
        return
    rows = [("workload W", "million steps/s"), *((f"{name}, 1 core", _millions(rate)) for name, rate in rates.items())]
    print(table([*rows, (f"{best}, {threads} cores", _millions(everything))]))
    print(f"\n{best}: {share:.0%} of the {peak / 1e9:.1f} Gflop/s that one core reaches in multiply-adds alone,")
    print(f"counting the {FLOP_PER_STEP} flop of a step as W defines it; cheaper propagation saves some of them")


def _millions(rate: float) -> str:
    return f"{rate / 1e6:.1f}"


def _steps_per_second(backend: str, threads: int) -> float:
    from detumble.compiled import core
    from detumble.workload import random_starts, start_columns, workload

    recipe = workload()
    periods: int = recipe["plan"]["periods"]

    def fly(count: int) -> float:
        columns = start_columns(random_starts(count))
        return _timed(lambda: core().fly_many(recipe, columns, count, threads=threads, backend=backend))

    probe = 64 * threads
    fly(probe)
    count = max(probe, round(probe * SECONDS / fly(probe) / probe) * probe)
    fly(count)
    return count * periods / statistics.median(fly(count) for _ in range(REPEATS))


def _fma_flops(backend: str) -> float:
    """Measure the peak of one core, flop/s: the best of the repeats, since a peak is never exceeded."""
    from detumble.compiled import core

    iterations = 1_000_000
    core().fma_peak(backend, iterations)
    done = 0.0

    def multiply_add() -> None:
        nonlocal done
        done = core().fma_peak(backend, iterations)

    fastest = min(_timed(multiply_add) for _ in range(2 * REPEATS))
    return done / fastest


def _timed(work: Callable[[], Any]) -> float:
    begin = time.perf_counter()
    work()
    return time.perf_counter() - begin
