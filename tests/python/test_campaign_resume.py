"""A campaign can be broken off at any moment, by anything, and continued: the same rows, nothing flown twice."""

from __future__ import annotations

import errno
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import detumble
from campaign_folders import child, flip, needs_a_disk_of_its_own, on_a_disk_of_its_own
from detumble.campaigns.result import CampaignResult, read_campaign
from detumble.campaigns.statistics.running import Statistics
from detumble.campaigns.store.campaign_folder import Store
from detumble.errors import RequestError
from detumble.progress import Watcher
from detumble.scenario import with_settings
from uncertain import flown, rows_digest, uncertain

SHARD = 100


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> CampaignResult:
    return flown(tmp_path_factory.mktemp("reference"))


class Remarks(Watcher):
    """Keeps what is remarked."""

    def __init__(self) -> None:
        self.texts: list[str] = []

    def remark(self, text: str) -> None:
        self.texts.append(text)


class Stop(Watcher):
    """Breaks off, with an error of any kind, once so many runs are done."""

    def __init__(self, after: int, error: BaseException) -> None:
        self.after, self.error = after, error

    def now(self, done: int, flown: int, statistics: Statistics) -> None:
        if statistics.runs >= self.after:
            raise self.error


def shards(folder: Path) -> dict[str, tuple[int, bytes]]:
    """Give each shard of a folder with the time at which it was written, and its bytes."""
    files = sorted((folder / "shards").glob("shard-*.parquet"))
    return {file.name: (file.stat().st_mtime_ns, file.read_bytes()) for file in files}


def others(folder: Path) -> set[str]:
    """Name the files beside the shards."""
    return {path.name for path in folder.rglob("*") if path.is_file() and not path.name.startswith("shard-")}


def broken_off(folder: Path, after: int = 200, **how: Any) -> None:
    """Fly the reference's campaign into a folder, up to some run."""
    with pytest.raises(ZeroDivisionError):
        flown(folder, watcher=Stop(after, ZeroDivisionError()), **how)


# --- broken off --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("error", [KeyboardInterrupt(), SystemExit(130), MemoryError(), RequestError("full")], ids=repr)
def test_whatever_breaks_it_off_it_goes_on_where_it_was(
    reference: CampaignResult, tmp_path: Path, error: BaseException
) -> None:
    with pytest.raises(type(error)):
        flown(tmp_path, watcher=Stop(200, error))
    before = shards(tmp_path)
    assert len(before) in (2, 3)
    again = flown(tmp_path, resume=True)
    assert rows_digest(again) == rows_digest(reference)
    assert again.statistics.to_json() == reference.statistics.to_json()
    assert again.effort.flown == 400 - SHARD * len(before)
    assert {name: shards(tmp_path)[name] for name in before} == before


def test_a_long_shard_is_broken_off_at_once_and_not_flown_to_its_end(tmp_path: Path) -> None:
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        flown(tmp_path, runs=400_000, shard=400_000, watcher=Stop(0, KeyboardInterrupt()))
    assert time.monotonic() - began < 10.0  # a minute and more else
    assert shards(tmp_path) == {}


def test_one_that_is_complete_is_read_and_not_flown(reference: CampaignResult) -> None:
    before = shards(reference.folder)
    again = flown(reference.folder, resume=True)
    assert again.effort.flown == 0
    assert again.to_json() | {"wall_s": 0.0} == reference.to_json() | dict.fromkeys(
        ("rate_runs_per_s", "steps_per_s", "lane_use")
    ) | {"flown": 0, "wall_s": 0.0}
    assert shards(reference.folder) == before
    read = read_campaign(reference.folder)
    assert read.statistics.to_json() == reference.statistics.to_json()
    assert rows_digest(read) == rows_digest(reference)


def test_a_shorter_campaign_is_lengthened_and_only_its_last_shard_flown_again(
    reference: CampaignResult, tmp_path: Path
) -> None:
    flown(tmp_path, runs=250)
    before = shards(tmp_path)
    assert len(before) == 3
    longer = flown(tmp_path, runs=400, resume=True)
    assert rows_digest(longer) == rows_digest(reference)
    assert longer.effort.flown == 200
    after = shards(tmp_path)
    assert [after[name] == before[name] for name in before] == [True, True, False]
    shorter = flown(tmp_path, runs=120, resume=True)
    assert shorter.statistics.runs == 400  # what is there is told of
    assert shorter.effort.flown == 0
    assert shards(tmp_path) == after
    assert read_campaign(tmp_path).statistics.runs == 400


def test_an_unfinished_campaign_can_be_read_as_far_as_it_is_whole(reference: CampaignResult, tmp_path: Path) -> None:
    broken_off(tmp_path)
    (tmp_path / "shards" / "shard-000002.parquet").unlink(missing_ok=True)
    read = read_campaign(tmp_path)
    assert read.statistics.runs == len(read.runs) == 200
    assert read.runs.to_polars().equals(reference.runs.to_polars().head(200))
    (tmp_path / "shards" / "shard-000000.parquet").unlink()
    with pytest.raises(RequestError, match=r"shard-000000.parquet: missing or damaged; --resume flies it$"):
        read_campaign(tmp_path)


FLYING = """
import detumble.campaigns.campaign, os
from uncertain import uncertain
scenario = uncertain()
for _ in sys.stdin:
    flying = os.fork()
    if not flying:
        detumble.campaign(scenario, "pd", 5000, 3, folder, threads=1, shard=50, resume=True)
        os._exit(0)
    print(flying, flush=True)
    print(os.waitstatus_to_exitcode(os.waitpid(flying, 0)[1]), flush=True)
"""
"""Lets a process of its own fly the campaign at each line, tells its number, and how it ended."""


def begun(nursery: subprocess.Popen[str]) -> int:
    """Give the number of a process that flies the campaign from now on."""
    assert nursery.stdin
    assert nursery.stdout
    nursery.stdin.write("\n")
    nursery.stdin.flush()
    return int(nursery.stdout.readline())


def killed(nursery: subprocess.Popen[str], flying: int) -> None:
    """Kill it, and see that it had not ended by itself."""
    os.kill(flying, signal.SIGKILL)
    assert nursery.stdout
    assert nursery.stdout.readline() == f"{-signal.SIGKILL}\n"


def test_killed_at_ten_random_moments_it_still_ends_with_the_same_rows(tmp_path: Path) -> None:
    rng = random.Random(7)
    with child(FLYING, tmp_path) as nursery:
        after = shards(tmp_path)
        for _ in range(10):
            before = after
            flying = begun(nursery)
            more = rng.randrange(4)  # shards, and then a moment in which the next is flown or written
            while len(list(tmp_path.glob("shards/shard-*"))) < len(before) + more:
                time.sleep(1e-3)
            time.sleep(rng.uniform(0.0, 0.05))
            killed(nursery, flying)
            after = shards(tmp_path)
            assert {name: after[name] for name in before} == before
    assert 0 < len(after) < 100
    remarks = Remarks()
    once = flown(tmp_path, runs=5000, shard=50, resume=True, watcher=remarks)
    assert remarks.texts == []
    assert once.effort.flown == 5000 - 50 * len(after)
    assert {name: shards(tmp_path)[name] for name in after} == after
    assert others(tmp_path) == {"campaign.json", ".lock"}
    whole = flown(tmp_path / "at once", runs=5000, shard=1000)
    assert rows_digest(once) == rows_digest(whole)
    assert once.statistics.to_json() == whole.statistics.to_json()


def test_of_two_processes_one_is_kept_out(tmp_path: Path) -> None:
    with child(FLYING, tmp_path) as nursery:
        flying = begun(nursery)
        while not list(tmp_path.glob("shards/shard-*")):
            time.sleep(0.01)
        with pytest.raises(RequestError) as refused:
            flown(tmp_path, runs=5000, shard=50, resume=True)
        assert str(refused.value) == f"{tmp_path}: another process ({flying}) is flying this campaign"
        killed(nursery, flying)


def command(*arguments: str | Path) -> list[str]:
    """Give the command line of a process that hears Ctrl-C, wherever this one was started."""
    program = (
        "import signal; signal.signal(signal.SIGINT, signal.default_int_handler); from detumble.cli import main; main()"
    )
    return [sys.executable, "-c", program, *map(str, arguments)]


@pytest.mark.parametrize("who", [(), ("--local-cluster", "1")], ids=["threads", "cluster"])
def test_ctrl_c_ends_in_one_line_that_says_how_to_go_on(tmp_path: Path, who: tuple[str, ...]) -> None:
    if who:
        pytest.importorskip("distributed")
    scenario, out = tmp_path / "u.toml", tmp_path / "out"
    with_settings(uncertain(), ["time.duration=10.0"]).save(scenario)
    asked = ["campaign", scenario, "--law", "pd", "--seed", "3", "--out", out]
    streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(command(*asked, *who, "--runs", "10000000"), start_new_session=True, **streams) as flying:
        while not (out / "shards" / "shard-000000.parquet").exists():
            assert flying.poll() is None, flying.communicate()
            time.sleep(0.01)
        os.killpg(flying.pid, signal.SIGINT)  # as a terminal does: to the workers too
        told, complaints = flying.communicate()
    assert flying.returncode == 130
    assert told == ""
    assert complaints == f"stopped; the same command with --resume continues it: {out}\n"
    before = shards(out)
    assert others(out) == {"campaign.json", ".lock"}
    again = detumble.campaign(scenario, "pd", 16_384 * len(before) + 100, 3, out, resume=True)
    assert again.effort.flown == 100
    assert {name: shards(out)[name] for name in before} == before
    assert again.runs.to_polars()["index"].to_list() == list(range(len(again.runs)))


# --- damage ------------------------------------------------------------------------------------------------------------


def cut(path: Path) -> None:
    os.truncate(path, path.stat().st_size // 2)


@pytest.mark.parametrize(
    ("harm", "remark"),
    [
        (Path.unlink, None),
        (cut, "cut off, or no Parquet file"),
        (lambda path: os.truncate(path, 0), "cut off, or no Parquet file"),
        (lambda path: flip(path, 1000), "its bytes are not those that were written"),
    ],
    ids=["deleted", "cut", "emptied", "flipped"],
)
def test_a_shard_that_is_lost_is_flown_again_and_that_is_remarked(
    reference: CampaignResult, tmp_path: Path, harm: Callable[[Path], None], remark: str | None
) -> None:
    flown(tmp_path)
    whole = shards(tmp_path)
    path = tmp_path / "shards" / "shard-000001.parquet"
    harm(path)
    with pytest.raises(
        RequestError, match=f"{path}: {f'damaged: {remark}' if remark else 'missing'}; --resume flies it"
    ):
        Store.open(tmp_path).shard(1)
    with pytest.raises(RequestError, match=r"holds this campaign already, of 400 runs; --resume continues it$"):
        flown(tmp_path)
    remarks = Remarks()
    mended = flown(tmp_path, resume=True, watcher=remarks)
    assert remarks.texts == ([f"{path}: damaged: {remark}; it is flown again"] if remark else [])
    assert mended.effort.flown == SHARD
    assert rows_digest(mended) == rows_digest(reference)
    assert {name: content for name, (_, content) in shards(tmp_path).items()} == {
        name: content for name, (_, content) in whole.items()
    }


def test_another_campaign_in_the_folder_is_refused_and_left_alone(reference: CampaignResult) -> None:
    before = shards(reference.folder)
    for change, told in (
        ({"law": "prrl"}, "law pd there, prrl asked for"),
        ({"seed": 4}, "seed 3 there, 4 asked for"),
        ({"shard": 50}, "shard 100 there, 50 asked for"),
        ({"backend": "portable"}, "arithmetic wide there, portable asked for"),
    ):
        for resume in (False, True):
            with pytest.raises(RequestError, match=f"holds another campaign \\({told}\\)$"):
                flown(reference.folder, resume=resume, **change)
    heavier = with_settings(uncertain(), ["chaser.mass=10.0"])
    with pytest.raises(RequestError, match=r"chaser\.mass 9 there, 10 asked for"):
        detumble.campaign(heavier, "pd", 400, 3, reference.folder, shard=100, resume=True)
    assert shards(reference.folder) == before


# --- disks -------------------------------------------------------------------------------------------------------------


def test_a_disk_that_is_full_is_reported_and_what_is_complete_kept(
    reference: CampaignResult, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written, fsync = [], os.fsync

    def third_fails(descriptor: int) -> None:
        name = Path(f"/proc/self/fd/{descriptor}").readlink().name
        if name.startswith(".shard-000002"):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        written.append(name)
        fsync(descriptor)

    monkeypatch.setattr(os, "fsync", third_fails)
    with pytest.raises(RequestError) as full:
        flown(tmp_path)
    assert str(full.value) == (
        f"{tmp_path}/shards/shard-000002.parquet: cannot be written: no space left on device; "
        "the shards that are complete are kept, and --resume continues"
    )
    monkeypatch.undo()
    assert len(shards(tmp_path)) == 2
    assert others(tmp_path) == {"campaign.json", ".lock"}
    assert rows_digest(flown(tmp_path, resume=True)) == rows_digest(reference)


@needs_a_disk_of_its_own
def test_disks_that_are_really_full_or_take_nothing_end_in_one_message(tmp_path: Path) -> None:
    scenario = tmp_path / "u.toml"
    uncertain().save(scenario)
    disk = tmp_path / "disk"
    disk.mkdir()
    asked = command("campaign", scenario, "--law", "pd", "--runs", "3000", "--out", disk / "out")
    for options, told in (
        (
            "size=100k",
            "out/shards/shard-000000.parquet: cannot be written: no space left on device; the shards that are",
        ),
        ("ro", "out: cannot be used as an output folder: read-only file system"),
    ):
        done = subprocess.run(on_a_disk_of_its_own(disk, options, *asked), capture_output=True, text=True)
        assert (done.returncode, done.stdout) == (2, "")
        assert done.stderr.startswith(f"{disk}/{told}")
        assert done.stderr.count("\n") == 1
