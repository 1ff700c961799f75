"""`detumble campaign` as a person and a program meet it, `detumble run --replay`, and campaigns that stop when sure enough."""

from __future__ import annotations

import json
import os
import pty
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from scipy.stats import binomtest

import detumble
from detumble.campaigns.columns import SCALARS
from detumble.campaigns.result import read_campaign
from detumble.campaigns.store.shard import digest
from detumble.cli import main
from detumble.errors import RequestError
from detumble.scenario import LAWS
from uncertain import flown, rows_digest, uncertain

RUNS = 500
Call = Callable[..., "Outcome"]


@dataclass(frozen=True)
class Outcome:
    code: int
    out: str
    err: str

    @property
    def json(self) -> dict[str, Any]:
        """The one JSON object printed; NaN and Infinity are no JSON."""
        value = json.loads(self.out, parse_constant=pytest.fail)
        assert isinstance(value, dict)
        return value


@pytest.fixture
def call(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Call:
    def run(*arguments: object) -> Outcome:
        monkeypatch.setattr(sys, "argv", ["detumble", *map(str, arguments)])
        with pytest.raises(SystemExit) as leaving:
            main()
        captured = capsys.readouterr()
        code = leaving.value.code
        return Outcome(code if isinstance(code, int) else int(code is not None), captured.out, captured.err)

    return run


@pytest.fixture(scope="module")
def scenario(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("scenario") / "uncertain.toml"
    uncertain().save(path)
    return path


# --- what is printed ---------------------------------------------------------------------------------------------------


def test_one_json_object_holds_everything_and_nothing_else_is_printed(
    call: Call, scenario: Path, tmp_path: Path
) -> None:
    outcome = call("campaign", scenario, "--law", "pd", "--runs", RUNS, "--seed", 3, "--out", tmp_path, "--json")
    assert (outcome.code, outcome.err) == (0, "")
    told = outcome.json
    rows = read_campaign(tmp_path).runs.to_polars()
    assert (told["law"], told["seed"], told["runs"], told["flown"]) == ("pd", 3, RUNS, RUNS)
    assert told["folder"] == str(tmp_path)
    assert told["captured"] == rows["capture_time_s"].count()
    assert told["success"] == rows["success"].mean()
    exact = binomtest(int(rows["success"].sum()), RUNS).proportion_ci(0.95, "exact")
    assert told["success_ci"] == pytest.approx([exact.low, exact.high], rel=1e-9)
    times = np.sort(rows["capture_time_s"].drop_nulls().to_numpy())
    for key, share in (("p05", 0.05), ("p50", 0.50), ("p95", 0.95)):
        assert told["capture_time_s"][key] == pytest.approx(np.quantile(times, share, method="inverted_cdf"), abs=1e-9)
        low, high = told["capture_time_s"][f"{key}_ci"]
        assert low <= told["capture_time_s"][key] <= high
    assert told["failures"] == dict(rows["failure"].drop_nulls().value_counts().sort("count", descending=True).rows())
    assert sum(told["failures"].values()) == RUNS - rows["success"].sum()
    ticks = (rows["end_time_s"] * 10.0 + 1.0).sum()
    assert told["steps_per_s"] * told["wall_s"] == pytest.approx(ticks - RUNS)
    assert told["rate_runs_per_s"] * told["wall_s"] == pytest.approx(RUNS)
    assert 0.5 < told["lane_use"] <= 1.0
    assert told["capture_time_s"]["count"] == len(times)
    for metric in SCALARS:
        if metric.unit != "s" and metric.kind != "whole":
            values = rows[metric.key].drop_nulls()
            assert told[metric.key]["count"] == len(values)
            if metric.key.startswith("capture_"):
                assert told[metric.key]["max"] == pytest.approx(values.max())
    stored = json.loads((tmp_path / "summary.json").read_text("utf-8"))
    assert stored == {key: value for key, value in told.items() if key != "files"}


def test_a_table_for_people_tells_the_same(call: Call, scenario: Path, tmp_path: Path) -> None:
    outcome = call("campaign", scenario, "--law", "pd", "--runs", RUNS, "--seed", 3, "--out", tmp_path)
    success = read_campaign(tmp_path).statistics.success
    assert (outcome.code, outcome.err) == (0, "")
    lines = outcome.out.splitlines()
    assert lines[1] == f"PD, seed 3, {RUNS} runs"
    assert (
        lines[3]
        == f"success  {100 * success.share:.2f} %   95 % interval {100 * success.low:.2f} to {100 * success.high:.2f} %"
    )
    assert any(line.startswith("diverged ") for line in lines)
    assert any(line.startswith("capture ") and line.endswith(" s") for line in lines)
    assert lines[-1].startswith(f"{RUNS} runs flown in ")


def test_a_campaign_in_which_nothing_happens_is_reported_too(call: Call, tmp_path: Path) -> None:
    far = ("--set", "chaser.position=[0,900,0]", "time.duration=1.0")
    outcome = call("campaign", "paper", "--runs", 3, "--out", tmp_path / "a", "--json", *far)
    assert outcome.json["capture_time_s"]["p50"] is None
    assert outcome.json["success"] == 0.0
    assert outcome.json["failures"] == {"never captured: distance + angle": 3}
    assert (
        "never captured: distance + angle" in call("campaign", "paper", "--runs", 3, "--out", tmp_path / "b", *far).out
    )


def test_settings_change_what_is_flown(call: Call, scenario: Path, tmp_path: Path) -> None:
    command = (
        "campaign",
        scenario,
        "--runs",
        5,
        "--out",
        tmp_path,
        "--json",
        "--set",
        "chaser.mass=12",
        "dispersions=[]",
    )
    assert call(*command).code == 0
    assert read_campaign(tmp_path).recipe.parsed.chaser.mass == 12.0
    assert "chaser.mass" not in read_campaign(tmp_path).runs.to_polars().columns


def test_a_terminal_sees_progress_and_a_program_still_gets_its_json(scenario: Path, tmp_path: Path) -> None:
    ours, theirs = pty.openpty()
    asked = ["campaign", str(scenario), "--law", "pd", "--runs", "5000", "--out", str(tmp_path), "--json"]
    done = subprocess.run(
        [sys.executable, "-m", "detumble.cli", *asked], stdout=subprocess.PIPE, stderr=theirs, text=True
    )
    os.close(theirs)
    seen = os.read(ours, 10**6).decode()
    os.close(ours)
    assert done.returncode == 0
    assert json.loads(done.stdout)["runs"] == 5000
    assert "/5000" in seen
    assert " runs/s" in seen


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("--runs", "0"), "runs 0: must be a whole number from 1 to "),
        (("--seed", "-1"), "seed -1: must be a whole number from 0 to "),
        (("--threads", "0"), "threads 0: must be a whole number from 1 to "),
        (("--local-cluster", "0"), "local_cluster 0: must be a whole number from 1 to "),
        (("--until-ci", "0.5"), "until_ci 0.5: must lie between 0 and 0.5"),
        (("--until-ci", "nan"), "until_ci nan: must lie between 0 and 0.5"),
        (("--threads", "1", "--local-cluster", "1"), "at most one of them says who flies"),
        (("--backend", "avx1024"), "no back end 'avx1024' on this machine"),
        (("--law", "prl"), f"law 'prl': must be one of {', '.join(LAWS)}, or none for open loop"),
        (("--set", "chaser.mas=3"), "chaser.mas  unknown key; did you mean mass"),
    ],
)
def test_what_cannot_be_flown_is_one_message_and_leaves_no_folder(
    call: Call, scenario: Path, tmp_path: Path, arguments: tuple[str, ...], told: str
) -> None:
    outcome = call("campaign", scenario, "--out", tmp_path / "new" / "out", *arguments)
    assert (outcome.code, outcome.out) == (2, "")
    assert told in outcome.err
    assert "Traceback" not in outcome.err
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize("shard", [0, 10**7, 1.5, True])
def test_a_shard_is_of_a_whole_number_of_runs(tmp_path: Path, shard: Any) -> None:
    with pytest.raises(RequestError, match=f"shard {shard!r}: must be a whole number from 1 to 1000000"):
        flown(tmp_path / "out", shard=shard)


def test_a_folder_that_holds_a_campaign_is_continued_only_on_request(
    call: Call, scenario: Path, tmp_path: Path
) -> None:
    command = ("campaign", scenario, "--runs", 20, "--out", tmp_path, "--json")
    assert call(*command).code == 0
    again = call(*command)
    assert (again.code, again.out) == (2, "")
    assert again.err == f"{tmp_path}: holds this campaign already, of 20 runs; --resume continues it\n"
    shard = tmp_path / "shards" / "shard-000000.parquet"
    shard.write_bytes(shard.read_bytes()[:99])
    resumed = call(*command, "--resume")
    assert (resumed.code, resumed.json["flown"]) == (0, 20)
    assert resumed.err == f"{shard}: damaged: cut off, or no Parquet file; it is flown again\n"
    complete = call(*command, "--resume")
    assert (complete.json["flown"], complete.json["lane_use"], complete.err) == (0, None, "")


def test_without_a_folder_the_runs_live_as_long_as_the_process() -> None:
    runs = detumble.campaign(uncertain(), "pd", 50, 3, shard=20).runs
    data = detumble.campaign(uncertain(), "pd", 50, 3).runs.to_xarray()
    assert digest(runs.to_polars()) == digest(detumble.campaign(uncertain(), "pd", 50, 3).runs.to_polars())
    assert data["delta_v_m_s"].values.tolist() == runs.to_polars()["delta_v_m_s"].to_list()
    program = "import detumble; print(detumble.campaign('paper', runs=1).folder)"
    done = subprocess.run([sys.executable, "-X", "dev", "-c", program], capture_output=True, text=True)
    assert done.stderr == ""
    assert not Path(done.stdout.strip()).exists()


# --- flown again -------------------------------------------------------------------------------------------------------


def test_a_run_is_flown_again_from_the_command_line(call: Call, scenario: Path, tmp_path: Path) -> None:
    result = flown(tmp_path / "a:b", runs=60)
    table = result.runs.to_polars()
    for index in (0, 17, 59):
        row = table.row(index, named=True)
        outcome = call("run", "--replay", f"{result.folder}:{index}", "--json")
        told = outcome.json
        assert outcome.code == (1 if row["failure"] == "diverged" else 0)
        assert {metric.key: told[metric.key] for metric in SCALARS} == {m.key: row[m.key] for m in SCALARS}
        assert (told["law"], told["seed"], told["index"]) == ("pd", 3, index)


@pytest.mark.parametrize("asked", ["{folder}:60", "{folder}:-1", "{folder}:x", "{folder}", ":3", "nowhere:3"])
def test_a_run_that_is_not_there_is_one_message(call: Call, tmp_path: Path, asked: str) -> None:
    flown(tmp_path, runs=60)
    outcome = call("run", "--replay", asked.format(folder=tmp_path))
    assert (outcome.code, outcome.out) == (2, "")
    assert outcome.err.count("\n") == 1


def test_a_replay_takes_no_scenario_law_seed_or_settings(call: Call, tmp_path: Path) -> None:
    flown(tmp_path, runs=5)
    for more in (("paper",), ("--set", "chaser.mass=12")):
        assert call("run", *more, "--replay", f"{tmp_path}:1").code == 2
    assert call("run").code == 2


# --- sure enough -------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def thousand(tmp_path_factory: pytest.TempPathFactory) -> pl.DataFrame:
    return flown(tmp_path_factory.mktemp("thousand"), runs=1000).runs.to_polars()


@pytest.mark.parametrize(("half_width", "how"), [(0.05, {}), (0.05, {"threads": 1}), (0.08, {"shard": 30})], ids=str)
def test_it_stops_at_the_first_shard_after_which_the_interval_is_narrow_enough(
    thousand: pl.DataFrame, tmp_path: Path, half_width: float, how: dict[str, Any]
) -> None:
    shard = how.get("shard", 100)
    successes = np.cumsum(thousand["success"])[shard - 1 :: shard]
    widths = [binomtest(int(k), (n + 1) * shard).proportion_ci(0.95, "exact") for n, k in enumerate(successes)]
    enough = shard * (1 + next(n for n, ci in enumerate(widths) if 0.5 * (ci.high - ci.low) <= half_width))
    assert shard < enough < 1000
    stopped = flown(tmp_path / "stopped", runs=1000, until_ci=half_width, **how)
    assert stopped.statistics.runs == len(stopped.runs) == enough
    assert stopped.statistics.success.half_width <= half_width
    assert rows_digest(stopped) == digest(thousand.head(enough))
    assert stopped.effort.flown == enough
    again = flown(tmp_path / "stopped", runs=1000, until_ci=half_width, resume=True, **how)
    assert (again.statistics.runs, again.effort.flown) == (enough, 0)
    onwards = flown(tmp_path / "stopped", runs=1000, resume=True, **how)
    assert onwards.effort.flown == 1000 - enough
    assert rows_digest(onwards) == digest(thousand)


def test_it_flies_all_runs_if_they_are_too_few(tmp_path: Path) -> None:
    assert flown(tmp_path, runs=150, until_ci=1e-3).statistics.runs == 150
