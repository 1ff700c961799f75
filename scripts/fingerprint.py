#!/usr/bin/env python
"""Hold what every shipped scenario flies, law by law, against SHA-256 sums on record: a change of structure changes no bit.

    .venv/bin/python scripts/fingerprint.py --check      compare with scripts/fingerprint.json; exit code 1 if a sum differs
    .venv/bin/python scripts/fingerprint.py --record     add the sums that are missing there; --all makes them all anew

For every scenario, law, form and transition: the history of flight 0 of seed 3, and the rows of a campaign of 2,000 runs of
seed 5. For workload W: end state, capture time and impulse of 2,000 flights. A sum covers the series and columns that are
on record with it, so new ones change nothing. Sums are those of back ends with fused multiply-add (AVX2, AVX-512).
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

import detumble
from detumble.compiled import core
from detumble.workload import random_starts, start_columns, workload

RECORD = Path(__file__).with_suffix(".json")
RUNS = 2_000
TRANSITIONS = ("approximate", "momentum_conserving")
W_COLUMNS = ("final_state", "capture_time", "impulse")


def digest(columns: Mapping[str, Any], names: Iterable[str]) -> str:
    """Give the sum of the columns of these names; text and missing values count by their JSON."""
    total = hashlib.sha256()
    for name in names:
        values = columns[name]
        total.update(name.encode())
        if isinstance(values, np.ndarray):
            total.update(np.ascontiguousarray(values).tobytes())
        else:
            total.update(json.dumps(values.to_list()).encode())
    return total.hexdigest()


def cases() -> Iterator[tuple[str, detumble.Scenario, str]]:
    """Give every scenario × law × form × transition under a name."""
    for title in detumble.scenarios():
        laws = detumble.load(title).laws
        for law in laws.closed_loop:
            forms = ("printed", "corrected") if hasattr(getattr(laws, law), "form") else ("",)
            for form in forms:
                for transition in TRANSITIONS:
                    scenario = detumble.load(title)
                    scenario.capture.transition = transition
                    if form:
                        getattr(scenario.laws, law).form = form
                    yield "/".join(filter(None, (title, law, form, transition))), scenario, law


def flown(name: str, scenario: detumble.Scenario, law: str, known: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Give the sums of one case, with the names of what they cover."""
    history = detumble.simulate(scenario, law, seed=3).history
    rows = detumble.campaign(scenario, law, RUNS, seed=5).runs.to_polars()
    for kind, columns, names in (("flight", history, sorted(history)), ("campaign", rows, rows.columns)):
        covered = known.get(f"{name}/{kind}", {}).get("covers", list(names))
        yield f"{name}/{kind}", {"covers": covered, "sha256": digest(columns, covered)}


def flown_w() -> tuple[str, Any]:
    """Give the sum of workload W."""
    flown = core().fly_many(workload(), start_columns(random_starts(RUNS)), RUNS, threads=2)
    return "workload W", {"covers": list(W_COLUMNS), "sha256": digest(flown, W_COLUMNS)}


def main() -> int:
    """Check or record."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--check", action="store_true", help="compare with the record")
    what.add_argument("--record", action="store_true", help="add what the record lacks")
    parser.add_argument("--all", action="store_true", help="with --record: make every sum anew")
    parser.add_argument("--only", default="", metavar="TEXT", help="cases whose name contains this")
    arguments = parser.parse_args()
    known = json.loads(RECORD.read_text()) if RECORD.exists() and not arguments.all else {}
    found: dict[str, Any] = {}
    for name, scenario, law in cases():
        if arguments.only in name:
            found |= flown(name, scenario, law, known)
    if arguments.only in "workload W":
        found |= [flown_w()]
    if arguments.record:
        sums = dict(sorted((known | {name: one for name, one in found.items() if name not in known}).items()))
        RECORD.write_text(json.dumps(sums, indent=1) + "\n")
        print(f"{len(sums)} sums on record, {len(sums) - len(known)} of them new")
        return 0
    differing = [name for name, one in known.items() if arguments.only in name and found.get(name) != one]
    for name in differing:
        print(f"{name}: {'differs' if name in found else 'is no longer flown'}")
    print(f"{sum(arguments.only in name for name in known) - len(differing)} sums as recorded, {len(differing)} not")
    return 1 if differing or not known else 0


if __name__ == "__main__":
    sys.exit(main())
