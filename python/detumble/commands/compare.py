"""`detumble compare`: control laws tuned with equal means, judged on the same runs that none was tuned on."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

from detumble.commands.arguments import folder, percentile, scenario_of
from detumble.commands.printing import print_json, remark
from detumble.errors import RequestError

if TYPE_CHECKING:
    from types import TracebackType
    from typing import Self

    from detumble.analysis.comparing.entries import Entry
    from detumble.analysis.tuning.objective import Until, What
    from detumble.scenario.model import Scenario


def compare(
    scenario: Annotated[str, typer.Argument(help="Name of a built-in scenario, or path of a TOML file.")],
    more: Annotated[list[str] | None, typer.Argument(hidden=True, metavar="[FIELD=VALUE]...")] = None,
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
    settings: Annotated[
        list[str] | None, typer.Option("--set", metavar="FIELD=VALUE ...", help="Change fields: chaser.mass=12")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(parser=folder, metavar="DIR", help="Write records, numbers, gains and figures here.")
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on with the tunings in DIR.")] = False,
    threads: Annotated[int | None, typer.Option(help="Threads to use; all processors by default.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Tune several laws with equal means and say which is better, how surely, and how far from the best possible."""
    from detumble.analysis.comparing.comparer import compare as work
    from detumble.analysis.comparing.plan import Plan
    from detumble.analysis.comparing.report import text_of
    from detumble.analysis.comparing.result import FIGURES, FILES
    from detumble.analysis.tuning import Objective
    from detumble.results import results_folder
    from detumble.simulation import INSIDE

    if resume and out is None:
        raise RequestError("--resume: needs --out, the folder to go on with")
    if held_out is not None:
        if held_out_seed is not None:
            raise RequestError("--held-out and --held-out-seed: are one option under two names; give the latter")
        remark("--held-out: is called --held-out-seed here, since --held-out of tune is a number of runs")
    chosen = scenario_of(scenario, [*(settings or ()), *(more or ())])
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
    with results_folder(out, FILES, scenario, stale=("tuned/*.toml", *FIGURES)), Stages(out) as stages:
        entries = _entries(chosen, laws, entry or [])
        result = work(chosen, entries, plan, out=out, resume=resume, threads=threads, watcher=stages)
        drawn = result.figures(out / "figures") if out else []
    if as_json:
        print_json(result.to_json() | {"files": [str(file) for file in drawn]})
    else:
        print(text_of(result))
    if not result.bounds.any():
        remark(f"warning: {INSIDE}, in every run")
    if out:
        remark(f"written: {len(drawn)} figures, comparison.json and the gains of each entry in {out}")
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


class Stages:
    """A line at the bottom of the terminal that tells what is done; in `with`. On Ctrl-C it says how to go on.

    Args:
        folder: of the comparison; None keeps nothing.
    """

    def __init__(self, folder: Path | None) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

        self._folder = folder
        self._bar = Progress(
            TextColumn("{task.description}", markup=False),
            BarColumn(),
            MofNCompleteColumn(),
            TimeRemainingColumn(),
            console=Console(stderr=True),
            transient=True,
            disable=not sys.stderr.isatty(),
        )
        self._task = self._bar.add_task("", total=None)

    def stage(self, what: str, total: int) -> None:
        """Begin a bar."""
        self._bar.reset(self._task, description=what, total=total)

    def now(self, done: int) -> None:
        """Draw it anew."""
        self._bar.update(self._task, completed=done)

    def __enter__(self) -> Self:
        self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.stop()
        from detumble.analysis.comparing.plan import RECORDS

        interrupted = isinstance(error, SystemExit | KeyboardInterrupt)
        if interrupted and self._folder and (self._folder / RECORDS).exists():
            remark(f"stopped; the same command with --resume goes on with the tunings: {self._folder}")
