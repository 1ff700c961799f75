"""What a flight is judged by: one definition, unit and name for each metric, used by Python, tables and files alike.

Commands are held from tick to tick, so integrals over the commands are exact sums. The core computes; this is the register.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

    from detumble.scenario.quantity import Vector

Value = float | tuple[float, float, float] | None

_SUFFIX = {"": "", "m/s": "_m_s", "N s": "_n_s", "N m s": "_n_m_s", "N/s": "_n_per_s", "N m/s": "_n_m_per_s"}
_SUFFIX |= {"s": "_s", "m": "_m", "rad": "_rad", "rad/s": "_rad_s", "N": "_n", "N m": "_n_m"}


@dataclass(frozen=True)
class Metric:
    """One metric's card.

    Attributes:
        name: attribute of `Metrics`.
        label: for tables.
        unit: SI; empty for shares.
        definition: what exactly is counted.
        source: key of the core's summary.
        total: the sum over the axes of that key, not the key itself.
        whole: a whole number.
    """

    name: str
    label: str
    unit: str
    definition: str
    source: str
    total: bool
    whole: bool

    @property
    def key(self) -> str:
        """Name in JSON, unit included: `capture_time_s`."""
        return self.name + _SUFFIX[self.unit]


def _metric(
    label: str, unit: str, definition: str, source: str = "", *, total: bool = False, whole: bool = False
) -> Any:
    card = {"label": label, "unit": unit, "definition": definition, "source": source, "total": total, "whole": whole}
    return field(default=None, metadata=card)


@dataclass(frozen=True)
class Metrics:
    """Metrics of one flight; None for what did not happen."""

    capture_time: float | None = _metric(
        "capture", "s", "first control tick at which every threshold has held for the dwell time"
    )
    capture_tick: int | None = _metric("capture tick", "", "number of that tick, counted from 0", whole=True)
    capture_distance: float | None = _metric("distance at capture", "m", "distance judged, before the merge")
    capture_angle: float | None = _metric("attitude error at capture", "rad", "angle between chaser and debris axes")
    capture_rate: float | None = _metric("relative rate at capture", "rad/s", "norm of w_C - R w_D")
    capture_speed: float | None = _metric("relative speed at capture", "m/s", "norm of v - v_des in H")
    settling_time: float | None = _metric(
        "settling", "s", "from capture to the tick from which angle and rate against H hold to the end of the flight"
    )
    settled_tick: int | None = _metric(
        "settled tick", "", "number of the tick from which they hold, counted from the start of the flight", whole=True
    )
    final_rate: float | None = _metric("final rate", "rad/s", "norm of the stack's rate relative to H at the end")
    final_pointing: float | None = _metric(
        "final pointing error", "rad", "angle of the stack's axes against H at the end"
    )
    momentum_at_capture: float | None = _metric(
        "momentum at capture", "N m s", "norm of the stack's angular momentum about its centre of mass after the merge"
    )
    final_momentum: float | None = _metric("final momentum", "N m s", "the same at the end of the flight")
    delta_v: float | None = _metric(
        "Δv", "m/s", "sum over axes of the integral of |F_i| / m, m the true mass of what flies", total=True
    )
    delta_v_axes: Vector | None = _metric("Δv by axis", "m/s", "integral of |F_i| / m", "delta_v")
    delta_v_to_capture: float | None = _metric("Δv to capture", "m/s", "the part of Δv spent until capture", total=True)
    impulse: float | None = _metric("impulse", "N s", "sum over axes of the integral of |F_i|", total=True)
    impulse_axes: Vector | None = _metric("impulse by axis", "N s", "integral of |F_i|", "impulse")
    torque_impulse: float | None = _metric(
        "torque impulse", "N m s", "sum over axes of the integral of |tau_i|", total=True
    )
    torque_impulse_axes: Vector | None = _metric(
        "torque impulse by axis", "N m s", "integral of |tau_i|", "torque_impulse"
    )
    peak_force_command: float | None = _metric("peak force asked", "N", "largest |F_i| before saturation")
    peak_force: float | None = _metric("peak force", "N", "largest |F_i| flown")
    peak_torque_command: float | None = _metric("peak torque asked", "N m", "largest |tau_i| before saturation")
    peak_torque: float | None = _metric("peak torque", "N m", "largest |tau_i| flown")
    force_saturated_share: float | None = _metric(
        "force saturated", "", "share of the time with a force command over its limit on any axis"
    )
    torque_saturated_share: float | None = _metric(
        "torque saturated", "", "share of the time with a torque command over its limit on any axis"
    )
    force_chattering: float | None = _metric(
        "force chattering", "N/s", "total variation of the force asked for, summed over axes, per second"
    )
    torque_chattering: float | None = _metric(
        "torque chattering", "N m/s", "total variation of the torque asked for, summed over axes, per second"
    )
    largest_rate: float | None = _metric(
        "largest rate",
        "rad/s",
        "largest norm of omega at a control tick: of chaser and stack, and of debris whose tumble is integrated step by step",
    )
    diverged_time: float | None = _metric("diverged", "s", "first tick whose state left the numbers")

    @classmethod
    def from_summary(cls, summary: Mapping[str, Any]) -> Metrics:
        """Take the metrics from the core's summary, where NaN stands for what did not happen."""
        values: dict[str, Any] = {metric.name: _value(summary[metric.source], metric) for metric in METRICS}
        return cls(**values)

    def to_json(self) -> dict[str, Value]:
        """Give the metrics under their names with units, as JSON takes them: numbers, lists, None."""
        return {metric.key: _jsonable(getattr(self, metric.name)) for metric in METRICS}

    @classmethod
    def from_json(cls, stored: Mapping[str, Any]) -> Metrics:
        """Undo `to_json`."""
        found = {metric.name: stored.get(metric.key) for metric in METRICS}
        values: dict[str, Any] = {
            name: tuple(value) if isinstance(value, list) else value for name, value in found.items()
        }
        return cls(**values)


METRICS: tuple[Metric, ...] = tuple(
    Metric(
        name=entry.name,
        label=entry.metadata["label"],
        unit=entry.metadata["unit"],
        definition=entry.metadata["definition"],
        source=entry.metadata["source"] or entry.name,
        total=entry.metadata["total"],
        whole=entry.metadata["whole"],
    )
    for entry in fields(Metrics)
)
"""The register, in the order of tables and files."""


def _value(raw: Any, metric: Metric) -> Value:
    if isinstance(raw, float | int):
        return None if math.isnan(raw) else int(raw) if metric.whole else float(raw)
    numbers = tuple(float(number) for number in raw)
    if any(math.isnan(number) for number in numbers):
        return None
    return sum(numbers) if metric.total else (numbers[0], numbers[1], numbers[2])


def _jsonable(value: Value) -> Any:
    if isinstance(value, tuple):
        return [_jsonable(element) for element in value]
    return value if value is None or math.isfinite(value) else None
