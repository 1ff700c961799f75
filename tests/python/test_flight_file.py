"""A flight's file is read as it was written or not at all."""

from __future__ import annotations

import json
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

import detumble
from detumble import RequestError
from detumble.netcdf import DIGEST, RECIPE, digest
from detumble.variables import VARIABLES


@pytest.fixture(scope="module")
def flight() -> detumble.Flight:
    scenario = detumble.load("paper")
    scenario.time.duration = 20.0
    return detumble.simulate(scenario, "prrl", seed=3)


@pytest.fixture
def path(flight: detumble.Flight, tmp_path: Path) -> Path:
    flight.to_netcdf(tmp_path / "flight.nc")
    return tmp_path / "flight.nc"


def refused(path: Path) -> str:
    with pytest.raises(RequestError) as caught:
        detumble.read_netcdf(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value) or isinstance(caught.value, detumble.ScenarioError)
    return str(caught.value)


def test_a_flight_comes_back_to_the_bit(flight: detumble.Flight, path: Path) -> None:
    again = detumble.read_netcdf(path)
    assert again.scenario == flight.scenario
    assert (again.law, again.seed, again.index, again.backend) == (
        flight.law,
        flight.seed,
        flight.index,
        flight.backend,
    )
    assert again.metrics == flight.metrics
    assert again.events == flight.events
    for name in ("time", *(variable.name for variable in VARIABLES)):
        assert again.history[name].tobytes() == flight.history[name].tobytes()


def test_damage_anywhere_never_becomes_another_flight(flight: detumble.Flight, path: Path, tmp_path: Path) -> None:
    whole = path.read_bytes()
    random_numbers = random.Random(1)
    damaged = tmp_path / "damaged.nc"
    places = [random_numbers.randrange(len(whole) - 64) for _ in range(150)] + list(range(0, 4000, 40))
    with h5py.File(path) as file:
        inside = [file[name].id.get_offset() + 80 for name in flight.history]
    survived = 0
    for place in (*places, *inside):
        turned = bytes(255 - byte for byte in whole[place : place + 64])
        damaged.write_bytes(whole[:place] + turned + whole[place + 64 :])
        try:
            again = detumble.read_netcdf(damaged)
        except RequestError:
            continue
        assert place not in inside
        survived += 1  # the bytes that were turned say nothing of the flight
        assert again.metrics == flight.metrics
        assert all(again.history[name].tobytes() == flight.history[name].tobytes() for name in flight.history)
    assert 0 < survived < len(places)


def test_a_file_that_was_cut_is_refused(path: Path, tmp_path: Path) -> None:
    whole = path.read_bytes()
    for size in (0, 7, 100, len(whole) // 2, len(whole) - 1):
        (tmp_path / "cut.nc").write_bytes(whole[:size])
        refused(tmp_path / "cut.nc")


@pytest.mark.parametrize("name", [*RECIPE, DIGEST])
def test_an_attribute_that_is_missing_or_changed_is_named(name: str, path: Path) -> None:
    def edit(change: Callable[[h5py.AttributeManager], None]) -> None:
        with h5py.File(path, "r+") as file:
            change(file.attrs)

    edit(lambda attributes: attributes.__setitem__(name, "x"))
    assert "changed after it was written" in refused(path)
    edit(lambda attributes: attributes.__delitem__(name))
    assert name in refused(path)


WRONG: dict[str, list[Any]] = {
    "law": ["x", "", "none "],
    "seed": ["-1", "x", "1.5", str(2**64)],
    "index": ["-1", "", "1e3"],
    "metrics": ["{", "{}", "[]", "3", '"x"', "null"],
    "events": [
        *("{", "3", "[3]", '[{"name": "captured"}]', '[{"what": 1}]', "[" * 3000),
        *('[{"name": "nix", "time": 1.0}]', '[{"name": "captured", "time": "a"}]'),
    ],
    "warnings": ["3", "{", '["a", 1, null]'],
    "backend": ["foo", "", "AVX2"],
    "scenario": ["", "title = 3", "x", "\x00"],
}


@pytest.mark.parametrize(("name", "value"), [(name, value) for name, values in WRONG.items() for value in values])
def test_a_wrong_attribute_under_a_right_digest_is_refused_too(
    name: str, value: str, flight: detumble.Flight, path: Path
) -> None:
    data = flight.data.copy()
    recipe = {key: str(data.attrs[key]) for key in RECIPE} | {name: value}
    data.attrs |= {name: value, DIGEST: digest(flight.history, recipe)}
    try:
        data.to_netcdf(path, engine="h5netcdf")
    except ValueError:  # HDF5 takes no NUL
        return
    refused(path)


@pytest.mark.parametrize("name", ["distance", "position", "chaser_attitude", "time"])
def test_series_of_another_shape_are_refused_before_they_are_read(
    name: str, flight: detumble.Flight, path: Path
) -> None:
    rows = len(flight.history["time"])
    for shape in ((10**12,), (rows - 1,), (rows, 2), (rows, 3, 3), ()):
        if shape[1:] == flight.history[name].shape[1:] and shape[:1] == (rows,):
            continue
        with h5py.File(path, "r+") as file:
            del file[name]
            file.create_dataset(name, shape, "f8", chunks=(1000,) if shape == (10**12,) else None)
        refused(path)


def test_what_is_no_flight_is_refused(path: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.nc"
    for content in (b"", b"nothing", b"\x89HDF\r\n\x1a\n" + bytes(100), json.dumps({}).encode()):
        other.write_bytes(content)
        refused(other)
    with h5py.File(other, "w") as file:
        file["x"] = np.zeros(3)
    refused(other)
    with h5py.File(path, "r+") as file:
        del file["position"]
    assert "position" in refused(path)
    refused(tmp_path / "absent.nc")
