#!/usr/bin/env python
"""Identify the gains that the paper does not publish, so that its five capture times come out.

    .venv/bin/python scripts/identify_paper.py           search, and print what was found
    .venv/bin/python scripts/identify_paper.py --write   and put it into the paper's scenario file
    .venv/bin/python scripts/identify_paper.py --check   search nothing: is the scenario file within 2 %?

Everything but five numbers is stated in the scenario file: the common start, the noise, the rotation gains and all
translation gains but one a law. That one is searched for. It alone sets the capture time, because the attitude is ready
long before the distance (the table shows when), and the larger it is the earlier the capture. So there is a range of it
that gives the published time: its two ends are bisected without noise, its middle is taken, rounded to the fewest digits
that keep the time within 0.3 %. Then many flights with noise show how far the times spread.

A match found so proves little: any law with one free number that sets its pace could be brought to any of these times.
"""

from __future__ import annotations

import argparse
import math
import re
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from check_scenarios import WITHIN, fly

from detumble.analysis.bounds.earliest import minimum_capture_time
from detumble.scenario import Scenario, load, with_settings
from detumble.scenario.files import LIBRARY
from detumble.scenario.paper import PUBLISHED_CAPTURE_TIMES

PAPER = LIBRARY / "paper.toml"
ROUNDING = 0.003
"""How far, relative, rounding the gain may move the capture time."""


@dataclass(frozen=True)
class Search:
    """The one translation gain searched for, and the ends between which the capture comes the earlier the larger it is."""

    gain: str
    least: float
    most: float


SEARCHES = {
    "pd": Search("kp", 1e-3, 1e-1),  # kd = 1: overdamped, the error decays at kp/kd
    "lqr": Search("q_error", 1e-6, 1e-2),  # q_rate and r given: the weight of the error sets the bandwidth
    "sosmc": Search("slope", 1e-3, 1e-1),  # K, alpha, phi take s to zero soon; then the error decays at the slope
    "tsmc": Search("slope", 1e-3, 1e-1),  # likewise, as a power of the error
    "prrl": Search("slope", 5e-2, 2e-1),  # here K counts too: it is chosen so that the force limit is hardly touched
}


def capture_time(scenario: Scenario, law: str) -> float:
    """Capture time of the first flight, s; inf if there is none."""
    time = float(fly(scenario, law, 1)["capture_time"][0])
    return math.inf if math.isnan(time) else time


def identify(scenario: Scenario, law: str) -> float:
    """Find the gain of one law that gives its published capture time."""
    search, published, tick = SEARCHES[law], PUBLISHED_CAPTURE_TIMES[law], scenario.time.control_period
    quiet = with_settings(scenario, ["sensors={}", "time.duration=150.0"])

    def time(gain: float) -> float:
        return capture_time(with_settings(quiet, [f"laws.{law}.translation.{search.gain}={gain!r}"]), law)

    least = threshold(lambda gain: time(gain) < published + 0.5 * tick, search.least, search.most)
    most = threshold(lambda gain: time(gain) < published - 0.5 * tick, search.least, search.most)
    middle = math.sqrt(least * most)
    rounded = (float(f"{middle:.{digits}g}") for digits in range(1, 16))
    return next(gain for gain in rounded if abs(time(gain) / published - 1.0) <= ROUNDING)


def threshold(early: Callable[[float], bool], low: float, high: float) -> float:
    """Bisect for the least gain whose capture is early; low is not, high is."""
    if early(low) or not early(high):
        raise SystemExit(f"identify_paper: the published time is not reached between the gains {low:g} and {high:g}")
    while high > low * (1.0 + 1e-6):
        middle = math.sqrt(low * high)
        low, high = (low, middle) if early(middle) else (middle, high)
    return high


def attitude_ready(scenario: Scenario, law: str) -> float:
    """Say from when on angle and rate alone would have allowed the capture, s."""
    return capture_time(with_settings(scenario, ["capture.distance=1e5"]), law)


def write(path: Path, law: str, gain: str, value: float) -> None:
    """Put a gain into the file, leaving all else as it is."""
    pattern = re.compile(rf"(\[laws\.{law}\]\n(?:(?!\[).*\n)*?translation = \{{[^}}\n]*?\b{gain} = )[^,\s}}]+")
    text, count = pattern.subn(r"\g<1>" + f"{value:g}".replace("e-0", "e-"), path.read_text(encoding="utf-8"))
    if count != 1:
        raise SystemExit(f"identify_paper: {path}: found {count} places for {gain} of {law}; there must be one")
    path.write_text(text, encoding="utf-8")


def report(scenario: Scenario, flights: int) -> bool:
    """Fly the scenario with noise and print the times; tell whether all are within 2 %."""
    minimum, well = minimum_capture_time(scenario), True
    print(f"{flights} flights a law, each with its own noise; no controller can capture before {minimum:.1f} s")
    print("law    translation gain   published s   seed 0  off %    least     most  attitude ready s  settling s, most")
    for law, search in SEARCHES.items():
        flown, published = fly(scenario, law, flights), PUBLISHED_CAPTURE_TIMES[law]
        times = flown["capture_time"]
        value = getattr(getattr(scenario.laws, law).translation, search.gain)
        print(
            f"{law:7}{search.gain + ' = ' + format(value, 'g'):18}{published:12.1f}{times[0]:9.1f}"
            f"{100.0 * (times[0] / published - 1.0):+7.1f}{times.min():9.1f}{times.max():9.1f}"
            f"{attitude_ready(scenario, law):18.1f}{flown['settling_time'].max():18.1f}"
        )
        well &= bool(np.all(np.abs(times / published - 1.0) <= WITHIN) and np.all(times >= minimum))
        well &= bool(np.all(np.isfinite(flown["settling_time"])))
    return well


def main() -> int:
    """Identify, or check what was identified."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    action = parser.add_mutually_exclusive_group()
    action.add_argument("--check", action="store_true", help="only fly the scenario file; exit code 1 if off")
    action.add_argument("--write", action="store_true", help="put the gains found into the scenario file")
    parser.add_argument("--flights", type=int, default=300, help="flights of each law (default 300)")
    options = parser.parse_args()
    scenario = load("paper")
    if not options.check:
        for law, search in SEARCHES.items():
            value = identify(scenario, law)
            scenario = with_settings(scenario, [f"laws.{law}.translation.{search.gain}={value!r}"])
            if options.write:
                write(PAPER, law, search.gain, value)
    well = report(scenario, options.flights)
    if not well:
        print(f"identify_paper: not every flight is within {WITHIN:.0%} and settled", file=sys.stderr)
    return 0 if well else 1


if __name__ == "__main__":
    sys.exit(main())
