"""What is measured: rates in turn, start-up, growth with the number of trajectories."""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from detumble.compiled import core
from detumble.workload import FLOP_PER_STEP, random_starts
from peers.process import Answer, Peer, PeerFailed
from peers.ways import WAYS, Way

if TYPE_CHECKING:
    from collections.abc import Callable

PEAK_ITERATIONS = 4_000_000
DETUMBLE = Path(sys.executable).with_name("detumble")


@dataclass(frozen=True)
class Rate:
    """One way's figures.

    Attributes:
        steps_per_s: of each round.
        ratio: how many times as fast detumble is on as many threads, median over the rounds.
        fma_share: of the multiply-add peak of one core, W's flop counted; None for ways that are not all of W.
        peak_bytes: the most memory that its process held.
    """

    steps_per_s: list[float]
    ratio: float
    fma_share: float | None
    peak_bytes: int | None


def rates(peers: dict[tuple[str, int], Peer], periods: int, rounds: int, failed: dict[str, str]) -> dict[str, Rate]:
    """Measure how many steps a second each way flies, all in turn, so that a change of the machine's speed meets all.

    Args:
        peers: running, by name and threads.
        periods: of a flight.
        rounds: how many times.
        failed: where ways that cannot be flown are noted, by label.
    """
    ways = [way for way in WAYS if (way.peer, way.threads) in peers]
    starts = random_starts(max(way.flights for way in ways))
    taken: dict[Way, list[Answer]] = {way: [] for way in ways}
    peak = 0.0  # the best of the rounds: it is what is never exceeded
    for _ in range(rounds + 1):
        peak = max(peak, multiply_adds_per_s())
        for way in list(taken):
            try:
                taken[way].append(peers[way.peer, way.threads].fly(way.call, starts[: way.flights]))
            except PeerFailed as failure:
                failed[way.label] = str(failure)
                del taken[way]
    # The first round was for compilers and caches.
    speeds = {way: [way.flights * periods / one.seconds for one in answers[1:]] for way, answers in taken.items()}
    ours = {way.threads: speeds[way] for way in speeds if way.peer == "detumble"}
    return {
        way.label: Rate(
            speeds[way],
            statistics.median(a / b for a, b in zip(ours[way.threads], speeds[way], strict=True)),
            statistics.median(speeds[way]) * FLOP_PER_STEP / peak if way.whole and way.threads == 1 else None,
            answers[-1].peak_bytes,
        )
        for way, answers in taken.items()
    }


def multiply_adds_per_s() -> float:
    """Run one core at nothing but multiply-adds; flop/s."""
    begin = time.perf_counter()
    flop: float = core().fma_peak(core().backends()[-1], PEAK_ITERATIONS)
    return flop / (time.perf_counter() - begin)


@dataclass(frozen=True)
class StartUp:
    """From the start of a process to the result of its first trajectory.

    Attributes:
        seconds: median of the repetitions.
        compiling: how much longer the first call took than a second one like it [s].
    """

    seconds: float
    compiling: float


def start_up(make: Callable[[], Peer], repetitions: int) -> StartUp:
    """Start a peer so many times and fly one trajectory each time.

    Raises:
        PeerFailed: it cannot fly.
    """
    whole, compiling = [], []
    start = random_starts(1)
    for _ in range(repetitions):
        peer = make()
        try:
            first = peer.fly("w", start)
            whole.append(time.perf_counter() - peer.begin)
            compiling.append(first.seconds - peer.fly("w", start).seconds)
        finally:
            peer.close()
    return StartUp(statistics.median(whole), statistics.median(compiling))


@dataclass(frozen=True)
class Point:
    """A campaign of so many trajectories; `seconds` None was not run: it would have taken about `expected`."""

    runs: int
    expected: float
    seconds: float | None = None
    peak_bytes: int | None = None


def growth(
    fly: Callable[[int], tuple[float, int | None]], rate: float, periods: int, sizes: list[int], budget: float
) -> list[Point]:
    """Fly more and more trajectories, as long as a point is expected within the budget.

    Args:
        fly: flies so many, gives seconds and the most memory held.
        rate: steps per second, as measured.
        periods: of a flight.
        sizes: numbers of trajectories, ascending.
        budget: for one point [s].

    Raises:
        PeerFailed: it ended instead.
    """
    points = []
    done, spent, each = 0, 0.0, periods / rate
    for runs in sizes:
        expected = spent + (runs - done) * each  # what was spent before holds what does not grow, such as start-up
        if expected > budget:
            points.append(Point(runs, expected))
            continue
        seconds, peak = fly(runs)
        points.append(Point(runs, expected, seconds, peak))
        if done:
            each = (seconds - spent) / (runs - done)
        done, spent = runs, seconds
    return points


def way_to_grow(peer: str) -> Way:
    """Give the peer's way for many trajectories: the one with the most threads, as a batch if it can."""
    return max((way for way in WAYS if way.peer == peer), key=lambda way: (way.threads, way.flights))


def fly_starts(runs: int, peer: Peer, call: str) -> tuple[float, int | None]:
    """Have a peer fly so many trajectories from arrays to arrays.

    Returns:
        Seconds of the call, and the most memory that its process has held.

    Raises:
        PeerFailed: it ended instead.
    """
    answer = peer.fly(call, random_starts(runs))
    return answer.seconds, answer.peak_bytes


# A process of its own, small and started anew, so that the peak it measures is the command's: on Linux a child begins
# with the peak of the process that started it.
LAUNCHER = """
import json, resource, subprocess, sys, time
begin = time.perf_counter()
done = subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
seconds = time.perf_counter() - begin
peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * (1 if sys.platform == "darwin" else 1024)
print(json.dumps({"seconds": seconds, "peak_bytes": peak, "code": done.returncode, "said": done.stderr.strip()}))
"""


def campaign(runs: int, folder: Path) -> tuple[float, int | None]:
    """Have the command fly a campaign of W and write its results.

    Returns:
        Seconds from the start of the process to its end, and the most memory that it held.

    Raises:
        PeerFailed: the command failed.
    """
    out = folder / f"campaign-{runs}"
    command = [
        "campaign",
        "workload_w",
        "--law",
        "prrl",
        "--runs",
        str(runs),
        "--seed",
        "1",
        "--out",
        str(out),
        "--json",
    ]
    launched = subprocess.run(
        [sys.executable, "-I", "-S", "-c", LAUNCHER, str(DETUMBLE), *command],
        capture_output=True,
        text=True,
        check=True,
    )
    result = json.loads(launched.stdout)
    if result["code"]:
        raise PeerFailed(result["said"] or f"exit code {result['code']}")
    return result["seconds"], result["peak_bytes"]
