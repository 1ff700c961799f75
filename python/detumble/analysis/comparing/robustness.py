"""Robustness of an entry to deviations from the scenario: belief, noise or control period, one at a time."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from detumble.analysis.comparing.judge import Runs, Verdict, fly
from detumble.analysis.trials import Change, Trials
from detumble.errors import ScenarioError

if TYPE_CHECKING:
    from collections.abc import Callable

    from detumble.scenario.model import Scenario

BELIEFS = (0.5, 0.7, 0.9, 1.0, 1.1, 1.3, 1.5)
NOISES = (1.0, 3.0, 10.0)
PERIODS = (0.05, 0.1, 0.2, 0.5, 1.0)


@dataclass(frozen=True)
class Sweep:
    """Values of one deviation, everything else as in the scenario.

    Attributes:
        key: name in JSON.
        label: for tables and figures, with the unit.
        own: the scenario's own value.
        values: that are flown; the scenario's own can be among them.
    """

    key: str
    label: str
    own: float
    values: tuple[float, ...]

    def change(self, value: float) -> Change:
        """Give the deviation at a value; none at the scenario's own."""
        if value == self.own:
            return Change()
        match self.key:
            case "belief":
                return Change(belief=value)
            case "noise":
                return Change(noise=value)
            case _:
                return Change(control_period=value)


def sweeps_of(scenario: Scenario) -> tuple[Sweep, ...]:
    """Give the sweeps of a scenario, without values that it cannot be flown with."""
    own = scenario.time.control_period
    sweeps = (
        Sweep("belief", "believed inertia over design [–]", 1.0, BELIEFS),
        Sweep("noise", "noise of the sensors, times [–]", 1.0, NOISES),
        Sweep("control_period_s", "control period [s]", own, tuple(sorted({*PERIODS, own}))),
    )
    return tuple(
        Sweep(
            sweep.key, sweep.label, sweep.own, tuple(value for value in sweep.values if _flies(scenario, sweep, value))
        )
        for sweep in sweeps
    )


def _flies(scenario: Scenario, sweep: Sweep, value: float) -> bool:
    try:
        Trials(scenario, 0, 0, 1, change=sweep.change(value)).nominal("none")
    except ScenarioError:
        return False
    return True


@dataclass(frozen=True)
class Curve:
    """Results of an entry along a sweep.

    Attributes:
        sweep: the deviations.
        verdicts: for each of its values.
    """

    sweep: Sweep
    verdicts: tuple[Verdict, ...]

    def to_json(self) -> list[dict[str, Any]]:
        """Give it as JSON takes it."""
        wanted = ("capture_time_s", "settling_time_s", "settled_time_s")
        return [
            {
                self.sweep.key: value,
                **verdict.success.to_json("success"),
                **{name: verdict.figures[name].to_json() for name in wanted},
            }
            for value, verdict in zip(self.sweep.values, self.verdicts, strict=True)
        ]


def robustness(
    trials: Trials,
    law: str,
    sweeps: tuple[Sweep, ...],
    own: Runs,
    *,
    threads: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> tuple[Curve, ...]:
    """Fly the runs of an entry again with each deviation.

    Args:
        trials: the runs without deviation, of the scenario with the gains of the entry.
        law: one of `LAWS`.
        sweeps: the deviations.
        own: results of the runs without deviation, which are not flown again.
        threads: to use; None for all processors.
        progress: called repeatedly with the number of runs done.
    """
    flown = 0
    known = Verdict.of(own)
    curves = []
    for sweep in sweeps:
        verdicts = []
        for value in sweep.values:
            change = sweep.change(value)
            if change == Change():
                verdicts.append(known)
                continue
            report = (lambda count, before=flown: progress(before + count)) if progress else None
            runs = fly(replace(trials, change=change), law, threads=threads, progress=report)
            verdicts.append(Verdict.of(runs))
            flown += len(own)
        curves.append(Curve(sweep, tuple(verdicts)))
    return tuple(curves)


def flights(sweeps: tuple[Sweep, ...], runs: int) -> int:
    """Give the number of flights that `robustness` takes."""
    return runs * sum(sweep.change(value) != Change() for sweep in sweeps for value in sweep.values)
