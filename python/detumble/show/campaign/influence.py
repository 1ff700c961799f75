"""Sensitivity of failures and capture times to the dispersed parameters."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from detumble.show.campaign.frame import PLAIN, QUIET, Caption, counted, page, show_message
from detumble.show.style import LIMIT, shortened

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from detumble.campaigns.statistics.sensitivity import Sensitivity

MOST = 20
"""Parameters shown; the others are counted."""
NAME = 40
"""Letters of a parameter's name."""
TITLES = {"failure": "failure", "capture_time_s": "capture time"}
"""Of outcomes."""


def plot_sensitivity(outcomes: Sequence[Sensitivity], caption: Caption) -> Figure:
    """Plot the indices of each outcome side by side, a row for each parameter, with their threshold; within `styled()`.

    Args:
        outcomes: failure and capture time, or one of them.
        caption: what was flown.
    """
    ranked = ranking(outcomes)
    fields = ranked[:MOST]
    left_out = f"   ·   {counted(len(ranked) - MOST)} weaker ones not shown" if len(ranked) > MOST else ""
    notes = ["whiskers: 95 %   ·   grey: no more than chance (dashed)   ·   ρ: Spearman's rank correlation" + left_out]
    figure = page(caption, 10.5, 1.9 + 0.3 * max(len(fields), 4), *(notes if fields else []))
    panels = figure.subplots(1, len(outcomes), squeeze=False)[0]
    named = False
    for axes, outcome in zip(panels, outcomes, strict=True):
        title = f"{TITLES.get(outcome.outcome, outcome.outcome)}, from {counted(outcome.runs, 'run')}"
        axes.set_title(title, color=QUIET)
        if outcome.silence or not outcome.influences:
            show_message(axes, outcome.silence or "no parameter varies")
        else:
            _bars(axes, outcome, fields, caption.colour)
            _set_rows(axes, fields, named=not named)
            named = True
    return figure


def ranking(outcomes: Sequence[Sensitivity]) -> list[str]:
    """Put the parameters in order of their largest index, measured by the threshold of its outcome."""
    strength: dict[str, float] = {}
    for outcome in outcomes:
        for found in outcome.influences:
            ratio = found.index / (outcome.threshold or 1.0)
            strength[found.field] = max(
                strength.get(found.field, -math.inf), ratio if math.isfinite(ratio) else -math.inf
            )
    return sorted(strength, key=lambda field: -strength[field])


def _bars(axes: Axes, outcome: Sensitivity, fields: Sequence[str], colour: str) -> None:
    influences = {found.field: found for found in outcome.influences if math.isfinite(found.index)}
    threshold = outcome.threshold or 0.0
    ends = [threshold]
    for row, field in enumerate(fields):
        found = influences.get(field)
        if found is None:
            continue
        low, high = max(found.index - found.confidence, 0.0), found.index + found.confidence
        axes.barh(row, found.index, height=0.62, color=colour if found.index > threshold else PLAIN, zorder=2.0)
        axes.plot([low, high], [row, row], "|-", color="black", markersize=7.0, linewidth=1.0, zorder=2.5)
        if math.isfinite(found.correlation):
            text = f"ρ {found.correlation:+.2f}".replace("-", "−")
            axes.annotate(
                text, (max(high, threshold), row), xytext=(6.0, 0.0), textcoords="offset points", va="center",
                fontsize=8.0, color=QUIET,
            )  # fmt: skip
        ends.append(high)
    axes.axvline(threshold, **LIMIT | {"zorder": 2.6})
    axes.set_xlim(0.0, 1.25 * max(ends) or 1.0)
    axes.set_xlabel("PAWN index [–]")


def _set_rows(axes: Axes, fields: Sequence[str], named: bool) -> None:
    axes.set_ylim(max(len(fields), 1) - 0.5, -0.5)
    axes.set_yticks(range(len(fields)), [shortened(field, NAME) if named else "" for field in fields])
    for label in axes.get_yticklabels():
        label.set_parse_math(False)
    axes.tick_params(axis="y", length=0.0)
    axes.grid(visible=False, axis="y")
