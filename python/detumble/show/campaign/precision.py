"""Convergence of the probability of success with the number of runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from detumble.intervals import Proportion
from detumble.show.axes import plot_level
from detumble.show.campaign.frame import QUIET, Caption, counted, page, percent, show_message
from detumble.show.style import LIMIT

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from detumble.campaigns.statistics.convergence import Convergence

SHOWN = 15.0
"""Final half widths that are shown on either side of the final estimate: early intervals may leave the picture."""
FIRST = 1e4
"""The last number of runs over the first one that is shown."""
PALE = "#E4E4E4"
"""Colour of the final interval."""


def plot_convergence(curve: Convergence, caption: Caption, target: float | None = None) -> Figure:
    """Plot the probability of success over the number of runs, and the half width of its interval; within `styled()`.

    Args:
        curve: (m,) estimates; may be empty.
        caption: what was flown.
        target: half width that was asked for.
    """
    figure = page(caption, 9.5, 6.2)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[1.5, 1.0])
    if not len(curve.runs):
        show_message(above, "no runs yet")
        below.set_axis_off()
        return figure
    _estimate(above, curve, caption)
    _half_width(below, curve, caption.colour, target)
    below.set_xscale("log")
    first, last = float(curve.runs[0]), float(curve.runs[-1])
    first = max(first, last / FIRST)
    below.set_xlim(first if first < last else 0.5 * first, last if first < last else 2.0 * last)
    below.set_xlabel("runs [–]")
    below.xaxis.set_minor_formatter("")
    figure.align_ylabels()
    return figure


def _estimate(axes: Axes, curve: Convergence, caption: Caption) -> None:
    low, high = float(curve.low[-1]), float(curve.high[-1])
    axes.axhspan(low, high, color=PALE, linewidth=0.0, zorder=0.5)
    for edge in (low, high):
        axes.axhline(edge, **LIMIT)
    axes.fill_between(curve.runs, curve.low, curve.high, color=caption.colour, alpha=0.25, linewidth=0.0)
    marker = "o" if len(curve.runs) == 1 else ""
    axes.plot(curve.runs, curve.share, color=caption.colour, linewidth=2.0, marker=marker)
    runs, share = int(curve.runs[-1]), float(curve.share[-1])
    reach = SHOWN * 0.5 * (high - low)
    bottom, top = max(share - reach, 0.0), min(share + reach, 1.0)
    axes.set_ylim(bottom - 0.03 * (top - bottom), top + 0.03 * (top - bottom))
    axes.set_ylabel("probability of success [–]")
    final = percent(Proportion(round(share * runs), runs, share, low, high))
    axes.set_title(f"after {counted(runs, 'run')}: {final}, shaded; interval of 95 % (Clopper–Pearson)", color=QUIET)


def _half_width(axes: Axes, curve: Convergence, colour: str, target: float | None) -> None:
    half = 0.5 * (curve.high - curve.low)
    axes.plot(curve.runs, half, color=colour, linewidth=2.0, marker="o" if len(half) == 1 else "")
    axes.set_yscale("log")
    axes.set_ylabel("half width of the interval [–]")
    known = half if target is None else np.append(half, target)
    axes.set_ylim(0.6 * float(known.min()), 1.6 * float(known.max()))
    if target is None:
        return
    reached = np.flatnonzero(half <= target)
    text = f"asked for: ±{target:g}"
    if reached.size:
        runs = int(curve.runs[reached[0]])
        axes.axvline(runs, **LIMIT)
        text += f", met at {counted(runs, 'run')}"
    else:
        text += ", not yet met"
    plot_level(axes, [target], text, above=False, at=0.005)
