"""`detumble compare`: control laws tuned with equal budgets, judged on common runs that none was tuned on."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from detumble.commands.arguments import (
    AsJson,
    More,
    ScenarioName,
    Settings,
    Threads,
    out_option,
    percentile,
    scenario_of,
)
from detumble.commands.printing import print_result, remark
from detumble.errors import RequestError

if TYPE_CHECKING:
    from detumble.analysis.comparing.entries import Entry
    from detumble.analysis.tuning.objective import Until, What
    from detumble.scenario.model import Scenario


def compare(
    scenario: ScenarioName,
    more: More = None,
    laws: Annotated[
        str | None, typer.Option(metavar="LAW,...", help="Laws, each printed and corrected.  [all]")
    ] = None,
    entry: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=LAW[:FORM]", help="Instead: one entry; repeat it. FORM: printed, corrected"),
    ] = None,
    as_given: Annotated[bool, typer.Option("--as-given", help="Tune nothing: judge the scenario's own gains.")] = False,
    objective: Annotated[str, typer.Option(help="capture, settling, delta_v or delta_v_total.")] = "capture",
    statistic: Annotated[str, typer.Option(help="Over the runs: mean, or a percentile such as p95.")] = "mean",
    required: Annotated[float, typer.Option(help="Share of the runs that must succeed.")] = 0.95,
    until: Annotated[
        str | None, typer.Option(help="How flights end: settled, captured or duration.  [as the scenario]")
    ] = None,
    budget: Annotated[int, typer.Option(help="Evaluations of each tuning.")] = 800,
    starts: Annotated[int, typer.Option(help="Starts that each evaluation flies.")] = 128,
    tunings: Annotated[int, typer.Option(help="Independent tunings of each entry; the best is judged.")] = 3,
    horizon: Annotated[float | None, typer.Option(help="Longest flight while tuning, s.  [from the bound]")] = None,
    seed: Annotated[int, typer.Option(help="Seed of the training starts.")] = 0,
    held_out_seed: Annotated[int | None, typer.Option(help="Seed of the runs that are judged.  [seed + 1]")] = None,
    held_out: Annotated[int | None, typer.Option(hidden=True, help="Old name of --held-out-seed.")] = None,
    runs: Annotated[int, typer.Option(help="Held-out runs of each entry.")] = 100_000,
    robust: Annotated[
        int, typer.Option(help="Of these, how many fly again with something changed; 0 leaves it out.")
    ] = 10_000,
    settings: Settings = None,
    out: Annotated[Path | None, out_option("Write records, numbers, gains and figures here.")] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on with the tunings in DIR.")] = False,
    threads: Threads = None,
    as_json: AsJson = False,
) -> None:
    """Tune several laws with equal means and say which is better, how surely, and how far from the best possible."""
    from detumble.analysis.comparing.comparer import compare as work
    from detumble.analysis.comparing.plan import Plan
    from detumble.analysis.comparing.report import text_of
    from detumble.analysis.comparing.result import FIGURES, FILES
    from detumble.analysis.tuning import Objective
    from detumble.commands.progress import Line
    from detumble.results import results_folder
    from detumble.simulation import INSIDE

    if resume and out is None:
        raise RequestError("--resume: needs --out, the folder to go on with")
    if held_out is not None:
        if held_out_seed is not None:
            raise RequestError("--held-out and --held-out-seed: are one option under two names; give the latter")
        remark("--held-out: is called --held-out-seed here, since --held-out of tune is a number of runs")
    chosen = scenario_of(scenario, settings, more)
    plan = Plan(
        objective=Objective(cast("What", objective), percentile(statistic), required, cast("Until | None", until)),
        horizon=horizon,
        budget=budget,
        starts=starts,
        tunings=tunings,
        seed=seed,
        held_out=held_out if held_out_seed is None else held_out_seed,
        runs=runs,
        robust=robust,
        as_given=as_given,
    )
    kept = None if as_given else out
    with results_folder(out, FILES, scenario, stale=("tuned/*.toml", *FIGURES)), Line(kept) as line:
        entries = _entries(chosen, laws, entry or [])
        result = work(chosen, entries, plan, out=out, resume=resume, threads=threads, watcher=line)
        pictures = result.figures(out / "figures") if out else []
    print_result(as_json, result.to_json(), lambda: text_of(result), pictures)
    if not result.bounds.any():
        remark(f"warning: {INSIDE}, in every run")
    if out:
        remark(f"written: {len(pictures)} figures, comparison.json and the gains of each entry in {out}")
    for fault in result.broken:
        remark(f"error: {fault}: the bound or the simulation is wrong; please report this")
    if result.broken:
        raise typer.Exit(1)


def _entries(scenario: Scenario, laws: str | None, entry: list[str]) -> list[Entry] | None:
    from detumble.analysis.comparing.entries import Entry, entries_of

    if laws is not None and entry:
        raise RequestError("--laws and --entry: only one of them says who takes part")
    if laws is not None:
        return list(entries_of([law.strip() for law in laws.split(",") if law.strip()]))
    return [Entry.parsed(text, scenario) for text in entry] or None
