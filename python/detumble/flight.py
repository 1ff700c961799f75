"""One simulated flight: what happened, tick by tick, what it amounts to, and how to fly it again."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

from detumble.checking import MOST_SEED, whole
from detumble.compiled import checked_backend, core
from detumble.errors import ScenarioError
from detumble.metrics import Metrics
from detumble.scenario.accuracy import coarse_step, most_asymmetric
from detumble.scenario.core import case
from detumble.scenario.files import given
from detumble.scenario.hints import far_away, warnings
from detumble.scenario.model import Scenario
from detumble.scenario.step import integration_step

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    import numpy as np
    import xarray as xr
    from numpy.typing import NDArray


@dataclass(frozen=True)
class Event:
    """Something that happened once.

    Attributes:
        name: what.
        time: when, s.
        details: what belongs to it: for `captured` the states before and after the merge, for `diverged` the cause.
    """

    name: Literal["captured", "settled", "diverged"]
    time: float
    details: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Flight:
    """One flight.

    Attributes:
        scenario: what was flown; a copy that later edits do not reach.
        law: name of the law, `none` for open loop.
        seed: of the sensor noise.
        index: number of the trajectory under that seed.
        backend: which build of the core flew it.
        history: time series by name, one row a tick: (N+1,), (N+1, 3) or (N+1, 4), SI. A flight that diverged ends at the
            last finite row.
        metrics: what it amounts to.
        events: in order of time.
        warnings: what a reader of the numbers ought to know.
    """

    scenario: Scenario = field(repr=False)
    law: str
    seed: int
    index: int
    backend: str
    history: Mapping[str, NDArray[np.float64]] = field(repr=False)
    metrics: Metrics
    events: tuple[Event, ...]
    warnings: tuple[str, ...]

    @cached_property
    def data(self) -> xr.Dataset:
        """The time series as an xarray Dataset over `time`, with units and long names."""
        from detumble.netcdf import dataset

        return dataset(self)

    @property
    def integration_step(self) -> float:
        """The integration step that was flown, s."""
        return integration_step(self.scenario)

    @property
    def diverged(self) -> bool:
        """Tell whether the state left the numbers."""
        return self.metrics.diverged_time is not None

    def event(self, name: str) -> Event | None:
        """Find an event by its name."""
        return next((event for event in self.events if event.name == name), None)

    def to_netcdf(self, path: str | os.PathLike[str]) -> None:
        """Write the flight as NetCDF, whole or not at all; its attributes hold the recipe to fly it again.

        Args:
            path: the file to write; an older one is replaced.

        Raises:
            RequestError: it cannot be written.
        """
        from detumble.netcdf import write

        write(self, path)


def simulate(
    scenario: Scenario | str | os.PathLike[str],
    law: str | None = None,
    seed: int = 0,
    *,
    index: int = 0,
    backend: str | None = None,
) -> Flight:
    """Fly a scenario once.

    Args:
        scenario: a scenario, or what `load` takes.
        law: one of `LAWS`, or `none` for open loop; None is the only one with gains here, else `prrl`.
        seed: of the sensor noise, 0 to 2^64 - 1.
        index: number of the trajectory under that seed: each has its own noise.
        backend: `portable`, `avx2`, `avx512`; None takes the core's choice. Noise does not depend on it.

    Returns:
        The flight; one that diverged is a flight too.

    Raises:
        ScenarioError: the scenario cannot be flown.
        RequestError: law, seed or back end cannot be used.
    """
    scenario = given(scenario)
    law = scenario.laws.default if law is None else law
    seed, index = whole("seed", seed, 0, MOST_SEED), whole("index", index, 0, MOST_SEED)
    return flown(scenario, law, seed, index, backend, case(scenario, law))


def flown(
    scenario: Scenario,
    law: str,
    seed: int,
    index: int,
    backend: str | None,
    numbers: dict[str, Any],
    differing: list[str] | None = None,
) -> Flight:
    """Fly the core's numbers of a scenario once.

    Args:
        scenario: what the flight will tell that it flew.
        law: its law.
        seed: of the sensor noise.
        index: number of the trajectory under that seed.
        backend: as in `simulate`.
        numbers: as `case` gives them.
        differing: paths of the numbers in which flights of its campaign differ.

    Raises:
        ScenarioError: the scenario cannot be flown.
        RequestError: there is no such back end.
    """
    checked = checked_backend(backend)
    try:
        record = core().fly(numbers, seed, index, checked, differing)
    except ValueError as error:
        raise ScenarioError(scenario.title, problem=str(error)) from None
    metrics = Metrics.from_summary(record["summary"])
    events = _events(metrics, record)
    remarks = (*_warnings(metrics, events, scenario, law, _fast_turn(record, numbers)), *_far(record, scenario))
    return Flight(
        scenario=scenario,
        law=law,
        seed=seed,
        index=index,
        backend=record["backend"],
        history=record["history"],
        metrics=metrics,
        events=events,
        warnings=(*remarks, *warnings(scenario, law)),
    )


def read_netcdf(path: str | os.PathLike[str]) -> Flight:
    """Read a flight that `Flight.to_netcdf` wrote.

    Args:
        path: the file.

    Returns:
        The flight, its scenario included.

    Raises:
        RequestError: the file cannot be read, or is no flight.
    """
    from detumble.netcdf import read

    return read(path)


def _events(metrics: Metrics, record: Mapping[str, Any]) -> tuple[Event, ...]:
    events = []
    if metrics.capture_time is not None:
        merge = record["merge"]
        events.append(Event("captured", metrics.capture_time, _listed(merge or {})))
        if metrics.settling_time is not None:
            events.append(Event("settled", metrics.capture_time + metrics.settling_time))
    if metrics.diverged_time is not None:
        events.append(Event("diverged", metrics.diverged_time, {"cause": _cause(record["history"])}))
    return tuple(events)


def _cause(history: Mapping[str, NDArray[np.float64]]) -> str:
    """Name the part of the state that grew fastest from the last finite row but one to the last."""
    if not len(history["time"]):
        return "the start is not finite"
    units = {"position": "m", "velocity": "m/s", "chaser_rate": "rad/s", "debris_rate": "rad/s"}
    last = {name: float(abs(history[name][-1]).max()) for name in units}
    before = {name: float(abs(history[name][-2:][0]).max()) for name in units}
    name = max(units, key=lambda name: (last[name] / before[name] if before[name] else 0.0, last[name]))
    return f"the state left the numbers; last finite {name}: {last[name]:.3g} {units[name]}"


def _listed(value: Any) -> Any:
    """Give lists for tuples all through, as a flight that was read back has them."""
    if isinstance(value, dict):
        return {key: _listed(element) for key, element in value.items()}
    return [_listed(element) for element in value] if isinstance(value, list | tuple) else value


def _far(record: Mapping[str, Any], scenario: Scenario) -> Iterator[str]:
    """Say that the flight left the neighbourhood in which its equations hold, unless it began outside."""
    positions = record["history"]["position"]
    if len(positions):
        reached = math.sqrt(float((positions * positions).sum(axis=1).max()))
        if not far_away(math.hypot(*scenario.chaser.position), scenario) and (text := far_away(reached, scenario)):
            yield f"reached a distance of {text}"


def _fast_turn(record: Mapping[str, Any], numbers: Mapping[str, Any]) -> str:
    """Say that a body turns too fast for the integration step; empty where none does."""
    import numpy as np

    history, plan, merge = record["history"], numbers["plan"], record["merge"]
    step = plan["control_period"] / plan["steps_per_period"]
    squares = (np.einsum("ij,ij->i", history[name], history[name]) for name in ("chaser_rate", "debris_rate"))
    fastest = math.sqrt(max(float(square.max(initial=0.0)) for square in squares))
    bodies = (numbers["chaser"]["inertia"], numbers["debris"]["inertia"], *([merge["stack_inertia"]] if merge else ()))
    return coarse_step(most_asymmetric(*bodies), fastest, step, plan["control_period"] * plan["periods"])


def _warnings(
    metrics: Metrics, events: tuple[Event, ...], scenario: Scenario, law: str, fast_turn: str
) -> tuple[str, ...]:
    found = []
    diverged = next((event for event in events if event.name == "diverged"), None)
    if metrics.capture_time == 0.0 and law != "none":
        found.append("the start is already inside every threshold: captured at t = 0")
    if diverged:
        found.append(f"diverged at {diverged.time:.10g} s: {diverged.details['cause']}")
    elif metrics.capture_time is None and law != "none":
        found.append(f"not captured within {scenario.time.duration:.10g} s")
    elif metrics.settling_time is None and law != "none" and scenario.capture.merge:
        found.append("captured, but not settled at the end of the flight")
    if fast_turn and not diverged:
        found.append(fast_turn)
    return tuple(found)
