"""How success and capture time follow when belief, noise or control period are not what the gains were found with."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from detumble.show.campaign.frame import QUIET, counted
from detumble.show.compare.frame import looks, sheet
from detumble.show.style import LIMIT

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from detumble.analysis.comparing.result import Comparison

SIZE = (11.0, 5.6)


def draw_changes(comparison: Comparison) -> Figure:
    """Draw the figure in memory; call it within `styled()`."""
    flown = counted(min(comparison.plan.robust, comparison.plan.runs), "run")
    figure = sheet(
        comparison,
        *SIZE,
        f"the first {flown}, one number changed at a time, nothing tuned anew   ·   dashed: as the scenario has it",
    )
    sweeps = [curve.sweep for curve in comparison.entries[0].curves]
    panels = figure.subplots(2, len(sweeps), sharex="col", sharey="row", squeeze=False)
    known, any_time = looks(comparison), False
    for column, sweep in enumerate(sweeps):
        success, times = panels[:, column]
        for place in reversed(comparison.ordered):
            verdicts = comparison.entries[place].curves[column].verdicts
            shares = [100.0 * verdict.success.share for verdict in verdicts]
            medians = [verdict.figures["capture_time_s"].median for verdict in verdicts]
            options = {**known[place].line, **known[place].point, "linewidth": 1.3, "clip_on": False}
            success.plot(sweep.values, shares, **options)
            finite = [found.value if found and np.isfinite(found.value) else np.nan for found in medians]
            any_time = any_time or bool(np.isfinite(finite).any())
            times.plot(sweep.values, finite, **options)
        _set_changes(times, sweep.values, sweep.key != "belief")
        times.set_xlabel(sweep.label)
        for axes in (success, times):
            axes.axvline(sweep.own, **LIMIT)
    panels[0, 0].set_ylabel("success [%]")
    panels[0, 0].set_ylim(0.0, 100.0)
    panels[1, 0].set_ylabel("median capture time [s]")
    if any_time:
        panels[1, 0].set_title("a line ends where half of the runs fail", color=QUIET)
        _set_decades(panels[1, 0])
    else:
        panels[1, 0].set_title("everywhere half of the runs fail", color=QUIET)
    return figure


def _set_changes(axes: Axes, values: tuple[float, ...], decades: bool) -> None:
    """Put a tick at each value that was flown."""
    from matplotlib.ticker import NullLocator

    if decades:
        axes.set_xscale("log")
    axes.set_xticks(list(values), [f"{value:g}" for value in values])
    axes.xaxis.set_minor_locator(NullLocator())
    margin = 1.08 if decades else 1.0
    axes.set_xlim(values[0] / margin - (0.0 if decades else 0.03), values[-1] * margin + (0.0 if decades else 0.03))


def _set_decades(axes: Axes) -> None:
    """Count decades where times lie far apart, with readable numbers."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

    axes.set_yscale("log")
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
