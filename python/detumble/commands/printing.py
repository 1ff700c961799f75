"""What commands print: tables for people, one object for programs, remarks beside both."""

from __future__ import annotations

import json
import math
import sys
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from detumble.text import printable

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence


def print_json(values: Mapping[str, Any]) -> None:
    """Print one JSON object on standard output; what is not finite becomes null."""
    print(json_text(values))


def json_text(values: Mapping[str, Any]) -> str:
    """Write an object as JSON, which stays whole in any encoding; what is not finite becomes null."""
    return json.dumps(_finite(values), indent=2, allow_nan=False)


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(element) for key, element in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(element) for element in value]
    if hasattr(value, "tolist"):
        return _finite(value.tolist())
    return None if isinstance(value, float) and not math.isfinite(value) else value


def remark(text: str) -> None:
    """Tell a person something without touching standard output; where nobody can be told, nothing is lost."""
    with suppress(OSError):
        print(printable(text), file=sys.stderr)


def table(rows: Sequence[Sequence[str]], *, header: bool = True) -> str:
    """Align columns: the first to the left, the others to the right, a rule under the header.

    Args:
        rows: cells; all rows of one length.
        header: the first row names the columns.

    Returns:
        The lines.
    """
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = [
        "  ".join(
            cell.ljust(width) if column == 0 else cell.rjust(width)
            for column, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]
    if header:
        lines.insert(1, "  ".join("─" * width for width in widths))
    return "\n".join(lines)


def cell(value: float | None, digits: int = 3) -> str:
    """Write a number for a table; a dash for what did not happen."""
    return "–" if value is None or not math.isfinite(value) else f"{value:.{digits}g}"


def fixed(value: float | None, decimals: int) -> str:
    """Write a number with a fixed number of decimals; a dash for what did not happen."""
    return "–" if value is None or not math.isfinite(value) else f"{value:.{decimals}f}"
