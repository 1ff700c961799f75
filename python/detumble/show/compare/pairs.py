"""Every entry against every other on common runs: difference, significance, and order."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from detumble.show.campaign.frame import QUIET

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from detumble.show.compare.frame import Sheet
    from detumble.show.series import Array

BETTER, WORSE, TIED = "#CFE3F5", "#FBE3C6", "#F2F2F2"
"""Of the row against the column; colours of no law."""


@dataclass(frozen=True)
class Matrix:
    """One metric of every pair of entries, the best first in rows and columns.

    Attributes:
        title: metric and unit.
        decimals: of the values below 10; larger ones have one.
        values: (n, n) row less column; NaN where there is none, infinite where one never happens as a rule.
        better: (n, n) whether the row is significantly better than the column.
    """

    title: str
    decimals: int
    values: Array
    better: NDArray[np.bool_]


@dataclass(frozen=True)
class Pairs:
    """Every pair of entries.

    Attributes:
        matrices: two metrics.
        above: (n, n) whether the row ranks above the column.
        significant: p-value below which a difference counts.
    """

    matrices: Sequence[Matrix]
    above: NDArray[np.bool_]
    significant: float


def plot_pairs(sheet: Sheet, pairs: Pairs) -> Figure:
    """Plot the figure in memory; call it within `styled()`."""
    count = len(sheet.looks)
    size = max(3.4, 0.52 * count + 1.6)
    notes = (
        f"blue: row better than column in significantly more runs than worse, orange: in fewer, p < {pairs.significant:g} "
        "after Holm",
        "framed: the row ranks above the column   ·   beside the names: rank, and letters that entries share which tie",
    )
    figure = sheet.page(max(9.5, 1.2 * count + 3.0), size, *notes, legend=False)
    panels = figure.subplots(1, len(pairs.matrices), sharey=True)
    for axes, matrix in zip(panels, pairs.matrices, strict=True):
        _plot_matrix(axes, sheet, matrix, pairs.above)
    labels = [
        f"{look.label}   {rank} {ties}" for look, rank, ties in zip(sheet.looks, sheet.ranks, sheet.ties, strict=True)
    ]
    panels[0].set_yticks(range(count), labels)
    for label in panels[0].get_yticklabels():
        label.set_parse_math(False)
    return figure


def _plot_matrix(axes: Axes, sheet: Sheet, matrix: Matrix, above: NDArray[np.bool_]) -> None:
    from matplotlib.patches import Rectangle

    count = len(sheet.looks)
    axes.set_title(matrix.title, color=QUIET)
    axes.set_xlim(-0.5, count - 0.5)
    axes.set_ylim(count - 0.5, -0.5)
    axes.set_xticks(range(count), [look.label for look in sheet.looks], rotation=90)
    for label in axes.get_xticklabels():
        label.set_parse_math(False)
    axes.grid(visible=False)
    axes.tick_params(length=0.0)
    for side in axes.spines.values():
        side.set_visible(False)
    for row in range(count):
        for column in range(count):
            if row == column:
                continue
            colour = BETTER if matrix.better[row, column] else WORSE if matrix.better[column, row] else TIED
            axes.add_patch(Rectangle((column - 0.47, row - 0.47), 0.94, 0.94, facecolor=colour, edgecolor="none"))
            if above[row, column]:
                frame = Rectangle((column - 0.44, row - 0.44), 0.88, 0.88, fill=False, edgecolor=QUIET, linewidth=0.9)
                axes.add_patch(frame)
            text = _signed(float(matrix.values[row, column]), matrix.decimals)
            axes.text(column, row, text, ha="center", va="center", fontsize=7.0)


def _signed(value: float, decimals: int) -> str:
    if math.isnan(value):
        return "–"
    if math.isinf(value):
        return "−∞" if value < 0.0 else "+∞"
    text = f"{value:+.{decimals if abs(value) < 10.0 else 1}f}".replace("-", "−")
    return text if text.strip("+−0.") else "0"
