"""Scenarios in and out of files, the built-in ones, and settings typed on a command line."""

from __future__ import annotations

import contextlib
import copy
import os
import re
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any

from detumble.checking import instance, met, texts
from detumble.errors import Fault, RequestError, ScenarioError
from detumble.scenario.faults import validated
from detumble.scenario.model import Scenario
from detumble.scenario.reflection import is_text, section_at
from detumble.text import did_you_mean
from detumble.writing import named_file, read_bytes, reason, write_text

if TYPE_CHECKING:
    from collections.abc import Iterable

MOST_BYTES = 2**24
"""Of a scenario file: they take a few thousand."""
MOST_DEPTH = 20
"""Of tables within tables."""
LIBRARY = Path(__file__).parent / "library"


def built_in() -> list[str]:
    """Name the scenarios that come with detumble, the paper's first."""
    return sorted((path.stem for path in LIBRARY.glob("*.toml")), key=lambda name: (name != "paper", name))


def load(source: str | os.PathLike[str]) -> Scenario:
    """Read a scenario.

    Args:
        source: the name of a built-in scenario, or the path of a TOML file. A built-in name wins over a file of that name
            without ending; `./name` reaches the file.

    Returns:
        The scenario, checked and editable.

    Raises:
        ScenarioError: the file cannot be read, or is no scenario; every fault is listed.
    """
    try:
        name = os.fspath(source)
    except TypeError:
        raise ScenarioError(met(source), problem="is neither a scenario nor the name of one nor a path") from None
    if not isinstance(name, str):
        raise ScenarioError(met(name), problem="is no text; a path must be text")
    if isinstance(source, str) and name in built_in():
        return from_toml((LIBRARY / f"{name}.toml").read_text(encoding="utf-8"), name)
    return from_toml(_read(name), name)


def given(scenario: Scenario | str | os.PathLike[str]) -> Scenario:
    """Give a scenario to work with: a checked copy, which later edits of the caller's do not reach.

    Args:
        scenario: a scenario, or what `load` takes.

    Raises:
        ScenarioError: it cannot be read, or contradicts itself.
    """
    if not isinstance(scenario, Scenario):
        return load(scenario)
    checked = validated(scenario.to_dict(), scenario.title)
    # a list can be appended to past every check: its items are taken from the checked copy
    own = scenario.model_copy(deep=True)
    own.dispersions, own.correlations = checked.dispersions, checked.correlations
    if own.laws.none is not None and checked.laws.none is not None:
        own.laws.none.segments = checked.laws.none.segments
    return own


def _read(name: str) -> str:
    known = ", ".join(built_in())
    if not name.strip():
        raise ScenarioError(f'"{name}"', problem=f"names neither a built-in scenario ({known}) nor a file")
    try:
        return read_bytes(Path(name), MOST_BYTES).decode("utf-8-sig")
    except UnicodeDecodeError as error:
        problem = f"not UTF-8 text (byte 0x{error.object[error.start]:02x} at position {error.start})"
    except FileNotFoundError:
        problem = f"no such file, and no built-in scenario ({known}){did_you_mean(Path(name).stem, built_in())}"
    except ValueError as error:
        problem = str(error)
    except OSError as error:
        problem = f"cannot be read: {reason(error)}"
    raise ScenarioError(name, problem=problem) from None


def from_toml(text: str, source: str = "scenario") -> Scenario:
    """Read a scenario from the text of a file.

    Args:
        text: TOML.
        source: what to call it in messages.

    Returns:
        The scenario.

    Raises:
        ScenarioError: as for `load`.
    """
    tables = _tables(instance("text", text, str, "the text of a scenario file"), source)
    if _deep(tables):
        raise ScenarioError(source, problem=f"tables nest more than {MOST_DEPTH} deep; a scenario's never do")
    return validated(tables, source)


def _deep(tables: Any) -> bool:
    level = [tables]
    for _ in range(MOST_DEPTH):
        level = [
            element
            for value in level
            if isinstance(value, dict | list)
            for element in (value.values() if isinstance(value, dict) else value)
        ]
    return bool(level)


def _tables(text: str, source: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        problem = str(error).split("\n")[0]
        where = re.search(r" \(at line (\d+), column (\d+)\)$", problem)
        if where:
            problem = f"line {where[1]}, column {where[2]}: {problem[: where.start()]}"
    except RecursionError:
        problem = f"nests more than {MOST_DEPTH} deep"
    except ValueError as error:
        problem = str(error)
    raise ScenarioError(source, problem=f"not valid TOML: {problem}") from None


def save(scenario: Scenario, path: str | os.PathLike[str]) -> None:
    """Write a scenario as TOML, whole or not at all.

    Args:
        scenario: the scenario.
        path: the file to write; an older one is replaced.

    Raises:
        ScenarioError: the scenario contradicts itself.
        RequestError: the file cannot be written.
    """
    scenario = given(scenario)
    write_text(named_file(path), scenario.to_toml())


def with_settings(scenario: Scenario, settings: Iterable[str], source: str = "") -> Scenario:
    """Change fields as typed on a command line.

    Args:
        scenario: the scenario to begin with; it is not changed.
        settings: `field=value` each, the field dotted, the value as in TOML; a bare word counts as text.
        source: what to call the scenario in messages.

    Returns:
        A changed scenario.

    Raises:
        RequestError: a setting has no `=`.
        ScenarioError: every fault of the changed scenario.
    """
    source = source or scenario.title
    raw, faults = copy.deepcopy(scenario.to_dict()), []
    for setting in texts("settings", settings):
        path, equals, text = setting.partition("=")
        if not equals or not path.strip():
            raise RequestError(f"--set {setting}: must be field=value, such as chaser.mass=12")
        fault = _set(raw, path.strip(), text.strip())
        faults += [fault] if fault else []
    if faults:
        raise ScenarioError(source, faults)
    return validated(raw, source)


def _value(text: str) -> Any:
    """Read a value as TOML does, also with the bare points that TOML refuses (.5, 1.); what is no value is text."""
    pointed = re.sub(r"(?<=\d)\.(?![\d])", ".0", re.sub(r"(?<![\w.])\.(?=\d)", "0.", text))
    for candidate in (text, pointed):
        with contextlib.suppress(ValueError, RecursionError):
            read = tomllib.loads(f"value = {candidate}")
            return read["value"] if len(read) == 1 else text
    return text


def _set(raw: dict[str, Any], path: str, text: str) -> Fault | None:
    names = path.split(".")
    if len(names) > MOST_DEPTH:
        return Fault(".".join([*names[:3], "..."]), f"has {len(names)} parts; no field has more than {MOST_DEPTH}")
    table = raw
    for depth, name in enumerate(names[:-1]):
        section = section_at(Scenario, tuple(names[: depth + 1]))
        if section is None:
            owner = section_at(Scenario, tuple(names[:depth]))
            known = owner.model_fields if owner else ()
            problem = "is not a table" if name in known else f"unknown key{did_you_mean(name, known)}"
            return Fault(".".join(names[: depth + 1]), problem)
        inner = table.setdefault(name, {})
        if not isinstance(inner, dict):
            return Fault(".".join(names[: depth + 1]), "cannot be set in parts")
        table = inner
    owner = section_at(Scenario, tuple(names[:-1]))
    for rival in owner.rivals(names[-1]) if owner else ():
        table.pop(rival, None)
    value = _value(text)
    as_typed = owner is not None and is_text(owner.model_fields.get(names[-1]))
    table[names[-1]] = text if as_typed and not isinstance(value, str) else value
    return None
