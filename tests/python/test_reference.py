"""The reference lists what there is: tables, options, keys, attributes, events, causes, files."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
import typer

import detumble
from detumble.campaigns.statistics.running import EXTENTS, TIMES
from detumble.commands.app import app
from detumble.failures import CAUSES, THRESHOLDS
from detumble.metrics import METRICS
from detumble.scenario import LAWS, with_settings
from detumble.variables import VARIABLES
from pages import call
from reference_tables import REFERENCE, TABLES, with_tables

METRIC_KEYS = {metric.key for metric in METRICS}
MANY_FAIL = ["paper_dispersed", "--law", "pd", "--runs", "60"]


def part_of_reference(heading: str) -> str:
    """Give the part of the reference from a heading to the next."""
    page = REFERENCE.read_text(encoding="utf-8")
    found = re.search(rf"^##+ {re.escape(heading)}$.*?(?=^##|\Z)", page, re.DOTALL | re.MULTILINE)
    assert found, heading
    return found[0]


def keys(command: str) -> set[str]:
    """Read the keys that the reference lists for a command."""
    part = part_of_reference(f"`detumble {command}`")
    return set(re.findall(r"^\| `([\w.<>\[\]]+)` \|", part, re.MULTILINE))


def flattened(value: Any, path: str = "") -> set[str]:
    """Give the keys of an object as the reference writes them: what has many names as `<law>`, `<backend>`, `<quantity>`."""
    if isinstance(value, list):
        return set().union({path}, *(flattened(item, f"{path}[]") for item in value if isinstance(item, dict)))
    if not isinstance(value, dict):
        return {path}
    found: set[str] = set()
    for name, inner in value.items():
        known = {**dict.fromkeys(LAWS, "<law>"), "portable": "<backend>", "avx2": "<backend>", "avx512": "<backend>"}
        known |= dict.fromkeys(CAUSES, "<cause>")
        known |= dict.fromkeys(detumble.scenarios(), "<name>") if path == "scenarios" else {}
        known |= dict.fromkeys((*TIMES, *EXTENTS), "<quantity>") if isinstance(inner, dict) else {}
        shown = re.sub(r"^p\d\d", "p<percent>", known.get(name, name))
        found |= flattened(inner, f"{path}.{shown}" if path else shown)
    return found


def test_tables_of_the_reference_match_the_code() -> None:
    page = REFERENCE.read_text(encoding="utf-8")
    assert set(re.findall(r"<!-- table: (\w+) -->", page)) == set(TABLES)
    assert with_tables(page) == page, "python tests/reference_tables.py writes them anew"


def test_the_reference_lists_every_command_and_option() -> None:
    for name, command in typer.main.get_command(app).commands.items():
        part = part_of_reference(f"`detumble {name}`")
        for option in (option for parameter in command.params for option in parameter.opts if option.startswith("--")):
            assert option in part, (name, option)


@pytest.mark.parametrize("command", ["run", "paper", "campaign", "scenarios", "bench"])
def test_the_reference_lists_every_key_of_the_json(
    command: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("detumble.commands.bench.SECONDS", 1e-3)
    more = {"run": ["paper"], "campaign": [*MANY_FAIL, "--out", str(tmp_path)]}.get(command, [])
    code, printed = call([command, *more, "--json"])
    assert code == 0
    object_ = json.loads(printed[printed.index("{") :])
    found = {key for key in flattened(object_) if not key.endswith("[]")}
    leaves = {key.rsplit(".", 1)[-1] for key in found}
    if command in ("run", "paper"):
        assert leaves >= METRIC_KEYS
        found = {key for key in found if key.rsplit(".", 1)[-1] not in METRIC_KEYS - {"capture_time_s"}}
    listed = keys(command)
    nested = {key for key in found if any(other.startswith((key + "[", key + ".")) for other in found)}
    assert found - nested == listed - nested


def test_the_reference_lists_attributes_and_events() -> None:
    short = with_settings(detumble.load("paper"), ["time.duration=60.0"])
    flight = detumble.simulate(short)
    attributes = re.findall(r"^\| (`.*?`) \|", part_of_reference("Time series"), re.MULTILINE)
    named = {name for row in attributes for name in re.findall(r"`(\w+)`", row)}
    assert named - {variable.name for variable in VARIABLES} == set(flight.data.attrs)

    part = part_of_reference("Events and warnings")
    events = re.findall(r"^\| `(\w+)` \|", part, re.MULTILINE)
    assert events == ["captured", "settled", "no_gains", "diverged"]
    assert [event.name for event in flight.events] == ["captured", "settled"]
    details = flight.events[0].details
    for name in (*details, *details["before"], *details["after"]):
        assert f"`{name}`" in part, name


def test_the_reference_lists_every_cause_of_failure_and_every_attribute_of_the_runs(tmp_path: Path) -> None:
    part = part_of_reference("Runs of a campaign")
    told = re.findall(r"^\| `([^`]*)`", part, re.MULTILINE)
    combined = {cause for cause in CAUSES if set(re.split(r": | \+ ", cause)) & set(THRESHOLDS)}
    assert set(CAUSES) - combined < set(told)
    assert all(f"`{name}`" in part for name in THRESHOLDS)
    runs = detumble.campaign("paper", runs=10, out=tmp_path).runs
    assert all(f"`{name}`" in part for name in runs.to_xarray().attrs)


def test_the_reference_lists_every_file_written(tmp_path: Path) -> None:
    page = REFERENCE.read_text(encoding="utf-8")
    uncertain = 'dispersions=[{field = "chaser.mass", distribution = "normal", sigma = 0.1}]'
    drawn = ["campaign", "paper", "--runs", "20", "--figures", "--set", "time.duration=30.0", uncertain]
    for command in (["run", "paper"], ["paper"], drawn):
        folder = tmp_path / command[0]
        code, printed = call([*command, "--out", str(folder)])
        assert code == 0, printed
        for file in (file for file in folder.rglob("*") if file.is_file()):
            named = {file.name, file.stem, str(file.relative_to(folder))}
            assert any(f"`{name}`" in page for name in named), file.name
