"""The file of a flight: a NetCDF dataset with units and long names on the series, all else in the attributes."""

from __future__ import annotations

import hashlib
import json
import os
import stat
from typing import TYPE_CHECKING, Any

import h5py  # type: ignore[import-untyped]  # has no types
import numpy as np
import xarray as xr

from detumble.errors import RequestError
from detumble.scenario.model import MOST_PERIODS
from detumble.surroundings import check_dask
from detumble.variables import AXES, COMPONENTS, VARIABLES
from detumble.writing import named_file, reason, write_bytes

if TYPE_CHECKING:
    from collections.abc import Mapping


def dataset(history: Mapping[str, Any], attributes: Mapping[str, Any]) -> xr.Dataset:
    """Give a flight as a dataset.

    Args:
        history: time series by name, as `Flight.history`.
        attributes: by name; those of `RECIPE` are needed.

    Returns:
        Variables over `time`, vectors also over `axis` (x, y, z), attitudes over `quaternion` (q0, scalar, to q3).
    """
    check_dask()
    coordinates = {
        "time": ("time", history["time"], {"units": "s", "long_name": "time"}),
        "axis": ("axis", np.array(AXES, dtype=object), {"long_name": "axis of the vector's frame"}),
        "quaternion": ("quaternion", np.array(COMPONENTS, dtype=object), {"long_name": "component, scalar first"}),
    }
    series = {
        variable.name: (
            ("time", variable.across) if variable.across else ("time",),
            history[variable.name],
            {"units": variable.unit, "long_name": variable.meaning},
        )
        for variable in VARIABLES
    }
    return xr.Dataset(series, coordinates, dict(attributes) | {DIGEST: digest(history, attributes)})


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


def write(flight: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Write the dataset of a flight as NetCDF, whole or not at all.

    Raises:
        RequestError: it cannot be written.
    """
    # in memory first: HDF5 crashes when the disk is full
    write_bytes(named_file(path), flight.to_netcdf(None, engine="h5netcdf"))


def read(path: str | os.PathLike[str]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Read the attributes and the time series of a flight, by name.

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
    if digest(history, recipe) != recipe[DIGEST]:
        raise RequestError(f"{name}: damaged, or changed after it was written")
    return recipe, history


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
