"""`python -m study`: everything in docs/study made anew. `make study` runs it."""

from __future__ import annotations

import argparse
import os
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import detumble
from detumble.analysis.comparing.comparer import compare
from detumble.analysis.comparing.entries import entries_of
from detumble.analysis.comparing.plan import Plan
from detumble.analysis.tuning.objective import Objective
from detumble.commands.printing import json_text
from detumble.commands.progress import Line
from detumble.scenario.files import load
from detumble.scenario.laws import FORMS, LAWS
from detumble.writing import output_folder, write_text
from study import alpha, fronts, handover, longer, maps, reach, surfaces
from study.cases import CASES, Case
from study.claims import Numbers
from study.page import filled

PAGE = Path("docs/study")
WORK = Path("results/study")
SHOWN = ("capture_time_s", "settling_time_s", "delta_v_to_capture_m_s", "torque_impulse_n_m_s")


@dataclass(frozen=True)
class Size:
    """Number of evaluations, starts and runs of each part."""

    budget: int = 400
    starts: int = 128
    tunings: int = 3
    runs: int = 100_000
    robust: int = 10_000
    front: int = 600
    front_starts: int = 64
    alpha: int = 300
    alpha_runs: int = 20_000
    longer: int = 2000
    handover: int = 5000
    field: int = 500
    field_starts: int = 128
    cells: int = 14
    cell_runs: int = 200


SMALL = Size(30, 8, 2, 200, 50, 30, 8, 20, 200, 40, 50, 30, 16, 3, 20)
"""A trial of the whole study, with too few runs for any conclusion."""


def main() -> None:
    """Make all parts and write the page."""
    arguments = argparse.ArgumentParser(prog="python -m study", description=__doc__)
    arguments.add_argument("--small", action="store_true", help="a trial of the whole study; the numbers mean nothing")
    arguments.add_argument("--page", type=Path, default=PAGE, help="folder of the page")
    arguments.add_argument(
        "--work", type=Path, default=WORK, help="folder of the comparisons; those in it are continued"
    )
    given = arguments.parse_args()
    with output_folder(given.page), output_folder(given.work):
        numbers = made(SMALL if given.small else Size(), given.page, given.work)
        write_text(given.page / "numbers.json", json_text(numbers) + "\n")
        page = given.page / "README.md"
        if page.exists():
            write_text(page, filled(page.read_text("utf-8"), numbers))
    print(f"written: {given.page}")


def made(size: Size, page: Path, work: Path) -> Numbers:
    """Do all parts, each with its figures.

    Args:
        size: of everything.
        page: folder of the figures.
        work: folder of the comparisons.

    Returns:
        Numbers for the tables of the page.
    """
    numbers: Numbers = {"about": {"version": detumble.__version__, "processors": os.cpu_count(), "seconds": {}}}
    for case in CASES:
        with _part(numbers, "compare", case.key) as found:
            found |= _compared(case, size, page, work / case.key)
    with _part(numbers, "given") as found:
        found |= {law: _as_given(law) for law in LAWS}
    with _part(numbers, "alpha") as found:
        for case in CASES[:2]:
            found[case.key] = alpha.fly(case.scenario, size.alpha, size.starts, size.alpha_runs)
            alpha.draw(found[case.key], f"PRRL-SMC, {case.title}", page / f"alpha-{case.key}.png")
    with _part(numbers, "longer") as found:
        found |= longer.fly(CASES[1].scenario, size.longer, size.starts, size.alpha_runs)
    with _part(numbers, "fronts") as found:
        found |= {case.key: fronts.search(case, size.front, size.front_starts) for case in CASES}
        fronts.draw(found, CASES, page / "fronts.png")
    tuned = {law: load(work / "dispersed" / "tuned" / f"{entries_of([law], ['printed'])[0].file}.toml") for law in LAWS}
    with _part(numbers, "maps") as found:
        for form in FORMS:
            found[form] = maps.fly(maps.tuned(form, size.field, size.field_starts), size.cells, size.cell_runs)
            maps.draw(found[form], f"{form} forms", page / f"maps-{form}.png")
    with _part(numbers, "reach") as found:
        found |= reach.fly()
        reach.draw(found, page / "reach.png")
    with _part(numbers, "surfaces") as found:
        found |= surfaces.fly()
        surfaces.draw(found, page / "surfaces.png")
    with _part(numbers, "handover") as found:
        given = dict.fromkeys(LAWS, CASES[1].scenario)
        found |= {name: handover.fly(gains, size.handover) for name, gains in (("given", given), ("tuned", tuned))}
    return numbers


@contextmanager
def _part(numbers: Numbers, *names: str) -> Iterator[Numbers]:
    """Give a table for the numbers of a part, and note how long it took."""
    title, table = " ".join(names), numbers
    for name in names:
        table = table.setdefault(name, {})
    print(f"{title} …", flush=True)
    began = time.perf_counter()
    yield table
    numbers["about"]["seconds"][title] = time.perf_counter() - began


def _compared(case: Case, size: Size, page: Path, work: Path) -> Numbers:
    """Compare all laws; figures and tuned scenarios go to the folder of the page."""
    plan = Plan(
        objective=Objective(case.objective),
        budget=size.budget,
        starts=size.starts,
        tunings=size.tunings,
        runs=size.runs,
        robust=size.robust,
    )
    with Line(work) as line:
        result = compare(case.scenario, plan=plan, out=work, resume=work.exists(), watcher=line)
    if result.broken:
        raise SystemExit("\n".join(result.broken))
    for figure in result.figures(work / "figures"):
        shutil.copyfile(figure, page / f"{figure.stem}-{case.key}{figure.suffix}")
    shutil.copytree(work / "tuned", page / "tuned" / case.key, dirs_exist_ok=True)
    whole = result.to_json()
    entries = [{name: value for name, value in entry.items() if name != "robustness"} for entry in whole.pop("entries")]
    return {name: value for name, value in whole.items() if name != "pairs"} | {"entries": entries}


def _as_given(law: str) -> Numbers:
    """Fly the paper's case with its own gains."""
    return {name: value for name, value in detumble.simulate("paper", law).metrics.to_json().items() if name in SHOWN}


if __name__ == "__main__":
    main()
