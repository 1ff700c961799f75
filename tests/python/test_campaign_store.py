"""The folder of a campaign: nothing half-written counts, nothing damaged is read, and everything can be continued."""

from __future__ import annotations

import errno
import inspect
import json
import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import polars as pl
import pytest
import xarray as xr

import detumble
from detumble.campaigns import shard as shards
from detumble.campaigns import table
from detumble.campaigns.manifest import FORMAT
from detumble.campaigns.recipe import Recipe
from detumble.campaigns.rows import CAUSES, INDEX, RESULTS
from detumble.campaigns.shard import Damage, column, decode, digest, encode, frame_of, rows_in
from detumble.campaigns.store import Checked, Store
from detumble.campaigns.table import Runs
from detumble.errors import RequestError

ROWS = 100
ABOUT = {"backend": "avx2", "machine": {"cpu": "a processor", "cores": 2}}
ODD = "a folder=1 [*] Δv"
"""Has what shells, globs and Hive partitions read something into."""


@pytest.fixture(scope="module")
def recipe() -> Recipe:
    return Recipe(detumble.load("paper").to_toml(), "prrl", 2**64 - 1, shard=ROWS)


@pytest.fixture
def store(recipe: Recipe, tmp_path: Path) -> Iterator[Store]:
    with Store.create(tmp_path / ODD, recipe, 450, about=ABOUT) as store:
        yield store


def rows(first: int, count: int = ROWS) -> dict[str, Any]:
    """Rows that depend on the run alone."""
    index = np.arange(first, first + count, dtype=np.uint64)
    noise = np.modf(np.sin(index.astype(float) + 1.0) * 43758.5453)[0]
    success = noise > -0.5
    return {
        "index": index,
        "chaser.mass": 8.0 + 0.1 * noise,
        "chaser.position.x": noise - 3.0,
        "success": success,
        "failure": [None if fine else CAUSES[number % len(CAUSES)] for number, fine in enumerate(success)],
        "capture_time_s": np.where(success, 40.0 + noise, np.nan),
        "force_saturated_share": np.abs(noise),
    }


def fly(store: Store, runs: int, but: tuple[int, ...] = ()) -> None:
    for number in reversed(range(store.recipe.shards(runs))):
        if number not in but:
            span = store.recipe.runs_of(number, runs)
            store.write(number, frame_of(rows(span.start, len(span))))


def flip(path: Path, place: int, bit: int = 0) -> None:
    content = bytearray(path.read_bytes())
    content[place] ^= 1 << bit
    path.write_bytes(content)


PRELUDE = f"""
from __future__ import annotations
import sys
from pathlib import Path
import numpy as np
import detumble
from detumble.campaigns.recipe import Recipe
from detumble.campaigns.rows import CAUSES
from detumble.campaigns.store import Store
from detumble.errors import RequestError

ROWS = {ROWS}
{inspect.getsource(rows)}
{inspect.getsource(fly)}
def begin():
    recipe = Recipe(detumble.load("paper").to_toml(), "prrl", 2**64 - 1, shard=ROWS)
    return Store.create(sys.argv[1], recipe, 450, about={ABOUT}, resume=True)
"""


def child(script: str, folder: Path, *wrapper: str) -> subprocess.Popen[str]:
    """Start a process that may `begin()` the fixture's campaign in a folder."""
    command = [*wrapper, sys.executable, "-c", PRELUDE + script, str(folder)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


# --- one shard ---------------------------------------------------------------------------------------------------------


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
    assert label["digest"] == digest(pl.read_parquet(content))


def test_equal_rows_give_equal_files_in_any_process(store: Store, tmp_path: Path) -> None:
    fly(store, 200)
    script = """
import polars as pl
pl.Series(["x", CAUSES[3]], dtype=pl.Categorical)  # what texts were met before must not matter
with begin() as store:
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


# --- beginning and continuing ------------------------------------------------------------------------------------------


def test_the_manifest_tells_what_is_flown(store: Store) -> None:
    stored = json.loads((store.folder / "campaign.json").read_text("utf-8"))
    assert stored["format"] == FORMAT
    assert stored["recipe"] == store.recipe.to_dict()
    assert (stored["identity"], stored["runs"], stored["about"]) == (store.recipe.identity, 450, [ABOUT])
    assert stored["created"].endswith("+00:00")
    opened = Store.open(store.folder)
    assert opened.manifest == store.manifest
    assert opened.recipe.parsed == detumble.load("paper")


def test_the_same_campaign_is_continued_only_on_request(store: Store, recipe: Recipe) -> None:
    fly(store, 450, but=(2,))
    store.close()
    with pytest.raises(RequestError, match=r"holds this campaign already, of 450 runs; --resume continues it$"):
        Store.create(store.folder, recipe, 450, about=ABOUT)
    with Store.create(store.folder, recipe, 450, about=ABOUT, resume=True) as again:
        assert again.check(450) == Checked(done=[0, 1, 3, 4], missing=[2])
        assert again.manifest == store.manifest


def test_what_is_to_be_continued_may_not_have_begun(recipe: Recipe, tmp_path: Path) -> None:
    with Store.create(tmp_path / "new" / "deep", recipe, 10, about=ABOUT, resume=True) as store:
        assert store.check(10) == Checked(missing=[0])


def test_a_campaign_grows_but_never_shrinks(store: Store, recipe: Recipe) -> None:
    fly(store, 450)
    store.close()
    with Store.create(store.folder, recipe, 900, about=ABOUT, resume=True) as longer:
        assert longer.check(900) == Checked(done=[0, 1, 2, 3], missing=[4, 5, 6, 7, 8])
        fly(longer, 900, but=(0, 1, 2, 3))
    with Store.create(store.folder, recipe, 430, about=ABOUT, resume=True) as shorter:
        seen: dict[int, Any] = {}
        assert shorter.check(430, seen.__setitem__) == Checked(done=[0, 1, 2, 3, 4])
        assert [frame.height for frame in seen.values()] == [100, 100, 100, 100, 30]
        assert shorter.runs == Store.open(store.folder).runs == 900
        assert Runs(shorter).to_polars()["index"].to_list() == list(range(900))
        assert Runs(shorter, 430).to_polars()["index"].to_list() == list(range(430))


def test_each_machine_that_flew_is_named_once(store: Store, recipe: Recipe) -> None:
    store.close()
    other = {"backend": "portable", "flags": ("a", "b")}
    for about in (ABOUT, other, ABOUT, other):
        Store.create(store.folder, recipe, 450, about=about, resume=True).close()
    assert Store.open(store.folder).manifest.about == [ABOUT, {"backend": "portable", "flags": ["a", "b"]}]


def test_another_campaign_is_refused_and_the_difference_named(store: Store, recipe: Recipe) -> None:
    scenario = recipe.parsed.model_copy(deep=True)
    scenario.title, scenario.chaser.mass = "mine", 12.0
    mine = replace(recipe, scenario=scenario.to_toml())
    for other, told in (
        (replace(recipe, law="pd", seed=3), f"law prrl there, pd asked for; seed {2**64 - 1} there, 3 asked for"),
        (replace(recipe, shard=200), "shard 100 there, 200 asked for"),
        (mine, 'mine" asked for; chaser.mass 9 there, 12 asked for'),
        (replace(recipe, scenario=recipe.scenario + "# a remark\n"), "text of the scenario"),
    ):
        for resume in (False, True):
            store.close()
            with pytest.raises(RequestError, match="holds another campaign") as caught:
                Store.create(store.folder, other, 450, about=ABOUT, resume=resume)
            assert told in str(caught.value)


def test_a_campaign_of_another_version_is_read_but_not_continued(
    store: Store, recipe: Recipe, monkeypatch: pytest.MonkeyPatch
) -> None:
    fly(store, 450)
    store.close()
    monkeypatch.setattr("detumble.campaigns.store.__version__", "9.0.0")
    told = f"flown by detumble {detumble.__version__}, this is 9.0.0: runs might differ, so it can be read, but not continued"
    for asked in (recipe, replace(recipe, version="9.0.0")):
        with pytest.raises(RequestError, match=re.escape(told)):
            Store.create(store.folder, asked, 450, about=ABOUT, resume=True)
    assert Runs(Store.open(store.folder)).to_polars().height == 450


def test_other_files_in_the_folder_do_not_matter(recipe: Recipe, tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / "shards").mkdir()
    with Store.create(tmp_path, recipe, 100, about=ABOUT) as store:
        fly(store, 100)
        (tmp_path / "shards" / "notes.parquet").write_text("mine")
        assert store.check(100).done == [0]
        assert len(Runs(store)) == 100
    assert (tmp_path / "notes.txt").read_text() == "mine"


def test_a_folder_whose_names_clash_is_refused(recipe: Recipe, tmp_path: Path) -> None:
    def refused(folder: Path) -> str:
        with pytest.raises(RequestError) as caught:
            Store.create(folder, recipe, 100, about=ABOUT, resume=True)
        return str(caught.value)

    (tmp_path / "file").touch()
    assert refused(tmp_path / "file") == f"{tmp_path}/file: cannot be used as an output folder: file exists"
    assert refused(tmp_path / "file" / "in").endswith("not a directory")
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "shards").touch()
    assert refused(tmp_path / "a") == f"{tmp_path}/a/shards: cannot be used: file exists"
    (tmp_path / "b" / "shards").mkdir(parents=True)
    (tmp_path / "b" / "shards" / "shard-000000.parquet").touch()
    assert refused(tmp_path / "b").endswith("not empty, but there is no campaign.json that says what it holds")
    (tmp_path / "c" / ".lock").mkdir(parents=True)
    assert refused(tmp_path / "c") == f"{tmp_path}/c/.lock: cannot be written: is a directory"


def test_a_manifest_that_cannot_be_used_says_why(store: Store, recipe: Recipe) -> None:
    store.close()
    path = store.folder / "campaign.json"
    sound = json.loads(path.read_text())

    def changed(**values: Any) -> bytes:
        return json.dumps(sound | values).encode()

    for content, told in (
        (b"", "broken: Expecting value"),
        (path.read_bytes()[:-20], "broken: "),
        (b"\xff\xfe{", "broken: "),
        (b"[]", "broken: "),
        (b"{}", "broken: format: field required"),
        (changed(runs="many"), "broken: runs: input should be a valid integer"),
        (changed(runs=0), "broken: runs: input should be greater than or equal to 1"),
        (changed(recipe={}), "broken: recipe.scenario: field required"),
        (changed(format=FORMAT + 1, recipe="?"), f"format {FORMAT + 1}; this detumble reads up to {FORMAT}: a newer"),
        (changed(recipe=sound["recipe"] | {"seed": 4}), "its recipe is not the one that was flown"),
        (changed(identity="0" * 64), "its recipe is not the one that was flown"),
    ):
        path.write_bytes(content)
        for use in (Store.open, lambda folder: Store.create(folder, recipe, 450, about=ABOUT, resume=True)):
            with pytest.raises(RequestError) as caught:
                use(store.folder)
            assert str(caught.value).startswith(f"{path}: {told}")


def test_a_folder_without_a_campaign_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    for folder in (tmp_path, tmp_path / "absent", tmp_path / "file"):
        with pytest.raises(RequestError, match=r"holds no campaign \(no campaign\.json\)$"):
            Store.open(folder)


# --- what happens to files ---------------------------------------------------------------------------------------------


def test_each_kind_of_damage_is_found_and_told(store: Store, recipe: Recipe, tmp_path: Path) -> None:
    fly(store, 1000)
    with Store.create(tmp_path / "other", replace(recipe, seed=1), 1000, about=ABOUT) as foreign:
        fly(foreign, 1000)
        shutil.copy(foreign.path(0), store.path(0))
    size = store.path(1).stat().st_size
    for number, length in ((1, 0), (2, size // 2), (3, size - 1)):
        os.truncate(store.path(number), length)
    flip(store.path(4), store.path(4).stat().st_size // 3)
    store.path(5).unlink()
    swapped = store.path(6).rename(tmp_path / "six")
    store.path(7).rename(store.path(6))
    swapped.rename(store.path(7))
    store.path(8).unlink()
    store.path(8).mkdir()
    told: list[int] = []
    checked = store.check(1000, lambda number, frame: told.append(number if frame is not None else -number))
    assert (checked.done, checked.missing) == ([9], [5])
    reasons = dict(checked.damaged)
    assert reasons == {
        0: "belongs to another campaign",
        1: "cut off, or no Parquet file",
        2: "cut off, or no Parquet file",
        3: "cut off, or no Parquet file",
        4: "its bytes are not those that were written",
        6: "is shard 7 under another's name",
        7: "is shard 6 under another's name",
        8: "cannot be read: is a directory",
    }
    assert told == [0, -1, -2, -3, -4, -5, -6, -7, -8, 9]
    for number, why in reasons.items():
        with pytest.raises(RequestError, match="--resume flies it again") as caught:
            store.shard(number)
        assert str(caught.value) == f"{store.path(number)}: damaged: {why}; --resume flies it again"
    with pytest.raises(RequestError, match="missing; --resume flies it again"):
        store.shard(5)
    store.path(8).rmdir()
    for number in (*reasons, 5):
        store.write(number, frame_of(rows(number * ROWS)))
    assert store.check(1000) == Checked(done=list(range(10)))


def test_a_file_reaches_the_disk_before_its_name_does(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    steps: list[str] = []
    fsync, rename = os.fsync, Path.replace

    def synced(descriptor: int) -> None:
        steps.append(f"sync {Path(f'/proc/self/fd/{descriptor}').readlink().name}")
        fsync(descriptor)

    def renamed(self: Path, target: Path) -> Path:
        steps.append(f"rename to {Path(target).name}")
        return rename(self, target)

    monkeypatch.setattr(os, "fsync", synced)
    monkeypatch.setattr(Path, "replace", renamed)
    store.write(3, frame_of(rows(300)))
    name = "shard-000003"
    assert steps == [f"sync .{name}.{os.getpid()}.parquet", f"rename to {name}.parquet", "sync shards"]


@pytest.mark.parametrize("code", [errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EIO])
def test_a_disk_that_refuses_keeps_what_is_complete(store: Store, monkeypatch: pytest.MonkeyPatch, code: int) -> None:
    fly(store, 300)
    before = {path.name: path.read_bytes() for path in store.path(0).parent.iterdir()}

    def refuse(_: int) -> None:
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(os, "fsync", refuse)
    for number in (2, 3):
        with pytest.raises(RequestError) as caught:
            store.write(number, frame_of(rows(number * ROWS, 50)))
        assert str(caught.value) == (
            f"{store.path(number)}: cannot be written: {os.strerror(code).lower()}; "
            "the shards that are complete are kept, and --resume continues"
        )
    assert {path.name: path.read_bytes() for path in store.path(0).parent.iterdir()} == before


def on_a_disk_of_its_own(folder: Path, options: str, script: str) -> tuple[str, str]:
    """Run a child that sees another file system at `folder`."""
    mount = f'mount -t tmpfs -o {options} none "$0" && exec "$@"'
    return child(script, folder, "unshare", "-rm", "sh", "-c", mount, str(folder)).communicate()


def can_mount() -> bool:
    command = ["unshare", "-rm", "mount", "-t", "tmpfs", "none", "/mnt"]
    return shutil.which("unshare") is not None and subprocess.run(command, capture_output=True).returncode == 0


needs_a_disk_of_its_own = pytest.mark.skipif(not can_mount(), reason="needs a file system of its own")


@needs_a_disk_of_its_own
def test_a_disk_that_is_really_full_keeps_what_is_complete_and_takes_the_rest_later(tmp_path: Path) -> None:
    script = """
with begin() as store:
    ballast = Path(sys.argv[1], "ballast")
    ballast.write_bytes(bytes(220 * 1024))
    try:
        fly(store, 450)
    except RequestError as error:
        print(error)
    checked = store.check(450)
    print(len(checked.done), len(checked.missing), len(list(Path(sys.argv[1], "shards").iterdir())))
    ballast.unlink()
    fly(store, 450)
    print(store.check(450).done)
"""
    told, complaints = on_a_disk_of_its_own(tmp_path, "size=252k", script)
    assert complaints == ""
    message, counts, after = told.splitlines()
    assert "cannot be written: no space left on device; the shards that are complete are kept" in message
    done, missing, files = map(int, counts.split())
    assert 0 < done < done + missing == 5
    assert files == done
    assert after == "[0, 1, 2, 3, 4]"


@needs_a_disk_of_its_own
def test_a_folder_that_takes_no_files_is_told(tmp_path: Path) -> None:
    told, _ = on_a_disk_of_its_own(tmp_path, "ro", "try:\n    begin()\nexcept RequestError as error:\n    print(error)")
    assert told == f"{tmp_path}: cannot be used as an output folder: read-only file system\n"


def test_a_campaign_can_be_read_from_where_nothing_can_be_written(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    fly(store, 450)
    store.close()
    before = sorted(store.folder.rglob("*"))
    opened = Store.open(store.folder)
    opened.check(450)
    Runs(opened).to_polars()
    assert sorted(store.folder.rglob("*")) == before


KILLED = """
with begin() as store:
    print("begun", flush=True)
    while True:
        for number in range(4):
            store.write(number, frame_of(rows(number * ROWS)))
"""


def test_one_process_flies_at_a_time_and_a_killed_one_leaves_only_whole_shards(
    recipe: Recipe, tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    for delay in (0.003, 0.017):
        writer = child(KILLED, tmp_path)
        request.addfinalizer(writer.kill)
        assert writer.stdout
        assert writer.stdout.readline() == "begun\n"
        with pytest.raises(RequestError) as caught:
            Store.create(tmp_path, recipe, 450, about=ABOUT, resume=True)
        assert str(caught.value) == f"{tmp_path}: another process ({writer.pid}) is flying this campaign"
        assert Store.open(tmp_path).runs == 450
        while not (tmp_path / "shards" / "shard-000003.parquet").exists():
            assert writer.poll() is None
        with pytest.raises(subprocess.TimeoutExpired):
            writer.wait(delay)
        writer.send_signal(signal.SIGKILL)
        assert writer.communicate()[1] == ""
        (tmp_path / "shards" / f".shard-000003.{writer.pid}.parquet").write_bytes(b"PAR1 half")
        (tmp_path / f".campaign.{writer.pid}.json").write_bytes(b"{")
        with Store.create(tmp_path, recipe, 450, about=ABOUT, resume=True) as store:
            assert store.check(450) == Checked(done=[0, 1, 2, 3], missing=[4])
            found = sorted(path.name for path in tmp_path.rglob("*") if path.is_file())
            assert found == [".lock", "campaign.json", *(f"shard-00000{number}.parquet" for number in range(4))]


def test_a_second_store_of_this_process_is_kept_out_too_until_the_first_is_closed(store: Store, recipe: Recipe) -> None:
    with pytest.raises(RequestError, match="is flying this campaign"):
        Store.create(store.folder, recipe, 450, about=ABOUT, resume=True)
    store.close()
    Store.create(store.folder, recipe, 450, about=ABOUT, resume=True).close()


def test_a_store_that_could_not_be_made_locks_nothing(store: Store, recipe: Recipe) -> None:
    store.close()
    with pytest.raises(RequestError, match="--resume"):
        Store.create(store.folder, recipe, 450, about=ABOUT)
    Store.create(store.folder, recipe, 450, about=ABOUT, resume=True).close()


# --- the table of all runs ---------------------------------------------------------------------------------------------


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


def test_gaps_are_refused_and_told(store: Store) -> None:
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
