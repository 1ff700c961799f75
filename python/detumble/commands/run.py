"""`detumble run`: one flight, its metrics, and on request its files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from detumble.commands.arguments import SCENARIO, AsJson, Backend, Law, More, Settings, out_option, scenario_of
from detumble.commands.printing import json_text, print_result, remark, remark_written
from detumble.errors import RequestError
from detumble.tables import cell, table

if TYPE_CHECKING:
    from detumble.flight import Flight

FILES = ("flight.nc", "scenario.toml", "metrics.json", "flight.png")
"""Files that are written into --out."""
ALWAYS_SHOWN = ("capture_time", "settling_time")
"""Metrics that are shown as a dash where they did not happen; others are left out."""


def run(
    scenario: Annotated[str | None, SCENARIO] = None,
    more: More = None,
    law: Law = None,
    seed: Annotated[int | None, typer.Option(help="Seed of the sensor noise.  [0]")] = None,
    index: Annotated[int, typer.Option(help="Index of the trajectory under that seed: each has its own noise.")] = 0,
    replay: Annotated[
        str | None, typer.Option(metavar="DIR:INDEX", help="Fly a run of a campaign again, instead of a scenario.")
    ] = None,
    replay_wrench: Annotated[
        str | None,
        typer.Option(
            metavar="FLIGHT.nc", help="Fly the commands that a flight recorded again, without sensors and law."
        ),
    ] = None,
    settings: Settings = None,
    out: Annotated[Path | None, out_option("Write flight, scenario and metrics here.")] = None,
    as_json: AsJson = False,
    backend: Backend = None,
) -> None:
    """Fly one scenario once and print its metrics."""
    from detumble import recorded
    from detumble.results import results_folder
    from detumble.simulation import simulate

    if sum(given is not None for given in (scenario, replay, replay_wrench)) != 1:
        raise RequestError("run: needs one of a scenario, --replay DIR:INDEX and --replay-wrench FLIGHT.nc")
    with results_folder(out, FILES, scenario or replay_wrench or ""):
        if scenario is None:
            if settings or more or index or law is not None or seed is not None:
                option = "--replay: flies a run" if replay_wrench is None else "--replay-wrench: flies a flight"
                raise RequestError(f"{option} as it was; neither law nor seed nor field can be set")
            flight = (
                _again(replay or "", backend)
                if replay_wrench is None
                else recorded.replay_wrench(replay_wrench, backend=backend)
            )
        else:
            chosen = scenario_of(scenario, settings, more, quiet=True)
            flight = simulate(chosen, law, 0 if seed is None else seed, index=index, backend=backend)
            if chosen.dispersions:
                remark(f"nominal values flown: {len(chosen.dispersions)} dispersions are for detumble campaign")
        files = _write(flight, out) if out else []
    print_result(as_json, _json(flight), lambda: _text(flight), files)
    for warning in flight.warnings:
        remark(f"warning: {warning}")
    remark_written(files)
    if flight.broken_off:
        raise typer.Exit(1)


def _again(replay: str, backend: str | None) -> Flight:
    """Fly the run DIR:INDEX of a campaign."""
    from detumble.campaigns.runs.flying import checked_index, fly_again
    from detumble.campaigns.store.campaign_folder import Store

    directory, colon, index = replay.rpartition(":")
    if not (colon and directory and index.isdecimal()):
        raise RequestError(f"--replay {replay}: must be DIR:INDEX, the folder of a campaign and the index of a run")
    store = Store.open(directory)
    return fly_again(store.recipe, checked_index(int(index), store.runs), backend=backend)


def _json(flight: Flight) -> dict[str, object]:
    return {
        "scenario": flight.scenario.title,
        "law": flight.law,
        "seed": flight.seed,
        "index": flight.index,
        "backend": flight.backend,
        "integration_step_s": flight.integration_step,
        **flight.metrics.to_json(),
        "events": [{"name": event.name, "time_s": event.time} for event in flight.events],
        "warnings": list(flight.warnings),
    }


def _text(flight: Flight) -> str:
    from detumble.metrics import METRICS
    from detumble.scenario.laws import TITLES

    rows = []
    for metric in METRICS:
        value = getattr(flight.metrics, metric.name)
        if value is None and metric.name not in ALWAYS_SHOWN:
            continue
        numbers = value if isinstance(value, tuple) else (value,)
        shown = "  ".join(
            str(number) if metric.kind == "whole" and number is not None else cell(number, 4) for number in numbers
        )
        rows.append((metric.label, shown, metric.unit))
    run = f", run {flight.index}" if flight.index else ""
    width = max(len(row[1]) for row in rows)
    lines = table([(label, shown.rjust(width)) for label, shown, _ in rows], header=False).splitlines()
    body = [f"{line}  {unit}".rstrip() for line, (_, _, unit) in zip(lines, rows, strict=True)]
    return "\n".join([flight.scenario.title, f"{TITLES[flight.law]}, seed {flight.seed}{run}", "", *body])


def _write(flight: Flight, folder: Path) -> list[Path]:
    from detumble.show.flight import plot_flight
    from detumble.show.style import write_figure
    from detumble.writing import write_text

    files = [folder / name for name in FILES]
    flight.to_netcdf(files[0])
    write_text(files[1], flight.scenario.to_toml())
    write_text(files[2], json_text({**_json(flight), "files": []}) + "\n")
    write_figure(lambda: plot_flight(flight), files[3])
    return files
