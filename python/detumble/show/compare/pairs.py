"""Every entry against every other on common runs: by how much, how surely, and who ranks above whom."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from detumble.analysis.comparing.ranking import SIGNIFICANT
from detumble.analysis.comparing.report import METRIC_TITLES
from detumble.analysis.comparing.result import OBJECTIVES
from detumble.show.campaign.frame import QUIET
from detumble.show.compare.frame import looks, sheet

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from detumble.analysis.comparing.result import Comparison

BETTER, WORSE, TIED = "#CFE3F5", "#FBE3C6", "#F2F2F2"
"""Of the row against the column; nobody's colours."""


def draw_pairs(comparison: Comparison) -> Figure:
    """Draw the figure in memory; call it within `styled()`."""
    count = len(comparison.entries)
    name, unit, *_ = METRIC_TITLES[OBJECTIVES[comparison.plan.objective.what]]
    size = max(3.4, 0.52 * count + 1.6)
    notes = (
        f"blue: row better than column in significantly more runs than worse, orange: in fewer, p < {SIGNIFICANT:g} after Holm",
        "framed: the row ranks above the column   ·   beside the names: rank, and letters that entries share which tie",
    )
    figure = sheet(comparison, max(9.5, 1.2 * count + 3.0), size, *notes, legend=False)
    left, right = figure.subplots(1, 2, sharey=True)
    _matrix(left, comparison, OBJECTIVES[comparison.plan.objective.what], f"{name}: median of row less column [{unit}]")
    _matrix(right, comparison, "failed", "failures: row less column [% of runs]")
    order, known = comparison.ordered, looks(comparison)
    labels = [
        f"{known[place].label}   {comparison.ranking.ranks[place]} {comparison.ranking.letters[place]}"
        for place in order
    ]
    left.set_yticks(range(count), labels)
    for label in left.get_yticklabels():
        label.set_parse_math(False)
    return figure


def _matrix(axes: Axes, comparison: Comparison, metric: str, title: str) -> None:
    from matplotlib.patches import Rectangle

    order, known = comparison.ordered, looks(comparison)
    axes.set_title(title, color=QUIET)
    axes.set_xlim(-0.5, len(order) - 0.5)
    axes.set_ylim(len(order) - 0.5, -0.5)
    axes.set_xticks(range(len(order)), [known[place].label for place in order], rotation=90)
    for label in axes.get_xticklabels():
        label.set_parse_math(False)
    axes.grid(visible=False)
    axes.tick_params(length=0.0)
    for side in axes.spines.values():
        side.set_visible(False)
    for row, one in enumerate(order):
        for column, other in enumerate(order):
            if one == other:
                continue
            better, worse, text = _said(comparison, one, other, metric)
            colour = BETTER if better else WORSE if worse else TIED
            axes.add_patch(Rectangle((column - 0.47, row - 0.47), 0.94, 0.94, facecolor=colour, edgecolor="none"))
            if comparison.ranking.above[one, other]:
                frame = Rectangle((column - 0.44, row - 0.44), 0.88, 0.88, fill=False, edgecolor=QUIET, linewidth=0.9)
                axes.add_patch(frame)
            axes.text(column, row, text, ha="center", va="center", fontsize=7.0)


def _said(comparison: Comparison, one: int, other: int, metric: str) -> tuple[bool, bool, str]:
    """Whether the first is better or worse, and by how much."""
    pair = comparison.pair(one, other)
    difference = pair.differences[metric]
    sign = 1.0 if pair.places[0] == one else -1.0
    _, _, decimals, factor = METRIC_TITLES[metric]
    if metric == "failed":  # a median of successes says nothing
        runs = difference.lower + difference.higher + difference.ties
        value = (difference.higher - difference.lower) / max(1, runs)
    else:
        value = difference.median.value if difference.median else math.nan
    value *= sign * factor
    if math.isnan(value):
        text = "–"
    elif math.isinf(value):
        text = "−∞" if value < 0.0 else "+∞"
    else:
        text = f"{value:+.{decimals if abs(value) < 10.0 else 1}f}".replace("-", "−")
        text = text if text.strip("+−0.") else "0"
    return pair.better(one, metric), pair.better(other, metric), text
