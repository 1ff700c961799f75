"""Numbers as text, and rows of text as aligned columns for a terminal."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence


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
