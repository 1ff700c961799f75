"""Flights as xarray datasets and NetCDF files: units and long names on the data, the recipe in the attributes."""

from __future__ import annotations

import hashlib
import json
import os
import stat
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import h5py  # type: ignore[import-untyped]  # has no types
import numpy as np
import xarray as xr
from pydantic import TypeAdapter

from detumble.checking import MOST_SEED, choice, whole
from detumble.errors import RequestError, ScenarioError
from detumble.metrics import METRICS, Metrics
from detumble.scenario.files import from_toml
from detumble.scenario.laws import LAWS
from detumble.scenario.model import MOST_PERIODS
from detumble.surroundings import check_dask
from detumble.variables import AXES, COMPONENTS, VARIABLES
from detumble.version import __version__
from detumble.writing import named_file, reason, write_bytes

if TYPE_CHECKING:
    from collections.abc import Mapping

    from detumble.flight import Flight


def dataset(flight: Flight) -> xr.Dataset:
    """Give a flight's time series as a dataset.

    Args:
        flight: the flight.

    Returns:
        Variables over `time`, vectors also over `axis` (x, y, z), attitudes over `quaternion` (q0, scalar, to q3).
    """
    check_dask()
    coordinates = {
        "time": ("time", flight.history["time"], {"units": "s", "long_name": "time"}),
        "axis": ("axis", np.array(AXES, dtype=object), {"long_name": "axis of the vector's frame"}),
        "quaternion": ("quaternion", np.array(COMPONENTS, dtype=object), {"long_name": "component, scalar first"}),
    }
    series = {
        variable.name: (
            ("time", variable.across) if variable.across else ("time",),
            flight.history[variable.name],
            {"units": variable.unit, "long_name": variable.meaning},
        )
        for variable in VARIABLES
    }
    return xr.Dataset(series, coordinates, _attributes(flight))


def _attributes(flight: Flight) -> dict[str, Any]:
    recipe = {
        "title": flight.scenario.title,
        "law": flight.law,
        "seed": str(flight.seed),
        "index": str(flight.index),
        "backend": flight.backend,
        "integration_step_s": flight.integration_step,
        "detumble_version": __version__,
        "scenario": flight.scenario.to_toml(),
        "metrics": json.dumps(flight.metrics.to_json()),
        "metric_definitions": json.dumps({metric.key: metric.definition for metric in METRICS}),
        "events": json.dumps([asdict(event) for event in flight.events]),
        "warnings": json.dumps(flight.warnings),
    }
    return recipe | {DIGEST: digest(flight.history, recipe)}


DIGEST = "digest"
"""Attribute that holds the hash of the recipe and of every series: a file that was damaged or edited is not read as a flight."""


def digest(history: Mapping[str, Any], recipe: Mapping[str, Any]) -> str:
    """Hash a flight's series and recipe bit by bit: BLAKE2b, 64 hexadecimal digits.

    Args:
        history: series by name, float64; those of `VARIABLES` and `time` count.
        recipe: attributes, texts; those of `RECIPE` count.
    """
    hashed = hashlib.blake2b(digest_size=32)
    for name in RECIPE:
        hashed.update(json.dumps([name, str(recipe[name])]).encode())
    for name in ("time", *(variable.name for variable in VARIABLES)):
        values = np.ascontiguousarray(history[name], dtype="<f8")
        hashed.update(json.dumps([name, values.shape]).encode())
        hashed.update(values.data)
    return hashed.hexdigest()


RECIPE = (
    "title",
    "law",
    "seed",
    "index",
    "backend",
    "detumble_version",
    "scenario",
    "metrics",
    "metric_definitions",
    "events",
    "warnings",
)
"""Attributes of the file that are its own."""


def write(flight: Flight, path: str | os.PathLike[str]) -> None:
    """Write a flight as NetCDF, whole or not at all.

    Raises:
        RequestError: it cannot be written.
    """
    # in memory first: HDF5 crashes when the disk is full
    write_bytes(named_file(path), flight.data.to_netcdf(None, engine="h5netcdf"))


def read(path: str | os.PathLike[str]) -> Flight:
    """Read a flight back.

    Raises:
        RequestError: the file cannot be read, is no flight, or is not as it was written.
    """
    name, series = named_file(path), ("time", *(variable.name for variable in VARIABLES))
    try:
        if not stat.S_ISREG(name.stat().st_mode):
            raise RequestError(f"{name}: is no regular file; a flight is a NetCDF file")
        with h5py.File(name, "r") as file:
            recipe = {key: file.attrs[key] for key in (*RECIPE, DIGEST) if key in file.attrs}
            _check_shapes({each: file[each].shape for each in series if each in file})
            history = {each: np.asarray(file[each]) for each in series if each in file}
    except OSError as error:
        raise RequestError(f"{name}: cannot be read as NetCDF: {reason(error)}") from None
    except (
        ValueError,
        KeyError,
        TypeError,
        RuntimeError,
        AttributeError,
        MemoryError,
    ) as error:  # what h5py makes of damage
        raise RequestError(f"{name}: cannot be read as NetCDF: {' '.join(str(error).split())}") from None
    missing = [each for each in (*series, *RECIPE, DIGEST) if each not in history and each not in recipe]
    if missing:
        raise RequestError(f"{name}: holds no detumble flight (no {', '.join(missing[:3])})")
    try:
        if digest(history, recipe) != recipe[DIGEST]:
            raise RequestError(f"{name}: damaged, or changed after it was written")
        return _flight(recipe, history, os.fspath(name))
    except ScenarioError:
        raise
    except RequestError as error:
        raise RequestError(f"{name}: {str(error).removeprefix(f'{name}: ')}") from None
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        raise RequestError(f"{name}: holds no detumble flight that this version ({__version__}) can read") from None


def _check_shapes(shapes: Mapping[str, tuple[int, ...]]) -> None:
    """Make sure, before anything is read, that series have one length, no more than a flight has, and their own widths.

    Raises:
        ValueError: they have not.
    """
    rows = (shapes.get("time") or (0,))[0]
    widths: dict[str, tuple[int, ...]] = {"axis": (3,), "quaternion": (4,), "": ()}
    wanted = {"time": (rows,)} | {variable.name: (rows, *widths[variable.across]) for variable in VARIABLES}
    wrong = [name for name, shape in shapes.items() if shape != wanted[name]]
    if wrong or rows > MOST_PERIODS + 1:
        raise ValueError(f"{', '.join(wrong) or 'time'}: no series of a flight has that shape")


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


def _flight(recipe: Mapping[str, Any], history: dict[str, Any], name: str) -> Flight:
    from detumble.flight import Event, Flight

    return Flight(
        scenario=from_toml(recipe["scenario"], f"{name} (scenario)"),
        law=choice("law", recipe["law"], (*LAWS, "none")),
        seed=whole("seed", int(recipe["seed"]), 0, MOST_SEED),
        index=whole("index", int(recipe["index"]), 0, MOST_SEED),
        backend=choice("backend", recipe["backend"], ("portable", "avx2", "avx512")),
        history=history,
        metrics=_checked_metrics(json.loads(recipe["metrics"])),
        events=TypeAdapter(tuple[Event, ...]).validate_json(recipe["events"], strict=True),
        warnings=TypeAdapter(tuple[str, ...]).validate_json(recipe["warnings"], strict=True),
    )
