"""Flights as xarray datasets and NetCDF files: units and long names on the data, the recipe in the attributes."""

from __future__ import annotations

import json
import os
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from detumble import __version__
from detumble.errors import RequestError
from detumble.metrics import METRICS, Metrics
from detumble.scenario.files import from_toml
from detumble.surroundings import check_dask
from detumble.variables import AXES, COMPONENTS, VARIABLES
from detumble.writing import write_bytes

if TYPE_CHECKING:
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
    return {
        "title": flight.scenario.title,
        "law": flight.law,
        "seed": str(flight.seed),
        "index": str(flight.index),
        "backend": flight.backend,
        "detumble_version": __version__,
        "scenario": flight.scenario.to_toml(),
        "metrics": json.dumps(flight.metrics.to_json()),
        "metric_definitions": json.dumps({metric.key: metric.definition for metric in METRICS}),
        "events": json.dumps([asdict(event) for event in flight.events]),
        "warnings": json.dumps(flight.warnings),
    }


def write(flight: Flight, path: str | os.PathLike[str]) -> None:
    """Write a flight as NetCDF, whole or not at all.

    Raises:
        RequestError: it cannot be written.
    """
    # in memory first: HDF5 crashes when the disk is full
    write_bytes(Path(path), flight.data.to_netcdf(None, engine="h5netcdf"))


def read(path: str | os.PathLike[str]) -> Flight:
    """Read a flight back.

    Raises:
        RequestError: the file cannot be read, or is no flight.
    """
    from detumble.flight import Event, Flight

    try:
        with xr.open_dataset(path, engine="h5netcdf") as stored:
            data = stored.load()
    except (OSError, ValueError) as error:
        raise RequestError(f"{os.fspath(path)}: cannot be read as NetCDF: {error}") from None
    recipe = data.attrs
    if "scenario" not in recipe or any(variable.name not in data for variable in VARIABLES):
        raise RequestError(f"{os.fspath(path)}: holds no detumble flight")
    return Flight(
        scenario=from_toml(recipe["scenario"], f"{os.fspath(path)} (scenario)"),
        law=recipe["law"],
        seed=int(recipe["seed"]),
        index=int(recipe["index"]),
        backend=recipe["backend"],
        history={name: data[name].to_numpy() for name in ("time", *(variable.name for variable in VARIABLES))},
        metrics=Metrics.from_json(json.loads(recipe["metrics"])),
        events=tuple(Event(**event) for event in json.loads(recipe["events"])),
        warnings=tuple(json.loads(recipe["warnings"])),
    )
