"""`detumble campaign`: many runs of one scenario with dispersed numbers, and their statistics."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from detumble.campaigns import FIGURES
from detumble.commands.arguments import (
    AsJson,
    Backend,
    Law,
    More,
    ScenarioName,
    Settings,
    Threads,
    out_option,
    scenario_of,
)
from detumble.commands.printing import json_text, print_result, remark, remark_written
from detumble.errors import RequestError
from detumble.tables import fixed, table

if TYPE_CHECKING:
    from detumble.campaigns.result import CampaignResult
    from detumble.campaigns.statistics.running import Statistics
    from detumble.scenario.model import Scenario

FILES = ("summary.json", *FIGURES)
"""Written into --out beside the runs."""
DEFAULT_RUNS = 1000
MOST_RUNS = 1_000_000
"""Default of --runs with --until-ci."""
SHOWN = (
    ("capture_time_s", "capture", "s", 1),
    ("settling_time_s", "settling", "s", 1),
    ("delta_v_m_s", "Δv", "m/s", 3),
    ("delta_v_to_capture_m_s", "Δv to capture", "m/s", 3),
)


def campaign(
    scenario: ScenarioName,
    out: Annotated[Path, out_option("Folder of the campaign.")],
    more: More = None,
    law: Law = None,
    runs: Annotated[
        int | None, typer.Option(help="Number of runs; with --until-ci the most to fly.  [1000, or 1000000]")
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of all random numbers.")] = 0,
    settings: Settings = None,
    threads: Threads = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Dask scheduler whose workers fly: tcp://host:8786")
    ] = None,
    local_cluster: Annotated[
        int | None, typer.Option(metavar="N", help="Start N Dask workers on this machine, and let them fly.")
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Continue the campaign in DIR.")] = False,
    until_ci: Annotated[
        float | None,
        typer.Option(metavar="HALF_WIDTH", help="Stop once the success probability is known this well (95 %)."),
    ] = None,
    figures: Annotated[bool, typer.Option("--figures", help="Write figures into DIR/figures.")] = False,
    over: Annotated[
        list[str] | None,
        typer.Option("--map", metavar="COLUMN", help="Give it twice: the two columns of the success map."),
    ] = None,
    as_json: AsJson = False,
    backend: Backend = None,
) -> None:
    """Fly a scenario many times and say how surely, how fast and at what cost it captures."""
    from detumble.surroundings import check_polars

    check_polars()  # before polars is imported, which prints warnings of its own
    from detumble.campaigns.campaign import campaign as fly
    from detumble.commands.progress import Line
    from detumble.results import refuse_foreign, results_folder
    from detumble.writing import write_text

    chosen = scenario_of(scenario, settings, more)
    refuse_foreign(out, FILES, scenario)
    if over and not figures:
        raise RequestError("--map: needs --figures")
    if figures:
        _check_figures(chosen, tuple(over or ()))
    with Line(out, "runs", _success) as line:
        result = fly(
            chosen,
            law,
            _runs(runs, until_ci, out if resume else None),
            seed,
            out,
            threads=threads,
            scheduler=scheduler,
            local_cluster=local_cluster,
            resume=resume,
            until_ci=until_ci,
            backend=backend,
            watcher=line,
        )
    with results_folder(out, FILES, stale=FILES if result.effort.flown or figures else ()):
        write_text(out / "summary.json", json_text(result.to_json()) + "\n")
        pictures = result.figures(tuple(over or ()), until_ci) if figures else []
    print_result(as_json, result.to_json(), lambda: _text(result), pictures)
    half_width = result.statistics.success.half_width
    if until_ci is not None and half_width > until_ci:
        remark(
            f"the interval is still {half_width:.3g} to either side, not {until_ci:g}: --resume with more --runs goes on"
        )
    for warning in result.warnings:
        if warning not in chosen.warnings:  # those were printed before
            remark(f"warning: {warning}")
    remark_written(pictures)
    if result.statistics.broken_off == result.statistics.runs:
        raise typer.Exit(1)


def _runs(asked: int | None, until_ci: float | None, resumed: Path | None) -> int:
    """Give the number of runs: as asked for, else that of the campaign that is continued, else the default."""
    from detumble.campaigns.store.manifest import MANIFEST, read_manifest

    if asked is not None:
        return asked
    if resumed is not None and (resumed / MANIFEST).exists():
        return read_manifest(resumed).runs
    return DEFAULT_RUNS if until_ci is None else MOST_RUNS


def _check_figures(scenario: Scenario, over: tuple[str, ...]) -> None:
    """Check, before anything is flown, that the figures can be made."""
    from detumble.campaigns.pictures import check_map
    from detumble.campaigns.statistics.sensitivity import pawn

    check_map(scenario, over)
    if scenario.dispersions:
        pawn()


def _success(statistics: Statistics) -> str:
    """Give the success of the runs so far, for the progress line."""
    estimate = statistics.success
    return f"success {100 * estimate.share:.2f} ± {100 * estimate.half_width:.2f} %" if statistics.runs else ""


def _text(result: CampaignResult) -> str:
    from detumble.scenario.laws import TITLES

    statistics, recipe = result.statistics, result.recipe
    success = statistics.success
    lines = [
        recipe.parsed.title,
        f"{TITLES[recipe.law]}, seed {recipe.seed}, {statistics.runs} runs",
        "",
        f"success  {100 * success.share:.2f} %   95 % interval {100 * success.low:.2f} to {100 * success.high:.2f} %",
    ]
    lines += ["", _quantiles(statistics)]
    if statistics.failures:
        lines += ["", _failures(statistics)]
    effort = result.effort.to_json()
    if result.effort.flown:
        lines += [
            "",
            f"{result.effort.flown} runs flown in {result.effort.seconds:.1f} s: {effort['rate_runs_per_s']:.4g} runs/s, "
            f"{effort['steps_per_s']:.3g} steps/s, lanes {100 * (effort['lane_use'] or 0.0):.1f} % busy",
        ]
    return "\n".join(lines)


def _quantiles(statistics: Statistics) -> str:
    rows = [("", "runs", "5 %", "median", "95 %", "95 % interval of the median", "unit")]
    for name, label, unit, decimals in SHOWN:
        summary = statistics.summary(name)
        if not summary.count:
            continue
        low, median, high = (summary.quantiles[percent] for percent in (5, 50, 95))
        between = f"{fixed(median.low, decimals)} – {fixed(median.high, decimals)}"
        five, half, ninety_five = (fixed(quantile.value, decimals) for quantile in (low, median, high))
        rows.append((label, str(summary.count), five, half, ninety_five, between, unit))
    return table(rows)


def _failures(statistics: Statistics) -> str:
    rows = [("failures", "runs", "%", "95 % interval")]
    for cause, share in statistics.failures.items():
        interval = f"{100 * share.low:.3g} – {100 * share.high:.3g}"
        rows.append((cause, str(share.count), f"{100 * share.share:.3g}", interval))
    rows.append(("of these saturated over half of the time", str(statistics.saturated_failures), "", ""))
    return table(rows)
