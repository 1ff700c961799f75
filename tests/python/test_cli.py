"""The command line as a person and a program meet it: exit codes, one JSON object, one message for a mistake."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

import detumble
from detumble.cli import main
from detumble.scenario import LAWS
from detumble.scenario.paper import PUBLISHED_CAPTURE_TIMES


@dataclass(frozen=True)
class Outcome:
    code: int
    out: str
    err: str


Call = Callable[..., Outcome]


@pytest.fixture
def call(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Call:
    def run(*arguments: str | Path) -> Outcome:
        monkeypatch.setattr(sys, "argv", ["detumble", *map(str, arguments)])
        with pytest.raises(SystemExit) as leaving:
            main()
        captured = capsys.readouterr()
        code = leaving.value.code
        return Outcome(code if isinstance(code, int) else int(code is not None), captured.out, captured.err)

    return run


def strict_json(text: str) -> dict[str, object]:
    """Read one JSON object and nothing else; NaN and Infinity are no JSON."""

    def refuse(word: str) -> float:
        raise AssertionError(word)

    value = json.loads(text, parse_constant=refuse)
    assert isinstance(value, dict)
    return value


SHORT = ("--set", "time.duration=20.0")


def test_run_prints_a_table_for_people(call: Call) -> None:
    outcome = call("run", "paper", "--law", "prrl", *SHORT)
    assert outcome.code == 0
    assert "PRRL-SMC, seed 0" in outcome.out
    assert any(line.startswith("capture ") and line.endswith(" s") for line in outcome.out.splitlines())


def test_run_prints_one_json_object_with_null_for_what_did_not_happen(call: Call) -> None:
    outcome = call("run", "paper", "--json", "--law", "pd", "--seed", "7", "--set", "time.duration=1.0")
    result = strict_json(outcome.out)
    assert outcome.code == 0
    assert result["capture_time_s"] is None
    assert (result["law"], result["seed"]) == ("pd", 7)
    assert "not captured within 1 s" in outcome.err


def test_run_takes_several_settings_in_either_style(call: Call) -> None:
    together = call("run", "paper", "--json", "--set", "chaser.mass=12", "time.duration=20.0")
    apart = call("run", "paper", "--set", "chaser.mass=12", "--set", "time.duration=20.0", "--json")
    assert strict_json(together.out) == strict_json(apart.out)
    assert (
        strict_json(together.out)["delta_v_m_s"]
        != strict_json(call("run", "paper", "--json", *SHORT).out)["delta_v_m_s"]
    )


def test_run_writes_flight_scenario_and_metrics(call: Call, tmp_path: Path) -> None:
    folder = tmp_path / "new" / "folder"
    outcome = call("run", "paper", "--out", folder, "--json", *SHORT)
    result = strict_json(outcome.out)
    assert outcome.code == 0
    assert sorted(path.name for path in folder.iterdir()) == [
        "flight.nc",
        "flight.png",
        "metrics.json",
        "scenario.toml",
        "written.json",
    ]
    stored = strict_json((folder / "metrics.json").read_text(encoding="utf-8"))
    assert stored["capture_time_s"] == result["capture_time_s"]
    again = detumble.simulate(folder / "scenario.toml")
    assert again.metrics.to_json()["capture_time_s"] == result["capture_time_s"]
    assert detumble.read_netcdf(folder / "flight.nc").metrics == again.metrics


def test_a_diverged_flight_is_reported_and_fails(call: Call, tmp_path: Path) -> None:
    runaway = ["--set", "actuators.force_limit=inf", "laws.pd.translation={kp = 1e6, kd = 1e5}", "time.duration=60.0"]
    outcome = call("run", "paper", "--law", "pd", "--json", *runaway, "--out", tmp_path)
    result = strict_json(outcome.out)
    assert outcome.code == 1
    assert isinstance(result["diverged_time_s"], float)
    assert "diverged at" in outcome.err
    assert (tmp_path / "flight.nc").exists()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["run", "papr"], "no such file, and no built-in scenario"),
        (
            ["run", "paper", "--law", "PRRL"],
            f"law 'PRRL': must be one of {', '.join(LAWS)}, or none for open loop; did",
        ),
        (["run", ""], '"": names neither a built-in scenario (paper, '),
        (["run", "paper", "--set", "chaser.mass=0"], "paper: 1 problem\n  chaser.mass  0 kg: must be at least 0.001"),
        (["run", "paper", "--set", "chaser.mass"], "must be field=value"),
        (["run", "paper", "--seed", "-1"], "seed -1: must be a whole number"),
        (["run", "paper", "--seed", "x"], "--seed"),
        (["run", "paper", "--backend", "gpu"], "no back end 'gpu'"),
        (["run", "paper", "--bogus"], "--bogus"),
        (["run"], "scenario"),
        (["rum"], "rum"),
        (["run", "paper", "--out", __file__], "cannot be used as an output folder: file exists"),
        (["run", "paper", "--out", f"{__file__}/x"], "cannot be used as an output folder: not a directory"),
        (["run", "paper", "--out", "x" * 300], "cannot be used as an output folder: file name too long"),
        (["run", "paper", "--out", ""], '--out "": names no folder; the current one is "."'),
        (["paper", "--out", " "], "names no folder"),
        (["paper", "--out", f"{__file__}/x"], "cannot be used as an output folder: not a directory"),
    ],
    ids=lambda value: " ".join(value)[:40] if isinstance(value, list) else "",
)
@pytest.mark.parametrize("style", [[], ["--json"]], ids=["table", "json"])
def test_a_mistake_ends_in_one_message_and_exit_code_2(
    call: Call, arguments: list[str], words: str, style: list[str]
) -> None:
    outcome = call(*arguments, *style)
    assert outcome.code == 2
    assert outcome.out == ""
    assert words in outcome.err
    assert "Traceback" not in outcome.err


def test_nothing_is_written_when_the_request_is_wrong(call: Call, tmp_path: Path) -> None:
    assert call("run", "paper", "--set", "chaser.mass=0", "--out", tmp_path / "x").code == 2
    assert call("run", "paper", "--law", "x", "--out", tmp_path / "x").code == 2
    assert call("run", "paper", "--seed", "-1", "--out", tmp_path / "x" / "y").code == 2
    assert not list(tmp_path.iterdir())


def test_scenarios_and_schema(call: Call) -> None:
    listed = call("scenarios")
    assert listed.code == 0
    assert listed.out.startswith("paper ")
    titles = strict_json(call("scenarios", "--json").out)["scenarios"]
    assert isinstance(titles, dict)
    assert {"paper", "workload_w"} <= set(titles)
    assert strict_json(call("schema").out) == detumble.Scenario.schema()


def test_version_and_help(call: Call) -> None:
    assert call("--version").out == f"detumble {detumble.__version__}\n"
    assert "paper" in call("--help").out


def test_paper_compares_the_five_laws(call: Call) -> None:
    outcome = call("paper", "--json")
    laws = strict_json(outcome.out)["laws"]
    assert outcome.code == 0
    assert isinstance(laws, dict)
    assert list(laws) == list(PUBLISHED_CAPTURE_TIMES)
    for name, law in laws.items():
        assert law["published_s"] == PUBLISHED_CAPTURE_TIMES[name]
        assert law["capture_time_s"] >= law["minimum_time_s"] > 0
        assert {"settling_time_s", "delta_v_m_s"} <= set(law)
    table = call("paper").out
    assert all(name in table for name in ("PD", "LQR", "SOSMC", "TSMC", "PRRL-SMC", "published s", "minimum s"))


def test_bench_gives_rates_of_every_back_end(call: Call, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("detumble.commands.bench.SECONDS", 0.001)
    monkeypatch.setattr("detumble.commands.bench.REPEATS", 1)
    result = strict_json(call("bench", "--json").out)
    rates = result["backends"]
    assert isinstance(rates, dict)
    assert "portable" in rates
    assert all(rate["steps_per_s"] > 1e4 for rate in rates.values())
    assert isinstance(result["all_cores_steps_per_s"], float)
    assert isinstance(result["fma_peak_share"], float)
    assert 0.0 < result["fma_peak_share"] < 1.0


def test_importing_detumble_loads_nothing_heavy() -> None:
    program = "import sys, detumble; print(*(m for m in ('numpy', 'pydantic', 'xarray', 'typer') if m in sys.modules))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == ""


def test_run_and_its_json_load_neither_xarray_nor_matplotlib() -> None:
    program = (
        "import sys, detumble.cli\nsys.argv = ['detumble', 'run', 'paper', '--json', '--set', 'time.duration=1.0']\n"
        "try: detumble.cli.main()\nexcept SystemExit as leaving: assert not leaving.code\n"
        "assert not {'xarray', 'matplotlib', 'scipy', 'rich'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)


def test_the_package_says_its_version_once() -> None:
    from importlib.metadata import version

    assert version("detumble") == detumble.__version__
    assert sorted(dir(detumble)) == sorted(detumble.__all__)
    with pytest.raises(AttributeError, match="no attribute 'lod'"):
        detumble.lod  # noqa: B018  # the look-up itself is the test
