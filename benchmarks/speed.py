#!/usr/bin/env python
"""Measure what the README says about speed, in one run on this machine.

    make setup && .venv/bin/python benchmarks/speed.py [--json]

Every figure is the median of repeated runs, taken in turn so that a change of the machine's speed meets all alike.
Steps per second are of workload W (docs/explanation.md); the share is of the peak rate of multiply-adds that the same
core reaches on the same instructions, measured beside it, with W's own count of 1635 flop a step.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

import detumble
from detumble.compiled import core
from detumble.workload import FLOP_PER_STEP, random_starts, start_columns, workload

ROUNDS = 7
HERE = Path(sys.executable).parent
PERIODS = 2400


def seconds(action: Callable[[], object]) -> float:
    """Time one call [s]."""
    begin = time.perf_counter()
    action()
    return time.perf_counter() - begin


def shell(*command: str) -> Callable[[], object]:
    """Give a call that runs a command as a user would, its output discarded."""
    return lambda: subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def measure() -> dict[str, float]:
    """Measure everything; seconds, steps per second, shares."""
    case = workload()
    backends = core().backends()
    flights = {backend: 512 if backend != "portable" else 64 for backend in backends}
    starts = random_starts(1024)
    scenario = detumble.load("paper")
    scenario.time.control_period = 0.05

    def fly(backend: str, threads: int, count: int) -> Callable[[], object]:
        columns = start_columns(starts[:count])
        return lambda: core().fly_many(case, columns, count, seed=1, threads=threads, backend=backend)

    disturbed = {
        "gravity_gradient": {"gravity_gradient": True, "constant": "none"},
        "loads": {"gravity_gradient": False, "constant": "lvlh"},
    }
    cores = os.cpu_count() or 1
    actions: dict[str, Callable[[], object]] = {f"w_{b}": fly(b, 1, flights[b]) for b in backends}
    columns = start_columns(starts[:64])
    for name, acting in disturbed.items():
        other = case | {"plan": case["plan"] | {"disturbances": acting}}
        actions[f"w_{name}"] = partial(core().fly_many, other, columns, 64, seed=1)
    actions["w_all_cores"] = fly(backends[-1], cores, 1024)
    actions["flight_600s_s"] = lambda: detumble.simulate(scenario, law="prrl", seed=1).data
    actions["shell_run_paper_prrl_s"] = shell(str(HERE / "detumble"), "run", "paper", "--law", "prrl")
    actions["import_detumble_s"] = shell(str(HERE / "python"), "-c", "import detumble")
    actions["python_alone_s"] = shell(str(HERE / "python"), "-c", "pass")
    iterations = 4_000_000
    for backend in backends:
        actions[f"peak_{backend}"] = partial(core().fma_peak, backend, iterations)

    for action in actions.values():
        action()
    taken: dict[str, list[float]] = {name: [] for name in actions}
    for _ in range(ROUNDS):
        for name, action in actions.items():
            taken[name].append(seconds(action))
    median = {name: statistics.median(times) for name, times in taken.items()}

    figures = {name: median[name] for name in median if name.endswith("_s")}
    for backend in backends:
        rate = flights[backend] * PERIODS / median[f"w_{backend}"]
        peak = core().fma_peak(backend, iterations) / median[f"peak_{backend}"]
        figures[f"w_steps_per_s_{backend}"] = rate
        figures[f"fma_peak_flops_{backend}"] = peak
        figures[f"fma_share_{backend}"] = rate * FLOP_PER_STEP / peak
    for name in disturbed:
        figures[f"w_steps_per_s_{name}"] = 64 * PERIODS / median[f"w_{name}"]
    figures["w_steps_per_s_all_cores"] = 1024 * PERIODS / median["w_all_cores"]
    return figures


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    asked = parser.parse_args()
    figures = measure()
    if asked.json:
        print(json.dumps(figures, indent=2))
        return
    print(f"{platform.processor() or platform.machine()}, {os.cpu_count()} cores, Python {platform.python_version()}")
    print(f"numpy {np.__version__}, detumble {detumble.__version__}; medians of {ROUNDS}\n")
    for name, value in figures.items():
        print(f"{name:32} {value:12.4g}")


if __name__ == "__main__":
    main()
