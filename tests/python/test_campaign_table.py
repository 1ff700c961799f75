"""The table of all runs, read back from the shards of a campaign."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import polars as pl
import pytest
import xarray as xr

from campaign_folders import ODD, ROWS, begin, fly, rows
from detumble.campaigns.columns import INDEX, RESULTS
from detumble.campaigns.recipe import Recipe
from detumble.campaigns.store import table
from detumble.campaigns.store.campaign_folder import Store
from detumble.campaigns.store.shard import frame_of
from detumble.campaigns.store.table import Runs
from detumble.errors import RequestError
from detumble.failures import CAUSES


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    with begin(tmp_path / ODD) as store:
        yield store


def test_the_table_is_in_order_whatever_the_engine_and_limited_to_the_runs_asked(store: Store) -> None:
    fly(store, 1500)
    runs = Runs(store, 1234)
    assert len(runs) == 1234
    expected = frame_of(rows(0, 1500)).head(1234)
    assert runs.to_polars().equals(frame_of({**rows(0, 1234), "failure": runs.to_polars()["failure"].to_list()}))
    assert (
        runs.lazy().select("index", "chaser.mass").collect(engine="streaming").equals(expected["index", "chaser.mass"])
    )
    late = runs.lazy().filter(pl.col("index") >= 1100).select("index").collect()
    assert late["index"].to_list() == list(range(1100, 1234))
    assert runs.lazy().select(pl.col("success").sum()).collect().item() == expected["success"].sum()


def test_gaps_are_refused_and_named(store: Store) -> None:
    fly(store, 450)
    store.path(2).unlink()
    store.write(4, frame_of(rows(400, 20)))
    os.truncate(store.path(3), 100)
    with pytest.raises(RequestError) as caught:
        Runs(store)
    assert str(caught.value) == (
        f"{store.folder}: of 450 runs only the first 200 can be read: shard 2 is missing, shard 3 is damaged (cut off, or no "
        "Parquet file), shard 4 has 20 of 50 runs; --resume flies what is missing"
    )
    assert len(Runs(store, 200)) == 200
    for number in range(5):
        store.path(number).unlink(missing_ok=True)
    with pytest.raises(RequestError, match=r"only the first 0 can be read: .*, and 2 more shards; --resume"):
        Runs(store)


def test_pandas_gets_the_same_table(store: Store) -> None:
    fly(store, 450)
    runs = Runs(store)
    found, expected = runs.to_pandas(), runs.to_polars()
    assert list(found.columns) == expected.columns
    assert isinstance(found["failure"].dtype, pd.CategoricalDtype)
    for name in expected.columns:
        values = found[name].astype(object).where(found[name].notna(), None).tolist()
        assert values == expected[name].to_list()
    assert found["success"].dtype == bool
    assert found["index"].dtype == np.uint64
    found.loc[0, "chaser.mass"] = 5.0
    assert found["chaser.mass"][0] == 5.0


def test_xarray_reads_only_the_column_and_the_shards_that_are_used(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    fly(store, 450)
    data = Runs(store, 430).to_xarray()
    read: list[tuple[str, list[str]]] = []
    reader = pl.read_parquet

    def watched(path: Path, columns: list[str], **options: Any) -> pl.DataFrame:
        read.append((path.stem[-1], columns))
        return reader(path, columns=columns, **options)

    monkeypatch.setattr(table.pl, "read_parquet", watched)
    repr(data)
    assert data.sizes == {"run": 430}
    assert read == []
    assert data["chaser.mass"][210:280].values.size == 70
    assert read == [("2", ["chaser.mass"])]
    read.clear()
    data["success"].isel(run=[425, 3, 429]).load()
    assert read == [("0", ["success"]), ("4", ["success"])]
    read.clear()
    data["capture_time_s"].load()
    data["capture_time_s"].load()
    assert [number for number, _ in read] == list("01234")


def test_xarray_gives_the_same_values_however_they_are_picked(store: Store) -> None:
    fly(store, 450)
    runs = Runs(store, 430)
    data, expected = runs.to_xarray(), runs.to_polars()
    picks: list[Any] = [
        slice(None),
        slice(95, 105),
        slice(3, 430, 101),
        slice(None, None, -7),
        slice(10, 10),
        0,
        429,
        -1,
    ]
    picks += [[5, 5, 100, 99], np.array([], dtype=int), np.array([429, 0, 200]), np.arange(430) % 3 == 0]
    for name in ("index", "chaser.mass", "success", "failure", "capture_time_s"):
        reference = np.array(expected[name].to_list(), dtype=object if name == "failure" else None)
        reference = reference.astype(float) if name == "capture_time_s" else reference
        for pick in picks:
            np.testing.assert_array_equal(data[name][pick].values, reference[pick])
    assert data["capture_time_s"].dtype == float
    assert data["index"].dtype == np.uint64
    assert float(data["capture_time_s"].mean()) == pytest.approx(expected["capture_time_s"].mean())


def test_xarray_knows_units_names_and_what_was_flown(store: Store, tmp_path: Path) -> None:
    fly(store, 450)
    data = Runs(store).to_xarray()
    assert data["chaser.position.x"].attrs["units"] == "m"
    assert data["chaser.position.x"].attrs["long_name"].startswith("chaser.position.x: r_CD_H at t = 0")
    assert data["capture_time_s"].attrs["units"] == "s"
    assert data["force_saturated_share"].attrs["units"] == "1"
    assert data["success"].attrs == {"long_name": "captured, and settled where the bodies merge; not diverged"}
    recipe = Recipe(data.attrs["scenario"], data.attrs["law"], int(data.attrs["seed"]), shard=data.attrs["shard"])
    assert recipe.identity == store.recipe.identity
    data.to_netcdf(tmp_path / "runs.nc", engine="h5netcdf")
    with xr.open_dataset(tmp_path / "runs.nc", engine="h5netcdf") as stored:
        np.testing.assert_array_equal(stored["capture_time_s"].values, data["capture_time_s"].values)
        assert stored.attrs == data.attrs


def test_every_result_of_a_run_can_be_stored_and_read_back(store: Store) -> None:
    number = np.arange(ROWS, dtype=float)
    columns: dict[str, Any] = {INDEX.name: np.arange(ROWS, dtype=np.uint64)}
    columns |= {result.name: number for result in RESULTS}
    columns |= {"success": number > len(CAUSES), "failure": [*CAUSES, *[None] * (ROWS - len(CAUSES))]}
    store.write(0, frame_of(columns))
    found = Runs(store, ROWS).to_polars()
    assert found.columns == list(columns)
    assert found["failure"].to_list() == columns["failure"]
