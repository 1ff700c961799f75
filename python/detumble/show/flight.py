"""One page of a single flight: errors, rates and commands over time, with thresholds, limits and events."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from detumble.show.axes import TIME_LABEL, plot_level, reach, set_symlog_beyond
from detumble.show.series import Array, merged, recorded_length, round_up, thinned, whole
from detumble.show.style import AXIS_LOOKS, LIMIT, heading, look, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from detumble.flight import Flight

SIZE = (11.7, 8.3)
"""Inches: a landscape page."""
MARGINS = {"left": 0.08, "right": 0.985, "bottom": 0.065, "top": 0.895, "wspace": 0.2, "hspace": 0.16}
"""Shares of the page; fixed, since a layout found by trial takes longer than the plotting."""

FARTHEST = 20.0
"""A limit this many times beyond what was reached is not plotted: it would flatten the rest."""


def plot_flight(flight: Flight) -> Figure:
    """Plot the page in memory, of any law, captured or not, diverged or not; call it within `styled()`."""
    figure = new_figure(*SIZE, layout=None)
    panels = figure.subplots(3, 2, sharex=True, gridspec_kw=MARGINS)
    end = shown_until(flight)
    panels[0, 0].set_xlim(0.0, end)
    _position(panels[0, 0], flight, end)
    _attitude(panels[0, 1], flight, end)
    _speed(panels[1, 0], flight, end)
    _rate(panels[1, 1], flight, end)
    axes = "axes as commanded" if flight.law == "none" else "LVLH axes"
    limits = flight.scenario.actuators
    _command(panels[2, 0], flight, end, "force", f"force, {axes} [N]", limits.force_limit)
    _command(panels[2, 1], flight, end, "torque", "torque, body axes [N m]", limits.torque_limit)
    for panel in panels.flat:
        panel.yaxis.set_label_coords(-0.135, 0.5)
        _mark_events(panel, flight, end)
        set_symlog_beyond(panel)
        panel.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=5, handlelength=2.4, borderaxespad=0.1)
    for panel in panels[-1]:
        panel.set_xlabel(TIME_LABEL)
        panel.xaxis.set_label_coords(0.5, -0.13)
    figure.suptitle(heading(flight.scenario.title), y=0.985, parse_math=False)
    style: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": 9.5, "color": "#404040"}
    figure.text(0.5, 0.94, _subtitle(flight, end), parse_math=False, **style)
    return figure


def shown_until(flight: Flight) -> float:
    """Choose the end of the time axis, s: all of the flight, unless it settled long before its end."""
    length = recorded_length(flight) or flight.scenario.time.duration
    settled = flight.event("settled")
    if settled is None or flight.law == "none":
        return length
    return min(length, round_up(max(1.5 * settled.time, 100.0 * flight.scenario.time.control_period)))


def _position(axes: Axes, flight: Flight, end: float) -> None:
    axes.set_ylabel("position error, LVLH axes [m]")
    goal = flight.history["goal_position"]
    _components(axes, flight, end, "position", goal)
    _norm(axes, flight, end, "distance", "distance")
    if flight.law != "none":
        _threshold(axes, flight, flight.scenario.capture.distance, None, end)


def _attitude(axes: Axes, flight: Flight, end: float) -> None:
    axes.set_ylabel("attitude error [°]")
    label = "against the debris, then LVLH" if merged(flight) else "against the debris"
    _norm(axes, flight, end, "angle_error", label, math.degrees(1.0))
    if flight.law != "none":
        _threshold(axes, flight, flight.scenario.capture.angle_deg, flight.scenario.settled.angle_deg, end)
    axes.set_ylim(bottom=0.0)


def _speed(axes: Axes, flight: Flight, end: float) -> None:
    axes.set_ylabel("velocity error, LVLH axes [m/s]")
    _components(axes, flight, end, "velocity", flight.history["goal_velocity"])
    _norm(axes, flight, end, "speed_error", "speed")
    limit = flight.scenario.capture.speed
    if limit is not None and flight.law != "none":
        _threshold(axes, flight, limit, None, end)


def _rate(axes: Axes, flight: Flight, end: float) -> None:
    axes.set_ylabel("angular rate, body axes [rad/s]")
    _components(axes, flight, end, "chaser_rate", None)
    _norm(axes, flight, end, "rate_error", "relative to debris, then LVLH" if merged(flight) else "relative to debris")
    if flight.law != "none":
        _threshold(axes, flight, flight.scenario.capture.rate, flight.scenario.settled.rate, end)


def _command(
    axes: Axes, flight: Flight, end: float, name: str, label: str, limit: float | tuple[float, float, float]
) -> None:
    axes.set_ylabel(label)
    for axis, component in enumerate(AXIS_LOOKS):
        line = thinned(flight.history["time"], flight.history[name][:, axis], end)
        axes.plot(*line, color=component.colour, linestyle=component.dashes, linewidth=1.2, label=component.label)
    largest = reach(axes)
    for bound in sorted(set(limit)) if isinstance(limit, tuple) else [limit]:
        if math.isfinite(bound) and bound <= FARTHEST * largest:
            plot_level(axes, [-bound, bound], f"limit {bound:g}", at=0.005)


def _components(axes: Axes, flight: Flight, end: float, name: str, reference: Array | None) -> None:
    for axis, component in enumerate(AXIS_LOOKS):
        time, values = whole(flight, name, axis)
        if reference is not None and len(time):
            values = values - np.interp(time, flight.history["time"], reference[:, axis])
        line = thinned(time, values, end)
        axes.plot(*line, color=component.colour, linestyle=component.dashes, linewidth=1.2, label=component.label)


def _norm(axes: Axes, flight: Flight, end: float, name: str, label: str, scale: float = 1.0) -> None:
    time, values = whole(flight, name)
    line = thinned(time, scale * values, end)
    axes.plot(*line, color=look(flight.law).colour, linewidth=1.8, label=label, zorder=2.5)


def _threshold(axes: Axes, flight: Flight, until: float, after: float | None, end: float) -> None:
    """Plot a threshold over the time it counts: that of capture until capture, that of settling from then on."""
    captured = flight.metrics.capture_time if merged(flight) else None
    size = reach(axes)
    change = end if captured is None else min(captured, end)
    if until <= FARTHEST * size:
        axes.plot([0.0, change], [until, until], **LIMIT, label="threshold")
    if after is not None and captured is not None and after <= FARTHEST * size:
        axes.plot([change, end], [after, after], **LIMIT)


def _mark_events(axes: Axes, flight: Flight, end: float) -> None:
    looks = {"captured": "-", "settled": (0, (5.0, 2.0))}
    for event in flight.events:
        if event.time <= end:
            dashes = looks.get(event.name, (0, (1.0, 1.0)))
            axes.axvline(event.time, color=look(flight.law).colour, linestyle=dashes, linewidth=1.0, alpha=0.8)


def _subtitle(flight: Flight, end: float) -> str:
    metrics, parts = flight.metrics, [f"{look(flight.law).label}, seed {flight.seed}"]
    if metrics.capture_time is not None:
        parts.append(f"captured at {metrics.capture_time:.1f} s (line)")
    elif flight.law != "none" and not flight.broken_off:
        parts.append("not captured")
    if metrics.settling_time is not None:
        parts.append(f"settled {metrics.settling_time:.1f} s later (dashed)")
    elif merged(flight) and not flight.broken_off:
        parts.append("not settled")
    if metrics.diverged_time is not None:
        parts.append(f"diverged at {metrics.diverged_time:.4g} s")
    elif flight.broken_off:
        parts.append(f"broken off at {flight.events[-1].time:.4g} s: no gains")
    if metrics.delta_v is not None and metrics.delta_v < 1e6:
        parts.append(f"Δv {metrics.delta_v:.3f} m/s")
    if end < recorded_length(flight):
        parts.append(f"flight of {recorded_length(flight):g} s, shown to {end:g} s")
    return "   ·   ".join(parts)
