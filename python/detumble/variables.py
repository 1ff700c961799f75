"""The time series of a flight: name, unit and meaning of each, as the core has them and in its order."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from detumble.compiled import register

AXES = ("x", "y", "z")
COMPONENTS = ("q0", "q1", "q2", "q3")

Across = Literal["", "axis", "quaternion"]
_ACROSS: dict[int, Across] = {1: "", 3: "axis", 4: "quaternion"}


@dataclass(frozen=True)
class Variable:
    """One time series.

    Attributes:
        name: in the dataset and in the core's history.
        unit: SI; `1` for pure numbers.
        meaning: with its frame.
        across: what the second dimension is: nothing, the three axes, or the quaternion's components.
    """

    name: str
    unit: str
    meaning: str
    across: Across


VARIABLES = tuple(
    Variable(name, unit, meaning, _ACROSS[width])
    for name, width, unit, meaning in register()["series"]
    if name != "time"
)
