"""How success and capture time follow when belief, noise or control period differ from those of the tuning."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from detumble.show.axes import label_decades
from detumble.show.campaign.frame import QUIET, counted
from detumble.show.style import LIMIT

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from detumble.show.compare.frame import Sheet
    from detumble.show.series import Array

SIZE = (11.0, 5.6)


@dataclass(frozen=True)
class SweepCurves:
    """What every entry gives along one sweep.

    Attributes:
        label: of the value that is changed, with its unit.
        own: the scenario's own value.
        values: (m,) that were flown.
        decades: count decades along the axis.
        runs: flown for each value.
        success: (entries, m) %.
        times: (entries, m) s, median capture time; not finite where half of the runs fail.
    """

    label: str
    own: float
    values: tuple[float, ...]
    decades: bool
    runs: int
    success: Array
    times: Array


def plot_changes(sheet: Sheet, sweeps: Sequence[SweepCurves]) -> Figure:
    """Plot the figure in memory; call it within `styled()`.

    Args:
        sheet: headline and entries.
        sweeps: at least one.
    """
    runs = counted(sweeps[0].runs, "run")
    figure = sheet.page(
        *SIZE,
        f"the first {runs}, one value changed at a time, nothing tuned anew   ·   dashed: as the scenario has it",
    )
    panels = figure.subplots(2, len(sweeps), sharex="col", sharey="row", squeeze=False)
    any_time = False
    for column, sweep in enumerate(sweeps):
        success, times = panels[:, column]
        for place in reversed(range(len(sheet.looks))):
            look = sheet.looks[place]
            options = {**look.line, **look.point, "linewidth": 1.3, "clip_on": False}
            success.plot(sweep.values, sweep.success[place], **options)
            times.plot(sweep.values, np.where(np.isfinite(sweep.times[place]), sweep.times[place], np.nan), **options)
        any_time = any_time or bool(np.isfinite(sweep.times).any())
        _set_changes(times, sweep.values, sweep.decades)
        times.set_xlabel(sweep.label)
        for axes in (success, times):
            axes.axvline(sweep.own, **LIMIT)
    panels[0, 0].set_ylabel("success [%]")
    panels[0, 0].set_ylim(0.0, 100.0)
    panels[1, 0].set_ylabel("median capture time [s]")
    if any_time:
        panels[1, 0].set_title("a line ends where half of the runs fail", color=QUIET)
        panels[1, 0].set_yscale("log")
        label_decades(panels[1, 0].yaxis)
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
