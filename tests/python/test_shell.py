"""The command line in rough surroundings: full disks and streams, poor encodings, closed pipes, Ctrl-C at any time."""

from __future__ import annotations

import json
import os
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from detumble.scenario import Scenario, with_settings

DETUMBLE = f"{shlex.quote(sys.executable)} -m detumble.cli"
RUN = f"{DETUMBLE} run paper --set time.duration=1.0"


def bash(command: str, folder: Path | None = None, **environment: str) -> subprocess.CompletedProcess[str]:
    surroundings = {**os.environ, "PYTHONUNBUFFERED": "", **environment}
    encoding = environment.get("PYTHONIOENCODING", "utf-8")
    return subprocess.run(["bash", "-c", command], cwd=folder, env=surroundings, capture_output=True, encoding=encoding)


def test_a_full_disk_is_one_message_and_leaves_nothing(tmp_path: Path) -> None:
    done = bash(f"ulimit -f 20; {DETUMBLE} run paper --out full", tmp_path)
    assert done.returncode == 2
    assert done.stderr == "full/flight.nc: cannot be written: file too large\n"
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize("command", [RUN, f"{RUN} --json", f"{DETUMBLE} scenarios", f"{DETUMBLE} --version"])
def test_standard_output_that_is_full_is_one_message(command: str, unbuffered: str) -> None:
    done = bash(f"{command} > /dev/full", PYTHONUNBUFFERED=unbuffered)
    assert done.returncode == 1
    complaints = [line for line in done.stderr.splitlines() if not line.startswith("warning: ")]
    assert complaints == ["standard output: cannot be written: no space left on device"]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full")
def test_standard_error_that_is_full_changes_no_exit_code_of_a_wrong_request() -> None:
    assert bash(f"{DETUMBLE} run papr 2> /dev/full").returncode == 2


@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize("reader", ["head -1", "true"])
def test_a_reader_that_has_seen_enough_is_no_mistake(reader: str, unbuffered: str) -> None:
    done = bash(f"{DETUMBLE} schema | {reader}", PYTHONUNBUFFERED=unbuffered)
    assert done.stderr == ""


def test_closed_streams_end_in_a_failure_without_a_traceback() -> None:
    assert bash(f"{RUN} >&- 2>&-").returncode == 1


@pytest.mark.parametrize("encoding", ["ascii", "latin-1"])
def test_any_encoding_will_do(encoding: str, paper: Scenario, tmp_path: Path) -> None:
    scenario = tmp_path / "x.toml"
    with_settings(paper, ["title=Δv 日本", "time.duration=1.0"]).save(scenario)
    done = bash(f"{DETUMBLE} run {scenario}", PYTHONIOENCODING=encoding)
    assert done.returncode == 0
    assert done.stdout.startswith("dv ??\n")
    assert any(line.startswith("dv ") and line.endswith(" m/s") for line in done.stdout.splitlines())
    told = bash(f"{DETUMBLE} run {scenario} --json", PYTHONIOENCODING=encoding)
    assert json.loads(told.stdout)["scenario"] == "Δv 日本"


INTERRUPTED = """
import importlib.abc, signal, sys

class Finger(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path, target=None):
        if name == {module!r}:
            try:
                signal.raise_signal(signal.SIGINT)
            except BaseException:
                {then}

sys.meta_path.insert(0, Finger())
sys.argv = ["detumble", "run", "paper", "--out", {folder!r}, "--set", "time.duration=1.0"]
from detumble.cli import main
main()
"""


@pytest.mark.parametrize(
    ("module", "then"),
    [
        ("typer", "raise"),
        ("pydantic", "raise"),
        ("numpy._core.multiarray", "raise"),
        ("numpy._core.multiarray", "raise ImportError('numpy: check your installation')"),
        ("numpy._core.multiarray", "pass"),
        ("detumble._core", "raise"),
        ("detumble._core", "raise ImportError('core')"),
        ("xarray", "raise"),
        ("matplotlib", "raise"),
    ],
)
def test_ctrl_c_during_an_import_is_quiet_whatever_the_library_makes_of_it(
    module: str, then: str, tmp_path: Path
) -> None:
    program = INTERRUPTED.format(module=module, then=then, folder=str(tmp_path / "out"))
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 130
    assert not list(tmp_path.rglob(".*"))
    if then != "pass":
        assert done.stderr == ""
        assert (tmp_path / "out").exists() == (module == "matplotlib")  # the other files were written before


def test_ctrl_c_before_anything_is_imported_is_quiet_too() -> None:
    program = INTERRUPTED.format(module="detumble.shell", then="raise", folder="nowhere")
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (130, "")


def test_ctrl_c_within_a_callback_that_can_raise_nothing_is_quiet() -> None:
    program = INTERRUPTED.replace("signal.raise_signal(signal.SIGINT)", "Dying()")
    dying = "class Dying:\n    def __del__(self): signal.raise_signal(signal.SIGINT)\n"
    program = dying + program.format(module="typer", then="raise", folder="").replace("\"--out\", '', ", "")
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 130
    assert "Exception ignored" not in done.stderr


def test_ctrl_c_stays_ignored_where_it_was() -> None:
    program = "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)\n" + INTERRUPTED
    program = program.format(module="typer", then="raise", folder="").replace("\"--out\", '', ", "")
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
