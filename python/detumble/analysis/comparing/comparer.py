"""A comparison from its plan to its result: tune, judge on held-out runs, bound, vary the scenario, test, order.

All entries get the same budget, objective, horizon, training starts and seeds of the searches. Each entry is tuned several
times, since searches scatter; the tuning of the least cost on the training starts is judged, and the others show the
spread. All that is reported was measured on held-out runs, except the training cost itself.
"""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from detumble.analysis.bounds.runs import capture_bounds, delta_v_bounds, settling_bounds
from detumble.analysis.comparing.entries import check_entries, entries_of
from detumble.analysis.comparing.judge import Runs, Verdict, fly
from detumble.analysis.comparing.judged import Judged, Tuning
from detumble.analysis.comparing.pairs import pairs_of, ranking_of
from detumble.analysis.comparing.plan import RECORDS, SPREAD, Plan
from detumble.analysis.comparing.ranking import Score
from detumble.analysis.comparing.ratios import FUEL_RUNS, Ratio
from detumble.analysis.comparing.result import FILES, PLAN, Comparison
from detumble.analysis.comparing.robustness import flights, robustness, sweeps_of
from detumble.analysis.trials import Trials
from detumble.analysis.tuning import tune
from detumble.analysis.tuning.gains import mean_acceleration
from detumble.analysis.tuning.horizon import default_horizon
from detumble.analysis.tuning.space import space_of
from detumble.checking import MOST_SEED, flag, instance, thread_count
from detumble.compiled import check_gains
from detumble.errors import RequestError
from detumble.progress import Watcher
from detumble.results import results_folder
from detumble.scenario.core import case
from detumble.scenario.files import given
from detumble.scenario.laws import LAWS
from detumble.scenario.model import Scenario
from detumble.version import __version__
from detumble.writing import named_folder, output_folder, read_bytes, write_text

if TYPE_CHECKING:
    import os
    from collections.abc import Sequence

    from detumble.analysis.comparing.entries import Entry
    from detumble.analysis.comparing.robustness import Curve
    from detumble.intervals import Array


def compare(
    scenario: Scenario | str | os.PathLike[str],
    entries: Sequence[Entry] | None = None,
    plan: Plan | None = None,
    *,
    out: str | os.PathLike[str] | None = None,
    resume: bool = False,
    threads: int | None = None,
    watcher: Watcher | None = None,
) -> Comparison:
    """Compare control laws in one scenario.

    Args:
        scenario: a scenario, or what `load` takes; its gains are what the searches begin with.
        entries: to be compared; None is every law, printed and corrected (as given: every law that the scenario has gains for).
        plan: budget, objective, runs; None is the default one.
        out: folder for the records of the searches, one scenario file per entry with its gains, and `comparison.json`.
        resume: continue the searches that the folder holds.
        threads: to use; None for all processors. The result is the same.
        watcher: follows the progress, stage by stage.

    Raises:
        RequestError: an argument makes no sense, or the folder cannot be used.
        ScenarioError: the scenario cannot be flown.
    """
    source = "" if isinstance(scenario, Scenario) else scenario
    scenario, resume = given(scenario), flag("resume", resume)
    plan = Plan() if plan is None else instance("plan", plan, Plan, "a Plan")
    if entries is None:
        entries = entries_of([law for law in LAWS if not plan.as_given or getattr(scenario.laws, law) is not None])
    check_entries(entries, scenario, as_given=plan.as_given)
    for entry in entries:
        checked = entry.of_scenario(scenario) if plan.as_given else space_of(scenario, entry.law, form=entry.form).base
        check_gains(scenario.title, case(checked, entry.law))
    threads = thread_count(threads)
    folder = named_folder(out, "out") if out is not None else None
    with results_folder(folder, FILES, source):
        if folder is not None:
            _begin(folder, scenario, entries, plan, resume)
        work = _Work(scenario, plan, folder, resume, threads, watcher or Watcher())
        judged = [work.judged(entry) for entry in entries]
        bounds = work.bounds()
        judged = [replace(one, ratios=ratios) for one, ratios in zip(judged, work.ratios(judged, bounds), strict=True)]
        judged = [replace(one, curves=work.curves(one)) for one in judged]
        pairs = pairs_of(judged, plan.objective.percentile)
        ranking = ranking_of(judged, pairs, plan.objective.what, scenario.time.control_period)
        result = Comparison(scenario, work.plan, tuple(judged), bounds, pairs, ranking)
        if folder is not None:
            result.save(folder)
    return result


def _begin(folder: Path, scenario: Scenario, entries: Sequence[Entry], plan: Plan, resume: bool) -> None:
    """Write into the folder what is compared, and check that it holds no other comparison.

    Raises:
        RequestError: the folder holds another comparison, or this one and it is not to be resumed.
    """
    path = folder / PLAN
    asked = {
        "scenario": hashlib.sha256(scenario.to_toml().encode()).hexdigest(),
        "entries": [asdict(entry) for entry in entries],
        **plan.to_json(),
        "version": __version__,
    }
    text = json.dumps(asked, indent=2) + "\n"
    if path.exists():
        try:
            there = json.loads(read_bytes(path, 2**20))
        except (OSError, ValueError) as error:
            raise RequestError(f"{path}: broken: {error}") from None
        known = there if isinstance(there, dict) else {}
        free = ("runs", "robustness_runs")  # can differ, since judging is repeated each time
        differing = [name for name, value in json.loads(text).items() if name not in free and known.get(name) != value]
        if differing:
            raise RequestError(f"{folder}: holds another comparison ({', '.join(differing)} differ)")
        if not resume:
            raise RequestError(f"{folder}: holds this comparison already; --resume continues it")
    write_text(path, text)


class _Work:
    """The steps of a comparison, and what all entries share."""

    def __init__(
        self,
        scenario: Scenario,
        plan: Plan,
        folder: Path | None,
        resume: bool,
        threads: int | None,
        watcher: Watcher,
    ) -> None:
        horizon = default_horizon(scenario, plan.seed, plan.starts) if plan.horizon is None else plan.horizon
        self.scenario = scenario
        self.plan = replace(plan, horizon=min(horizon, scenario.time.duration))
        self.end = plan.objective.end(scenario)
        acceleration = mean_acceleration(scenario) if plan.objective.unit == "m/s" else math.inf
        self.ceiling = plan.objective.ceiling(min(horizon, scenario.time.duration), acceleration)
        self.sweeps = sweeps_of(scenario) if plan.robust else ()
        self.folder, self.resume, self.threads, self.watcher = folder, resume, threads, watcher

    def _stage(self, title: str, total: int) -> None:
        self.watcher.stage(title)
        self.watcher.begin(total)

    def judged(self, entry: Entry) -> Judged:
        """Tune an entry, and fly the held-out runs with its best gains."""
        plan = self.plan
        found = (
            [_as_given(entry, self.scenario)] if plan.as_given else [self._tuned(entry, k) for k in range(plan.tunings)]
        )
        chosen = min(range(len(found)), key=lambda index: found[index].cost or 0.0)
        runs = self._held_out(entry, found[chosen].scenario, plan.runs)
        first = [
            runs.first(SPREAD) if index == chosen else self._held_out(entry, tuning.scenario, min(SPREAD, plan.runs))
            for index, tuning in enumerate(found)
        ]
        tunings = tuple(
            replace(tuning, verdict=Verdict.of(own), score=self._score(own))
            for tuning, own in zip(found, first, strict=True)
        )
        return Judged(entry, tunings, chosen, runs, self._counted(runs), Verdict.of(runs), self._score(runs))

    def _tuned(self, entry: Entry, index: int) -> Tuning:
        plan = self.plan
        record = self.folder / RECORDS / f"{entry.file}-{index}" / "record.jsonl" if self.folder else None
        if record:
            with output_folder(record.parent):
                pass
        self.watcher.stage(f"{entry.name}: tuning {index + 1} of {plan.tunings}")
        tuned = tune(
            self.scenario,
            entry.law,
            form=entry.form,
            budget=plan.budget,
            starts=plan.starts,
            seed=plan.seed,
            optimiser_seed=(plan.seed + index) % (MOST_SEED + 1),
            objective=plan.objective,
            horizon=plan.horizon,
            record=record,
            resume=self.resume,
            threads=self.threads,
            watcher=self.watcher,
        )
        return Tuning(tuned.optimiser_seed, tuned.scenario, tuned.gains, tuned.cost, tuned.success)

    def _held_out(self, entry: Entry, scenario: Scenario, runs: int) -> Runs:
        self._stage(f"{entry.name}: held-out runs", runs)
        trials = Trials(scenario, self.plan.judging, 0, runs, end=self.end)
        return fly(trials, entry.law, threads=self.threads, progress=self.watcher.now)

    def _score(self, runs: Runs) -> Score:
        objective = self.plan.objective
        cost = float(objective.judge(runs.results(), self.ceiling).cost[0])
        return Score.of(float(np.mean(runs.succeeded)), objective.required, cost)

    def _counted(self, runs: Runs) -> Array:
        """Value of each run in the objective."""
        values = self.plan.objective.values(runs.results())[0]
        return np.where(runs.succeeded, np.fmin(values, self.ceiling), self.ceiling)

    def bounds(self) -> Array:
        """Bound the capture time of every held-out run, (runs,), for all entries; NaN where a disturbance acts."""
        if self.scenario.disturbances.acting:
            return np.full(self.plan.runs, np.nan)
        self._stage("least capture time of every run", self.plan.runs)
        trials = Trials(self.scenario, self.plan.judging, 0, self.plan.runs)
        return capture_bounds(trials, processes=self.threads, progress=self.watcher.now)

    def ratios(self, judged: Sequence[Judged], bounds: Array) -> list[dict[str, Ratio]]:
        """Divide what each entry achieved by the bounds of its runs; where a disturbance acts there are none."""
        if self.scenario.disturbances.acting:
            none = Ratio.of(bounds, bounds)
            return [dict.fromkeys(("time", "delta_v", "settling"), none) for _ in judged]
        count = min(FUEL_RUNS, self.plan.runs)
        self._stage("least Δv of the first runs", count * len(judged))
        within = np.array([one.runs["capture_time"][:count] for one in judged])
        trials = Trials(self.scenario, self.plan.judging, 0, count)
        fuel = delta_v_bounds(trials, within, processes=self.threads, progress=self.watcher.now)
        several = min(SPREAD, self.plan.runs)
        momentum = np.array([one.runs["momentum_at_capture"][:several] for one in judged])
        settling = settling_bounds(Trials(self.scenario, self.plan.judging, 0, several), momentum)
        return [
            {
                "time": Ratio.of(one.runs["capture_time"], bounds),
                "delta_v": Ratio.of(one.runs["delta_v_to_capture"][:count], least),
                "settling": Ratio.of(one.runs["settling_time"][:several], quickest),
            }
            for one, least, quickest in zip(judged, fuel, settling, strict=True)
        ]

    def curves(self, one: Judged) -> tuple[Curve, ...]:
        """Fly an entry with each deviation from the scenario."""
        if not self.plan.robust:
            return ()
        count = min(self.plan.robust, self.plan.runs)
        self._stage(f"{one.entry.name}: robustness", flights(self.sweeps, count))
        return robustness(
            Trials(one.tuning.scenario, self.plan.judging, 0, count, end=self.end),
            one.entry.law,
            self.sweeps,
            one.runs.first(count),
            threads=self.threads,
            progress=self.watcher.now,
        )


def _as_given(entry: Entry, scenario: Scenario) -> Tuning:
    return Tuning(None, entry.of_scenario(scenario), {}, None, None)
