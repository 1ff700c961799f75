"""Where each law captures: success and time over distance × tumble rate, with the gains tuned on the dispersed case.

In each cell the same 200 starts for every law: any direction at that distance, at rest, any attitudes, any axis of tumble.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from detumble.analysis.bounds.earliest import minimum_capture_times
from detumble.analysis.bounds.pursuit import Pursuit
from detumble.analysis.trials import Array, Trials
from detumble.scenario import Scenario
from detumble.scenario.core import case
from detumble.scenario.laws import TITLES
from detumble.show.style import new_figure, save, styled
from study.axes import plain_log
from study.cases import on_spheres, with_laws_of

SEED = 23
RUNS = 200
BOUNDED = 24
"""Runs of a cell whose bound is computed; the median of the ratio is of these."""
HORIZON = 300.0
"""s"""


def fly(tuned: Mapping[str, Scenario], distances: Array, rates: Array, runs: int = RUNS) -> dict[str, Any]:
    """Fly every law in every cell until capture.

    Args:
        tuned: by law, a scenario with its gains.
        distances: from the goal, m.
        rates: of tumble, rad/s.
        runs: in a cell.

    Returns:
        By law: `success`, the share of runs that capture within the horizon, and `ratio`, the median of capture time over
        each run's own lower bound, failures counting as infinite; (distances, rates) nested lists.
    """
    shape = (len(distances), len(rates))
    found = {law: {"success": np.empty(shape), "ratio": np.empty(shape)} for law in tuned}
    for cell in np.ndindex(shape):
        base = on_spheres(float(distances[cell[0]]), float(rates[cell[1]]))
        bounds = _bounds(base, min(runs, BOUNDED))
        for law, scenario in tuned.items():
            flown = Trials(with_laws_of(base, scenario), SEED, 0, runs, horizon=HORIZON, end="captured").fly(law)
            times = np.where(flown.succeeded[0], flown["capture_time"][0], np.inf)
            found[law]["success"][cell] = flown.succeeded.mean()
            found[law]["ratio"][cell] = np.median(times[: len(bounds)] / bounds)
    return {law: {name: grid.tolist() for name, grid in grids.items()} for law, grids in found.items()}


def _bounds(scenario: Scenario, runs: int) -> Array:
    """Give the least time, s, of the first runs, at least one control period."""
    trials = Trials(scenario, SEED, 0, runs)
    plain = case(scenario, "none")
    starts = np.tile(np.concatenate([np.ravel(plain["start"][name]) for name in _ORDER]), (runs, 1))
    columns = trials.columns("none")
    at = 0
    for name in _ORDER:
        width = np.size(plain["start"][name])
        starts[:, at : at + width] = columns.get(f"start.{name}", starts[:, at : at + width])
        at += width
    return np.maximum(minimum_capture_times(Pursuit.of(plain), starts), scenario.time.control_period)


_ORDER = ("position", "velocity", "chaser_attitude", "chaser_rate", "debris_attitude", "debris_rate")


def draw(grids: Mapping[str, Any], distances: Array, rates: Array, path: Path) -> list[Path]:
    """Draw success above and ratio to the bound below, one column a law."""
    with styled():
        figure = new_figure(2.3 * len(grids) + 1.0, 5.0)
        panels = figure.subplots(2, len(grids), sharex=True, sharey=True, squeeze=False)
        degrees = np.degrees(rates)
        for column, (law, grid) in enumerate(grids.items()):
            ratio = np.array(grid["ratio"])
            success = panels[0][column].pcolormesh(
                degrees,
                distances,
                np.array(grid["success"]) * 100.0,
                vmin=0,
                vmax=100,
                cmap="viridis",
                shading="nearest",
            )
            slowness = panels[1][column].pcolormesh(
                degrees,
                distances,
                np.where(np.isfinite(ratio), ratio, np.nan),
                vmin=1,
                vmax=4,
                cmap="magma_r",
                shading="nearest",
            )
            panels[0][column].set_title(TITLES[law])
            panels[1][column].set_xlabel("tumble rate [°/s]")
            panels[1][column].set_facecolor("#B0B0B0")
            for row in (0, 1):
                plain_log(panels[row][column])
                panels[row][column].grid(visible=False)
        for row, (mesh, label) in enumerate(
            ((success, "captures within 300 s [%]"), (slowness, "median capture time / bound"))
        ):
            panels[row][0].set_ylabel("distance [m]")
            figure.colorbar(mesh, ax=list(panels[row]), label=label, pad=0.01, extend="max" if row else "neither")
        figure.suptitle("Where the tuned laws capture (grey: fewer than half do)")
        return save(figure, [path])
