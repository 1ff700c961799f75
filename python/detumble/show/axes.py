"""Elements of several figures: rows of panels over time, lines of all laws, captures, limits, legends."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from detumble.show.series import Array, Span, after_capture, thinned, until_capture
from detumble.show.style import LIMIT, look, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    from detumble.flight import Flight

Panels: TypeAlias = list[list["Axes"]]

TIME_LABEL = "time [s]"
LEFT, BELOW, GAP, LABEL = 0.92, 0.5, 0.3, 0.58
"""Margins, space between columns (twice that between rows), and from a vertical axis to its label, inches."""


def time_panels(
    shown: Sequence[Span],
    labels: Sequence[str],
    size: tuple[float, float],
    time_label: str = TIME_LABEL,
    *,
    above: float = 0.72,
    right: float = 0.25,
) -> tuple[Figure, Panels]:
    """Make one row of panels for each quantity and one column for each span of time.

    Margins are fixed, since a layout found by trial takes longer than the plotting.

    Args:
        shown: the spans, from `series.spans`.
        labels: what each row shows, with its unit.
        size: width and height, inches.
        time_label: below the lowest row.
        above, right: margins, inches; the legend is above the panels.

    Returns:
        The figure, and its panels by row and column.
    """
    width, height = size
    figure = new_figure(width, height, layout=None)
    wide = (width - LEFT - right - GAP * (len(shown) - 1)) / len(shown)
    high = (height - above - BELOW - 0.5 * GAP * (len(labels) - 1)) / len(labels)
    sides = {"left": LEFT / width, "right": 1.0 - right / width, "bottom": BELOW / height, "top": 1.0 - above / height}
    grid = figure.subplots(
        len(labels),
        len(shown),
        sharex="col",
        sharey="row",
        squeeze=False,
        gridspec_kw={**sides, "wspace": GAP / wide, "hspace": 0.5 * GAP / high},
    )
    panels = [list(row) for row in grid]
    for row, label in zip(panels, labels, strict=True):
        row[0].set_ylabel(label)
        row[0].yaxis.set_label_coords(-LABEL / wide, 0.5)
    for column, span in enumerate(shown):
        panels[0][column].set_title(span.title, color="#404040")
        panels[-1][column].set_xlabel(time_label)
        panels[-1][column].xaxis.set_label_coords(0.5, -0.3 / high)
        panels[-1][column].set_xlim(0.0, span.end)
    return figure, panels


def plot_line(axes: Axes, law: str, line: tuple[Array, Array], end: float = math.inf, **changes: Any) -> None:
    """Plot one law's line in its look, up to `end` s; keyword arguments change the look."""
    style = look(law)
    options = {"color": style.colour, "linestyle": style.dashes, "linewidth": style.width} | changes
    axes.plot(*thinned(*line, end), **options)


def plot_laws(
    panels: Sequence[Axes],
    shown: Sequence[Span],
    flights: Mapping[str, Flight],
    name: str,
    axis: int | None = None,
    *,
    scale: float = 1.0,
    faint_after: bool = False,
    dotted_end: bool = True,
) -> None:
    """Plot a series of all laws until each one's capture, in every panel of a row.

    Args:
        panels: the row.
        shown: the span of each panel.
        flights: by law.
        name: of the series.
        axis: component; None for a scalar.
        scale: what values are multiplied by.
        faint_after: go on after capture, thin and pale.
        dotted_end: put the law's marker where its line ends.
    """
    for axes, span in zip(panels, shown, strict=True):
        for law, flight in flights.items():
            style = look(law)
            time, values = until_capture(flight, name, axis)
            if faint_after:
                later, beyond = after_capture(flight, name, axis)
                plot_line(axes, law, (later, scale * beyond), span.end, linewidth=0.8, alpha=0.4, zorder=1.8)
            plot_line(axes, law, (time, scale * values), span.end)
            captured = flight.metrics.capture_time
            if dotted_end and captured is not None and captured <= span.end and len(time):
                axes.plot(
                    time[-1],
                    scale * values[-1],
                    style.marker,
                    color=style.colour,
                    markersize=5.5,
                    markeredgecolor="white",
                    markeredgewidth=0.8,
                    zorder=3.0,
                    clip_on=captured < axes.get_xlim()[0],
                )


def plot_captures(panels: Sequence[Axes], flights: Mapping[str, Flight]) -> None:
    """Mark the capture of each law by a vertical line in its look."""
    for axes in panels:
        left, right = sorted(axes.get_xlim())
        for law, flight in flights.items():
            time = flight.metrics.capture_time
            if time is not None and left <= time <= right:
                style = look(law)
                axes.axvline(time, color=style.colour, linestyle=style.dashes, linewidth=0.9, alpha=0.75, zorder=1.6)


def plot_level(axes: Axes, values: Sequence[float], text: str = "", *, above: bool = True, at: float = 0.995) -> None:
    """Plot limits as horizontal lines; the first carries the text, the rest are bare. What is not finite is left out."""
    finite = [value for value in values if math.isfinite(value)]
    for value in finite:
        axes.axhline(value, **LIMIT)
    if finite and text:
        axes.annotate(
            text,
            (at, finite[0]),
            xycoords=("axes fraction", "data"),
            xytext=(0.0, 2.0 if above else -2.0),
            textcoords="offset points",
            ha="right" if at > 0.5 else "left",
            va="bottom" if above else "top",
            fontsize=7.5,
            color="#404040",
            bbox={"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 0.6},
        )


def law_legend(figure: Figure, flights: Mapping[str, Flight], ends: Mapping[str, str], title: str = "") -> None:
    """Put one legend for all panels on top: each law's look and its text in `ends`.

    Args:
        figure: where.
        flights: by law.
        ends: by law, like `captured at 7.6 s`.
        title: of the legend: what the texts in `ends` are.
    """
    from matplotlib.lines import Line2D

    handles = []
    for law in flights:
        style = look(law)
        label = f"{style.label}  {ends[law]}".rstrip()
        handles.append(
            Line2D(
                [], [], color=style.colour, linestyle=style.dashes, linewidth=style.width, marker=style.marker,
                markersize=5.5, markeredgecolor="white", markeredgewidth=0.8, label=label,
            )
        )  # fmt: skip
    legend = figure.legend(
        handles=handles,
        loc="upper center",
        borderaxespad=0.3,
        ncols=min(5, len(handles)),
        title=title or None,
    )
    legend.get_title().set_multialignment("center")
    for text in legend.get_texts():  # a name is no formula
        text.set_parse_math(False)


def captured_at(flights: Mapping[str, Flight]) -> dict[str, str]:
    """Write the capture time of each law."""
    return {law: time_text(flight.metrics.capture_time, flight) for law, flight in flights.items()}


def time_text(time: float | None, flight: Flight) -> str:
    """Write a time for a legend, or what happened instead."""
    if time is not None:
        return f"{time:.1f} s"
    return "diverged" if flight.diverged else "–"


def set_log_time(axes: Axes, start: float, end: float) -> None:
    """Make a time axis logarithmic, from `start` to `end` s, with readable numbers."""
    axes.set_xscale("log")
    axes.set_xlim(start, end)
    label_decades(axes.xaxis)


def label_decades(axis: Axis) -> None:
    """Label a logarithmic axis at 1, 2 and 5 of each decade."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))


def set_symlog_beyond(axes: Axes, most: float = 1e4) -> None:
    """Make a vertical axis logarithmic if a diverged flight exceeds `most` on it."""
    size = reach(axes)
    if size > most:
        axes.set_yscale("symlog", linthresh=1.0, linscale=0.1 * math.log10(size))
        axes.set_ylim(-10.0 * size, 10.0 * size)


def reach(axes: Axes) -> float:
    """Largest absolute value that the lines of a panel carry; 0 without any."""
    return max((float(np.abs(data).max()) for line in axes.lines if (data := _numbers(line)).size), default=0.0)


def _numbers(line: Line2D) -> Array:
    values: Array = np.asarray(line.get_ydata(), float)
    return values[np.isfinite(values)]
