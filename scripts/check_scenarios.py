#!/usr/bin/env python
"""Fly every law of the scenarios that come with detumble many times, each flight with noise of its own, and judge them.

    .venv/bin/python scripts/check_scenarios.py [--flights 300] [--scenario NAME ...]

Every flight must be captured and settled, settled long before it ends, and no capture may come before the minimum time
that any controller needs. The paper's capture times must be within 2 % of the published ones. Exit code 1 otherwise.
"""

from __future__ import annotations

import argparse
import sys

import numpy as np
from numpy.typing import NDArray

from detumble.analysis.bounds.earliest import minimum_capture_time
from detumble.compiled import core
from detumble.scenario import LAWS, Scenario, load
from detumble.scenario.core import case
from detumble.scenario.paper import PUBLISHED_CAPTURE_TIMES

SCENARIOS = ("paper", "far_tumble", "twelve_u")
WITHIN = 0.02
"""How close to the published capture times every flight must come."""
LATEST = 0.8
"""Share of the duration by which every flight must be settled."""


def fly(scenario: Scenario, law: str, flights: int) -> dict[str, NDArray[np.float64]]:
    """Fly the scenario's start so many times; the first flight is that of seed 0. Gives the core's summary by name."""
    flown: dict[str, NDArray[np.float64]] = core().fly_many(case(scenario, law), {}, flights)
    return flown


def faults(name: str, scenario: Scenario, law: str, flown: dict[str, NDArray[np.float64]], minimum: float) -> list[str]:
    """Say what is wrong with the flights of one law."""
    capture, settling = flown["capture_time"], flown["settling_time"]
    found = []
    if lost := int(np.isnan(capture).sum()):
        found.append(f"{lost} of {len(capture)} not captured")
    if unsettled := int(np.isnan(settling).sum()) - lost:
        found.append(f"{unsettled} of {len(capture)} captured but not settled")
    if np.nanmax(capture + settling, initial=0.0) > LATEST * scenario.time.duration:
        found.append(f"settled only after {LATEST:.0%} of the flight")
    if np.nanmin(capture, initial=np.inf) < minimum:
        found.append(f"captured before the minimum time, {minimum:.1f} s")
    if name == "paper" and law in PUBLISHED_CAPTURE_TIMES:
        published = PUBLISHED_CAPTURE_TIMES[law]
        if (off := float(np.nanmax(np.abs(capture / published - 1.0), initial=0.0))) > WITHIN:
            found.append(f"{off:.1%} off the published {published} s")
    return found


def judge(name: str, scenario: Scenario, flights: int) -> bool:
    """Fly and print one scenario; tell whether all is well."""
    minimum = minimum_capture_time(scenario)
    print(scenario.title)
    print(
        f"  {flights} flights a law of {scenario.time.duration:.0f} s; no controller can capture before {minimum:.1f} s"
    )
    print(
        "  law     capture s: seed 0, least, most   settling s: least, most   at the end, most: pointing °, rate mrad/s"
    )
    well = True
    for law in LAWS:
        flown = fly(scenario, law, flights)
        capture, settling = flown["capture_time"], flown["settling_time"]
        spread = "".join(f"{value:9.1f}" for value in (capture[0], np.nanmin(capture), np.nanmax(capture)))
        settled = "".join(f"{value:9.1f}" for value in (np.nanmin(settling), np.nanmax(settling)))
        pointing, rate = np.degrees(np.nanmax(flown["final_pointing"])), 1e3 * np.nanmax(flown["final_rate"])
        found = faults(name, scenario, law, flown, minimum)
        print(f"  {law:7}{spread}{settled:>26}{pointing:21.2f}{rate:13.2f}   {'; '.join(found) or 'ok'}")
        well &= not found
    return well


def main() -> int:
    """Judge the scenarios asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--flights", type=int, default=300, help="flights of each law (default 300)")
    parser.add_argument("--scenario", action="append", choices=SCENARIOS, help="only this one; may be repeated")
    options = parser.parse_args()
    well = [judge(name, load(name), options.flights) for name in options.scenario or SCENARIOS]
    return 0 if all(well) else 1


if __name__ == "__main__":
    sys.exit(main())
