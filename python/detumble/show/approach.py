"""Figures 1 to 7 of the paper: the approach under each law, until capture.

Capture times differ widely, so an early part is shown beside the whole where that helps. Lines are thin and pale after
capture, where the law controls the stack; figures 3 and 5 end there, as the paper's do.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from detumble.show.axes import (
    Panels,
    captured_at,
    law_legend,
    plot_captures,
    plot_laws,
    plot_level,
    plot_line,
    set_symlog_beyond,
    time_panels,
)
from detumble.show.series import Span, capture_times, recorded_length, spans, thinned, until_capture
from detumble.show.style import AXIS_LOOKS, look

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from detumble.flight import Flight

WIDTH = 9.5
"""Inches, of every figure."""


def relative_position_x(flights: Mapping[str, Flight]) -> Figure:
    """Figure 1: radial position of the chaser relative to the debris, with the goal."""
    shown = approach_spans(flights)
    figure, panels = time_panels(shown, ["relative position x (radial, LVLH) [m]"], (WIDTH, 4.2))
    plot_laws(panels[0], shown, flights, "position", 0, faint_after=True)
    goal = first(flights).history["goal_position"]
    if len(goal) and not np.ptp(goal[:, 0]):
        for axes in panels[0]:
            plot_level(axes, [float(goal[0, 0])], "goal" if axes is panels[0][0] else "", at=0.005)
    return _finished(figure, panels, flights)


def relative_velocity_x(flights: Mapping[str, Flight]) -> Figure:
    """Figure 2: radial relative velocity."""
    shown = approach_spans(flights)
    figure, panels = time_panels(shown, ["relative velocity x (radial, LVLH) [m/s]"], (WIDTH, 4.2))
    plot_laws(panels[0], shown, flights, "velocity", 0, faint_after=True)
    return _finished(figure, panels, flights)


def chaser_rate(flights: Mapping[str, Flight]) -> Figure:
    """Figure 3: angular velocity of the chaser in its body axes, until capture."""
    shown = approach_spans(flights)
    labels = [f"chaser rate $\\omega_{axis}$ [rad/s]" for axis in "xyz"]
    figure, panels = time_panels(shown, labels, (WIDTH, 7.2))
    for axis, row in enumerate(panels):
        plot_laws(row, shown, flights, "chaser_rate", axis)
    return _finished(figure, panels, flights)


def debris_rate(flights: Mapping[str, Flight]) -> Figure:
    """Figure 4: angular velocity of the debris in its body axes; torque-free, so the same under every law."""
    last = max(flights.values(), key=lambda flight: (flight.metrics.capture_time or math.inf, recorded_length(flight)))
    shown = approach_spans(flights)[-1:]
    shown = [Span(shown[0].end, "torque-free: the same under every law until it captures")]
    figure, panels = time_panels(shown, ["debris rate (body axes) [rad/s]"], (WIDTH, 4.2), right=1.75)
    axes = panels[0][0]
    for axis, component in enumerate(AXIS_LOOKS):
        line = thinned(*until_capture(last, "debris_rate", axis), shown[0].end)
        label = f"$\\omega_{component.label}$"
        axes.plot(*line, color=component.colour, linestyle=component.dashes, linewidth=2.0, label=label)
    size = np.linalg.norm(last.history["debris_rate"], axis=1)
    rows = len(until_capture(last, "angle_error")[0])
    norm = thinned(last.history["time"][:rows], size[:rows], shown[0].end)
    axes.plot(*norm, color="#9A9A9A", linewidth=1.2, label="norm")
    degrees = axes.secondary_yaxis("right", functions=(np.degrees, np.radians))
    degrees.set_ylabel("debris rate [°/s]")
    figure.legend(*axes.get_legend_handles_labels(), loc="center right")
    return _finished(figure, panels, flights)


def attitude_error(flights: Mapping[str, Flight]) -> Figure:
    """Figure 5: angle between the chaser's axes and the debris', until capture, with the threshold."""
    shown = approach_spans(flights)
    figure, panels = time_panels(shown, ["attitude error against the debris [°]"], (WIDTH, 4.2))
    plot_laws(panels[0], shown, flights, "angle_error", scale=math.degrees(1.0))
    limit = first(flights).scenario.capture.angle_deg
    for axes in panels[0]:
        plot_level(axes, [limit], f"capture below {limit:g}°" if axes is panels[0][-1] else "")
        axes.set_ylim(bottom=0.0)
    return _finished(figure, panels, flights)


def force_x(flights: Mapping[str, Flight]) -> Figure:
    """Figure 6: radial force given, with its saturation; a row for each law, since commands chatter over each other."""
    limit = _first_axis(first(flights).scenario.actuators.force_limit)
    return _command(flights, "force", limit, "Fx", "N", "radial force Fx, LVLH axes")


def torque_x(flights: Mapping[str, Flight]) -> Figure:
    """Figure 7: torque applied about the body x axis, with its saturation; a row for each law."""
    limit = _first_axis(first(flights).scenario.actuators.torque_limit)
    return _command(flights, "torque", limit, "τx", "N m", "torque τx, body axes")


def approach_spans(flights: Mapping[str, Flight]) -> list[Span]:
    """Choose the spans of time that show every law's approach to its capture."""
    times = capture_times(flights)
    return spans(list(times.values()), max(recorded_length(flight) for flight in flights.values()), "whole approach")


def first(flights: Mapping[str, Flight]) -> Flight:
    """Give a flight to read the common scenario from."""
    return next(iter(flights.values()))


def _command(flights: Mapping[str, Flight], name: str, limit: float, symbol: str, unit: str, quantity: str) -> Figure:
    from matplotlib.ticker import NullLocator

    shown = approach_spans(flights)
    height = 1.5 + 1.25 * len(flights)
    figure, panels = time_panels(
        shown, [f"{look(law).label}\n{symbol} [{unit}]" for law in flights], (WIDTH, height), above=0.9
    )
    for row, (law, flight) in zip(panels, flights.items(), strict=True):
        plot_laws(row, shown, {law: flight}, name, 0, faint_after=True, dotted_end=False)
        for axes, span in zip(row, shown, strict=True):
            asked = until_capture(flight, f"{name}_command", 0)
            plot_line(axes, law, asked, span.end, linewidth=0.7, linestyle=(0, (1.0, 1.5)), alpha=0.6, zorder=1.7)
            plot_level(axes, [limit, -limit])
        row[0].yaxis.label.set_color(look(law).colour)
        row[0].yaxis.label.set_parse_math(False)
        if math.isfinite(limit):
            row[0].set_yscale("symlog", linthresh=0.01 * limit, linscale=0.5)
            row[0].set_ylim(-2.5 * limit, 2.5 * limit)
            row[0].set_yticks([-limit, -0.1 * limit, 0.0, 0.1 * limit, limit])
            row[0].yaxis.set_major_formatter(lambda value, _: f"{value:g}".replace("-", "−"))
            row[0].yaxis.set_minor_locator(NullLocator())
        plot_captures(row, {law: flight})
        set_symlog_beyond(row[0])
    scale = " (linear within 1 % of the limit, logarithmic beyond)" if math.isfinite(limit) else ""
    notes = f"{quantity}{scale}\ndashed: limit; dotted: asked for; pale: the stack, after capture at"
    law_legend(figure, flights, captured_at(flights), notes)
    return figure


def _first_axis(limit: float | tuple[float, float, float]) -> float:
    return limit[0] if isinstance(limit, tuple) else limit


def _finished(figure: Figure, panels: Panels, flights: Mapping[str, Flight]) -> Figure:
    for row in panels:
        plot_captures(row, flights)
        set_symlog_beyond(row[0])
    law_legend(figure, flights, captured_at(flights), "law, captured at")
    return figure
