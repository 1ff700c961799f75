"""The pictures of a campaign: from its statistics, its table, and some of its runs flown again."""

from __future__ import annotations

import math
from contextlib import suppress
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
import polars as pl

from detumble.campaigns import FIGURES
from detumble.campaigns.columns import SUCCEEDED, drawn_table
from detumble.campaigns.runs import draws
from detumble.campaigns.runs.flying import fly_again
from detumble.campaigns.statistics.inputs import drawn_columns, inputs
from detumble.campaigns.statistics.sensitivity import sensitivities
from detumble.campaigns.store.table import Runs
from detumble.checking import texts
from detumble.errors import RequestError
from detumble.results import results_folder
from detumble.scenario.dispersions.fitting import fields
from detumble.scenario.wording import pretty
from detumble.show.campaign import (
    Caption,
    Trace,
    plot_capture_times,
    plot_convergence,
    plot_envelope,
    plot_failures,
    plot_sensitivity,
    plot_success_map,
)
from detumble.show.style import write_figure
from detumble.text import did_you_mean
from detumble.writing import output_folder

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from detumble.campaigns.recipe import Recipe
    from detumble.campaigns.statistics.running import Statistics
    from detumble.campaigns.statistics.sensitivity import Sensitivity
    from detumble.campaigns.store.campaign_folder import Store
    from detumble.scenario.model import Scenario

Array: TypeAlias = "NDArray[np.float64]"

MAPPED = 200_000
"""Most runs of the success map, the first of the campaign."""
REFLOWN = 200
"""Most runs of the envelope, the first of the campaign."""
TICKS = 4_000_000
"""Most ticks of the envelope, over all of its runs."""
ENVELOPE = ("distance", "angle_error", "rate_error")
"""Time series of the envelope."""


def write_pictures(store: Store, statistics: Statistics, over: Sequence[str], target: float | None) -> list[Path]:
    """Write the pictures into the folder `figures` of a campaign.

    Args:
        store: the folder of the campaign.
        statistics: of all its runs.
        over: the two inputs of the success map; none takes the two that matter most.
        target: half width of the success interval that was asked for.

    Returns:
        The files.

    Raises:
        RequestError: there are no such inputs, SALib is not installed, or a file cannot be written.
    """
    recipe = store.recipe
    scenario, law = recipe.parsed, recipe.law
    check_map(scenario, over)
    caption = Caption(scenario.title, law, statistics.runs, recipe.seed)
    folder = store.folder / "figures"
    runs = Runs(store, statistics.runs).lazy()
    table = runs.head(MAPPED).select(SUCCEEDED.name, *drawn_columns(runs.collect_schema().names())).collect()
    varying, _ = inputs(table, scenario)
    with results_folder(store.folder, FIGURES), output_folder(folder):
        settled = {law: statistics.ecdf("settled_time_s")} if scenario.capture.merge and law != "none" else {}
        captured = {law: statistics.ecdf("capture_time_s")}
        files = [
            write_figure(lambda: plot_capture_times(captured, settled, caption), folder / "capture-times.png"),
            write_figure(
                lambda: plot_failures(statistics.success, statistics.failures, caption), folder / "failures.png"
            ),
            write_figure(
                lambda: plot_convergence(statistics.convergence(), caption, target), folder / "convergence.png"
            ),
            *_envelope(recipe, statistics.runs, caption, folder / "envelope.png"),
        ]
        if varying:
            outcomes = sensitivities(runs, scenario)
            files.append(write_figure(lambda: plot_sensitivity(outcomes, caption), folder / "sensitivity.png"))
            across, up = over or _strongest(outcomes, varying)
            x, y, success = varying[across], varying[up], table[SUCCEEDED.name].to_numpy()
            labels = (_label(across), _label(up))
            files.append(
                write_figure(
                    lambda: plot_success_map(x, y, success, labels, caption),
                    folder / "success-map.png",
                )
            )
    return files


def check_map(scenario: Scenario, over: Sequence[str]) -> None:
    """Check, before anything is flown, that a success map can be made over two inputs.

    Args:
        scenario: what is flown.
        over: the two inputs; none is fine.

    Raises:
        RequestError: they are not two, or not drawn.
    """
    if not texts("over", over):
        return
    varying, _ = inputs(pl.DataFrame(drawn_table(draws.draw(scenario, 0, 0, 2))), scenario)
    for name in over:
        if name not in varying:
            raise RequestError(
                f"--map {name}: not drawn{did_you_mean(name, varying)}; there are {', '.join(varying) or 'none'}"
            )
    if len(over) != 2 or over[0] == over[1]:
        raise RequestError("--map: give it twice, with two different inputs")


def _strongest(outcomes: Sequence[Sensitivity], varying: dict[str, Array]) -> tuple[str, str]:
    """Name the two inputs, of two fields if there are two, that matter most to failure, or else to the capture time."""
    ranked = [influence.field for outcome in outcomes for influence in outcome.influences]
    names = list(dict.fromkeys([*(name for name in ranked if name in varying), *varying]))
    first = names[0]
    return first, next((name for name in names if _field(name) != _field(first)), names[min(1, len(names) - 1)])


def _field(name: str) -> str:
    """Name the dispersed field that an input comes from; the input itself if it comes from several."""
    stem = name.strip("|").partition(" ")[0]
    return next((path for path in (stem, stem.rpartition(".")[0]) if path in fields()), name)


def _label(name: str) -> str:
    """Write an input with its unit."""
    turned = " " in name  # angles and components of a turn, which come from attitudes
    unit = "rad" if turned else pretty(fields()[_field(name)].unit)
    return f"{name} [{unit}]" if unit else name


def _envelope(recipe: Recipe, runs: int, caption: Caption, path: Path) -> list[Path]:
    """Plot runs flown again, without those that cannot be flown or have no finite row; no picture where none is left."""
    scenario = recipe.parsed
    ticks = round(scenario.time.duration / scenario.time.control_period) + 1
    count = min(runs, max(10, min(REFLOWN, TICKS // ticks)))
    time, series = np.empty(0), np.full((len(ENVELOPE), count, ticks), np.nan)
    for index in range(count):
        with suppress(RequestError):  # a run that cannot be flown again does not stop the picture
            own, *values = _history(recipe, index)
            time = max(time, own, key=len)
            series[:, index, : len(own)] = values
    if not len(time):
        return []
    distance, angle, rate = series[:, :, : len(time)]
    capture, settled = scenario.capture, scenario.settled
    traces = [
        Trace("distance to goal [m]", distance, {"capture": capture.distance}),
        Trace(
            "attitude error [°]",
            np.multiply(angle, math.degrees(1.0), out=angle),
            {"capture": capture.angle_deg, "settled": settled.angle_deg},
        ),
        Trace("rate error [rad/s]", rate, {"capture": capture.rate, "settled": settled.rate}),
    ]
    return [write_figure(lambda: plot_envelope(time, traces, caption), path)]


def _history(recipe: Recipe, index: int) -> list[Array]:
    """Fly a run again, and keep only the time and the series that are plotted, (ticks,) each."""
    history = fly_again(recipe, index).history
    return [history[name] for name in ("time", *ENVELOPE)]
