"""The folder of a campaign: nothing half-written counts, nothing damaged is read, and everything can be continued."""

from __future__ import annotations

import errno
import json
import os
import re
import shutil
import signal
import subprocess
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import detumble
from campaign_folders import (
    ABOUT,
    ODD,
    ROWS,
    begin,
    child,
    flip,
    fly,
    needs_a_disk_of_its_own,
    on_a_disk_of_its_own,
    recipe,
    rows,
    there,
)
from detumble.campaigns.store.campaign_folder import Store
from detumble.campaigns.store.manifest import FORMAT
from detumble.campaigns.store.shard import frame_of
from detumble.campaigns.store.table import Runs
from detumble.errors import RequestError


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    with begin(tmp_path / ODD) as store:
        yield store


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


def test_the_same_campaign_is_continued_only_on_request(store: Store) -> None:
    fly(store, 450, but=(2,))
    store.close()
    with pytest.raises(RequestError, match=r"holds this campaign already, of 450 runs; --resume continues it$"):
        begin(store.folder)
    with begin(store.folder, resume=True) as again:
        assert there(again, 450) == ([0, 1, 3, 4], [])
        assert again.manifest == store.manifest


def test_what_is_to_be_continued_may_not_have_begun(tmp_path: Path) -> None:
    with begin(tmp_path / "new" / "deep", 10, resume=True) as store:
        assert there(store, 10) == ([], [])


def test_a_campaign_grows_but_never_shrinks(store: Store) -> None:
    fly(store, 450)
    store.close()
    with begin(store.folder, 900, resume=True) as longer:
        assert there(longer, 900) == ([0, 1, 2, 3], [])
        fly(longer, 900, but=(0, 1, 2, 3))
    with begin(store.folder, 430, resume=True) as shorter:
        assert there(shorter, 430) == ([0, 1, 2, 3, 4], [])
        last = shorter.find(4, 30, pytest.fail)
        assert last is not None
        assert last["index"].to_list() == list(range(400, 430))
        assert shorter.runs == Store.open(store.folder).runs == 900
        assert Runs(shorter).to_polars()["index"].to_list() == list(range(900))
        assert Runs(shorter, 430).to_polars()["index"].to_list() == list(range(430))


def test_each_machine_that_flew_is_named_once(store: Store) -> None:
    store.close()
    other = {"backend": "portable", "flags": ("a", "b")}
    for about in (ABOUT, other, ABOUT, other):
        Store.create(store.folder, recipe(), 450, about=about, resume=True).close()
    assert Store.open(store.folder).manifest.about == [ABOUT, {"backend": "portable", "flags": ["a", "b"]}]


def test_another_campaign_is_refused_and_the_difference_named(store: Store) -> None:
    scenario = recipe().parsed.model_copy(deep=True)
    scenario.title, scenario.chaser.mass = "mine", 12.0
    mine = replace(recipe(), scenario=scenario.to_toml())
    for other, told in (
        (replace(recipe(), law="pd", seed=3), f"law prrl there, pd asked for; seed {2**64 - 1} there, 3 asked for"),
        (replace(recipe(), shard=200), "shard 100 there, 200 asked for"),
        (mine, 'mine" asked for; chaser.mass 9 there, 12 asked for'),
        (replace(recipe(), scenario=recipe().scenario + "# a remark\n"), "text of the scenario"),
    ):
        for resume in (False, True):
            store.close()
            with pytest.raises(RequestError, match="holds another campaign") as caught:
                Store.create(store.folder, other, 450, about=ABOUT, resume=resume)
            assert told in str(caught.value)


def test_a_campaign_of_another_version_is_read_but_not_continued(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    fly(store, 450)
    store.close()
    monkeypatch.setattr("detumble.campaigns.store.campaign_folder.__version__", "9.0.0")
    told = f"flown by detumble {detumble.__version__}, this is 9.0.0: runs might differ, so it can be read, but not continued"
    for asked in (recipe(), replace(recipe(), version="9.0.0")):
        with pytest.raises(RequestError, match=re.escape(told)):
            Store.create(store.folder, asked, 450, about=ABOUT, resume=True)
    assert Runs(Store.open(store.folder)).to_polars().height == 450


def test_other_files_in_the_folder_do_not_matter(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    (tmp_path / "shards").mkdir()
    with begin(tmp_path, 100) as store:
        fly(store, 100)
        (tmp_path / "shards" / "notes.parquet").write_text("mine")
        assert there(store, 100) == ([0], [])
        assert len(Runs(store)) == 100
    assert (tmp_path / "notes.txt").read_text() == "mine"


def test_a_folder_whose_names_clash_is_refused(tmp_path: Path) -> None:
    def refused(folder: Path) -> str:
        with pytest.raises(RequestError) as caught:
            begin(folder, resume=True)
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


def test_a_manifest_that_cannot_be_used_says_why(store: Store) -> None:
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
        (changed(format=FORMAT + 1, recipe="?"), f"format {FORMAT + 1}; this detumble reads format {FORMAT}: a newer"),
        (changed(format=FORMAT - 1, recipe="?"), f"format {FORMAT - 1}; this detumble reads format {FORMAT}: an older"),
        (changed(recipe=sound["recipe"] | {"seed": 4}), "its recipe is not the one that was flown"),
        (changed(identity="0" * 64), "its recipe is not the one that was flown"),
    ):
        path.write_bytes(content)
        for use in (Store.open, lambda folder: begin(folder, resume=True)):
            with pytest.raises(RequestError) as caught:
                use(store.folder)
            assert str(caught.value).startswith(f"{path}: {told}")


def test_a_folder_without_a_campaign_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    for folder in (tmp_path, tmp_path / "absent", tmp_path / "file"):
        with pytest.raises(RequestError, match=r"holds no campaign \(no campaign\.json\)$"):
            Store.open(folder)


# --- what happens to files ---------------------------------------------------------------------------------------------


def test_each_kind_of_damage_is_found_and_told(store: Store, tmp_path: Path) -> None:
    fly(store, 1000)
    with Store.create(tmp_path / "other", replace(recipe(), seed=1), 1000, about=ABOUT) as foreign:
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
    reasons = {
        0: "belongs to another campaign",
        1: "cut off, or no Parquet file",
        2: "cut off, or no Parquet file",
        3: "cut off, or no Parquet file",
        4: "its bytes are not those that were written",
        6: "is shard 7 under another's name",
        7: "is shard 6 under another's name",
        8: "is a folder; needed: a regular file",
    }
    told = [f"{store.path(number)}: damaged: {why}; it is flown again" for number, why in reasons.items()]
    assert there(store, 1000) == ([9], told)
    for number, why in reasons.items():
        with pytest.raises(RequestError, match="--resume flies it again") as caught:
            store.shard(number)
        assert str(caught.value) == f"{store.path(number)}: damaged: {why}; --resume flies it again"
    with pytest.raises(RequestError, match="missing; --resume flies it again"):
        store.shard(5)
    store.path(8).rmdir()
    for number in (*reasons, 5):
        store.write(number, frame_of(rows(number * ROWS)))
    assert there(store, 1000) == (list(range(10)), [])


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


@needs_a_disk_of_its_own
def test_a_disk_that_is_really_full_keeps_what_is_complete_and_takes_the_rest_later(tmp_path: Path) -> None:
    script = """
with begin(folder) as store:
    ballast = folder / "ballast"
    ballast.write_bytes(bytes(220 * 1024))
    try:
        fly(store, 450)
    except RequestError as error:
        print(error)
    print(len(there(store, 450)[0]), len(list((folder / "shards").iterdir())))
    ballast.unlink()
    fly(store, 450)
    print(there(store, 450))
"""
    told, complaints = child(script, tmp_path, *on_a_disk_of_its_own(tmp_path, "size=252k")).communicate()
    assert complaints == ""
    message, counts, after = told.splitlines()
    assert "cannot be written: no space left on device; the shards that are complete are kept" in message
    done, files = map(int, counts.split())
    assert 0 < done == files < 5
    assert after == "([0, 1, 2, 3, 4], [])"


@needs_a_disk_of_its_own
def test_a_folder_that_takes_no_files_is_told(tmp_path: Path) -> None:
    script = "try:\n    begin(folder)\nexcept RequestError as error:\n    print(error)"
    told, _ = child(script, tmp_path, *on_a_disk_of_its_own(tmp_path, "ro")).communicate()
    assert told == f"{tmp_path}: cannot be used as an output folder: read-only file system\n"


def test_a_campaign_can_be_read_from_where_nothing_can_be_written(
    store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    fly(store, 450)
    store.close()
    before = sorted(store.folder.rglob("*"))
    opened = Store.open(store.folder)
    assert there(opened, 450) == ([0, 1, 2, 3, 4], [])
    Runs(opened).to_polars()
    assert sorted(store.folder.rglob("*")) == before


KILLED = """
with begin(folder, resume=True) as store:
    print("begun", flush=True)
    while True:
        for number in range(4):
            store.write(number, frame_of(rows(number * ROWS)))
"""


def test_one_process_flies_at_a_time_and_a_killed_one_leaves_only_whole_shards(
    tmp_path: Path, request: pytest.FixtureRequest
) -> None:
    for delay in (0.003, 0.017):
        writer = child(KILLED, tmp_path)
        request.addfinalizer(writer.kill)
        assert writer.stdout
        assert writer.stdout.readline() == "begun\n"
        with pytest.raises(RequestError) as caught:
            begin(tmp_path, resume=True)
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
        with begin(tmp_path, resume=True) as store:
            assert there(store, 450) == ([0, 1, 2, 3], [])
            found = sorted(path.name for path in tmp_path.rglob("*") if path.is_file())
            assert found == [".lock", "campaign.json", *(f"shard-00000{number}.parquet" for number in range(4))]


def test_a_second_store_of_this_process_is_kept_out_too_until_the_first_is_closed(store: Store) -> None:
    with pytest.raises(RequestError, match="is flying this campaign"):
        begin(store.folder, resume=True)
    store.close()
    begin(store.folder, resume=True).close()


def test_a_store_that_could_not_be_made_locks_nothing(store: Store) -> None:
    store.close()
    with pytest.raises(RequestError, match="--resume"):
        begin(store.folder)
    begin(store.folder, resume=True).close()
