"""`detumble tune`: search for the gains with which a law is at its best, and say what they are worth on runs not seen before."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from detumble.commands.arguments import folder, percentile, scenario_of
from detumble.commands.printing import cell, fixed, json_text, print_json, remark, table
from detumble.errors import RequestError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from detumble.analysis.tuning.pareto import Front
    from detumble.analysis.tuning.space import Space
    from detumble.analysis.tuning.tuner import Tuned, Worth
    from detumble.scenario.model import Scenario

RECORD = "record.jsonl"
NUMBERS = "tuning.json"
FILES = ("scenario.toml", NUMBERS, "convergence.png")
FRONT_FILES = (NUMBERS, "front.csv", "front.png", "point-[0-9]*.toml")
"""Patterns of what is written into --out; the record looks after itself."""


def tune(
    scenario: Annotated[str, typer.Argument(help="Name of a built-in scenario, or path of a TOML file.")],
    more: Annotated[list[str] | None, typer.Argument(hidden=True, metavar="[FIELD=VALUE]...")] = None,
    law: Annotated[
        str | None, typer.Option(help="pd, lqr, sosmc, tsmc or prrl.  [prrl, or the only one given]")
    ] = None,
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
    settings: Annotated[
        list[str] | None, typer.Option("--set", metavar="FIELD=VALUE ...", help="Change fields: chaser.mass=12")
    ] = None,
    threads: Annotated[int | None, typer.Option(help="Threads to use; all processors by default.")] = None,
    out: Annotated[
        Path | None, typer.Option(parser=folder, metavar="DIR", help="Write scenario, record, numbers and figure here.")
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Continue the search in DIR.")] = False,
    show: Annotated[bool, typer.Option("--list", help="List the gains and their ranges, and leave.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object.")] = False,
) -> None:
    """Search for a law's gains and say what they are worth."""
    from detumble.analysis.tuning.space import space_of
    from detumble.results import results_folder

    if stack and one_set:
        raise RequestError("--stack and --one-set: only one of them can be asked for")
    chosen = scenario_of(scenario, [*(settings or ()), *(more or ())])
    law = chosen.laws.default if law is None else law
    own_set = True if stack else False if one_set else None
    if resume and out is None:
        raise RequestError("--resume: needs --out, the folder of the search to continue")
    whole = space_of(chosen, law, form=form, stack=own_set)  # type: ignore[arg-type]  # checked there
    held = _held(fix or (), whole)
    what: dict[str, Any] = {"percentile": percentile(statistic), "required": required, "until": until}
    if show:
        space_of(chosen, law, form=form, stack=own_set, fixed=held)  # type: ignore[arg-type]  # refuses what cannot be held
        if as_json:
            print_json({"law": law, "gains": _gains_json(whole)})
        else:
            print(_ranges(whole))
        return
    how: dict[str, Any] = {
        "budget": budget,
        "starts": starts,
        "seed": seed,
        "optimiser_seed": optimiser_seed,
        "horizon": horizon,
        "form": form,
        "stack": own_set,
        "fixed": held,
        "record": out / RECORD if out else None,
        "resume": resume,
        "threads": threads,
    }
    files = FRONT_FILES if objective == "pareto" else FILES
    with results_folder(out, files, scenario, stale=files):
        if objective == "pareto":
            _pareto(chosen, law, how, what, out, as_json)
        else:
            _single(chosen, law, how, {"what": objective, **what}, held_out, out, as_json)


def _held(fix: Sequence[str], space: Space) -> dict[str, float | None]:
    """Read --fix; a gain without a value keeps its own."""
    held: dict[str, float | None] = {}
    for text in fix:
        path, equals, value = text.partition("=")
        if path in held:
            raise RequestError(f"--fix {text}: {path} is held already; hold it once")
        if not equals and path in space.own:
            held[path] = None
            continue
        try:
            held[path] = float(value)
        except ValueError:
            known = ", ".join(space.own)
            raise RequestError(f"--fix {text}: must be GAIN or GAIN=NUMBER, of {known}") from None
    return held


def _single(
    scenario: Scenario,
    law: str,
    how: dict[str, Any],
    what: dict[str, Any],
    runs: int,
    out: Path | None,
    as_json: bool,
) -> None:
    from detumble.analysis.tuning import Objective, held_out
    from detumble.analysis.tuning import tune as search
    from detumble.checking import whole
    from detumble.commands.progress import SearchProgress
    from detumble.simulation import INSIDE

    objective = Objective(**what)
    runs = whole("held_out", runs, 0, 10**9)
    with SearchProgress(out, objective.unit) as progress:
        tuned = search(scenario, law, objective=objective, watcher=progress, **how)
    other = (tuned.seed + 1) % 2**64
    judged = held_out(tuned, runs, other, threads=how["threads"]) if runs else None
    numbers = tuned.to_json() | {"feasible": tuned.feasible, "held_out": _judged_json(judged, runs, other)}
    files = _write(tuned, numbers, out) if out else []
    if as_json:
        print_json(numbers | {"files": [str(file) for file in files]})
    else:
        print(_text(tuned, judged, runs, other))
    if not tuned.feasible:
        remark(
            f"no candidate succeeds in {100 * objective.required:g} % of the starts; "
            f"the best one does in {100 * tuned.success:.1f} % within {tuned.horizon:g} s; --horizon gives them longer, "
            "--required asks for less"
        )
    if tuned.objective.what == "capture" and tuned.initial_cost == 0.0:
        remark(f"warning: {INSIDE}, in every start")
    _say(files)


def _pareto(
    scenario: Scenario, law: str, how: dict[str, Any], what: dict[str, Any], out: Path | None, as_json: bool
) -> None:
    from detumble.analysis.tuning import pareto_front
    from detumble.commands.progress import SearchProgress

    with SearchProgress(out, "s") as progress:
        front = pareto_front(scenario, law, watcher=progress, **what, **how)
    files = _write_front(front, out) if out else []
    if as_json:
        print_json(front.to_json() | {"files": [str(file) for file in files]})
    else:
        print(_front_text(front))
    if not front.points:
        remark(
            f"no candidate succeeds in {100 * front.objective.required:g} % of the starts within {front.horizon:g} s: there is "
            "no front; --horizon gives them longer, --required asks for less"
        )
    _say(files)


def _say(files: Sequence[Path]) -> None:
    for file in files:
        remark(f"written: {file}")


def _judged_json(judged: tuple[Worth, Worth] | None, runs: int, seed: int) -> dict[str, Any] | None:
    if judged is None:
        return None
    before, after = ({"cost": worth.cost, "success": worth.success} for worth in judged)
    return {"runs": runs, "seed": seed, "initial": before, "tuned": after}


def _gains_json(space: Space) -> list[dict[str, Any]]:
    gains = []
    for tunable in space.tunables:
        low, high = tunable.range(space.natural(tunable, space.own))
        gains.append(
            {
                "gain": tunable.path,
                "own": space.own[tunable.path],
                "low": low,
                "high": high,
                "unit": tunable.unit or "1",
            }
        )
    return gains


def _ranges(space: Space) -> str:
    """Table of the gains that can be searched for, the scenario's own, and where they are searched."""
    meanings = {tunable.path: tunable.meaning for tunable in space.tunables}
    rows = [("gain", "own", "from", "to", "unit")]
    for gain in _gains_json(space):
        numbers = [cell(gain[key], 4) for key in ("own", "low", "high")]
        rows.append((gain["gain"], *numbers, "" if gain["unit"] == "1" else gain["unit"]))
    lines = table(rows).splitlines()
    return "\n".join(
        [
            *lines[:2],
            *(
                f"{line.ljust(len(lines[1]))}  {meanings[row[0]]}"
                for line, row in zip(lines[2:], rows[1:], strict=True)
            ),
        ]
    )


def _headline(result: Tuned | Front, what: str) -> str:
    from detumble.scenario.laws import TITLES

    law, objective = result.law, result.objective
    form = getattr(result.initial.laws, law).form
    return (
        f"{result.initial.title}\n{TITLES[law]}, {form}: {objective.statistic} {what} over {result.starts} starts of seed "
        f"{result.seed}\nat least {100 * objective.required:g} % successful within {result.horizon:g} s"
    )


def _text(tuned: Tuned, judged: tuple[Worth, Worth] | None, runs: int, seed: int) -> str:
    from detumble.analysis.tuning.gains import gains_in
    from detumble.analysis.tuning.objective import MEANINGS

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
    return "\n\n".join([_headline(tuned, MEANINGS[objective.what]), table(gains), table(worth), done])


def _front_text(front: Front) -> str:
    from detumble.analysis.tuning.objective import MEANINGS

    rows = [("point", "time s", "Δv m/s", "success %")]
    for place in front.spread(12):
        point = front.points[place]
        rows.append((str(place + 1), fixed(point.time, 2), fixed(point.delta_v, 4), fixed(100 * point.success, 1)))
    what = f"{MEANINGS[front.objective.what]} against Δv to capture"
    done = f"{len(front.points)} points from {front.evaluations} candidates in {front.seconds:.1f} s"
    return "\n\n".join([_headline(front, what), table(rows), done])


def _write(tuned: Tuned, numbers: dict[str, Any], out: Path) -> list[Path]:
    from detumble.show.tuning import convergence_figure
    from detumble.writing import write_text

    files = [out / "scenario.toml", out / NUMBERS, out / RECORD, out / "convergence.png"]
    tuned.scenario.save(files[0])
    history = [
        {"evaluations": one.evaluations, "best": one.best, "median": one.median, "success": one.success}
        for one in tuned.history
    ]
    write_text(files[1], json_text(numbers | {"history": history}) + "\n")
    convergence_figure(tuned, files[3])
    return files


def _write_front(front: Front, out: Path) -> list[Path]:
    import csv
    import io

    from detumble.show.tuning import front_figure
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
        files.append(front_figure(front, out / "front.png"))
    return files
