"""The tables of docs/reference.md that come from the code: what lies between `<!-- table: name -->` and `<!-- end -->`.

`python tests/reference_tables.py` writes them anew.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

from detumble.campaigns.columns import END_TIME, FAILURE, INDEX, SCALARS, SUCCEEDED
from detumble.metrics import METRICS
from detumble.scenario import LAWS, Scenario
from detumble.scenario.wording import number, pretty
from detumble.variables import VARIABLES

REFERENCE = Path(__file__).parents[1] / "docs" / "reference.md"


def fields_table() -> str:
    """Every field of a scenario, from its JSON Schema: a table for each section, laws' channels side by side with their law."""
    schema = Scenario.schema()
    parts: list[str] = []
    _section(schema, schema, "", parts)
    return "\n\n".join(parts)


def _section(schema: dict[str, Any], section: dict[str, Any], path: str, parts: list[str]) -> None:
    rows: list[tuple[str, ...]] = []
    inner: list[tuple[str, dict[str, Any]]] = []
    kind = ""
    for name, raw in section["properties"].items():
        field = _resolved(schema, raw)
        items = _resolved(schema, field.get("items", {}))
        dotted = f"{path}.{name}" if path else name
        if name == "stack" and path.startswith("laws."):
            rows.append(
                (name, "tables `translation`, `rotation`", "none", "gains for the stack; same fields as before")
            )
        elif name == "tuned" and path.startswith("laws."):
            rows.append((name, "table", "none", "how these gains were found"))
            inner += [("laws.LAW.tuned", field)] if path == f"laws.{LAWS[-1]}" else []  # once: the same for every law
        elif "const" in field and name in section["required"]:
            kind = f"`{name} = {json.dumps(field['const'])}`"
        elif "properties" in field:
            inner.append((dotted, field))
        elif "properties" in items:
            inner.append((f"[{dotted}]", items))
        elif "discriminator" in items:
            inner += [(f"[{dotted}]", _resolved(schema, choice)) for choice in items["oneOf"]]
        else:
            default = "required" if name in section.get("required", ()) else _default(field)
            rows.append((name, _kind(field), default, field.get("description", "")))
    if rows:
        title = f"### `[{path}]`" if path else "### at the top of the file"
        title += f", {kind}" if kind else ""
        about = [section["description"].split("\n")[0]] if path else []
        head = ("field", "takes", "default", "meaning")
        parts.append("\n\n".join([title, *about, _markdown(head, [(f"`{row[0]}`", *row[1:]) for row in rows])]))
    for dotted, field in inner:
        _section(schema, field, dotted, parts)


def _resolved(schema: dict[str, Any], node: dict[str, Any]) -> dict[str, Any]:
    return schema["$defs"][node["$ref"].rsplit("/", 1)[1]] if "$ref" in node else node


def _kind(field: dict[str, Any]) -> str:
    if "const" in field:
        return f'`"{field["const"]}"`'
    if "enum" in field:
        return " or ".join(f'`"{choice}"`' for choice in field["enum"])
    if field.get("type") in ("string", "boolean"):
        return {"string": "text", "boolean": "`true` or `false`"}[field["type"]]
    if field.get("type") == "array" and field["items"]["type"] in ("string", "array"):
        return {"string": "list of paths", "array": "list of rows"}[field["items"]["type"]]
    shape, numbers = _shape(field)
    unit = field.get("unit", "1")
    limits = _limits(numbers)
    return ", ".join(part for part in (shape, pretty(unit) if unit != "1" else "", limits) if part)


def _shape(field: dict[str, Any]) -> tuple[str, dict[str, Any]]:
    """Say what shape a field has, and give the schema of one of its numbers."""
    if "oneOf" in field:
        single, several = field["oneOf"]
        if "enum" in several:
            return "number or " + _kind(several), single
        numbers = single.get("items", single)
        return ("3 numbers or 3×3" if several["items"].get("type") == "array" else "1 number or 3"), numbers
    if field["type"] == "array":
        return f"{field['minItems']} numbers", field["items"]
    whole = "odd whole number" if "unit" in field else "whole number"
    return (whole if field["type"] == "integer" else "number"), field


def _limits(numbers: dict[str, Any]) -> str:
    signs = (("exclusiveMinimum", ">"), ("minimum", "≥"), ("exclusiveMaximum", "<"), ("maximum", "≤"))
    if numbers.get("minimum", 1.0) == -numbers.get("maximum", 1.0):
        return f"± {_plain(numbers['maximum'])}"
    return ", ".join(f"{sign} {_plain(numbers[key])}" for key, sign in signs if key in numbers)


def _default(field: dict[str, Any]) -> str:
    if "default" not in field:
        return "none"
    return f"`{_literal(field['default'])}`"


def _literal(value: Any) -> str:
    if isinstance(value, list):
        return "[" + ", ".join(_literal(element) for element in value) + "]"
    return _plain(value) if isinstance(value, float) else json.dumps(value)


def _plain(value: float) -> str:
    return number(float(value)).removesuffix(".0")


def metrics_table() -> str:
    head = ("attribute", "JSON key", "unit", "what is counted")
    return _markdown(head, [(f"`{m.name}`", f"`{m.key}`", m.unit or "–", m.definition) for m in METRICS])


def variables_table() -> str:
    head = ("variable", "over", "unit", "meaning, frame")
    rows = [(f"`{v.name}`", f"time, {v.across}".removesuffix(", "), v.unit, v.meaning) for v in VARIABLES]
    return _markdown(head, rows)


def columns_table() -> str:
    """The columns of a campaign's table of runs; metrics are told elsewhere, drawn values by their fields."""
    rows = [
        (f"`{column.name}`", column.unit or "–", column.meaning) for column in (INDEX, SUCCEEDED, FAILURE, END_TIME)
    ]
    drawn = "a column for each dispersed number: drawn value, under the field's path"
    rows.insert(1, ("`chaser.mass`, `debris.tumble_rate.x`, …", "the field's", drawn))
    keys = ", ".join(f"`{metric.key}`" for metric in SCALARS)
    rows.append((keys, "in the name", "the [metrics](#metrics) that are single numbers"))
    return _markdown(("column", "unit", "meaning"), rows)


def _markdown(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    cells = [[cell.replace("|", "\\|") for cell in row] for row in rows]
    return "\n".join(["| " + " | ".join(row) + " |" for row in [list(head), ["---"] * len(head), *cells]])


TABLES: dict[str, Callable[[], str]] = {
    "fields": fields_table,
    "metrics": metrics_table,
    "columns": columns_table,
    "variables": variables_table,
}


def with_tables(page: str) -> str:
    """Write every marked table of a page anew."""

    def written(found: re.Match[str]) -> str:
        return f"{found[1]}\n\n{TABLES[found[2]]()}\n\n{found[3]}"

    return re.sub(r"(<!-- table: (\w+) -->)\n.*?(<!-- end -->)", written, page, flags=re.DOTALL)


if __name__ == "__main__":
    REFERENCE.write_text(with_tables(REFERENCE.read_text(encoding="utf-8")), encoding="utf-8", newline="\n")
