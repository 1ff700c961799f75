"""Scenarios as TOML text: one line a field, its unit beside it, exact to the last bit."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from detumble.scenario.dispersions.fitting import unit_in
from detumble.scenario.laws import Provenance
from detumble.scenario.reflection import quantity_of
from detumble.scenario.section import Section
from detumble.scenario.wording import number

if TYPE_CHECKING:
    from detumble.scenario.model import Scenario

_COMMENT_COLUMN = 44


def text_of(scenario: Scenario) -> str:
    """Write a scenario as TOML; reading the text gives an equal scenario.

    Args:
        scenario: the scenario.

    Returns:
        The text of the file.
    """
    lines: list[str] = []
    _table(scenario, "", lines)
    return "\n".join(lines).strip() + "\n"


def _table(section: Section, path: str, lines: list[str]) -> None:
    tables: list[tuple[str, Section]] = []
    arrays: list[tuple[str, list[Section]]] = []
    own: list[str] = []
    inline: list[str] = []
    for name, field in type(section).model_fields.items():
        value = getattr(section, name)
        if value is None or (isinstance(value, Section) and field.default_factory and not value.model_fields_set):
            continue
        if isinstance(value, Section):
            if path.startswith("laws.") and not isinstance(value, Provenance):
                inline.append(f"{name} = {literal(value)}")
            else:
                tables.append((name, value))
        elif isinstance(value, list):
            arrays.append((name, value))
        else:
            quantity = quantity_of(field)
            own.append(_commented(f"{name} = {literal(value)}", unit_in(section, quantity) if quantity else ""))
    if path and (own or inline or not (tables or arrays)):
        lines += ["", f"[{path}]"]
    lines += own + inline
    for name, table in tables:
        _table(table, f"{path}.{name}" if path else name, lines)
    for name, items in arrays:
        for item in items:
            lines += ["", f"[[{path}.{name}]]" if path else f"[[{name}]]"]
            _table(item, "", lines)


def _commented(line: str, unit: str) -> str:
    return f"{line.ljust(_COMMENT_COLUMN - 1)} # {unit}" if unit else line


def literal(value: Any) -> str:
    """Write one value as TOML does; a section becomes an inline table."""
    if isinstance(value, Section):
        value = value.to_dict() if hasattr(value, "to_dict") else value.model_dump(exclude_none=True)
    if isinstance(value, dict):
        return (
            "{ " + ", ".join(f"{key} = {literal(element)}" for key, element in value.items()) + " }" if value else "{}"
        )
    if isinstance(value, list | tuple):
        return "[" + ", ".join(literal(element) for element in value) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        return number(value)
    return _string(str(value))


def _string(text: str) -> str:
    plain = all(character.isprintable() or character == "\n" for character in text)
    if "\n" in text and plain and "\\" not in text and '"' not in text:
        return f'"""\n{text}"""'
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
