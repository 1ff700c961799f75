"""The peers' side of the protocol: one process a peer, requests as lines of JSON on stdin, answers on stdout.

    python run_PEER.py THREADS

The first line holds detumble's case of workload W. Each line after it asks for one call of the peer,

    {"call": "w", "starts": FILE.npy, "noisy": true, "seed": 1, "out": FILE.npz or null}

and is answered by `{"seconds": s, "peak_bytes": b}`, the time of the call alone and the most memory the process has
held so far, or by `{"error": "..."}`.
"""

from __future__ import annotations

import json
import os
import resource
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
Fly: TypeAlias = Callable[[Array, bool, int], dict[str, Array]]
"""(starts of shape (n, 20), with noise?, seed) -> arrays by name, their rows in the order of the starts."""


def threads_asked() -> int:
    """Give the number of threads that this process may use."""
    return int(sys.argv[1])


def serve(calls_of: Callable[[dict[str, Any]], dict[str, Fly]]) -> None:
    """Answer requests until there are no more.

    Args:
        calls_of: gives, for a case, what the peer can be asked for by name.
    """
    # Whatever a library prints goes to stderr: stdout carries answers only.
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)
    calls = calls_of(json.loads(sys.stdin.readline()))
    for line in sys.stdin:
        request = json.loads(line)
        starts = np.load(request["starts"])
        begin = time.perf_counter()
        try:
            result = calls[request["call"]](starts, request["noisy"], request["seed"])
        except Exception as error:
            print(json.dumps({"error": f"{type(error).__name__}: {error}"}), file=answers)
            continue
        seconds = time.perf_counter() - begin
        if request["out"]:
            np.savez(request["out"], **result)
        print(json.dumps({"seconds": seconds, "peak_bytes": peak_bytes()}), file=answers)


def peak_bytes() -> int | None:
    """Give the most memory that this process, or the largest of those it has ended, has held; None where it is unknown.

    For the process itself getrusage would not do: on Linux it starts with the peak of the one that started it.
    """
    status = Path("/proc/self/status")
    if not status.exists():
        return None
    line = next(line for line in status.read_text().splitlines() if line.startswith("VmHWM:"))
    return 1024 * max(int(line.split()[1]), resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
