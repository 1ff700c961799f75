"""`detumble paper`: the paper's five laws against its published capture times, with its figures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from detumble.commands.arguments import AsJson, out_option
from detumble.commands.printing import json_text, print_result, remark
from detumble.tables import fixed, table

if TYPE_CHECKING:
    from detumble.flight import Flight

SCENARIO = "paper"
FILES = ("paper.json", "scenario.toml", "fig[1-9]_*.png", "fig[1-9]_*.svg")
"""Patterns of what is written into --out."""


def paper(
    out: Annotated[Path | None, out_option("Write figures, numbers and scenario here.")] = None,
    as_json: AsJson = False,
) -> None:
    """Fly the paper's case under its five laws and compare."""
    from detumble.analysis.bounds.earliest import minimum_capture_time
    from detumble.results import results_folder
    from detumble.scenario.files import load
    from detumble.scenario.paper import PUBLISHED_CAPTURE_TIMES
    from detumble.simulation import simulate

    scenario = load(SCENARIO)
    with results_folder(out, FILES):
        flights = {law: simulate(scenario, law) for law in PUBLISHED_CAPTURE_TIMES}
        minimum = float(minimum_capture_time(scenario))
        result = {"laws": {law: _numbers(law, flight, minimum) for law, flight in flights.items()}}
        files = _write(flights, result, minimum, out) if out else []
    print_result(as_json, result, lambda: _text(flights, minimum), files)
    for law, flight in flights.items():
        for warning in flight.warnings:
            remark(f"warning: {law}: {warning}")
    if files:
        remark(f"written: {len(files)} files in {out}")
    if any(flight.broken_off for flight in flights.values()):
        raise typer.Exit(1)


def _numbers(law: str, flight: Flight, minimum: float) -> dict[str, Any]:
    from detumble.scenario.paper import PUBLISHED_CAPTURE_TIMES

    metrics = flight.metrics.to_json()
    return {
        "capture_time_s": metrics.pop("capture_time_s"),
        "published_s": PUBLISHED_CAPTURE_TIMES[law],
        "minimum_time_s": minimum,
        **metrics,
        "warnings": list(flight.warnings),
    }


def _text(flights: dict[str, Flight], minimum: float) -> str:
    import math

    from detumble.scenario.laws import TITLES
    from detumble.scenario.paper import PUBLISHED_CAPTURE_TIMES

    header = (
        "law",
        "capture s",
        "published s",
        "off %",
        "minimum s",
        "settling s",
        "Δv m/s",
        "force sat. %",
        "rate mrad/s",
        "pointing °",
    )
    rows = [header]
    for law, flight in flights.items():
        metrics, published = flight.metrics, PUBLISHED_CAPTURE_TIMES[law]
        capture, saturated = metrics.capture_time, metrics.force_saturated_share
        rate, pointing = metrics.final_rate, metrics.final_pointing
        rows.append(
            (
                TITLES[law],
                fixed(capture, 1),
                fixed(published, 1),
                "–" if capture is None else f"{100 * (capture / published - 1):+.1f}",
                fixed(minimum, 1),
                fixed(metrics.settling_time, 1),
                fixed(metrics.delta_v, 3),
                fixed(None if saturated is None else 100 * saturated, 1),
                fixed(None if rate is None else 1e3 * rate, 2),
                fixed(None if pointing is None else math.degrees(pointing), 2),
            )
        )
    scenario = next(iter(flights.values())).scenario
    notes = (
        "Minimum: before that no controller whatever can capture from this start under these limits (a lower bound).",
        "Settling counts from capture; rate and pointing are the stack's against LVLH at the end.",
    )
    return "\n".join((scenario.title, "", table(rows), "", *notes))


def _write(flights: dict[str, Flight], result: dict[str, Any], minimum: float, folder: Path) -> list[Path]:
    from detumble.show.figures import paper_figures
    from detumble.writing import write_text

    files = [folder / "paper.json", folder / "scenario.toml"]
    write_text(files[0], json_text(result) + "\n")
    write_text(files[1], next(iter(flights.values())).scenario.to_toml())
    return [*files, *paper_figures(flights, folder, minimum)]
