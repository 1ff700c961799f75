"""Files are replaced where a link leads, keep their mode, and nothing but a regular file is read or replaced."""

from __future__ import annotations

import os
import stat
import subprocess
import sys
from collections.abc import Callable
from contextlib import chdir
from pathlib import Path
from threading import Thread

import pytest

import detumble
from detumble.scenario import Scenario
from detumble.writing import read_bytes, write_text

Save = Callable[[Path], None]


@pytest.fixture(scope="module")
def paper() -> Scenario:
    scenario = detumble.load("paper")
    scenario.time.duration = 5.0
    return scenario


@pytest.fixture(params=["scenario", "flight"])
def save(request: pytest.FixtureRequest, paper: Scenario) -> Save:
    return paper.save if request.param == "scenario" else detumble.simulate(paper, "prrl").to_netcdf


def test_a_symbolic_link_stays_and_its_file_is_replaced(save: Save, tmp_path: Path) -> None:
    there = tmp_path / "elsewhere" / "file"
    there.parent.mkdir()
    there.write_text("old")
    link, dangling = tmp_path / "link", tmp_path / "dangling"
    link.symlink_to("elsewhere/file")
    dangling.symlink_to(tmp_path / "new")
    for path in (link, dangling):
        save(path)
        assert path.is_symlink()
        assert path.stat().st_size > 1000
    assert there.stat().st_size > 1000
    assert sorted(path.name for path in tmp_path.iterdir()) == ["dangling", "elsewhere", "link", "new"]


@pytest.mark.parametrize("mode", [0o640, 0o600, 0o444, 0o755])
def test_a_file_keeps_its_mode(save: Save, tmp_path: Path, mode: int) -> None:
    path = tmp_path / "file"
    path.write_text("old")
    path.chmod(mode)
    save(path)
    assert stat.S_IMODE(path.stat().st_mode) == mode
    assert path.stat().st_size > 1000


def test_a_new_file_has_the_mode_that_the_process_gives(tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        write_text(tmp_path / "file", "text")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "file").stat().st_mode) == 0o640


def test_what_is_no_regular_file_is_not_replaced(save: Save, tmp_path: Path) -> None:
    pipe, folder, loop = tmp_path / "pipe", tmp_path / "folder", tmp_path / "loop"
    os.mkfifo(pipe)
    folder.mkdir()
    loop.symlink_to(loop)
    to_device = tmp_path / "to device"
    to_device.symlink_to("/dev/null")
    for path, why in ((pipe, "pipe"), (folder, "folder"), (loop, "symbolic links"), (to_device, "device")):
        with pytest.raises(detumble.RequestError, match=why):
            save(path)
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    assert stat.S_ISCHR(Path("/dev/null").stat().st_mode)
    for path in ("", " ", "a\0b", "x" * 300, 5, None):
        with pytest.raises(detumble.RequestError):
            save(path)  # type: ignore[arg-type]
    assert len(list(tmp_path.iterdir())) == 4


@pytest.mark.parametrize("name", ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1", "link"])
def test_standard_output_that_goes_to_a_file_is_not_replaced(name: str, tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to("/dev/stdout")
    program = f"""
import detumble
print("before", flush=True)
try:
    detumble.load("paper").save({name!r})
except detumble.RequestError as error:
    print("refused", flush=True)
"""
    log = tmp_path / "log"
    with log.open("w") as file:
        subprocess.run([sys.executable, "-c", program], cwd=tmp_path, stdout=file, check=True)
    assert log.read_text() == "before\nrefused\n"


def test_a_name_as_long_as_the_system_allows_is_written(tmp_path: Path) -> None:
    path = tmp_path / ("x" * 250 + ".toml")
    write_text(path, "text")
    assert [each.name for each in tmp_path.iterdir()] == [path.name]


def test_threads_of_one_process_do_not_share_a_temporary_file(tmp_path: Path) -> None:
    path = tmp_path / "file"
    texts = [character * 100_000 for character in "abcdefgh"]
    threads = [Thread(target=write_text, args=(path, text)) for text in texts for _ in range(5)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert path.read_text() in texts
    assert len(list(tmp_path.iterdir())) == 1


def test_reading_ends_at_what_is_allowed(tmp_path: Path) -> None:
    path, pipe = tmp_path / "file", tmp_path / "pipe"
    path.write_bytes(bytes(1000))
    os.mkfifo(pipe)
    assert read_bytes(path, 1000) == bytes(1000)
    for source, why in ((path, "1000 bytes"), (pipe, "pipe"), (Path("/dev/zero"), "device"), (tmp_path, "folder")):
        with pytest.raises(ValueError, match=why):
            read_bytes(source, 999)


def test_a_scenario_is_read_from_nothing_that_has_no_end(tmp_path: Path) -> None:
    pipe, large = tmp_path / "pipe", tmp_path / "large.toml"
    os.mkfifo(pipe)
    with large.open("wb") as file:
        file.truncate(5 * 2**30)
    for source, why in (("/dev/zero", "device"), (pipe, "pipe"), (large, "bytes"), (tmp_path, "folder")):
        with pytest.raises(detumble.ScenarioError, match=why):
            detumble.load(source)
    for source in ("/dev/zero", pipe, tmp_path):
        with pytest.raises(detumble.RequestError, match="regular file"):
            detumble.read_netcdf(source)


def test_depth_of_tables_is_limited() -> None:
    deep = ".".join("a" * 5000)
    nested = "x = " + "[" * 5000 + "]" * 5000
    for text in (f"{deep} = 1", nested, f"[{deep}]", "x = " + "{a=" * 3000 + "1" + "}" * 3000):
        with pytest.raises(detumble.ScenarioError):
            detumble.scenario.from_toml(text)
    paper = detumble.load("paper")
    for setting in (f"{deep}=1", f"chaser.{deep}=1", f"laws.prrl.{deep}=1", f"chaser.mass={'[' * 3000}"):
        with pytest.raises(detumble.RequestError):
            detumble.scenario.with_settings(paper, [setting])


def test_a_current_folder_that_is_gone_is_one_message(paper: Scenario, tmp_path: Path) -> None:
    gone = tmp_path / "gone"
    gone.mkdir()
    with chdir(gone):
        gone.rmdir()
        for use in (lambda: detumble.campaign(paper, "prrl", 2, out="x"), lambda: detumble.load("x.toml")):
            with pytest.raises(detumble.RequestError):
                use()
