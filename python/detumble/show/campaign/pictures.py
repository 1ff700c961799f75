"""Every picture of a campaign, from its statistics, its table, and a few of its runs flown again."""

from __future__ import annotations

import math
from contextlib import suppress
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
import polars as pl

from detumble.campaigns import FIGURES
from detumble.campaigns.runs import draws
from detumble.campaigns.statistics.inputs import drawn_columns, inputs
from detumble.campaigns.store.rows import SUCCEEDED, drawn_names
from detumble.checking import texts
from detumble.errors import RequestError
from detumble.results import results_folder
from detumble.scenario.dispersions.fitting import fields
from detumble.scenario.wording import pretty
from detumble.show.campaign import (
    Caption,
    Trace,
    capture_times,
    convergence,
    envelope,
    failures,
    sensitivity,
    success_map,
)
from detumble.text import did_you_mean
from detumble.writing import output_folder

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from detumble.campaigns.result import CampaignResult
    from detumble.campaigns.statistics.sensitivity import Sensitivity
    from detumble.scenario.model import Scenario

Array: TypeAlias = "NDArray[np.float64]"

MAPPED = 200_000
"""Most runs of the success map, the first of the campaign."""
REFLOWN = 200
"""Most runs of the envelope, the first of the campaign."""
TICKS = 4_000_000
"""Most ticks kept for it in all."""
SEEN = ("distance", "angle_error", "rate_error")
"""Series that it shows."""


def draw(result: CampaignResult, over: Sequence[str], target: float | None) -> list[Path]:
    """Write the pictures into the folder `figures` of a campaign.

    Args:
        result: the campaign.
        over: the two inputs of the success map; none takes the two that matter most.
        target: half width of the success interval that was asked for.

    Returns:
        The files.

    Raises:
        RequestError: there are no such inputs, SALib is not installed, or a file cannot be written.
    """
    statistics, recipe = result.statistics, result.recipe
    scenario, law = recipe.parsed, recipe.law
    check_map(scenario, over)
    caption = Caption(scenario.title, law, statistics.runs, recipe.seed)
    folder = result.folder / "figures"
    rows = result.runs.lazy().head(MAPPED)
    rows = rows.select(SUCCEEDED.name, *drawn_columns(rows.collect_schema().names()))
    table = rows.collect()
    varying, _ = inputs(table, scenario)
    with results_folder(result.folder, FIGURES), output_folder(folder):
        settled = {law: statistics.ecdf("settled_time_s")} if scenario.capture.merge and law != "none" else {}
        files = [
            capture_times({law: statistics.ecdf("capture_time_s")}, settled, caption, folder / "capture-times.png"),
            failures(statistics.success, statistics.failures, caption, folder / "failures.png"),
            convergence(statistics.convergence(), caption, folder / "convergence.png", target),
            *_envelope(result, caption, folder / "envelope.png"),
        ]
        if varying:
            outcomes = result.sensitivities()
            files.append(sensitivity(outcomes, caption, folder / "sensitivity.png"))
            across, up = over or _strongest(outcomes, varying)
            labels = (_label(across), _label(up))
            success = table[SUCCEEDED.name].to_numpy()
            files.append(
                success_map(varying[across], varying[up], success, labels, caption, folder / "success-map.png")
            )
    return files


def check_map(scenario: Scenario, over: Sequence[str]) -> None:
    """Make sure, before anything is flown, that a success map can be drawn over two inputs.

    Args:
        scenario: what is flown.
        over: the two inputs; none is fine.

    Raises:
        RequestError: they are not two, or not drawn.
    """
    if not texts("over", over):
        return
    drawn: dict[str, Array] = {}
    for path, values in draws.draw(scenario, 0, 0, 2).items():
        rows = values.reshape(2, -1)
        names = drawn_names(path, fields()[path].shape, rows.shape[1])
        drawn |= {name: rows[:, element] for element, name in enumerate(names)}
    varying, _ = inputs(pl.DataFrame(drawn), scenario)
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


def _envelope(result: CampaignResult, caption: Caption, path: Path) -> list[Path]:
    """Draw runs flown again, without those that cannot be, or that have no finite row; nothing where none is left."""
    scenario = result.recipe.parsed
    ticks = round(scenario.time.duration / scenario.time.control_period) + 1
    count = min(result.statistics.runs, max(10, min(REFLOWN, TICKS // ticks)))
    time, seen = np.empty(0), np.full((len(SEEN), count, ticks), np.nan)
    for index in range(count):
        with suppress(RequestError):  # one run that cannot be flown again stops no picture
            own, *series = _seen(result, index)
            time = max(time, own, key=len)
            for values, one in zip(seen, series, strict=True):
                values[index, : len(one)] = one
    if not len(time):
        return []
    distance, angle, rate = seen[:, :, : len(time)]
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
    return [envelope(time, traces, caption, path)]


def _seen(result: CampaignResult, index: int) -> list[Array]:
    """Fly a run again, and let go of all of its history but the time and the series that are drawn."""
    history = result.replay(index).history
    return [history[name] for name in ("time", *SEEN)]
