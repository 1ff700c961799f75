"""Surroundings that a command or a script inherits: settings of drawing libraries, environment, current folder, streams."""

from __future__ import annotations

import json
import os
import shlex
import subprocess
import sys
from hashlib import sha256
from pathlib import Path

import pytest

from detumble.analysis.comparing.entries import Entry, check_entries
from detumble.errors import RequestError
from detumble.scenario import Scenario, with_settings
from detumble.simulation import simulate

DETUMBLE = f"{shlex.quote(sys.executable)} -m detumble.cli"
RUN = ["run", "paper", "--set", "time.duration=2.0", "--out"]
NOTEBOOK = "module://matplotlib_inline.backend_of_a_notebook"
TASTE = "text.usetex: True\nfont.size: 30\nno.such.key: 3\nbackend: qtagg\naxes.facecolor: black\n"


def command(*arguments: str, cwd: Path | None = None, **environment: str) -> subprocess.CompletedProcess[str]:
    surroundings = {**os.environ, **environment}
    program = [sys.executable, "-m", "detumble.cli", *arguments]
    return subprocess.run(program, cwd=cwd, env=surroundings, capture_output=True, text=True)


def script(text: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", text], env={**os.environ, **environment}, capture_output=True, text=True
    )


def digest(path: Path) -> str:
    return sha256(path.read_bytes()).hexdigest()


@pytest.fixture(scope="module")
def picture(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Digest of the picture of a short flight, drawn where nothing is set."""
    folder = tmp_path_factory.mktemp("plain")
    assert command(*RUN, str(folder)).returncode == 0
    return digest(folder / "flight.png")


def settings(kind: str, tmp_path: Path) -> tuple[Path, dict[str, str]]:
    """A current folder and an environment that suit matplotlib badly."""
    folder = tmp_path / "settings"
    (folder / "stylelib").mkdir(parents=True)
    (folder / "matplotlibrc").write_text(TASTE)
    broken = tmp_path / "broken"
    (broken / "stylelib").mkdir(parents=True)
    for name in ("matplotlibrc", "stylelib/mine.mplstyle", "file"):
        (broken / name).write_bytes(b"\xff\xfe\x00")
    match kind:
        case "backend, broken home":
            return tmp_path, {"MPLBACKEND": NOTEBOOK, "MPLCONFIGDIR": str(broken)}
        case "current folder":
            return folder, {"MPLCONFIGDIR": str(folder)}
        case "broken current folder":
            return broken, {"MATPLOTLIBRC": str(folder)}
        case _:
            return tmp_path, {"MATPLOTLIBRC": str(broken), "MPLCONFIGDIR": str(broken / "file")}


KINDS = ["backend, broken home", "current folder", "broken current folder", "broken file, no home"]


@pytest.mark.parametrize("kind", KINDS)
def test_settings_of_matplotlib_neither_stop_a_command_nor_reach_its_picture(
    kind: str, picture: str, tmp_path: Path
) -> None:
    here, environment = settings(kind, tmp_path)
    done = command(*RUN, str(tmp_path / "out"), cwd=here, **environment)
    assert done.returncode == 0
    assert all(line.startswith(("warning: not captured", "written: ")) for line in done.stderr.splitlines())
    assert digest(tmp_path / "out" / "flight.png") == picture


def test_a_search_for_gains_needs_no_backend(tmp_path: Path) -> None:
    done = command("tune", "paper", "--budget", "10", "--starts", "8", "--held-out", "0", MPLBACKEND=NOTEBOOK)
    assert done.returncode == 0, done.stderr


DRAWN = """
import sys
from pathlib import Path
import detumble
from detumble.scenario import with_settings
from detumble.show.flight import plot_flight
from detumble.show.style import write_figure
{before}
flight = detumble.simulate(with_settings(detumble.load("paper"), ["time.duration=2.0"]))
write_figure(lambda: plot_flight(flight), Path(sys.argv[1] if len(sys.argv) > 1 else {path!r}))
{after}
"""
CHANGED = """
import matplotlib.pyplot as plt
plt.style.use("dark_background")
plt.rcParams.update({"text.usetex": True, "font.family": "serif", "font.size": 20, "lines.linewidth": 9, "savefig.dpi": 30})
"""


def test_settings_made_in_python_reach_no_picture_and_are_left_as_they_were(picture: str, tmp_path: Path) -> None:
    path = tmp_path / "flight.png"
    kept = 'assert plt.rcParams["text.usetex"] and plt.rcParams["lines.linewidth"] == 9 and plt.get_backend() == "agg"'
    done = script(DRAWN.format(before=CHANGED, path=str(path), after=kept), MPLBACKEND="agg")
    assert done.returncode == 0, done.stderr
    assert digest(path) == picture


def test_in_a_script_settings_that_work_hold_and_others_do_not_stop_the_drawing(picture: str, tmp_path: Path) -> None:
    path = tmp_path / "flight.png"
    own = 'import matplotlib, os; assert matplotlib.rcParams["font.size"] == {size}, matplotlib.rcParams["font.size"]'
    (tmp_path / "matplotlibrc").write_text("font.size: 30\n")
    done = script(DRAWN.format(before="", path=str(path), after=own.format(size=30)), MATPLOTLIBRC=str(tmp_path))
    assert done.returncode == 0, done.stderr
    assert digest(path) == picture
    path.unlink()
    after = own.format(size=10) + f'; assert os.environ["MPLBACKEND"] == {NOTEBOOK!r}'
    done = script(DRAWN.format(before="", path=str(path), after=after), MPLBACKEND=NOTEBOOK)
    assert done.returncode == 0, done.stderr
    assert digest(path) == picture


@pytest.mark.skipif(sys.platform == "win32", reason="a current folder cannot be deleted there")
@pytest.mark.parametrize(
    "arguments", [RUN, ["tune", "paper", "--budget", "10", "--starts", "8", "--held-out", "0", "--out"]]
)
def test_a_current_folder_that_is_gone_stops_nothing(arguments: list[str], tmp_path: Path) -> None:
    gone = tmp_path / "gone"
    gone.mkdir()
    line = f"rmdir {shlex.quote(str(gone))}; exec {DETUMBLE} {shlex.join([*arguments, str(tmp_path / 'out')])}"
    done = subprocess.run(["bash", "-c", line], cwd=gone, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert list((tmp_path / "out").glob("*.png"))


@pytest.mark.parametrize("name", ["POLARS_MAX_THREADS", "POLARS_ASYNC_THREAD_COUNT"])
@pytest.mark.parametrize("number", ["0", "abc", "", "99999"])
def test_a_number_of_threads_that_polars_cannot_have_is_one_message(name: str, number: str, tmp_path: Path) -> None:
    done = command("campaign", "paper", "--runs", "4", "--out", str(tmp_path / "c"), **{name: number})
    assert done.returncode == 2
    assert done.stderr == f"{name} {number!r}: must be a whole number from 1 to 9999, or not set at all\n"
    assert not (tmp_path / "c").exists()


def test_an_unexpected_error_is_one_message_and_shows_its_place_on_request() -> None:
    broken = {"NUMPY_MADVISE_HUGEPAGE": "x"}  # read by numpy as it is imported
    done = command("run", "paper", "--json", **broken)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (1, "", 1)
    assert "DETUMBLE_TRACEBACK=1" in done.stderr
    assert "Traceback" in command("run", "paper", "--json", **broken, DETUMBLE_TRACEBACK="1").stderr


def test_a_configuration_of_dask_that_cannot_be_read_is_one_message(tmp_path: Path) -> None:
    pytest.importorskip("dask")
    (tmp_path / "dask.yaml").write_text("{bad: [\n")
    done = command(*RUN, str(tmp_path / "out"), DASK_CONFIG=str(tmp_path / "dask.yaml"))
    assert done.returncode == 2
    assert done.stderr.startswith("Dask cannot read its configuration (DASK_CONFIG, ~/.config/dask): ")
    assert done.stderr.count("\n") == 1


def test_variables_that_make_no_sense_stop_nothing(tmp_path: Path) -> None:
    names = ("OMP_NUM_THREADS", "RAYON_NUM_THREADS", "COLUMNS", "LINES", "TERMINAL_WIDTH", "SOURCE_DATE_EPOCH")
    senseless = dict.fromkeys(names, "abc") | {"TERM": "", "TMPDIR": "/nowhere", "PYTHONWARNINGS": "error"}
    assert command("--help", **senseless).returncode == 0
    assert command(*RUN[:-1], "--json", **senseless).returncode == 0
    senseless |= {"SOURCE_DATE_EPOCH": "9" * 30, "TERMINAL_WIDTH": "9" * 5000, "_DETUMBLE_COMPLETE": "foo"}
    senseless |= {"HDF5_DRIVER": "foo", "HDF5_VOL_CONNECTOR": "foo", "POLARS_PANIC_ON_ERR": "1"}
    assert command("run", "--help", **senseless).returncode == 0
    done = command(*RUN, str(tmp_path / "out"), **senseless)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out" / "flight.nc").exists()
    assert command("bound", "paper_dispersed", "--runs", "1", "--quick", **senseless).returncode == 0


def test_a_campaign_without_any_temporary_folder_asks_for_one() -> None:
    text = """
import tempfile, detumble
tempfile._candidate_tempdir_list = lambda: ["/nowhere"]
try:
    detumble.campaign("paper", runs=1)
except detumble.RequestError as error:
    print(error)
"""
    assert script(text).stdout.startswith("the runs need a folder: no temporary one can be made (")


def closed(redirections: str) -> subprocess.CompletedProcess[str]:
    line = f"{DETUMBLE} run paper --set time.duration=2.0 --json {redirections}"
    return subprocess.run(["bash", "-c", line], capture_output=True, text=True)


def test_with_standard_error_closed_standard_output_holds_the_object_alone() -> None:
    done = closed("2>&-")
    assert done.returncode == 0
    assert json.loads(done.stdout)["warnings"] == ["not captured within 2 s"]


def test_what_cannot_be_written_to_a_closed_standard_output_is_reported() -> None:
    done = closed(">&-")
    assert done.returncode == 1
    assert done.stderr.splitlines()[-1] == "standard output: cannot be written: bad file descriptor"


def test_closed_streams_leave_their_numbers_to_no_file(tmp_path: Path) -> None:
    line = f"{DETUMBLE} {shlex.join([*RUN, 'whole'])}; {DETUMBLE} {shlex.join([*RUN, 'closed'])} <&- >&- 2>&-"
    done = subprocess.run(["bash", "-c", line], cwd=tmp_path, capture_output=True)
    assert done.returncode == 1  # nobody can be told of the result
    for name in ("scenario.toml", "metrics.json", "flight.nc", "flight.png"):
        assert (tmp_path / "closed" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()


@pytest.mark.parametrize("name", ["x" * 61, "a\nb", "a\x00b"])
def test_a_name_that_no_table_has_room_for_is_refused(name: str, paper: Scenario) -> None:
    with pytest.raises(RequestError, match=r"its name has .* characters; it must be a line of at most 60"):
        check_entries([Entry(name, "pd", "printed"), Entry.of("lqr", "printed")], paper, as_given=True)


def test_names_are_drawn_as_they_are(tmp_path: Path) -> None:
    names = (r"x$\frac{$", r"_\alpha^{ " + 50 * "W")
    entries = [part for name in names for part in ("--entry", f"{name}=prrl")]
    done = command(
        "compare", "paper", *entries, "--as-given", "--runs", "20", "--robust", "20", "--out", str(tmp_path / "out"),
        "--set", "time.duration=20.0", PYTHONWARNINGS="error",
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert len(list((tmp_path / "out" / "figures").glob("*.png"))) == 3


def test_the_name_of_a_law_in_a_figure_is_no_formula(paper: Scenario) -> None:
    from detumble.show.figures import build
    from detumble.show.style import styled

    flight = simulate(with_settings(paper, ["time.duration=20.0"]))
    with styled():
        for figure in build({r"mine $\frac{$": flight}, 5.6).values():
            figure.draw_without_rendering()
