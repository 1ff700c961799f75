"""`detumble tune`: what it prints and writes, how it goes on, and what it refuses."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path
from typing import Any

import pytest

import detumble
from pages import call

SMALL = ["--budget", "24", "--starts", "8", "--until", "captured", "--horizon", "40"]


def tune(*more: str) -> tuple[int, str]:
    return call(["tune", "paper_dispersed", *SMALL, *more])


def test_a_search_is_told_and_written(tmp_path: Path) -> None:
    code, printed = tune("--law", "tsmc", "--required", "0.5", "--held-out", "32", "--out", str(tmp_path))
    assert code == 0, printed
    for text in (
        "TSMC, printed: mean time to capture over 8 starts of seed 0",
        "translation.exponent",
        "held out, 32 runs",
    ):
        assert text in printed
    names = {file.name for file in tmp_path.iterdir()}
    assert names == {"scenario.toml", "tuning.json", "record.jsonl", "convergence.png", ".lock", "written.json"}
    numbers = json.loads((tmp_path / "tuning.json").read_text())
    scenario = detumble.load(tmp_path / "scenario.toml")
    assert scenario.laws.tsmc.translation.slope == numbers["tuned"]["gains"]["translation.slope"]
    assert scenario.laws.tsmc.tuned.time_s == numbers["tuned"]["cost"]
    assert numbers["history"][-1]["best"] == numbers["tuned"]["cost"]
    assert numbers["held_out"]["runs"] == 32


def test_json_is_one_object_and_the_same_after_a_continuation(tmp_path: Path) -> None:
    arguments = ["--law", "pd", "--json", "--held-out", "0"]
    code, whole = tune(*arguments)
    assert code == 0
    out = str(tmp_path / "out")
    assert tune(*arguments[:-3], "--budget", "10", "--out", out)[0] == 0
    code, printed = tune(*arguments, "--resume", "--out", out)
    assert code == 0, printed
    first, second = json.loads(whole[whole.index("{") : whole.rindex("}") + 1]), printed
    second = json.loads(second[second.index("{") : second.rindex("}") + 1])
    assert first["held_out"] is None
    assert len(second["files"]) == 4
    for key in ("seconds", "files"):
        del first[key], second[key]
    assert first == second


def test_a_front_is_told_and_written(tmp_path: Path) -> None:
    code, printed = tune("--objective", "pareto", "--budget", "60", "--required", "0.5", "--out", str(tmp_path))
    assert code == 0, printed
    assert "time to capture against Δv to capture" in printed
    rows = list(csv.DictReader((tmp_path / "front.csv").read_text().splitlines()))
    numbers = json.loads((tmp_path / "tuning.json").read_text())
    assert [float(row["time_s"]) for row in rows] == [point["time_s"] for point in numbers["front"]]
    assert float(rows[0]["alpha"]) == detumble.load(tmp_path / "point-1.toml").laws.prrl.alpha
    assert (tmp_path / "front.png").stat().st_size > 10_000


def keys(value: Any, path: str = "") -> set[str]:
    """Give the keys of an object as the reference writes them."""
    if isinstance(value, dict):
        names = {name: "<gain>" if path.endswith("gains") else name for name in value}
        return {key for name in value for key in keys(value[name], f"{path}.{names[name]}".removeprefix("."))}
    return {path}


def test_the_reference_lists_every_key_of_the_json() -> None:
    page = (Path(__file__).parents[2] / "docs" / "reference.md").read_text(encoding="utf-8")
    found = re.search(r"^### `detumble tune`$.*?(?=^##)", page, re.DOTALL | re.MULTILINE)
    assert found
    code, printed = tune("--law", "pd", "--json", "--held-out", "4", "--budget", "2")
    assert code == 0
    listed = set(re.findall(r"^\| `([\w.<>]+)` \|", found[0], re.MULTILINE))
    assert keys(json.loads(printed[: printed.rindex("}") + 1])) == listed


def test_gains_and_ranges_are_listed() -> None:
    code, printed = tune("--list", "--law", "lqr", "--stack")
    assert code == 0
    assert [line.split()[0] for line in printed.splitlines()[2:]] == [
        f"{stack}{channel}.{weight}"
        for stack in ("", "stack.")
        for channel in ("translation", "rotation")
        for weight in ("q_error", "q_rate")
    ]
    listed = json.loads(tune("--list", "--law", "lqr", "--json")[1])["gains"]
    assert listed[0]["low"] < listed[0]["own"] < listed[0]["high"]


def test_a_requirement_that_no_candidate_meets_is_told() -> None:
    code, printed = tune("--law", "pd", "--horizon", "2", "--held-out", "0")
    assert code == 0
    assert "no candidate succeeds in 95 % of the starts; the best one does in 0.0 %" in printed


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["--resume"], "--resume: needs --out"),
        (["--statistic", "median"], "--statistic median: must be mean, or a percentile such as p95"),
        (["--form", "mine"], "form 'mine': must be printed or corrected"),
        (["--objective", "fuel"], "objective 'fuel': must be one of"),
        (["--law", "none"], "law 'none': must be one of"),
        (["--fix", "alpha=x"], "--fix alpha=x: must be GAIN or GAIN=NUMBER"),
        (["--fix", "alpha=1.5"], "laws.prrl.alpha"),
        (["--required", "2"], "required 2: a share"),
        (["--seed", "-1"], "seed -1"),
        (["--held-out", "-5"], "held_out -5"),
    ],
)
def test_what_makes_no_sense_is_refused_in_words(arguments: list[str], text: str) -> None:
    code, printed = tune(*arguments)
    assert code == 2
    assert text in printed
    assert "Traceback" not in printed


def test_a_wrong_number_of_held_out_runs_is_refused_before_the_search(tmp_path: Path) -> None:
    assert tune("--held-out", "-5", "--out", str(tmp_path / "out"))[0] == 2
    assert not (tmp_path / "out").exists()


def test_a_held_gain_keeps_its_value_or_takes_one() -> None:
    code, printed = tune("--fix", "alpha", "--fix", "rotation.layer=0.05", "--json", "--held-out", "0", "--budget", "2")
    assert code == 0
    gains = json.loads(printed[: printed.rindex("}") + 1])["tuned"]["gains"]
    assert set(gains) == {f"translation.{name}" for name in ("slope", "gain", "layer")} | {
        "rotation.slope",
        "rotation.gain",
    }
