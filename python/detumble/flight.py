"""One flight: its history tick by tick, its metrics and events, and what is needed to fly it again."""

from __future__ import annotations

import json
import os
from dataclasses import asdict, dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

from detumble.checking import MOST_SEED, choice, whole
from detumble.errors import RequestError, ScenarioError
from detumble.metrics import METRICS, Metrics
from detumble.scenario.files import from_toml
from detumble.scenario.laws import LAWS
from detumble.scenario.step import integration_step
from detumble.version import __version__
from detumble.writing import named_file

if TYPE_CHECKING:
    from collections.abc import Mapping

    import numpy as np
    import xarray as xr
    from numpy.typing import NDArray

    from detumble.scenario.model import Scenario

BROKEN_OFF = {"diverged": "diverged", "no_gains": "broken off"}
"""Events with which a flight ends before its time, and what a warning calls them."""


@dataclass(frozen=True)
class Event:
    """Something that happened once.

    Attributes:
        name: what.
        time: when, s.
        details: what belongs to it: for `captured` the states before and after the merge, for `diverged` and `no_gains`
            the cause.
    """

    name: Literal["captured", "settled", "no_gains", "diverged"]
    time: float
    details: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Flight:
    """One flight.

    Attributes:
        scenario: what was flown; a copy that later edits do not reach.
        law: name of the law, `none` for open loop.
        seed: of the sensor noise.
        index: of the trajectory under that seed.
        backend: which build of the core flew it.
        history: time series by name, one row a tick: (N+1,), (N+1, 3) or (N+1, 4), SI. A flight that diverged ends at the
            last finite row, one whose law has no gains at the tick at which it would command: nothing is commanded there.
        metrics: scalars of the flight.
        events: in order of time.
        warnings: sentences about what limits the validity of the flight.
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

        return dataset(self.history, self._attributes())

    @property
    def integration_step(self) -> float:
        """The integration step that was flown, s."""
        return integration_step(self.scenario)

    @property
    def diverged(self) -> bool:
        """Tell whether the state became non-finite."""
        return self.metrics.diverged_time is not None

    @property
    def broken_off(self) -> bool:
        """Tell whether the flight ended before its time: it diverged, or its law had no gains."""
        return any(event.name in BROKEN_OFF for event in self.events)

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

        write(self.data, path)

    def _attributes(self) -> dict[str, Any]:
        """Give everything but the time series as NetCDF attributes: texts and numbers."""
        return {
            "title": self.scenario.title,
            "law": self.law,
            "seed": str(self.seed),
            "index": str(self.index),
            "backend": self.backend,
            "integration_step_s": self.integration_step,
            "detumble_version": __version__,
            "scenario": self.scenario.to_toml(),
            "metrics": json.dumps(self.metrics.to_json()),
            "metric_definitions": json.dumps({metric.key: metric.definition for metric in METRICS}),
            "events": json.dumps([asdict(event) for event in self.events]),
            "warnings": json.dumps(self.warnings),
        }


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

    name = os.fspath(named_file(path))
    try:
        return _flight(*read(name), name)
    except ScenarioError:
        raise
    except RequestError as error:
        raise RequestError(f"{name}: {str(error).removeprefix(f'{name}: ')}") from None
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        raise RequestError(f"{name}: holds no detumble flight that this version ({__version__}) can read") from None


def _checked_metrics(stored: Mapping[str, Any]) -> Metrics:
    """Read metrics, each of which must be there: a number, three numbers, or None.

    Raises:
        ValueError: they are not.
    """
    for metric in METRICS:
        value = stored[metric.key]
        numbers = value if metric.name.endswith("_axes") and isinstance(value, list) else [value]
        if any(isinstance(one, bool) or not isinstance(one, int | float | None) for one in numbers):
            raise ValueError(metric.key)
    return Metrics.from_json(stored)


def _flight(attributes: Mapping[str, Any], history: dict[str, Any], name: str) -> Flight:
    from pydantic import TypeAdapter

    return Flight(
        scenario=from_toml(attributes["scenario"], f"{name} (scenario)"),
        law=choice("law", attributes["law"], (*LAWS, "none")),
        seed=whole("seed", int(attributes["seed"]), 0, MOST_SEED),
        index=whole("index", int(attributes["index"]), 0, MOST_SEED),
        backend=choice("backend", attributes["backend"], ("portable", "avx2", "avx512")),
        history=history,
        metrics=_checked_metrics(json.loads(attributes["metrics"])),
        events=TypeAdapter(tuple[Event, ...]).validate_json(attributes["events"], strict=True),
        warnings=TypeAdapter(tuple[str, ...]).validate_json(attributes["warnings"], strict=True),
    )
