"""Quantities of a campaign's flights over time: median, band and extremes of the flights still under way."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from detumble.show.axes import TIME_LABEL, plot_level
from detumble.show.campaign.frame import Caption, counted, page
from detumble.show.series import LARGEST, Array, round_up

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LEVELS = (0.0, 0.05, 0.5, 0.95, 1.0)
"""Quantiles shown."""
MOST_TIMES = 1000
"""Columns kept of longer histories."""
FEW = 10
"""Flights under way below which they have extremes, but neither median nor band, unless there were fewer from the start."""
DECADES_FROM = 30.0
"""A quantity that changes by more than this factor is shown in decades."""


@dataclass(frozen=True)
class Trace:
    """One quantity of many flights.

    Attributes:
        label: of the axis, with its unit.
        values: (M, K), a row for each flight; NaN after its end.
        thresholds: values to hold it against, by what to write beside them.
    """

    label: str
    values: Array
    thresholds: Mapping[str, float] = field(default_factory=dict)


def plot_envelope(time: Array, traces: Sequence[Trace], caption: Caption) -> Figure:
    """Plot quantities of many flights over time, a panel each, and how many flights are under way; within `styled()`.

    Args:
        time: (K,) s, ascending.
        traces: what to show, of the same flights: distance to the goal, attitude error, relative rate.
        caption: what was flown.
    """
    flights = len(traces[0].values)
    shown = f"{counted(flights)} of them, while under way"
    note = f"{shown}   ·   line: median   ·   band: 5–95 %   ·   thin: least and greatest   ·   dashed: thresholds"
    figure = page(caption, 9.5, 1.6 + 2.1 * len(traces) + 0.8, note)
    panels = figure.subplots(len(traces) + 1, 1, sharex=True, height_ratios=[*(1.0 for _ in traces), 0.35])
    every = max(1, -(-len(time) // MOST_TIMES))
    time = time[::every]
    flying = np.isfinite(traces[0].values[:, ::every]).sum(axis=0)
    for axes, trace in zip(panels[:-1], traces, strict=True):
        _panel(axes, time, trace, every, caption.colour)
    last = panels[-1]
    last.fill_between(time, flying, step="post", color=caption.colour, alpha=0.35, linewidth=0.0)
    last.set_ylim(0.0, max(1.05 * flights, 1.0))
    last.set_ylabel("flights\nunder way [–]")
    last.yaxis.get_major_locator().set_params(integer=True, nbins=3)
    last.set_xlabel(TIME_LABEL)
    under_way = np.flatnonzero(flying)
    end = float(time[under_way[-1]]) if under_way.size else 0.0
    last.set_xlim(0.0, min(round_up(end), float(time[-1])) or 1.0)
    figure.align_ylabels(panels)
    return figure


def quantiles(values: Array, levels: Sequence[float] = LEVELS) -> Array:
    """Take quantiles over the rows that have a number, column by column, with linear interpolation between ranks.

    Args:
        values: (M, K); what is not finite does not count.
        levels: (q,) 0 to 1.

    Returns:
        (q, K); NaN where a column has no number.
    """
    ordered = np.sort(np.where(np.abs(values) < LARGEST, values, np.nan), axis=0)  # NaN comes last
    count = np.isfinite(ordered).sum(axis=0)
    rank = np.asarray(levels)[:, None] * np.maximum(count - 1, 0)
    below = np.floor(rank).astype(int)
    above = np.minimum(below + 1, np.maximum(count - 1, 0))
    lower, upper = (np.take_along_axis(ordered, place, axis=0) for place in (below, above))
    between: Array = lower + (rank - below) * (upper - lower)
    return between


def _panel(axes: Axes, time: Array, trace: Trace, every: int, colour: str) -> None:
    values = trace.values[:, ::every]
    least, low, median, high, most = quantiles(values)
    few = np.isfinite(values).sum(axis=0) < min(FEW, len(values))
    low, median, high = (np.where(few, np.nan, part) for part in (low, median, high))
    axes.fill_between(time, low, high, color=colour, alpha=0.25, linewidth=0.0)
    for edge in (least, most):
        axes.plot(time, edge, color=colour, linewidth=0.6, alpha=0.8)
    axes.plot(time, median, color=colour, linewidth=2.0)
    axes.set_ylabel(trace.label)
    _set_scale(axes, trace, low, high, most)
    for text, value in trace.thresholds.items():
        plot_level(axes, [value], text)


def _set_scale(axes: Axes, trace: Trace, low: Array, high: Array, most: Array) -> None:
    """Count decades where the quantity falls through several; down to a hundredth of the lowest threshold at most."""
    known = [part[np.isfinite(part)] for part in (low, high, most)]
    if not known[0].size:
        return
    top = float(known[2].max())
    floor = min((0.01 * value for value in trace.thresholds.values() if value > 0.0), default=0.0)
    positive = known[0][known[0] > 0.0]
    bottom = max(float(positive.min()), floor) if positive.size else 0.0
    if 0.0 < DECADES_FROM * bottom < float(known[1].max()) and float(known[0].min()) >= 0.0:
        axes.set_yscale("log")
        axes.set_ylim(bottom / 1.5, 1.5 * top)
    elif float(known[0].min()) >= 0.0:
        axes.set_ylim(0.0, max(1.05 * top, 1.1 * max(trace.thresholds.values(), default=0.0)) or 1.0)
