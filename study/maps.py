"""Where each law captures: success and time over distance × tumble rate, with gains tuned on that whole field.

Each law is tuned for the mean capture time over starts at any distance and tumble of the map, failures counting as the horizon;
then, in each cell, the same starts for every law: any direction at that distance, at rest, any attitudes, any axis of tumble.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from detumble.analysis.bounds.runs import capture_bounds
from detumble.analysis.trials import Array, Trials
from detumble.analysis.tuning.objective import Objective
from detumble.analysis.tuning.tuner import tune
from detumble.scenario import Scenario
from detumble.scenario.laws import LAWS, REGISTER, TITLES, Form
from detumble.show.axes import label_decades
from detumble.show.style import new_figure, save, styled
from study.cases import on_spheres, with_laws_of

SEED, HELD_OUT = 23, 24
DISTANCES, RATES = (0.6, 30.0), (math.radians(0.5), math.radians(60.0))
"""Axes of the map: least and greatest, m and rad/s."""
BOUNDED = 24
"""Number of runs of a cell whose bound is computed; the ratio is a median over them."""
HORIZON = 300.0
"""Longest flight, s."""
REQUIRED = 0.5
"""Share of starts that must capture: no torque follows the fastest tumbles."""


def tuned(form: Form, budget: int, starts: int) -> dict[str, Scenario]:
    """Tune every law on the whole field, in this form where it has several."""
    field = on_spheres((float(DISTANCES[0]), float(DISTANCES[1])), (float(RATES[0]), float(RATES[1])))
    objective = Objective("capture", required=REQUIRED, until="captured")
    forms = {law: form if REGISTER[law].forms() else None for law in LAWS}
    return {
        law: tune(
            field, law, form=own, budget=budget, starts=starts, seed=SEED, objective=objective, horizon=HORIZON
        ).scenario
        for law, own in forms.items()
    }


def fly(gains: Mapping[str, Scenario], cells: int, runs: int) -> dict[str, Any]:
    """Fly every law in every cell until capture.

    Args:
        gains: by law, a scenario with its gains.
        cells: along each axis.
        runs: in a cell.

    Returns:
        The axes, `distance_m` and `tumble_rate_rad_s`; and by law `success`, the share of runs that capture within the
        horizon, and `ratio`, the median of capture time over each run's own lower bound, failures counting as infinite:
        (distances, rates) nested lists.
    """
    distances, rates = np.geomspace(*DISTANCES, cells), np.geomspace(*RATES, cells)
    shape = (cells, cells)
    grids = {law: {"success": np.empty(shape), "ratio": np.empty(shape)} for law in gains}
    for cell in np.ndindex(shape):
        distance, rate = float(distances[cell[0]]), float(rates[cell[1]])
        base = on_spheres((distance, distance), (rate, rate))
        bounds = _bounds(base, min(runs, BOUNDED))
        for law, scenario in gains.items():
            flown = Trials(with_laws_of(base, scenario), HELD_OUT, 0, runs, horizon=HORIZON, end="captured").fly(law)
            times = np.where(flown.succeeded[0], flown["capture_time"][0], np.inf)
            grids[law]["success"][cell] = flown.succeeded.mean()
            grids[law]["ratio"][cell] = np.median(times[: len(bounds)] / bounds)
    laws = {law: {name: grid.tolist() for name, grid in found.items()} for law, found in grids.items()}
    return {"distance_m": distances.tolist(), "tumble_rate_rad_s": rates.tolist(), "laws": laws}


def _bounds(scenario: Scenario, runs: int) -> Array:
    """Give the least time, s, of the first runs, at least one control period."""
    return np.maximum(capture_bounds(Trials(scenario, HELD_OUT, 0, runs), processes=1), scenario.time.control_period)


def draw(found: Mapping[str, Any], title: str, path: Path) -> list[Path]:
    """Plot success above and ratio to the bound below, one column a law."""
    grids, distances = found["laws"], np.array(found["distance_m"])
    with styled():
        figure = new_figure(2.3 * len(grids) + 1.0, 5.0)
        panels = figure.subplots(2, len(grids), sharex=True, sharey=True, squeeze=False)
        degrees = np.degrees(found["tumble_rate_rad_s"])
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
                panels[row][column].set(xscale="log", yscale="log")
                for axis in (panels[row][column].xaxis, panels[row][column].yaxis):
                    label_decades(axis)
                panels[row][column].grid(visible=False)
        for row, (mesh, label) in enumerate(
            ((success, "captures within 300 s [%]"), (slowness, "median capture time / bound"))
        ):
            panels[row][0].set_ylabel("distance [m]")
            figure.colorbar(mesh, ax=list(panels[row]), label=label, pad=0.01, extend="max" if row else "neither")
        figure.suptitle(f"Where the tuned laws capture: {title} (grey: fewer than half of the runs do)")
        return save(figure, [path])
