"""Figures of a search for gains: how it converged, and the front of time against Δv."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from detumble.show.style import LIMIT, heading, look, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from detumble.analysis.tuning.pareto import Front
    from detumble.analysis.tuning.tuner import Tuned

PALE = "#A0A0A0"
"""Colour of single generations."""


def plot_convergence(tuned: Tuned) -> Figure:
    """Plot the figure in memory; call it within `styled()`."""
    from matplotlib.ticker import LogLocator

    figure = new_figure(7.5, 5.2)
    figure.suptitle(heading(tuned.scenario.title, 71), parse_math=False)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[2.2, 1.0])
    colour, history = look(tuned.law).colour, tuned.history
    made = np.array([one.evaluations for one in history])
    best, median = np.array([one.best for one in history]), np.array([one.median for one in history])
    # of the first candidate alone the median is itself
    above.plot(made[1:], median[1:], ".", color=PALE, markersize=3.0, label="median of a generation")
    above.step(made, best, where="post", color=colour, linewidth=2.0, label="best so far")
    if best[-1] > 0.0:  # a start within the thresholds costs nothing
        above.set_yscale("log")
        above.yaxis.set_minor_locator(LogLocator(subs=(2.0, 5.0)))
    for formatted in (above.yaxis.set_major_formatter, above.yaxis.set_minor_formatter):
        formatted("{x:g}")
    objective = tuned.objective
    above.set_ylabel(f"{objective.statistic} {objective.meaning} [{objective.unit}]")
    _level(above, tuned)
    above.legend(loc="upper right")
    above.set_title(f"{look(tuned.law).label}: {tuned.evaluations} candidates, {tuned.starts} starts each")
    below.step(made, [100.0 * one.success for one in history], where="post", color=colour, linewidth=2.0)
    below.axhline(100.0 * objective.required, **LIMIT)
    below.set_ylabel("success of the best [%]")
    below.set_ylim(top=101.0)
    below.set_xlabel("candidates [–]")
    below.set_xlim(0, max(int(made[-1]), 1))
    figure.align_ylabels()
    return figure


def _level(axes: Axes, tuned: Tuned) -> None:
    """Mark above what cost too few starts succeed, where any candidate was there."""
    if tuned.objective.unit != "s" or max(one.median for one in tuned.history) <= tuned.horizon:
        return
    axes.axhline(tuned.horizon, **LIMIT)
    axes.annotate(
        "above: too few starts succeed",
        (0.99, tuned.horizon),
        xycoords=("axes fraction", "data"),
        xytext=(0, 2),
        textcoords="offset points",
        ha="right",
        va="bottom",
        color=LIMIT["color"],
        fontsize=8.0,
    )


def plot_front(front: Front) -> Figure:
    """Plot the figure in memory; call it within `styled()`."""
    figure = new_figure(7.0, 4.6)
    figure.suptitle(heading(front.initial.title, 66), parse_math=False)
    axes = figure.subplots()
    times, efforts = ([getattr(point, name) for point in front.points] for name in ("time", "delta_v"))
    axes.step(times, efforts, where="post", color=look(front.law).colour, linewidth=1.0, alpha=0.5)
    axes.plot(times, efforts, look(front.law).marker, color=look(front.law).colour, markersize=4.0)
    axes.margins(0.04)
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel(f"{front.objective.statistic} {front.objective.meaning} [s]")
    axes.set_ylabel(f"{front.objective.statistic} Δv to capture [m/s]")
    share = f"{100.0 * front.objective.required:g}"
    label = look(front.law).label
    axes.set_title(
        f"{label}: at least {share} % of {front.starts} starts succeed; {front.evaluations} candidates flown"
    )
    return figure
