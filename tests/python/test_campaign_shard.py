"""The file of a shard: what was written comes back to the bit, and nothing damaged is read."""

from __future__ import annotations

import json
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest

from campaign_folders import ROWS, begin, child, flip, fly, rows
from detumble.campaigns.store import shard as shards
from detumble.campaigns.store.campaign_folder import Store
from detumble.campaigns.store.shard import Damage, column, decode, digest, encode, frame_of, rows_in
from detumble.failures import CAUSES


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    with begin(tmp_path) as store:
        yield store


def test_rows_come_back_as_they_were_written_and_nan_as_null(store: Store) -> None:
    written = rows(200)
    written["capture_time_s"][:3] = [np.inf, -0.0, 5e-324]
    store.write(2, frame_of(written))
    frame = store.shard(2)
    assert frame.columns == list(written)
    for name, values in written.items():
        if name == "failure":
            assert frame[name].to_list() == values
        elif values.dtype == float:
            assert frame[name].null_count() == np.isnan(values).sum()
            assert frame[name].is_nan().sum() == 0
            there = ~np.isnan(values)
            assert frame[name].to_numpy()[there].tobytes() == values[there].tobytes()
        else:
            assert frame[name].to_numpy().tobytes() == values.tobytes()
    assert store.shard(2, ["success"]).columns == ["success"]


def test_any_reader_of_parquet_finds_units_and_what_the_shard_is(store: Store) -> None:
    store.write(1, frame_of(rows(100)))
    content = store.path(1).read_bytes()
    label = pl.read_parquet_metadata(BytesIO(content))
    assert [label[key] for key in ("campaign", "shard", "first", "rows")] == [store.recipe.identity, "1", "100", "100"]
    units = json.loads(label["units"])
    assert units["chaser.mass"] == "kg"
    assert units["chaser.position.x"] == "m"
    assert units["capture_time_s"] == "s"
    assert units["success"] == units["force_saturated_share"] == ""
    meanings = json.loads(label["meanings"])
    assert set(meanings) == set(units)
    assert meanings["chaser.mass"] == "chaser.mass: mass"
    assert meanings["capture_time_s"] == column("capture_time_s").meaning
    assert label["digest"] == digest(pl.read_parquet(content))


def test_equal_rows_give_equal_files_in_any_process(store: Store, tmp_path: Path) -> None:
    fly(store, 200)
    script = """
import polars as pl
pl.Series(["x", CAUSES[3]], dtype=pl.Categorical)  # what texts were met before must not matter
with begin(folder) as store:
    fly(store, 200)
"""
    assert child(script, tmp_path / "other", "env", "POLARS_MAX_THREADS=1").communicate()[1] == ""
    for number in (0, 1):
        twin = tmp_path / "other" / "shards" / store.path(number).name
        assert twin.read_bytes() == store.path(number).read_bytes()


def test_the_digest_depends_on_the_rows_alone(tmp_path: Path) -> None:
    frame = frame_of(rows(0))
    for compression in ("uncompressed", "gzip", "lz4"):
        frame.write_parquet(tmp_path / "x.parquet", compression=compression)
        assert digest(pl.read_parquet(tmp_path / "x.parquet")) == digest(frame)


def test_the_digest_sees_every_bit_but_one_nan_in_another() -> None:
    columns = {**rows(0), "flag": np.zeros(ROWS, np.uint8)}
    seen = {digest(frame_of(columns))}
    changes: list[dict[str, Any]] = []
    for name, values in columns.items():
        if name == "failure":
            changes.append({name: [CAUSES[0], *values[1:]] if values[0] is None else [None, *values[1:]]})
        else:
            changed = values.copy()
            changed.view(np.uint8)[8 * 7 if values.itemsize == 8 else 7] ^= 1
            changes.append({name: changed})
    changes.append({"chaser.mass": np.where(np.arange(ROWS) == 5, np.nan, columns["chaser.mass"])})
    changes.append({"chaser.mass": columns["chaser.mass"].view(np.uint64)})
    seen |= {digest(frame_of(columns | change)) for change in changes}
    seen.add(digest(frame_of(dict(reversed(columns.items())))))
    seen.add(digest(frame_of({("mass" if name == "chaser.mass" else name): v for name, v in columns.items()})))
    assert len(seen) == 1 + len(changes) + 2

    zero, negative, quiet, other = np.zeros(1), np.array([-0.0]), np.array([np.nan]), np.array([-np.nan])
    other.view(np.uint64)[0] |= 12345
    assert digest(frame_of({"chaser.mass": zero})) != digest(frame_of({"chaser.mass": negative}))
    assert digest(frame_of({"chaser.mass": quiet})) == digest(frame_of({"chaser.mass": other}))


def test_no_flipped_bit_and_no_cut_passes_or_reaches_the_reader_of_parquet(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = encode(frame_of(rows(0)), "me", 0, 0)
    assert decode(whole, "me", 0, 0).height == ROWS
    monkeypatch.setattr(pl, "read_parquet", lambda *_: pytest.fail("damaged bytes were parsed"))
    footer = whole[len(whole) - int.from_bytes(whole[-8:-4], "little") - 8 :]
    label = pl.read_parquet_metadata(BytesIO(footer))
    monkeypatch.setattr(
        pl,
        "read_parquet_metadata",
        lambda source: label if source.getvalue() == footer else pytest.fail("a damaged footer was parsed"),
    )
    for place in range(len(whole)):
        flipped = bytearray(whole)
        flipped[place] ^= 1 << (place % 8)
        with pytest.raises(Damage):
            decode(bytes(flipped), "me", 0, 0)
        with pytest.raises(Damage):
            decode(whole[:place], "me", 0, 0)
    with pytest.raises(Damage):
        decode(whole + b"\0", "me", 0, 0)


def test_rows_that_a_sound_file_should_not_hold_are_damage(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(Damage, match="not the runs from 100 on"):
        decode(encode(frame_of(rows(0)), "me", 1, 100), "me", 1, 100)
    monkeypatch.setattr(shards, "digest", lambda _: "0" * 64)
    content = encode(frame_of(rows(0)), "me", 0, 0)
    monkeypatch.undo()
    with pytest.raises(Damage, match="rows are not those"):
        decode(content, "me", 0, 0)


def test_the_end_of_a_file_tells_its_rows_without_the_rest(store: Store) -> None:
    store.write(4, frame_of(rows(400, 50)))
    path, content = store.path(4), store.path(4).read_bytes()
    assert rows_in(path, store.recipe.identity, 4) == 50
    flip(path, 20)
    assert rows_in(path, store.recipe.identity, 4) == 50
    length = int.from_bytes(content[-8:-4], "little") + 8
    for place in range(-length, 0, 41):
        path.write_bytes(content)
        flip(path, place)
        with pytest.raises(Damage):
            rows_in(path, store.recipe.identity, 4)
    for size in (0, 3, 7, 8, len(content) // 2, len(content) - 1):
        path.write_bytes(content[:size])
        with pytest.raises(Damage, match="cut off"):
            rows_in(path, store.recipe.identity, 4)


@pytest.mark.parametrize(
    ("name", "unit", "meaning"),
    [
        ("index", "", "number of the run"),
        ("delta_v_m_s", "m/s", "sum over axes"),
        ("debris.mass", "kg", "debris.mass: mass"),
        ("debris.tumble_rate.z", "rad/s", "debris.tumble_rate.z: omega_DN_D"),
        ("chaser.attitude.w", "", "chaser.attitude.w: C -> N"),
        ("chaser.inertia.xy", "kg m^2", "chaser.inertia.xy: inertia"),
        ("orbit.altitude", "m", "orbit.altitude: height"),
        ("laws.prrl.translation.gain", "(m/s)^(1-alpha)/s", "laws.prrl.translation.gain: K"),
    ],
)
def test_each_column_has_its_unit_and_meaning(name: str, unit: str, meaning: str) -> None:
    found = column(name)
    assert (found.name, found.unit) == (name, unit)
    assert found.meaning.startswith(meaning)


@pytest.mark.parametrize("name", ["capture_tme_s", "chaser.masss", "chaser", "title", ""])
def test_a_column_of_no_meaning_is_refused(name: str) -> None:
    with pytest.raises(ValueError, match="neither a result"):
        column(name)


@pytest.mark.parametrize("values", [np.zeros(3, np.float32), np.zeros((3, 3)), np.array(["a", "b", "c"])])
def test_a_column_of_another_type_is_refused(values: Any) -> None:
    with pytest.raises(ValueError, match="chaser"):
        frame_of({"chaser.mass": values})


@pytest.mark.parametrize("columns", [rows(100), rows(0, ROWS + 1), rows(0, 0), rows(1, 50)])
def test_runs_of_another_shard_are_not_written(store: Store, columns: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="shard 0: its rows must be the runs from 0 on"):
        store.write(0, frame_of(columns))
    assert not store.path(0).exists()
