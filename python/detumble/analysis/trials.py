"""Trials: laws and gains flown from the same starts through the same noise, many candidates in one batch.

Run i of a trial is run i of the campaign of that scenario and seed, whatever law and gains fly it (common random numbers), so
two candidates differ only by their own commands.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from detumble.campaigns.runs.draws import draw
from detumble.campaigns.runs.overlay import overlay
from detumble.compiled import core
from detumble.errors import ScenarioError
from detumble.failures import SUCCESS
from detumble.scenario.conversions import ticks
from detumble.scenario.core import case
from detumble.scenario.faults import validated
from detumble.surroundings import available_threads

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from detumble.scenario.model import Scenario

Array = NDArray[np.float64]
_SENSORS = ("position", "velocity", "attitude", "rate")
_BELIEFS = {"belief.chaser_inertia", "belief.stack_inertia"}


@dataclass(frozen=True)
class Change:
    """A deviation from the scenario, for tests of robustness.

    Attributes:
        belief: factor on the inertias that the laws believe; where `belief.stack` is `true`, that of the stack stays true.
        noise: factor on the noise of the sensors.
        control_period: s; None is the scenario's.
    """

    belief: float = 1.0
    noise: float = 1.0
    control_period: float | None = None


@dataclass(frozen=True)
class Results:
    """Results of a trial; every array is (candidates, runs).

    Attributes:
        failure: the core's code of why a run failed, see `detumble.failures`; 0 is a success.
        columns: the core's summary, by its name there: `capture_time`, `delta_v`, …; NaN where the event did not happen.
    """

    failure: NDArray[np.uint8]
    columns: Mapping[str, Array]

    @property
    def succeeded(self) -> NDArray[np.bool_]:
        """Which runs succeeded."""
        good: NDArray[np.bool_] = self.failure == SUCCESS
        return good

    def __getitem__(self, column: str) -> Array:
        return self.columns[column]


@dataclass(frozen=True)
class Trials:
    """Runs `first` to `first + count - 1` of a campaign, independent of the law.

    Attributes:
        scenario: nominal case and dispersions.
        seed: of dispersions and noise.
        first: index of the first run.
        count: number of runs.
        horizon: s, after which flights end; None is the scenario's duration.
        end: how flights end early, as `campaign.end`; None as the scenario says.
        change: deviation from the scenario.
    """

    scenario: Scenario
    seed: int
    first: int
    count: int
    horizon: float | None = None
    end: Literal["settled", "captured", "duration"] | None = None
    change: Change = Change()

    @cached_property
    def drawn(self) -> dict[str, Array]:
        """The dispersed fields, run by run."""
        return draw(self.scenario, self.seed, self.first, self.count)

    def columns(self, law: str) -> dict[str, Array]:
        """Give the inputs of the core that differ from run to run: by path, (runs, width)."""
        differing = overlay(self.scenario, law, self.drawn)
        for sensor in _SENSORS:
            path = f"sensors.{sensor}"
            if path in differing:
                differing[path] = self.change.noise * differing[path]
        for path in _BELIEFS & differing.keys():
            differing[path] = self.change.belief * differing[path]
        return differing

    def nominal(self, law: str) -> dict[str, Any]:
        """Give the case of the core with horizon, end and change applied.

        Raises:
            ScenarioError: the scenario cannot be flown with the change.
        """
        plain = case(_timed(self.scenario, self.change.control_period), law, until_the_end=False)
        plan, sensors, belief = plain["plan"], plain["sensors"], plain["belief"]
        if self.horizon is not None:
            plan["periods"] = min(plan["periods"], max(1, ticks(self.horizon, plan["control_period"])))
        if self.end is not None:
            plan["end"] = self.end
        sensors |= {sensor: self.change.noise * sensors[sensor] for sensor in _SENSORS}
        for path in _BELIEFS:
            name = path.removeprefix("belief.")
            belief[name] = (self.change.belief * np.array(belief[name])).tolist()
        return plain

    def fly(
        self,
        law: str,
        gains: Mapping[str, Array] | None = None,
        *,
        threads: int | None = None,
        backend: str | None = None,
        progress: Callable[[int], None] | None = None,
    ) -> Results:
        """Fly every candidate through every run, all in one batch.

        Args:
            law: of all candidates, one of `LAWS`.
            gains: the candidates' gains by path of the core (`law.before.rotation.gain`), each (candidates, width); None is
                one candidate with the scenario's own.
            threads: to use; None for all processors.
            backend: of the core; None for its choice.
            progress: called repeatedly with the number of flights done; an exception that it raises ends the work.

        Returns:
            Results that depend, to the bit, neither on the threads nor on which candidates fly together.

        Raises:
            ScenarioError: the scenario, or a candidate, cannot be flown.
        """
        gains = gains or {}
        candidates = len(next(iter(gains.values()))) if gains else 1
        columns = {path: np.tile(values, (candidates, 1)) for path, values in self.columns(law).items()}
        columns |= {path: np.repeat(values, self.count, axis=0) for path, values in gains.items()}
        flights = candidates * self.count
        threads = threads or available_threads()
        nominal = self.nominal(law)
        try:
            flown = core().fly_many(
                nominal,
                columns,
                flights,
                seed=self.seed,
                first_index=self.first,
                threads=threads,
                backend=backend,
                progress=progress,
                cycle=self.count,
            )
        except ValueError as error:
            raise ScenarioError(self.scenario.title, problem=str(error)) from None
        failure = flown.pop("failure").reshape(candidates, self.count)
        square = {
            name: values.reshape(candidates, self.count)
            for name, values in flown.items()
            if isinstance(values, np.ndarray) and values.shape == (flights,)
        }
        return Results(failure, square)


def _timed(scenario: Scenario, control_period: float | None) -> Scenario:
    """Change the control period; the duration becomes a whole number of them, and no step is longer than one."""
    if control_period is None:
        return scenario
    raw = scenario.to_dict()
    time = raw["time"]
    time["duration"] = ticks(time["duration"], control_period) * control_period
    if time["integration_step"] != "auto":
        time["integration_step"] = min(time["integration_step"], control_period)
    time["control_period"] = control_period
    return validated(raw, f"{scenario.title}, control period {control_period:g} s")
