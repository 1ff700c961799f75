"""Data of the figures: time series until and after capture, thinned to what can be seen, and the spans of time to show."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from detumble.flight import Flight

Array: TypeAlias = NDArray[np.float64]

MOST_POINTS = 4000
LARGEST = 1e100
"""What a diverged flight reaches beyond this is not plotted: axes cannot show it."""

_BEFORE_MERGE = ("position", "velocity", "chaser_attitude", "chaser_rate", "debris_attitude", "debris_rate")
_HELD = ("force", "force_command", "torque", "torque_command")
"""Held over the period that follows: the value at capture is already the stack's."""
_JUDGED = {"distance": "capture_distance", "angle_error": "capture_angle", "rate_error": "capture_rate"}
_JUDGED |= {"speed_error": "capture_speed"}


@dataclass(frozen=True)
class Span:
    """A span of time to plot, s.

    Attributes:
        end: it begins at 0.
        title: what to write above it; empty where there is only one.
    """

    end: float
    title: str


def capture_row(flight: Flight) -> int | None:
    """Give the row of the history at which capture was judged, or None."""
    time = flight.metrics.capture_time
    if time is None:
        return None
    row = int(np.searchsorted(flight.history["time"], time - 0.5 * flight.scenario.time.control_period))
    return min(row, len(flight.history["time"]) - 1)


def merged(flight: Flight) -> bool:
    """Tell whether the bodies became one, so that errors after capture are against LVLH."""
    return flight.metrics.capture_time is not None and flight.law != "none" and flight.scenario.capture.merge


def until_capture(flight: Flight, name: str, axis: int | None = None) -> tuple[Array, Array]:
    """Time, s, and a series up to and including capture, as it was before the merge; all of it without capture.

    Args:
        flight: what was flown.
        name: of the series.
        axis: component; None for a scalar.
    """
    time, values = flight.history["time"], _component(flight.history[name], axis)
    row = capture_row(flight)
    if row is None:
        return time, values
    values = values[: row + 1].copy()
    if name in _HELD:
        values[row] = values[max(row - 1, 0)]
    elif merged(flight):
        values[row] = _judged(flight, name, axis, float(values[row]))
    return time[: row + 1], values


def after_capture(flight: Flight, name: str, axis: int | None = None) -> tuple[Array, Array]:
    """Time, s, and a series from capture on, beginning with the state after the merge; empty without capture."""
    time, values = flight.history["time"], _component(flight.history[name], axis)
    row = capture_row(flight)
    return (time[:0], values[:0]) if row is None else (time[row:], values[row:])


def whole(flight: Flight, name: str, axis: int | None = None) -> tuple[Array, Array]:
    """Time, s, and a series with a gap at the merge, where its meaning or its value jumps."""
    if not merged(flight):
        return flight.history["time"], _component(flight.history[name], axis)
    (before, first), (after, second) = until_capture(flight, name, axis), after_capture(flight, name, axis)
    return np.concatenate((before, before[-1:], after)), np.concatenate((first, [np.nan], second))


def thinned(time: Array, values: Array, end: float = math.inf, most: int = MOST_POINTS) -> tuple[Array, Array]:
    """Cut a line at `end`, and if it is long keep the least and the greatest value of each of most/2 bins.

    Peaks and chattering stay where they are; a gap (NaN) may close. Values too large for an axis become gaps.

    Args:
        time: (n,) s, ascending.
        values: (n,) of any unit.
        end: s; one more point is kept, so that the line leaves the picture.
        most: points to keep.
    """
    stop = int(np.searchsorted(time, end, side="right")) + 1
    time, values = time[:stop], values[:stop]
    size = len(time)
    if size > most:
        each = math.ceil(size / (most // 2))
        whole_bins = size // each * each
        bins = np.nan_to_num(values[:whole_bins], nan=0.0).reshape(-1, each)
        starts = np.arange(0, whole_bins, each)
        ends = np.sort(np.stack((starts + bins.argmin(axis=1), starts + bins.argmax(axis=1)), axis=1), axis=1)
        kept = np.unique(np.concatenate((ends.ravel(), np.arange(whole_bins, size), [0, size - 1])))
        time, values = time[kept], values[kept]
    return time, np.where(np.abs(values) < LARGEST, values, np.nan)


def round_up(length: float) -> float:
    """Round a length of time up to a number that reads well: two digits, the second 0 or 5 above 2."""
    if length <= 0.0:
        return 1.0
    decade = 10.0 ** math.floor(math.log10(length))
    step = 0.1 * decade if length < 2.0 * decade else 0.5 * decade
    return float(f"{math.ceil(length / step - 1e-9) * step:.6g}")


def spans(ends: Sequence[float | None], longest: float, what: str) -> list[Span]:
    """Choose what to show of lines that end at very different times: all of them, and if it helps the early part alone.

    Args:
        ends: when each line ends, s; None for one that goes on.
        longest: length of the flight, s.
        what: names the whole.

    Returns:
        One span, or a short one before it.
    """
    known = sorted(end for end in ends if end is not None)
    last = longest if not known or len(known) < len(ends) else min(round_up(1.1 * known[-1]), longest)
    last = last if last > 0.0 else 1.0
    early = round_up(1.15 * known[len(known) // 2]) if known and known[0] > 0.0 else 0.0
    overall = Span(last, f"{what}, {last:g} s")
    return [Span(early, f"first {early:g} s"), overall] if 0.0 < 2.2 * early < last else [Span(last, "")]


def capture_times(flights: Mapping[str, Flight]) -> dict[str, float | None]:
    """Give the capture time of each flight, s."""
    return {law: flight.metrics.capture_time for law, flight in flights.items()}


def recorded_length(flight: Flight) -> float:
    """Length of what was recorded, s."""
    time = flight.history["time"]
    return float(time[-1]) if len(time) else 0.0


def _component(values: Array, axis: int | None) -> Array:
    return values if axis is None else values[:, axis]


def _judged(flight: Flight, name: str, axis: int | None, default: float) -> float:
    """Value at capture before the merge: the history holds the one after it."""
    if name in _JUDGED:
        value = getattr(flight.metrics, _JUDGED[name])
        return default if value is None else float(value)
    event = flight.event("captured")
    before = event.details.get("before") if event and name in _BEFORE_MERGE else None
    return float(before[name][axis]) if before and name in before and axis is not None else default
