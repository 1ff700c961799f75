"""Scenarios keep every bit on the way through a file, and their schema says what the check says."""

from __future__ import annotations

import json
import math
import random
import re
import tomllib
from pathlib import Path

import pytest

from detumble.errors import RequestError
from detumble.scenario import LAWS, Scenario, built_in, from_toml, load, with_settings
from detumble.scenario.wording import number

DATA = Path(__file__).parents[1] / "data"
FILES = [*built_in(), *sorted((DATA / "scenarios").glob("*.toml"))]


@pytest.mark.parametrize("source", FILES, ids=lambda source: Path(source).stem)
def test_saving_and_loading_gives_an_equal_scenario(source: str | Path, tmp_path: Path) -> None:
    scenario = load(source)
    scenario.save(tmp_path / "again.toml")
    again = load(tmp_path / "again.toml")
    assert again == scenario
    assert again.to_toml() == scenario.to_toml()
    assert [path.name for path in tmp_path.iterdir()] == ["again.toml"]


@pytest.mark.parametrize("law", LAWS)
def test_how_gains_were_found_survives_a_file(law: str, paper: Scenario) -> None:
    raw = paper.to_dict()
    raw["laws"][law]["tuned"] = {
        "objective": "capture", "statistic": "mean", "success": 1.0, "required": 0.95, "until": "settled", "horizon_s": 90.0,
        "starts": 8, "seed": 0, "optimiser_seed": 0, "evaluations": 10, "version": "0.1.0",
    }  # fmt: skip
    scenario = Scenario.model_validate(raw)
    assert from_toml(scenario.to_toml()) == scenario


def test_awkward_values_survive_a_file(paper: Scenario) -> None:
    paper.title = 'quotes " \\ and ünïcödé, "\\n"'
    paper.description = 'two\nlines, \t quotes """ and \\\n'
    paper.chaser.mass = 0.1 + 0.2
    paper.chaser.position = (1e-300, -1e-9 / 3, math.pi * 1e5)
    paper.actuators.force_limit = (math.inf, 0.1, 1e-6 / 7)
    assert from_toml(paper.to_toml()) == paper


def test_numbers_are_written_exactly_and_as_people_write_them() -> None:
    rng = random.Random(1)
    for _ in range(2000):
        value = rng.uniform(-1, 1) * 10.0 ** rng.randint(-300, 300)
        assert tomllib.loads(f"x = {number(value)}")["x"] == value
    shown = {
        700e3: "700e3",
        6871e3: "6.871e6",
        3.986004418e14: "3.986004418e14",
        1e-4: "1e-4",
        0.05: "0.05",
        9.0: "9.0",
    }
    assert {value: number(value) for value in shown} == shown


def test_a_saved_file_tells_units(paper: Scenario) -> None:
    text = paper.to_toml()
    assert re.search(r"^mass = 9\.0 +# kg$", text, re.M)
    assert re.search(r"^altitude = 700e3 +# m$", text, re.M)


def test_a_file_is_written_whole_or_not_at_all(paper: Scenario, tmp_path: Path) -> None:
    with pytest.raises(RequestError, match="cannot be written"):
        paper.save(tmp_path / "nowhere" / "x.toml")
    (tmp_path / "taken").mkdir()
    with pytest.raises(RequestError, match="cannot be written"):
        paper.save(tmp_path / "taken")
    assert [path.name for path in tmp_path.iterdir()] == ["taken"]


def test_settings_change_a_copy(paper: Scenario) -> None:
    changed = with_settings(
        paper,
        [
            "chaser.mass=12",
            "laws.prrl.translation.gain=[1, 2, 3]",
            "orbit.radius=7e6",
            "belief.stack=true",
            "title=a b",
        ],
    )
    assert paper == load("paper")
    assert changed.chaser.mass == 12.0
    assert changed.laws.prrl is not None
    assert changed.laws.prrl.translation.gain == (1.0, 2.0, 3.0)
    assert (changed.orbit.altitude, changed.orbit.radius) == (None, 7e6)
    assert (changed.belief.stack, changed.title) == ("true", "a b")


def test_built_in_names_come_first_and_paths_reach_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert built_in()[0] == "paper"
    monkeypatch.chdir(tmp_path)
    Path("paper").write_text(load("workload_w").to_toml(), encoding="utf-8")
    assert load("paper").title != load("./paper").title


def test_the_papers_file_says_beside_each_unpublished_value_that_it_is_ours() -> None:
    text = (Path(load.__code__.co_filename).parent / "library" / "paper.toml").read_text(encoding="utf-8")
    for key in ("position", "attitude", "tumble_rate", "control_period"):
        lines = [line for line in text.splitlines() if line.startswith(f"{key} =")]
        assert lines
        assert all("ours" in line for line in lines), key
    gains = text.split("[laws.")[1:]
    assert len(gains) == len(LAWS)
    assert all("ours" in law for law in gains)


def test_the_schema_has_unit_range_and_meaning_of_every_quantity() -> None:
    schema = Scenario.schema()
    json.dumps(schema)
    assert schema["required"] == ["title", "time", "orbit", "chaser", "debris"]
    mass = schema["$defs"]["Chaser"]["properties"]["mass"]
    assert mass["unit"] == "kg"
    assert mass["minimum"] == 1e-3
    words = '"type": "null"'
    assert words not in json.dumps(schema)
    for name, section in schema["$defs"].items():
        assert section["additionalProperties"] is False
        for field, properties in section["properties"].items():
            told = "description" in properties or "$ref" in properties or "anyOf" in properties
            assert told or "$ref" in json.dumps(properties), f"{name}.{field}"
