"""`detumble tune`: search for the best gains of a law, and judge them on held-out runs."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

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
from detumble.commands.printing import json_text, print_json, print_result, remark, remark_written
from detumble.errors import RequestError
from detumble.tables import cell, fixed, table

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from detumble.analysis.tuning.pareto import Front
    from detumble.analysis.tuning.search import Generation
    from detumble.analysis.tuning.setting import SearchResult
    from detumble.analysis.tuning.space import Space
    from detumble.analysis.tuning.tuner import Tuned, Worth
    from detumble.scenario.model import Scenario

RECORD = "record.jsonl"
NUMBERS = "tuning.json"
FILES = ("scenario.toml", NUMBERS, "convergence.png")
FRONT_FILES = (NUMBERS, "front.csv", "front.png", "point-[0-9]*.toml")
"""Patterns of what is written into --out beside the record."""


def tune(
    scenario: ScenarioName,
    more: More = None,
    law: Annotated[str | None, typer.Option(help="{laws}.  [prrl, or the only one given]")] = None,
    budget: Annotated[int, typer.Option(help="Number of candidates; each flies from all starts.")] = 2000,
    starts: Annotated[int, typer.Option(help="Runs of the campaign that each candidate flies.")] = 256,
    seed: Annotated[int, typer.Option(help="Seed of these runs.")] = 0,
    optimiser_seed: Annotated[int | None, typer.Option(help="Seed of the search.  [the same]")] = None,
    objective: Annotated[
        str, typer.Option(help="capture, settling, delta_v, delta_v_total, or pareto for capture against delta_v.")
    ] = "capture",
    statistic: Annotated[str, typer.Option(help="Over the starts: mean, or a percentile such as p95.")] = "mean",
    required: Annotated[float, typer.Option(help="Share of the starts that must succeed.")] = 0.95,
    until: Annotated[
        str | None, typer.Option(help="Flights end when captured or when settled.  [as the scenario says]")
    ] = None,
    horizon: Annotated[
        float | None, typer.Option(help="Seconds after which a run has failed.  [found from the minimum time]")
    ] = None,
    form: Annotated[str | None, typer.Option(help="printed or corrected.  [as the scenario says]")] = None,
    stack: Annotated[bool, typer.Option("--stack", help="Own gains after capture.  [as the scenario]")] = False,
    one_set: Annotated[bool, typer.Option("--one-set", help="One set for both.  [as the scenario]")] = False,
    fix: Annotated[
        list[str] | None, typer.Option(metavar="GAIN[=VALUE]", help="Hold a gain: alpha=0.3, translation.kd")
    ] = None,
    held_out: Annotated[int, typer.Option(help="Runs of another seed that judge the result; 0 for none.")] = 1000,
    settings: Settings = None,
    threads: Threads = None,
    out: Annotated[Path | None, out_option("Write scenario, record, numbers and figure here.")] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Continue the search in DIR.")] = False,
    show: Annotated[bool, typer.Option("--list", help="List the gains and their ranges, and leave.")] = False,
    as_json: AsJson = False,
) -> None:
    """Search for a law's gains and say what they are worth."""
    from detumble.checking import whole
    from detumble.results import results_folder

    if stack and one_set:
        raise RequestError("--stack and --one-set: only one of them can be asked for")
    if resume and out is None:
        raise RequestError("--resume: needs --out, the folder of the search to continue")
    chosen = scenario_of(scenario, settings, more)
    law = chosen.laws.default if law is None else law
    searched: dict[str, Any] = {
        "form": form,
        "stack": True if stack else False if one_set else None,
        "fixed": _fixed(fix or ()),
    }
    if show:
        _list(chosen, law, searched, as_json)
        return
    judged: dict[str, Any] = {"percentile": percentile(statistic), "required": required, "until": until}
    how: dict[str, Any] = searched | {
        "scenario": chosen,
        "law": law,
        "budget": budget,
        "starts": starts,
        "seed": seed,
        "optimiser_seed": optimiser_seed,
        "horizon": horizon,
        "record": out / RECORD if out else None,
        "resume": resume,
        "threads": threads,
    }
    runs = whole("held_out", held_out, 0, 10**9)
    files = FRONT_FILES if objective == "pareto" else FILES
    with results_folder(out, files, scenario, stale=files):
        if objective == "pareto":
            _pareto(judged | how, out, as_json)
        else:
            _single({"what": objective, **judged}, how, runs, out, as_json)


def _fixed(fix: Sequence[str]) -> dict[str, float | None]:
    """Read --fix; a gain without a value keeps that of the scenario."""
    fixed: dict[str, float | None] = {}
    for text in fix:
        path, equals, value = text.partition("=")
        if path in fixed:
            raise RequestError(f"--fix {text}: {path} is held already; hold it once")
        try:
            fixed[path] = float(value) if equals else None
        except ValueError:
            raise RequestError(f"--fix {text}: must be GAIN or GAIN=NUMBER; --list shows the gains") from None
    return fixed


def _list(scenario: Scenario, law: str, searched: dict[str, Any], as_json: bool) -> None:
    """Print all gains that can be searched for, those held by --fix among them."""
    from detumble.analysis.tuning.space import space_of

    space_of(scenario, law, **searched)  # refuses what cannot be held
    space = space_of(scenario, law, **searched | {"fixed": None})
    if as_json:
        print_json({"law": law, "gains": _gains_json(space)})
    else:
        print(_ranges(space))


def _single(judged: dict[str, Any], how: dict[str, Any], runs: int, out: Path | None, as_json: bool) -> None:
    from detumble.analysis.tuning import Objective, held_out
    from detumble.analysis.tuning import tune as search
    from detumble.commands.progress import Line
    from detumble.simulation import INSIDE

    objective = Objective(**judged)
    with Line(out, "candidates", _best(objective.unit)) as line:
        tuned = search(objective=objective, watcher=line, **how)
    other = (tuned.seed + 1) % 2**64
    worth = held_out(tuned, runs, other, threads=how["threads"]) if runs else None
    numbers = tuned.to_json() | {"feasible": tuned.feasible, "held_out": _held_out_json(worth, runs, other)}
    files = _write(tuned, numbers, out) if out else []
    print_result(as_json, numbers, lambda: _text(tuned, worth, runs, other), files)
    if not tuned.feasible:
        _remark_infeasible(tuned, f"the best one does in {100 * tuned.success:.1f} % within {tuned.horizon:g} s")
    if tuned.objective.what == "capture" and tuned.initial_cost == 0.0:
        remark(f"warning: {INSIDE}, in every start")
    remark_written(files)


def _pareto(how: dict[str, Any], out: Path | None, as_json: bool) -> None:
    from detumble.analysis.tuning import pareto_front
    from detumble.commands.progress import Line

    with Line(out, "candidates", _best("s")) as line:
        front = pareto_front(watcher=line, **how)
    files = _write_front(front, out) if out else []
    print_result(as_json, front.to_json(), lambda: _front_text(front), files)
    if not front.points:
        _remark_infeasible(front, f"there is no front within {front.horizon:g} s")
    remark_written(files)


def _best(unit: str) -> Callable[[Generation], str]:
    """Describe the best candidate so far, for the progress line."""
    return lambda last: f"best {last.best:.4g} {unit}, success {100 * last.success:.1f} %"


def _remark_infeasible(result: SearchResult, rest: str) -> None:
    remark(
        f"no candidate succeeds in {100 * result.objective.required:g} % of the starts; {rest}; --horizon gives them longer, "
        "--required asks for less"
    )


def _held_out_json(worth: tuple[Worth, Worth] | None, runs: int, seed: int) -> dict[str, Any] | None:
    if worth is None:
        return None
    before, after = ({"cost": one.cost, "success": one.success} for one in worth)
    return {"runs": runs, "seed": seed, "initial": before, "tuned": after}


def _gains_json(space: Space) -> list[dict[str, Any]]:
    gains = []
    for tunable in space.tunables:
        low, high = tunable.range(space.natural(tunable, space.own))
        own, unit = space.own[tunable.path], tunable.unit or "1"
        gains.append({"gain": tunable.path, "own": own, "low": low, "high": high, "unit": unit})
    return gains


def _ranges(space: Space) -> str:
    """Table of the gains that can be searched for: the scenario's own, the range, the meaning."""
    rows: list[tuple[str, ...]] = [("gain", "own", "from", "to", "unit")]
    for gain, tunable in zip(_gains_json(space), space.tunables, strict=True):
        rows.append((tunable.path, *(cell(gain[key], 4) for key in ("own", "low", "high")), tunable.unit))
    head, rule, *lines = table(rows).splitlines()
    meanings = (tunable.meaning for tunable in space.tunables)
    return "\n".join(
        [head, rule, *(f"{line.ljust(len(rule))}  {meaning}" for line, meaning in zip(lines, meanings, strict=True))]
    )


def _headline(result: SearchResult, what: str) -> str:
    from detumble.scenario.laws import TITLES

    law, objective = ", ".join(filter(None, (TITLES[result.law], result.setting.form))), result.objective
    return (
        f"{result.initial.title}\n{law}: {objective.statistic} {what} over {result.starts} starts of seed {result.seed}\n"
        f"at least {100 * objective.required:g} % successful within {result.horizon:g} s"
    )


def _text(tuned: Tuned, judged: tuple[Worth, Worth] | None, runs: int, seed: int) -> str:
    from detumble.analysis.tuning.gains import gains_in

    law, objective = tuned.law, tuned.objective
    units = {tunable.path: tunable.unit for tunable in gains_in(law, tuned.initial.to_dict()["laws"][law])}
    gains = [("gain", "before", "after", "unit")]
    for path, value in tuned.gains.items():
        gains.append((path, cell(tuned.initial_gains[path], 4), cell(value, 4), units[path]))

    def row(label: str, before: tuple[float, float], after: tuple[float, float]) -> tuple[str, ...]:
        shown = [
            (fixed(cost, 3) if success >= objective.required else "–", fixed(100 * success, 1))
            for cost, success in (before, after)
        ]
        return (label, *shown[0], *shown[1])

    worth: list[tuple[str, ...]] = [
        ("", f"before {objective.unit}", "success %", f"after {objective.unit}", "success %")
    ]
    found = (tuned.cost, tuned.success)
    worth.append(row(f"training, {tuned.starts} runs", (tuned.initial_cost, tuned.initial_success), found))
    if judged:
        before, after = ((one.cost, one.success) for one in judged)
        worth.append(row(f"held out, {runs} runs of seed {seed}", before, after))
    rate = tuned.evaluations / max(tuned.seconds, 1e-9)
    done = f"{tuned.evaluations} candidates in {tuned.seconds:.1f} s ({rate:.0f}/s)"
    return "\n\n".join([_headline(tuned, objective.meaning), table(gains), table(worth), done])


def _front_text(front: Front) -> str:

    rows = [("point", "time s", "Δv m/s", "success %")]
    for place in front.spread(12):
        point = front.points[place]
        rows.append((str(place + 1), fixed(point.time, 2), fixed(point.delta_v, 4), fixed(100 * point.success, 1)))
    what = f"{front.objective.meaning} against Δv to capture"
    done = f"{len(front.points)} points from {front.evaluations} candidates in {front.seconds:.1f} s"
    return "\n\n".join([_headline(front, what), table(rows), done])


def _write(tuned: Tuned, numbers: dict[str, Any], out: Path) -> list[Path]:
    from detumble.show.style import write_figure
    from detumble.show.tuning import plot_convergence
    from detumble.writing import write_text

    files = [out / "scenario.toml", out / NUMBERS, out / RECORD, out / "convergence.png"]
    tuned.scenario.save(files[0])
    history = [asdict(generation) for generation in tuned.history]
    write_text(files[1], json_text(numbers | {"history": history}) + "\n")
    write_figure(lambda: plot_convergence(tuned), files[3])
    return files


def _write_front(front: Front, out: Path) -> list[Path]:
    import csv
    import io

    from detumble.show.style import write_figure
    from detumble.show.tuning import plot_front
    from detumble.writing import write_text

    files = [out / NUMBERS, out / "front.csv", out / RECORD]
    write_text(files[0], json_text(front.to_json()) + "\n")
    rows, text = front.rows(), io.StringIO()
    writer = csv.DictWriter(text, list(rows[0]) if rows else ["time_s", "delta_v_m_s", "success"], lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    write_text(files[1], text.getvalue())
    for place in front.spread(12):
        files.append(out / f"point-{place + 1}.toml")
        front.scenario(place).save(files[-1])
    if front.points:
        files.append(write_figure(lambda: plot_front(front), out / "front.png"))
    return files
