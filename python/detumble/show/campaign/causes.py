"""Shares of successful runs and of each cause of failure."""

from __future__ import annotations

from collections.abc import Mapping
from textwrap import wrap
from typing import TYPE_CHECKING

from detumble.show.campaign.frame import PLAIN, QUIET, Caption, counted, page, percent, show_message

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from detumble.intervals import Proportion

WIDTH = 9.5
"""Inches."""
LINE = 30
"""Letters in a line of a cause's name."""


def plot_failures(success: Proportion, causes: Mapping[str, Proportion], caption: Caption) -> Figure:
    """Plot the share of successes, and below it, on a scale of its own, that of each cause of failure; within `styled()`.

    Args:
        success: runs that succeeded.
        causes: runs that failed, by cause, in the order to show; empty if none did.
        caption: what was flown.
    """
    names = ["\n".join(wrap(cause, LINE, max_lines=3, placeholder=" …")) for cause in causes]
    rows = max(2.0, sum(0.6 + 0.5 * name.count("\n") + 0.4 for name in names))
    figure = page(caption, WIDTH, 2.6 + 0.34 * rows, "whiskers and brackets: exact interval of 95 % (Clopper–Pearson)")
    above, below = figure.subplots(2, 1, height_ratios=[1.4, rows])
    _bars(above, ["success"], [success], caption.colour, 1.0)
    above.set_xlim(0.0, 1.0)
    if not causes:
        show_message(below, f"no failure in {counted(success.runs, 'run')}: its probability is below {_bound(success)}")
        return figure
    _bars(below, names, list(causes.values()), PLAIN, max(found.high for found in causes.values()))
    below.set_title("failures by cause (own scale)", color=QUIET)
    below.set_xlabel("share of all runs [–]")
    return figure


def _bars(axes: Axes, names: list[str], found: list[Proportion], colour: str, most: float) -> None:
    """Plot shares with their whiskers; the numbers are to the right of the panel."""
    for row, one in enumerate(found):
        axes.barh(row, one.share, height=0.6, color=colour, zorder=2.0)
        axes.plot([one.low, one.high], [row, row], "|-", color="black", markersize=8.0, linewidth=1.1, zorder=2.5)
        text = f"{counted(one.count)}   {percent(one)}"
        axes.annotate(
            text, (1.0, row), xycoords=("axes fraction", "data"), xytext=(8.0, 0.0), textcoords="offset points",
            va="center", fontsize=8.5, annotation_clip=False,
        )  # fmt: skip
    axes.set_xlim(0.0, min(1.08 * most, 1.0))
    axes.set_ylim(len(found) - 0.5, -0.5)
    axes.set_yticks(range(len(found)), names)
    for label in axes.get_yticklabels():
        label.set_parse_math(False)
    axes.tick_params(axis="y", length=0.0)
    axes.grid(visible=False, axis="y")


def _bound(success: Proportion) -> str:
    return f"{100.0 * (1.0 - success.low):.2g} %"
