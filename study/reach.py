"""Starts from which a capture by 7.6 s is possible under any law: only limits and thresholds count.

The debris does not turn and the attitudes agree, so only translation counts; starts in 200 directions about the goal.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import detumble
from detumble.analysis.bounds.earliest import minimum_capture_times
from detumble.analysis.bounds.pursuit import Pursuit, start_of
from detumble.analysis.trials import Array
from detumble.scenario.core import case
from detumble.show.style import new_figure, save, styled
from study.cases import PUBLISHED_TIME

DIRECTIONS = 200
SEED = 5
CLOSING = (0.0, 0.02, 0.05, 0.1)
"""Speeds towards the goal at the start, m/s."""
DISTANCES = np.linspace(0.5, 2.0, 31)
"""Distances from the goal, m."""


def fly() -> dict[str, Any]:
    """Share of directions from which a capture by the published time is not excluded, by closing speed and distance."""
    plain = case(detumble.load("paper"), "none")
    pursuit = replace(
        Pursuit.of(plain), angle=np.pi, rate=1e3, periods=round(PUBLISHED_TIME / plain["plan"]["control_period"])
    )
    normals = np.random.default_rng(SEED).standard_normal((DIRECTIONS, 3))
    directions = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    shares = {
        f"{speed:g}": [_share(pursuit, start_of(plain), directions, distance, speed) for distance in DISTANCES]
        for speed in CLOSING
    }
    at_rest = np.array(shares["0"])
    return {
        "distance_m": DISTANCES.tolist(),
        "share": shares,
        "every_direction_up_to_m": float(DISTANCES[at_rest == 1.0].max()),
        "no_direction_from_m": float(DISTANCES[at_rest == 0.0].min()),
    }


def _share(pursuit: Pursuit, start: Array, directions: Array, distance: float, speed: float) -> float:
    starts = np.tile(start, (len(directions), 1))
    starts[:, :3] = pursuit.goal + distance * directions
    starts[:, 3:6] = -speed * directions
    return float(np.isfinite(minimum_capture_times(pursuit, starts)).mean())


def draw(found: dict[str, Any], path: Path) -> list[Path]:
    """Plot the shares over the distance."""
    with styled():
        figure = new_figure(6.5, 3.2)
        axes = figure.subplots()
        for number, (speed, shares) in enumerate(found["share"].items()):
            axes.plot(
                found["distance_m"],
                100.0 * np.array(shares),
                color=f"{0.2 * number:g}",
                label=f"closing at {float(speed):g} m/s",
            )
        axes.set(xlabel="distance from the goal at the start [m]", ylabel="directions [%]", ylim=(-2, 102))
        axes.legend()
        figure.suptitle(f"Where any controller could capture by {PUBLISHED_TIME} s (0.1 N per axis on 9 kg)")
        return save(figure, [path])
