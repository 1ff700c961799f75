"""What a flight is judged by. Name, label, unit and definition of each metric are the core's: this is its register for Python.

Commands are held from tick to tick, so integrals over the commands are exact sums.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, Literal

from detumble.compiled import register

if TYPE_CHECKING:
    from collections.abc import Mapping

    from detumble.scenario.quantity import Vector

Value = float | tuple[float, float, float] | None

_SUFFIX = {"": "", "m/s": "_m_s", "N s": "_n_s", "N m s": "_n_m_s", "N/s": "_n_per_s", "N m/s": "_n_m_per_s"}
_SUFFIX |= {"s": "_s", "m": "_m", "rad": "_rad", "rad/s": "_rad_s", "N": "_n", "N m": "_n_m"}


@dataclass(frozen=True)
class Metric:
    """What one metric is.

    Attributes:
        name: attribute of `Metrics`.
        label: for tables.
        unit: SI; empty for shares.
        definition: what exactly is counted.
        kind: a number, a whole number, or a number for each axis.
    """

    name: str
    label: str
    unit: str
    definition: str
    kind: Literal["number", "whole", "axes"]

    @property
    def key(self) -> str:
        """Name in JSON, unit included: `capture_time_s`."""
        return self.name + _SUFFIX[self.unit]


METRICS = tuple(Metric(*row) for row in register()["metrics"])
"""The register, in the order of tables and files."""


@dataclass(frozen=True)
class Metrics:
    """Metrics of one flight, in SI units as `METRICS` describes them; None for what did not happen."""

    capture_time: float | None = None
    capture_tick: int | None = None
    capture_distance: float | None = None
    capture_angle: float | None = None
    capture_rate: float | None = None
    capture_speed: float | None = None
    settling_time: float | None = None
    settled_tick: int | None = None
    final_rate: float | None = None
    final_pointing: float | None = None
    momentum_at_capture: float | None = None
    final_momentum: float | None = None
    delta_v: float | None = None
    delta_v_axes: Vector | None = None
    delta_v_to_capture: float | None = None
    impulse: float | None = None
    impulse_axes: Vector | None = None
    torque_impulse: float | None = None
    torque_impulse_axes: Vector | None = None
    peak_force_command: float | None = None
    peak_force: float | None = None
    peak_torque_command: float | None = None
    peak_torque: float | None = None
    force_saturated_share: float | None = None
    torque_saturated_share: float | None = None
    force_chattering: float | None = None
    torque_chattering: float | None = None
    largest_rate: float | None = None
    diverged_time: float | None = None

    @classmethod
    def from_summary(cls, summary: Mapping[str, Any]) -> Metrics:
        """Take the metrics from the core's summary, where NaN stands for what did not happen."""
        values: dict[str, Any] = {metric.name: _value(summary[metric.name], metric) for metric in METRICS}
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


if [field.name for field in fields(Metrics)] != [metric.name for metric in METRICS]:
    raise ImportError(
        "detumble.metrics and the compiled core name different metrics; `make setup` builds the core anew"
    )


def _value(raw: Any, metric: Metric) -> Value:
    if metric.kind == "axes":
        return None if any(map(math.isnan, raw)) else (raw[0], raw[1], raw[2])
    return None if math.isnan(raw) else int(raw) if metric.kind == "whole" else float(raw)


def _jsonable(value: Value) -> Any:
    if isinstance(value, tuple):
        return [_jsonable(element) for element in value]
    return value if value is None or math.isfinite(value) else None
