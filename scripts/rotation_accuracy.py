#!/usr/bin/env python
"""Measure how far the integrated rotation of free bodies is off, beside its estimate; prints the table of docs/explanation.md.

    .venv/bin/python scripts/rotation_accuracy.py [--time 600]

The chaser is flown without law or torque, and held against the closed form in tests/independent/free_rotation.py. Of each body
the worst of all spins counts. A cell is the measured error of the attitude, in brackets the estimate, rad.
Below the table stands the momentum lost.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from detumble import load, simulate
from detumble.scenario import with_settings
from detumble.scenario.accuracy import attitude_error

sys.path.append(str(Path(__file__).parents[1] / "tests"))
from independent.free_rotation import matrix, rotation

BODIES = {
    "nearly a sphere": (1.0, 1.02, 1.05),
    "6U": (0.1, 0.13, 0.05),
    "plate": (1.0, 1.0, 2.0),
    "rod, 1:30": (1.0, 30.0, 30.0),
}
"""Principal moments; only their ratios count."""
RATES = (0.2, 1.0, 5.0)
"""rad/s"""
STEPS = (0.01, 0.025, 0.05, 0.1)
"""s"""
MOST_TURN = 0.3
"""rad in a step; beyond it nothing is measured."""
RESOLVED = 1e-10
"""rad; below it rounding has a part in the error."""
SPINS = np.vstack(
    [
        np.random.default_rng(1).normal(size=(12, 3)),
        np.eye(3),
        [[0.93, 0.38, 0.0], [0.0, 0.38, 0.93]],  # about which rod and plate err most
    ]
)
"""Directions of the rate at the start."""


@dataclass(frozen=True)
class Measured:
    """What was found for one spin.

    Attributes:
        error: of the attitude at the end, rad.
        lost: share of the momentum.
        estimate: of the error, rad.
    """

    error: float
    lost: float
    estimate: float


def measure(inertia: Sequence[float], rate: Sequence[float], step: float, time: float) -> Measured:
    """Fly one free body and hold it against the closed form.

    Args:
        inertia: principal moments (3,), kg m².
        rate: at the start, body axes (3,), rad/s.
        step: integration step, s.
        time: whole seconds.
    """
    settings = [
        f"chaser.inertia={list(inertia)}",
        f"chaser.rate={[float(w) for w in rate]}",
        "chaser.attitude=[1.0, 0.0, 0.0, 0.0]",
        "debris.tumble_rate=[0.0, 0.0, 0.0]",
        f"time={{duration = {time}, control_period = 1.0, integration_step = {step}}}",
    ]
    flown = simulate(with_settings(load("paper"), settings), law="none").history
    exact, _ = rotation(np.diag(inertia), rate, time)
    off = float(np.linalg.norm(matrix(flown["chaser_attitude"][-1]) - exact))
    momenta = np.linalg.norm(np.array(inertia) * flown["chaser_rate"][[0, -1]], axis=1)
    largest = float(np.linalg.norm(flown["chaser_rate"], axis=1).max())
    return Measured(
        error=2.0 * float(np.arcsin(min(1.0, off / np.sqrt(8.0)))),
        lost=float(1.0 - momenta[1] / momenta[0]),
        estimate=attitude_error(inertia, largest, step, time),
    )


def worst(inertia: Sequence[float], rate: float, step: float, time: float) -> Measured:
    """Give the worst of all spins of a body: each number is the largest of its kind."""
    found = [measure(inertia, rate * spin / np.linalg.norm(spin), step, time) for spin in SPINS]
    return Measured(
        error=max(one.error for one in found),
        lost=max(one.lost for one in found),
        estimate=max(one.estimate for one in found),
    )


def shown(error: float) -> str:
    """Write an error with one digit."""
    digit, _, power = f"{error:.0e}".partition("e")
    return f"{digit}e{int(power)}" if error < 1.0 else "> 1"


def cell(found: Measured) -> str:
    """Write one cell."""
    return f"{shown(found.error)} ({shown(found.estimate)})" if found.error > RESOLVED else f"< {shown(RESOLVED)}"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--time", type=float, default=600.0, help="flown, whole seconds")
    time = parser.parse_args().time
    print("| body | rad/s | " + " | ".join(f"{step} s" for step in STEPS) + " |")
    print("|" + "---|" * (2 + len(STEPS)))
    lost = {}
    for body, inertia in BODIES.items():
        for rate in RATES:
            row = {step: worst(inertia, rate, step, time) for step in STEPS if rate * step <= MOST_TURN}
            cells = [cell(row[step]) if step in row else "–" for step in STEPS]
            print(f"| {body} | {rate} | " + " | ".join(cells) + " |", flush=True)
            lost |= {(body, rate, step): found.lost for step, found in row.items()}
    print("\nShare of the momentum lost, where more than a millionth:")
    for (body, rate, step), share in lost.items():
        if share > 1e-6:
            print(f"{body}, {rate} rad/s, {step} s: {share:.0e}")


if __name__ == "__main__":
    main()
