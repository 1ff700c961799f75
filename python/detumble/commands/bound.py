"""`detumble bound`: what any controller could do at best: capture time, Δv, detumbling."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from detumble.commands.arguments import AsJson, More, ScenarioName, Settings, out_option, scenario_of
from detumble.commands.bounds_of_runs import bounds_of_runs, summary, text_of_runs, write_runs
from detumble.commands.printing import json_text, print_result, remark, remark_written
from detumble.errors import RequestError
from detumble.tables import fixed, table

if TYPE_CHECKING:
    from detumble.analysis.bounds.bound import Bounds
    from detumble.quaternions import Array
    from detumble.scenario.model import Scenario


TABLES = ("translation.csv", "least_delta_v.csv", "attitude.csv")
FILES = ("bound.json", "bounds.parquet", "scenario.toml", "bound.png", *TABLES)
"""Patterns of what is written into --out."""


def bound(
    scenario: ScenarioName,
    more: More = None,
    within: Annotated[
        float | None, typer.Option(metavar="SECONDS", help="Least Δv to capture within this time.  [the duration]")
    ] = None,
    runs: Annotated[
        int | None, typer.Option(help="Bound so many runs of the campaign instead, about two seconds each.")
    ] = None,
    quick: Annotated[
        bool, typer.Option("--quick", help="With --runs: the lower bound of the capture time alone, milliseconds each.")
    ] = False,
    seed: Annotated[int | None, typer.Option(help="Seed of the campaign.  [0]")] = None,
    settings: Settings = None,
    out: Annotated[Path | None, out_option("Write bounds and trajectories here.")] = None,
    as_json: AsJson = False,
) -> None:
    """Bound what any controller could do: the fastest capture, the least Δv, the least time to detumble."""
    from detumble.analysis.bounds.bound import bound as bounds_of
    from detumble.results import results_folder
    from detumble.simulation import INSIDE
    from detumble.surroundings import check_polars

    if out:
        check_polars()  # which writes the tables
    if (quick or seed is not None) and runs is None:
        raise RequestError("--quick and --seed: need --runs, the number of runs of the campaign")
    chosen = scenario_of(scenario, settings, more)
    with results_folder(out, FILES, scenario, stale=FILES):
        if runs is not None:
            seed = 0 if seed is None else seed
            values = bounds_of_runs(chosen, runs, seed, within, quick)
            files = write_runs(chosen, values, out) if out else []
            result, text = summary(values) | {"runs": runs, "seed": seed}, text_of_runs(chosen, values, seed)
        else:
            found = bounds_of(chosen, within)
            files = _write(chosen, found, out) if out else []
            result, text = found.to_json(), _text(chosen, found)
            if found.capture.upper == 0.0:
                remark(f"warning: {INSIDE}")
            if chosen.dispersions:
                remark(f"nominal values bounded: --runs takes the {len(chosen.dispersions)} dispersions into account")
    print_result(as_json, result | {"scenario": chosen.title}, lambda: text, files)
    remark_written(files)


def _text(scenario: Scenario, found: Bounds) -> str:
    rows = [("", "no less than", "done in", "gap %", "unit")]
    for label, bracket, unit in (
        ("capture", found.capture, "s"),
        ("translation alone", found.translation, "s"),
        ("attitude alone", found.attitude, "s"),
        (f"Δv within {found.within:g} s", found.delta_v, "m/s"),
    ):
        gap = 100.0 * (bracket.upper / bracket.lower - 1.0) if bracket.lower > 0.0 else None
        decimals = 5 if unit == "m/s" else 3
        rows.append((label, fixed(bracket.lower, decimals), fixed(bracket.upper, decimals), fixed(gap, 2), unit))
    rows.append(("detumbling", fixed(found.detumble.lower, 3), "–", "–", "s"))
    rows.append(("detumbling after a perfect match", fixed(found.detumble.matched, 3), "–", "–", "s"))
    notes = (
        "No controller does it in less, with or without noise; the other column is done by a trajectory found.",
        "Capture is judged at control ticks, its two halves at any time. A dash: not within the flight, or none found.",
    )
    return "\n".join([scenario.title, "", table(rows), "", *notes])


def _write(scenario: Scenario, found: Bounds, out: Path) -> list[Path]:
    from detumble.show.bound import plot_bound
    from detumble.show.style import write_figure
    from detumble.writing import write_text

    files = [out / "bound.json", out / "scenario.toml"]
    write_text(files[0], json_text(found.to_json()) + "\n")
    write_text(files[1], scenario.to_toml())
    capture = found.capture
    for name, transfer in (("translation", capture.transfer), ("least_delta_v", found.delta_v.transfer)):
        if transfer is not None:
            columns = {"position_m": transfer.states[:, :3], "velocity_m_s": transfer.states[:, 3:]}
            files.append(
                _table(out / f"{name}.csv", transfer.times, columns, "acceleration_m_s2", transfer.acceleration)
            )
    if capture.slew is not None:
        slew = capture.slew
        turn = {"attitude": slew.attitude, "rate_rad_s": slew.rate}
        files.append(_table(out / "attitude.csv", slew.times, turn, "torque_n_m", slew.torque))
    if capture.transfer is not None:
        files.append(write_figure(lambda: plot_bound(scenario.title, capture), out / "bound.png"))
    return files


def _table(path: Path, times: Array, states: dict[str, Array], held: str, control: Array) -> Path:
    """Write a trajectory: a row for each time, with the control from then on; the last row has none."""
    import numpy as np
    import polars as pl

    from detumble.writing import write_text

    columns = {"time_s": times}
    for name, values in (states | {held: np.vstack((control, np.full((1, 3), np.nan)))}).items():
        axes = "xyz" if values.shape[1] == 3 else "wxyz"
        columns |= {f"{name}.{axis}": values[:, index] for index, axis in enumerate(axes)}
    write_text(path, pl.DataFrame(columns).fill_nan(None).write_csv())
    return path
