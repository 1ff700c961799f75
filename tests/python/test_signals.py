"""What asks a command for its end: Ctrl-C, the end of a job (SIGTERM), the end of a terminal (SIGHUP)."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="has no such signals")

MARK = "DETUMBLE_TEST_OF_SIGNALS"
STUCK = """
import importlib.abc, signal, sys, time
{before}
class Stuck(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name == "xarray":
            try:
                print("ready", flush=True)
                time.sleep(60)
            finally:
                {after}

sys.meta_path.insert(0, Stuck())
sys.argv = ["detumble", "run", "paper", "--out", {folder!r}, "--set", "time.duration=1.0"]
from detumble.cli import main
main()
"""


def begun(*arguments: str, program: str = "") -> subprocess.Popen[str]:
    """Begin a command in a group of its own, whose processes can be found by a mark."""
    rest = ["-c", program] if program else ["-m", "detumble.cli", *arguments]
    return subprocess.Popen(
        [sys.executable, *rest],
        env={**os.environ, MARK: str(os.getpid())},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def await_that(holds: Callable[[], object], process: subprocess.Popen[str]) -> None:
    deadline = time.monotonic() + 60.0
    while not holds():
        assert process.poll() is None, process.communicate()[1]
        assert time.monotonic() < deadline
        time.sleep(0.02)


def left_over() -> list[Path]:
    """Processes that carry the mark."""
    found = []
    for path in Path("/proc").glob("[0-9]*/environ"):
        try:
            if f"{MARK}={os.getpid()}\0".encode() in path.read_bytes():
                found.append(path.parent)
        except OSError:
            pass
    return found


def end_all(process: subprocess.Popen[str], number: signal.Signals) -> tuple[int, str]:
    """Signal the whole group, as schedulers of jobs do; gives the exit code and what was said."""
    os.killpg(process.pid, number)
    _, said = process.communicate(timeout=30.0)
    if Path("/proc/self/environ").exists():
        deadline = time.monotonic() + 5.0
        while left_over() and time.monotonic() < deadline:
            time.sleep(0.05)
        assert not left_over()
    return process.returncode, said


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_a_campaign_says_how_to_go_on(number: signal.Signals, tmp_path: Path) -> None:
    process = begun("campaign", "paper_dispersed", "--runs", "10000000", "--out", str(tmp_path / "c"))
    await_that(lambda: list(tmp_path.glob("c/shards/*")), process)
    code, said = end_all(process, number)
    assert code == 128 + number
    assert said == f"stopped; the same command with --resume continues it: {tmp_path / 'c'}\n"
    assert not list(tmp_path.glob("c/shards/.*"))


@pytest.mark.parametrize(
    ("number", "at_work"), [(signal.SIGTERM, True), (signal.SIGTERM, False), (signal.SIGHUP, False)]
)
def test_workers_of_a_local_cluster_are_quiet_and_go(number: signal.Signals, at_work: bool, tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    options = ("--runs", "10000000", "--local-cluster", "1", "--out", str(tmp_path / "c"))
    process = begun("campaign", "paper_dispersed", *options)
    # before there are shards, the worker begins
    await_that(lambda: list(tmp_path.glob("c/shards/*")) if at_work else len(left_over()) > 2, process)
    code, said = end_all(process, number)
    assert code == 128 + number
    assert said in ("", f"stopped; the same command with --resume continues it: {tmp_path / 'c'}\n")
    assert bool(said) or not at_work


def test_bounds_of_many_runs_leave_no_worker() -> None:
    process = begun("bound", "paper_dispersed", "--runs", "100000", "--quick")
    await_that(lambda: len(left_over()) > 2, process)
    assert end_all(process, signal.SIGTERM) == (128 + signal.SIGTERM, "")


def test_a_search_for_gains_says_how_to_go_on(tmp_path: Path) -> None:
    process = begun("tune", "paper", "--budget", "1000000", "--starts", "8", "--out", str(tmp_path / "t"))
    record = tmp_path / "t" / "record.jsonl"
    await_that(lambda: record.exists() and record.read_text().count("\n") > 10, process)
    code, said = end_all(process, signal.SIGTERM)
    assert code == 128 + signal.SIGTERM
    assert said == f"stopped; the same command with --resume continues it: {tmp_path / 't'}\n"


def test_figures_half_drawn_go(tmp_path: Path) -> None:
    process = begun("paper", "--out", str(tmp_path))
    await_that(lambda: list(tmp_path.glob(".fig*")), process)
    assert end_all(process, signal.SIGTERM) == (128 + signal.SIGTERM, "")
    assert not list(tmp_path.glob(".*"))


def test_a_second_signal_ends_at_once(tmp_path: Path) -> None:
    process = begun(
        program=STUCK.format(before="", after="print('again', flush=True); time.sleep(60)", folder=str(tmp_path))
    )
    assert process.stdout is not None
    for word in ("ready", "again"):
        assert process.stdout.readline() == f"{word}\n"
        process.send_signal(signal.SIGTERM)
    assert process.wait(timeout=5.0) == -signal.SIGTERM
    process.communicate()


@pytest.mark.parametrize("number", [signal.SIGHUP, signal.SIGTERM])
def test_a_signal_that_is_ignored_stays_so(number: signal.Signals, tmp_path: Path) -> None:
    before = f"signal.signal({int(number)}, signal.SIG_IGN)\ntime.sleep, wait = (lambda _: wait(0.5)), time.sleep\n"
    process = begun(program=STUCK.format(before=before, after="pass", folder=str(tmp_path)))
    assert process.stdout is not None
    assert process.stdout.readline() == "ready\n"
    process.send_signal(number)
    process.communicate(timeout=60.0)
    assert process.returncode == 0
