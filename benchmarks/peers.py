#!/usr/bin/env python
"""Measure detumble beside its peers on workload W, in one run on this machine; docs/benchmarks.md says what it means.

    make setup && .venv/bin/python benchmarks/peers.py [--quick] [--only NAME ...] [--json FILE] [--python PYTHON]

Sets the peers up in an environment of their own, checks that all give the same answer where they solve the same problem,
and then measures them in turn. A peer that cannot be had is named with the reason; one that does not agree is not
measured, and the exit code is 1.
"""

from __future__ import annotations

import argparse
import os
import statistics
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path

from peers import agreement, measure
from peers.environment import machine, peers_python
from peers.process import Peer, PeerFailed
from peers.ways import PEERS, TITLES, TOLERANCES, WAYS

from detumble.commands.printing import json_text, remark
from detumble.errors import RequestError
from detumble.workload import random_starts, workload
from detumble.writing import write_text

ROUNDS, QUICK_ROUNDS = 7, 2
SIZES, QUICK_SIZES = [10**3, 10**4, 10**5, 10**6], [10**3, 10**4]
BUDGET, QUICK_BUDGET = 100.0, 5.0
"""For one point of growth [s]."""


class Session:
    """One run of the benchmark.

    Args:
        chosen: names of peers.
        python: of the peers' environment.
        folder: for what is exchanged.
    """

    def __init__(self, chosen: list[str], python: Path, folder: Path) -> None:
        self.chosen, self.python, self.folder = ["detumble", *chosen], python, folder
        self.case = workload()
        self.periods = self.case["plan"]["periods"]
        self.absent: dict[str, str] = {}

    def peer(self, name: str, threads: int) -> Peer:
        """Start a peer."""
        python = Path(sys.executable) if name == "detumble" else self.python
        return Peer(name, python, threads, self.case, self.folder)

    def present(self) -> list[str]:
        """Name the peers without a fault."""
        return [name for name in self.chosen if name not in self.absent]

    def agree(self) -> list[agreement.Check]:
        """Compare every peer with detumble; those that cannot be run are noted."""
        starts = random_starts(max(agreement.FLIGHTS, *agreement.NOISY.values()))
        checks = []
        ours = self.peer("detumble", 1)
        for name in self.chosen[1:]:
            remark(f"comparing {TITLES[name]} ...")
            peer = self.peer(name, 1)
            try:
                found = agreement.check_peer(peer, ours, starts)
            except PeerFailed as failure:
                self.absent[name] = str(failure)
            else:
                checks += found
                if any(check.faults for check in found):
                    self.absent[name] = "does not agree with detumble"
            peer.close()
        ours.close()
        return checks

    def rates(self, rounds: int) -> dict[str, measure.Rate]:
        """Measure all ways in turn."""
        remark("measuring rates ...")
        kinds = dict.fromkeys((way.peer, way.threads) for way in WAYS if way.peer in self.present())
        peers = {kind: self.peer(*kind) for kind in kinds}
        try:
            return measure.rates(peers, self.periods, rounds, self.absent)
        finally:
            for peer in peers.values():
                peer.close()

    def start_up(self, repetitions: int) -> dict[str, measure.StartUp]:
        """Measure the time to a first result of every peer."""
        remark("measuring start-up ...")
        taken = {}
        for name in self.present():
            try:
                taken[name] = measure.start_up(partial(self.peer, name, 1), repetitions)
            except PeerFailed as failure:
                self.absent[name] = str(failure)
        return taken

    def growth(self, rates: dict[str, measure.Rate], sizes: list[int], budget: float) -> dict[str, list[measure.Point]]:
        """Fly more and more trajectories: detumble by its command, the peers from arrays to arrays."""
        points = {}
        for name in self.present():
            way = measure.way_to_grow(name)
            if way.label not in rates:
                continue
            label = "detumble campaign" if name == "detumble" else way.label
            remark(f"flying more and more: {label} ...")
            rate = statistics.median(rates[way.label].steps_per_s)
            fly = partial(measure.campaign, folder=self.folder)
            peer = self.peer(name, way.threads)
            try:
                if name != "detumble":
                    measure.fly_starts(2, peer, way.call)  # compiles
                    fly = partial(measure.fly_starts, peer=peer, call=way.call)
                points[label] = measure.growth(fly, rate, self.periods, sizes, budget)
            except PeerFailed as failure:
                self.absent[label] = str(failure)
            peer.close()
        return points


def arguments(given: list[str]) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="few rounds and trajectories: a look, not a measurement")
    parser.add_argument("--only", nargs="+", choices=PEERS, default=list(PEERS), metavar="NAME", help=", ".join(PEERS))
    parser.add_argument("--json", type=Path, metavar="FILE", help="also write everything measured there")
    parser.add_argument("--python", help="Python to set the peers up with (V-BAR needs 3.12 or newer)")
    return parser.parse_args(given)


def table(rows: Sequence[tuple[str, ...]]) -> str:
    """Write a table as the documentation has it; the first row names the columns."""
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = [
        [
            cell.rjust(width) if column else cell.ljust(width)
            for column, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        for row in rows
    ]
    lines.insert(1, ["-" * (width - 1) + (":" if column else "-") for column, width in enumerate(widths)])
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def print_agreement(checks: list[agreement.Check]) -> None:
    """Say how far the peers are from detumble."""
    for check in checks:
        figures = ", ".join(f"{name} {value:.1g}" for name, value in check.figures.items())
        print(f"{TITLES[check.peer]}, {check.what}: {'; '.join(check.faults) or 'agrees'} ({figures})")
        if check.faults and check.what == "no noise":
            print(f"    expected: {TOLERANCES[check.peer].why}")


def print_rates(rates: dict[str, measure.Rate]) -> None:
    """Print million steps per second, in the median and from least to most."""
    rows = [("workload W", "million steps/s", "least to most", "detumble is", "of FMA peak", "memory MB")]
    for label, rate in rates.items():
        million = [value / 1e6 for value in rate.steps_per_s]
        rows.append(
            (
                label,
                f"{statistics.median(million):.3g}",
                f"{min(million):.3g} – {max(million):.3g}",
                f"{plain(rate.ratio)} ×",
                "–" if rate.fma_share is None else f"{100 * rate.fma_share:.2g} %",
                megabytes(rate.peak_bytes),
            )
        )
    print(table(rows))


def print_start_up(start_up: dict[str, measure.StartUp]) -> None:
    """Print seconds to a first result."""
    rows = [("one trajectory", "s from process start", "of these compiling")]
    rows += [
        (TITLES[name], f"{times.seconds:.2f}", f"{max(times.compiling, 0.0):.2f}") for name, times in start_up.items()
    ]
    print(table(rows))


def print_growth(growth: dict[str, list[measure.Point]]) -> None:
    """Print seconds and memory of each number of trajectories."""
    if not growth:
        return
    sizes = [point.runs for point in next(iter(growth.values()))]
    rows = [("trajectories", *(f"{size:,}" for size in sizes))]
    for label, points in growth.items():
        rows.append((label, *(grown(point) for point in points)))
    print(table(rows))


def grown(point: measure.Point) -> str:
    """Write one number of trajectories."""
    if point.seconds is None:
        return f"not run: would take ~{plain(point.expected)} s"
    return f"{point.seconds:.3g} s, {megabytes(point.peak_bytes)} MB"


def plain(value: float) -> str:
    """Write a positive number to three figures, large ones with separators."""
    return f"{value:.3g}" if value < 1000.0 else f"{float(f'{value:.3g}'):,.0f}"


def megabytes(size: int | None) -> str:
    """Write a size of memory."""
    return "–" if size is None else f"{size / 1e6:.0f}"


def main() -> int:
    """Set up, compare, measure, print."""
    asked = arguments(sys.argv[1:])
    python = peers_python(asked.python)
    host = machine(python)
    print(f"{host['processor']}, {host['cores']} cores, {host['date']}; load {host['load_before']}")
    print(
        f"detumble {host['detumble']}, Python {host['python']}; {', '.join(host['peers'])}, Python {host['peers_python']}\n"
    )
    with tempfile.TemporaryDirectory() as folder:
        session = Session(asked.only, python, Path(folder))
        checks = session.agree()
        print_agreement(checks)
        rates = session.rates(QUICK_ROUNDS if asked.quick else ROUNDS)
        print()
        print_rates(rates)
        start_up = session.start_up(1 if asked.quick else 3)
        print()
        print_start_up(start_up)
        sizes, budget = (QUICK_SIZES, QUICK_BUDGET) if asked.quick else (SIZES, BUDGET)
        growth = session.growth(rates, sizes, budget)
        print()
        print_growth(growth)
    for name, reason in session.absent.items():
        print(f"left out: {name}: {reason}")
    if asked.json:
        everything = {
            "machine": host | {"load_after": round(os.getloadavg()[0], 2)},
            "left_out": session.absent,
            "agreement": [asdict(check) for check in checks],
            "rates": {label: asdict(rate) for label, rate in rates.items()},
            "start_up": {name: asdict(times) for name, times in start_up.items()},
            "growth": {label: [asdict(point) for point in points] for label, points in growth.items()},
        }
        write_text(asked.json, json_text(everything) + "\n")
    return int(any(check.faults for check in checks))


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (RequestError, PeerFailed) as error:
        sys.exit(f"peers: {error}")
