"""Figure 8: rates and pointing of the stack after capture, which the paper describes and does not show."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from detumble.show.approach import WIDTH, first
from detumble.show.axes import law_legend, plot_level, plot_line, time_panels, time_text
from detumble.show.series import LARGEST, Array, after_capture, merged, recorded_length, spans
from detumble.show.style import look

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from detumble.flight import Flight


def stack_after_capture(flights: Mapping[str, Flight]) -> Figure:
    """Figure 8: rate and pointing error of the stack against LVLH since capture, with thresholds and settling times."""
    settled = first(flights).scenario.settled
    stacks = {law: flight for law, flight in flights.items() if merged(flight)}
    left = [recorded_length(flight) - (flight.metrics.capture_time or 0.0) for flight in stacks.values()]
    shown = spans([flight.metrics.settling_time for flight in stacks.values()], max(left, default=1.0), "whole")
    labels = ["stack rate relative to LVLH [rad/s]", "pointing error against LVLH [°]"]
    figure, panels = time_panels(shown, labels, (WIDTH, 6.6), "time since capture [s]")
    quantities = (
        ("rate_error", 1.0, settled.rate, f"settled below {settled.rate:g} rad/s"),
        ("angle_error", math.degrees(1.0), settled.angle_deg, f"settled below {settled.angle_deg:g}°"),
    )
    for row, (name, scale, level, text) in zip(panels, quantities, strict=True):
        for axes, span in zip(row, shown, strict=True):
            for law, flight in stacks.items():
                time, values = after_capture(flight, name)
                since = time - (flight.metrics.capture_time or 0.0)
                plot_line(axes, law, (since, scale * values), span.end)
                _mark_settling(axes, law, flight, since, scale * values, span.end)
            plot_level(axes, [level], text if axes is row[-1] else "")
        _set_log_scale(row[0], level, [scale * after_capture(flight, name)[1] for flight in stacks.values()])
    ends = {law: time_text(flight.metrics.settling_time, flight) for law, flight in flights.items()}
    law_legend(figure, flights, ends, "law, settled after capture within")
    return figure


def _mark_settling(axes: Axes, law: str, flight: Flight, since: Array, values: Array, end: float) -> None:
    time = flight.metrics.settling_time
    if time is None or not len(since) or time > end:
        return
    style = look(law)
    row = min(int(np.searchsorted(since, time - 1e-6)), len(values) - 1)
    axes.axvline(time, color=style.colour, linestyle=style.dashes, linewidth=0.9, alpha=0.6, zorder=1.6)
    axes.plot(
        since[row], values[row], style.marker, color=style.colour, markersize=5.5, markeredgecolor="white",
        markeredgewidth=0.8, zorder=3.0,
    )  # fmt: skip


def _set_log_scale(axes: Axes, level: float, plotted: Sequence[Array]) -> None:
    """Count decades, from a hundredth of the threshold to a little above the largest value."""
    values = np.concatenate([[level], *plotted])
    values = values[(values > 0.0) & (values < LARGEST)]
    axes.set_yscale("log")
    axes.set_ylim(max(float(values.min()) / 1.5, 1e-2 * level), 2.0 * float(values.max()))
