"""Figure 9: the case on one slide.

Above, by law: capture time (published, ours, and the minimum no controller can beat), propellant, settling. Below: the
path in the LVLH plane in which most of it happens (pale after capture), and what capture waited for: distance and attitude.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from detumble.scenario.paper import PUBLISHED_CAPTURE_TIMES
from detumble.show.approach import first
from detumble.show.axes import TIME_LABEL, plot_captures, plot_laws, plot_level, set_log_time, set_symlog_beyond
from detumble.show.series import (
    LARGEST,
    MOST_POINTS,
    Array,
    Span,
    after_capture,
    capture_times,
    recorded_length,
    round_up,
    until_capture,
)
from detumble.show.style import LIMIT, heading, look, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from detumble.flight import Flight

PLANES = ((1, 0), (1, 2), (2, 0))
"""Horizontal and vertical axis of the projections to choose from: along-track to the right, radial upwards."""
NAMES = ("radial x", "along-track y", "cross-track z")


def summary(flights: Mapping[str, Flight], minimum_time: float) -> Figure:
    """Plot figure 9.

    Args:
        flights: of one scenario, by law.
        minimum_time: before that no controller can capture, s; inf where none can at all.
    """
    figure = new_figure(13.33, 7.5)
    halves = figure.subfigures(2, 1, squeeze=False, height_ratios=(1.0, 1.25))
    above = halves[0, 0].subplots(1, 3, width_ratios=(2.0, 1.0, 1.0), sharey=True)
    below = halves[1, 0].subplots(1, 3)
    scenario = first(flights).scenario
    figure.suptitle(heading(scenario.title), parse_math=False)
    _captures(above[0], flights, minimum_time)
    _bars(above[1], flights, "Δv to capture [m/s]", lambda flight: flight.metrics.delta_v_to_capture, ".3f")
    _bars(above[2], flights, "settling after capture [s]", lambda flight: flight.metrics.settling_time, ".1f")
    _plane(below[0], flights)
    _approach(below[1], flights, "distance", 1.0)
    below[1].set_ylabel("distance from the goal [m]")
    plot_level(below[1], [scenario.capture.distance], f"capture below {scenario.capture.distance:g} m", at=0.005)
    _approach(below[2], flights, "angle_error", math.degrees(1.0))
    below[2].set_ylabel("attitude error against the debris [°]")
    plot_level(below[2], [scenario.capture.angle_deg], f"capture below {scenario.capture.angle_deg:g}°", at=0.005)
    return figure


def _captures(axes: Axes, flights: Mapping[str, Flight], minimum_time: float) -> None:
    """Capture times on a log axis: published, ours, minimum."""
    times = capture_times(flights)
    known = [time for time in (*times.values(), minimum_time) if time and math.isfinite(time)]
    known += [PUBLISHED_CAPTURE_TIMES[law] for law in flights if law in PUBLISHED_CAPTURE_TIMES]
    least, most = min(known, default=1.0), max(known, default=10.0)
    set_log_time(axes, 0.6 * least, 9.0 * most)
    _name_rows(axes, flights)
    for row, (law, time) in enumerate(times.items()):
        style, published = look(law), PUBLISHED_CAPTURE_TIMES.get(law)
        words = "not captured" if time is None else f"{time:.1f} s"
        if published is not None:
            axes.plot(published, row, "D", markersize=12, color="none", markeredgecolor="#404040", markeredgewidth=1.1)
            words += f"  (published {published:.1f} s)"
        if time:
            axes.plot([0.6 * least, time], [row, row], color=style.colour, linewidth=2.5, alpha=0.5, zorder=1.9)
            axes.plot(time, row, style.marker, markersize=7, color=style.colour, zorder=3.0)
        at = max(value for value in (time, published, least) if value)
        axes.annotate(words, (at, row), xytext=(11.0, 0.0), textcoords="offset points", va="center", fontsize=8.5)
    if math.isfinite(minimum_time) and minimum_time > 0.0:
        axes.axvspan(0.6 * least, minimum_time, color="#E4E4E4", zorder=0.5, linewidth=0.0)
        axes.axvline(minimum_time, **LIMIT)
    bound = (
        f"grey: before {minimum_time:.1f} s no controller can capture"
        if math.isfinite(minimum_time)
        else "no controller can capture"
    )
    axes.set_title(f"filled: ours; diamond: published; {bound}", color="#404040")
    axes.set_xlabel("capture time [s]")


def _bars(
    axes: Axes, flights: Mapping[str, Flight], label: str, value: Callable[[Flight], float | None], form: str
) -> None:
    _name_rows(axes, flights)
    values = {law: value(flight) for law, flight in flights.items()}
    most = max((number for number in values.values() if number is not None), default=0.0)
    most = most if 0.0 < most < 1e12 else 1.0
    for row, (law, number) in enumerate(values.items()):
        shown = min(number or 0.0, most)
        axes.barh(row, shown, height=0.55, color=look(law).colour, zorder=2.0)
        text = "–" if number is None else format(number, form if number < 1e6 else ".1e")
        axes.annotate(text, (shown, row), xytext=(4.0, 0.0), textcoords="offset points", va="center", fontsize=8.5)
    axes.set_xlim(0.0, 1.25 * most)
    axes.set_xlabel(label)


def _name_rows(axes: Axes, flights: Mapping[str, Flight]) -> None:
    axes.set_ylim(len(flights) - 0.5, -0.5)
    axes.set_yticks(range(len(flights)), [look(law).label for law in flights])
    for text, law in zip(axes.get_yticklabels(), flights, strict=False):
        text.set_parse_math(False)
        text.set_color(look(law).colour)
        text.set_fontweight("bold")
    axes.tick_params(axis="y", length=0.0)
    axes.grid(visible=False, axis="y")


def _plane(axes: Axes, flights: Mapping[str, Flight]) -> None:
    """Paths until capture in the plane they stretch over most, with the capture sphere."""
    paths = {
        law: np.stack([until_capture(flight, "position", axis)[1] for axis in range(3)])
        for law, flight in flights.items()
    }
    scenario = first(flights).scenario
    goals = first(flights).history["goal_position"]
    goal = goals[0] if len(goals) and not np.ptp(goals, axis=0).any() else None
    marks = [np.zeros((3, 1))] + ([] if goal is None else [goal[:, None]])
    stretch = np.ptp(np.concatenate([*paths.values(), *marks], axis=1), axis=1)
    stretch = np.minimum(stretch, LARGEST**0.4)
    across, up = max(PLANES, key=lambda plane: stretch[plane[0]] * stretch[plane[1]])
    for law, path in paths.items():
        _path(axes, law, path[across], path[up])
        later = [after_capture(flights[law], "position", axis)[1] for axis in (across, up)]
        _path(axes, law, later[0], later[1], linewidth=0.8, alpha=0.5, zorder=1.8)
        if flights[law].metrics.capture_time is not None:
            axes.plot(*path[[across, up], -1], look(law).marker, color=look(law).colour, markersize=5.5, zorder=3.0)
    axes.plot(0.0, 0.0, "*", color="#404040", markersize=11, label="debris")
    if goal is not None:
        axes.plot(goal[across], goal[up], "X", color="#404040", markersize=7, label="goal")
    centre = np.zeros(3) if scenario.capture.distance_from == "debris" else goal
    if centre is not None:
        from matplotlib.patches import Circle

        radius = scenario.capture.distance
        label = f"capture sphere, {radius:g} m"
        axes.add_patch(Circle((centre[across], centre[up]), radius, color="#EDEDED", zorder=0.5, label=label))
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.08)
    axes.set_xlabel(f"{NAMES[across]} (LVLH) [m]")
    axes.set_ylabel(f"{NAMES[up]} (LVLH) [m]")
    axes.legend(loc="best", handlelength=1.5)


def _path(axes: Axes, law: str, across: Array, up: Array, **changes: Any) -> None:
    """Plot a path in a plane, thinned evenly."""
    every = max(1, len(across) // MOST_POINTS)
    style = look(law)
    across, up = (np.where(np.abs(part[::every]) < LARGEST, part[::every], np.nan) for part in (across, up))
    axes.plot(across, up, **({"color": style.colour, "linestyle": style.dashes} | changes))


def _approach(axes: Axes, flights: Mapping[str, Flight], name: str, scale: float) -> None:
    """A series until capture over the logarithm of time."""
    times = [time for time in capture_times(flights).values() if time]
    last = max(recorded_length(flight) for flight in flights.values())
    last = last if len(times) < len(flights) or not times else min(last, round_up(1.2 * max(times)))
    start = min(1.0, 0.1 * min(times, default=10.0))
    set_log_time(axes, start, max(last, 10.0 * start))
    plot_laws([axes], [Span(last, "")], flights, name, scale=scale)
    plot_captures([axes], flights)
    if name == "angle_error":
        axes.set_ylim(bottom=0.0)
    set_symlog_beyond(axes)
    axes.set_xlabel(TIME_LABEL)
