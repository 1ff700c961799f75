"""Distribution of the capture times of a campaign, with the share that never captures: one law, or several."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from detumble.intervals import Proportion
from detumble.show.axes import plot_level, set_log_time
from detumble.show.campaign.frame import QUIET, Caption, below_headline, page, percent
from detumble.show.series import Array, round_up
from detumble.show.style import look

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from detumble.campaigns.statistics.summaries import Ecdf

SIZE = (11.0, 5.0)
"""Inches, without the table."""
MARKED = (0.5, 0.95)
"""Shares of all runs whose times are marked."""
SPREAD = 20.0
"""Times whose ratio exceeds this are shown in decades."""
_ROW = 0.22
"""Height of a row of the table, inches."""
_COLUMNS = (0.11, 0.2, 0.312, 0.395, 0.595, 0.707, 0.79)
"""Where the columns of the table begin, shares of the width: the law, then two times and a share for each event."""


def plot_capture_times(captured: Mapping[str, Ecdf], settled: Mapping[str, Ecdf], caption: Caption) -> Figure:
    """Plot the distribution of capture times, in full and as the share that still has not captured; within `styled()`.

    Args:
        captured: by law, distribution of the capture time, s; at least one law.
        settled: by law, that of the time from the start until the stack has settled, s; laws may be missing.
        caption: what was flown.
    """
    width, height = SIZE
    room = _ROW * (len(captured) + 1) + 0.1
    figure = page(caption, width, height + room, room=room)
    left, right = figure.subplots(1, 2)
    curves = [*captured.values(), *settled.values()]
    for axes in (left, right):
        _set_times(axes, curves)
        axes.set_xlabel("time from the start [s]")
    _distribution(left, captured, settled)
    _remainder(right, captured, settled, caption.runs)
    _table(figure, captured, settled, caption.runs)
    return figure


def time_of(curve: Ecdf, share: float) -> float | None:
    """Give the time, s, by which a share of all runs had the event; None if fewer ever had it."""
    place = int(np.searchsorted(curve.fraction, share - 1e-12))
    return float(curve.values[place]) if place < len(curve.values) else None


def _set_times(axes: Axes, curves: list[Ecdf]) -> None:
    known = [curve.values for curve in curves if len(curve.values)]
    first = min((float(values[0]) for values in known), default=0.0)
    last = max((float(values[-1]) for values in known), default=1.0)
    if 0.0 < SPREAD * first < last:
        set_log_time(axes, 0.8 * first, 1.25 * last)
    else:
        axes.set_xlim(0.0, round_up(1.05 * last))


def _stairs(axes: Axes, time: Array, height: Array, start: float) -> tuple[Array, Array]:
    """Corners of a step function that is `start` before the first time and goes on to the end of the axis."""
    begin, end = axes.get_xlim()
    steps = np.concatenate([[start], height])
    corners = np.concatenate([[begin], np.repeat(time, 2), [end]])
    return corners, np.repeat(steps, 2)


def _distribution(axes: Axes, captured: Mapping[str, Ecdf], settled: Mapping[str, Ecdf]) -> None:
    axes.set_ylim(0.0, 1.0)
    axes.set_ylabel("share of runs that have captured [–]")
    axes.set_title("bold: captured   ·   thin: settled" if settled else "", color=QUIET)
    for share in MARKED:
        plot_level(axes, [share], f"{100 * share:g} %", above=False)
    for curves, wide, opacity in ((settled, False, 0.1), (captured, True, 0.2)):
        for law, curve in curves.items():
            style = look(law)
            time, low = _stairs(axes, curve.values, curve.low, 0.0)
            reach = float((curve.high - curve.fraction).max(initial=0.0))  # the band has one width until it meets 1
            high = _stairs(axes, curve.values, curve.high, reach)[1]
            axes.fill_between(time, low, high, color=style.colour, alpha=opacity, linewidth=0.0)
            line = _stairs(axes, curve.values, curve.fraction, 0.0)
            axes.plot(*line, color=style.colour, linestyle=style.dashes, linewidth=2.0 if wide else 0.9)
            for share in MARKED if wide else ():
                time_there = time_of(curve, share)
                if time_there is not None:
                    axes.plot(
                        time_there, share, style.marker, color=style.colour, markersize=6.0, markeredgecolor="white",
                        markeredgewidth=0.8, zorder=3.0,
                    )  # fmt: skip


def _remainder(axes: Axes, captured: Mapping[str, Ecdf], settled: Mapping[str, Ecdf], runs: int) -> None:
    """One minus the distribution, in decades: there rare failures and long tails show."""
    least = min(0.3 / runs, 0.03)
    axes.set_yscale("log")
    axes.set_ylim(least, 1.5)
    axes.set_ylabel("share of runs that have not [–]")
    axes.set_title("at the edge: never captured, with its interval", color=QUIET)
    for curves, wide in ((settled, False), (captured, True)):
        for law, curve in curves.items():
            style = look(law)
            time, height = _stairs(axes, curve.values, 1.0 - curve.fraction, 1.0)
            height = np.where(height > least, height, 0.5 * least)  # to the lower edge, where the last one is in
            axes.plot(time, height, color=style.colour, linestyle=style.dashes, linewidth=2.0 if wide else 0.9)
    for place, (law, curve) in enumerate(captured.items()):
        style, never = look(law), Proportion.of(_never(curve, runs), runs)
        at = 1.02 + 0.02 * place
        axes.plot(
            [at, at], [max(never.low, least), never.high], color=style.colour, linewidth=1.6, solid_capstyle="butt",
            transform=axes.get_yaxis_transform(), clip_on=False,
        )  # fmt: skip
        if never.count:
            axes.plot(
                at, never.share, style.marker, color=style.colour, markersize=5.0,
                transform=axes.get_yaxis_transform(), clip_on=False,
            )  # fmt: skip


def _never(curve: Ecdf, runs: int) -> int:
    return runs - round(float(curve.fraction[-1]) * runs) if len(curve.fraction) else runs


def _table(figure: Figure, captured: Mapping[str, Ecdf], settled: Mapping[str, Ecdf], runs: int) -> None:
    """What the curves show_message in numbers, a row for each law; the name stands beside its line."""
    from matplotlib.lines import Line2D

    height = figure.get_figheight()
    heads = ["", *_heads("captured"), *(_heads("settled") if settled else [])]
    columns = _COLUMNS if settled else tuple(column + 0.15 for column in _COLUMNS[:4])
    for row, law in enumerate(["", *captured]):
        at = 1.0 - (below_headline(0) + (row + 0.5) * _ROW) / height
        if not law:
            for column, head in zip(columns, heads, strict=False):
                figure.text(column, at, head, va="center", fontsize=8.5, color=QUIET)
            continue
        style = look(law)
        sample = Line2D(
            [columns[0] - 0.045, columns[0] - 0.01], [at, at], color=style.colour, linestyle=style.dashes, linewidth=2.0,
            marker=style.marker, markevery=[1], markersize=5.5, transform=figure.transFigure, figure=figure,
        )  # fmt: skip
        figure.add_artist(sample)
        figure.text(columns[0], at, style.label, va="center", fontweight="bold", color=style.colour, parse_math=False)
        words = _texts(captured[law], runs) + (_texts(settled[law], runs) if law in settled else [])
        for column, word in zip(columns[1:], words, strict=False):
            figure.text(column, at, word, va="center", fontsize=9.0)


def _heads(event: str) -> list[str]:
    first, *others = [f"{100 * share:g} % by" for share in MARKED]
    return [f"{event}: {first}", *others, "never (95 % interval)"]


def _texts(curve: Ecdf, runs: int) -> list[str]:
    times = [time_of(curve, share) for share in MARKED]
    never = percent(Proportion.of(_never(curve, runs), runs))
    return [*("not reached" if time is None else f"{time:.1f} s" for time in times), never]
