"""When the runs of each entry capture: capture times, and their ratio to the least time of each run."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from detumble.show.axes import plot_level, set_log_time
from detumble.show.campaign.frame import QUIET, show_message

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from detumble.show.compare.frame import Sheet
    from detumble.show.series import Array

SIZE = (11.0, 4.6)
MARKED = (0.5, 0.95)
POINTS = 1500
"""Most corners of a curve."""


@dataclass(frozen=True)
class CaptureTimes:
    """Capture times of all runs; lists by entry, the best first.

    Attributes:
        captures: (runs,) s each; +inf for a run that failed.
        ratios: (runs,) each, capture time over the least time of that run.
        bounds: (runs,) s, least time of each run.
    """

    captures: Sequence[Array]
    ratios: Sequence[Array]
    bounds: Array


def plot_times(sheet: Sheet, times: CaptureTimes) -> Figure:
    """Plot the figure in memory; call it within `styled()`."""
    figure = sheet.page(*SIZE)
    left, right = figure.subplots(1, 2, sharey=True)
    _distributions(left, sheet, times.captures, times.bounds)
    left.set_xlabel("capture time [s]")
    left.set_ylabel("share of all runs [–]")
    begin, end = left.get_xlim()
    time, share = stairs(times.bounds, end)
    left.plot(time, share, color=QUIET, linewidth=1.0, zorder=1.6)
    left.fill_betweenx(share, begin, time, color="#E4E4E4", zorder=1.0)
    left.set_title("grey: sooner than any controller could", color=QUIET)
    _distributions(right, sheet, times.ratios, np.ones(1))
    right.set_xlabel("capture time over the least time of that run [–]")
    right.set_title("1: as soon as any controller could", color=QUIET)
    return figure


def _distributions(axes: Axes, sheet: Sheet, values: Sequence[Array], least: Array) -> None:
    """Plot the distribution of each entry's values, including the least value in the axis."""
    known = np.concatenate([*values, least])
    known = known[np.isfinite(known) & (known > 0.0)]
    axes.set_ylim(0.0, 1.0)
    if not known.size:
        show_message(axes, "no run captured")
        return
    first, last = 0.95 * float(np.quantile(known, 0.001)), 1.15 * float(np.quantile(known, 0.999))
    set_log_time(axes, first, max(last, 1.3 * first))
    for share in MARKED:
        plot_level(axes, [share], f"{100 * share:g} %", above=False, at=0.01)
    end = axes.get_xlim()[1]
    for place in reversed(range(len(values))):
        style = sheet.looks[place]
        corners, shares = stairs(values[place], end)
        axes.plot(corners, shares, **style.line, linewidth=1.6, solid_capstyle="butt")
        for level in MARKED:
            there = np.flatnonzero(shares >= level)
            if there.size and corners[there[0]] < end:
                axes.plot(corners[there[0]], level, linestyle="none", zorder=3.0, **style.point)


def stairs(values: Array, end: float) -> tuple[Array, Array]:
    """Give the corners of the distribution function of values (n,), which may be infinite, up to an end.

    Returns:
        Places and shares of all n, thinned where there are very many.
    """
    ordered = np.sort(values)
    finite = int(np.searchsorted(ordered, np.inf))
    places, firsts = np.unique(ordered[:finite], return_index=True)
    shares = np.append(firsts[1:], finite) / len(values)
    if len(places) > POINTS:
        kept = np.unique(np.searchsorted(shares, np.linspace(0.0, shares[-1], POINTS)))
        places, shares = places[kept], shares[kept]
    start = places[:1]
    across = (
        np.concatenate([start, np.repeat(places[1:], 2), [max(end, float(places[-1]))]])
        if len(places)
        else np.array([end])
    )
    up = np.repeat(shares, 2) if len(places) else np.zeros(1)
    return np.concatenate([start, across]), np.concatenate([np.zeros(len(start)), up])
