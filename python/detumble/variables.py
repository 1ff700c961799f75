"""The time series of a flight: name, unit and meaning of each, in the core's order."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

AXES = ("x", "y", "z")
COMPONENTS = ("q0", "q1", "q2", "q3")


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
    across: Literal["", "axis", "quaternion"] = "axis"


VARIABLES = (
    Variable("position", "m", "chaser relative to the debris' orbit in H; the stack's centre of mass after capture"),
    Variable("velocity", "m/s", "rate of change of position as seen in the turning H"),
    Variable("chaser_attitude", "1", "quaternion C -> N, scalar first; the stack's after capture", "quaternion"),
    Variable("chaser_rate", "rad/s", "omega_CN_C; the stack's after capture"),
    Variable("debris_attitude", "1", "quaternion D -> N, scalar first; fixed in the stack after capture", "quaternion"),
    Variable("debris_rate", "rad/s", "omega_DN_D; that of the stack after capture"),
    Variable("goal_position", "m", "r_des in H"),
    Variable("goal_velocity", "m/s", "v_des in H"),
    Variable("force_command", "N", "force asked for, in H (open loop in body axes: in C)"),
    Variable("force", "N", "force applied, after saturation, same axes"),
    Variable("torque_command", "N m", "torque asked for, in C (open loop in LVLH: in H)"),
    Variable("torque", "N m", "torque applied, after saturation, same axes"),
    Variable("distance", "m", "distance from the goal as capture judges it", ""),
    Variable("angle_error", "rad", "attitude error against the debris, after capture against H", ""),
    Variable("rate_error", "rad/s", "norm of the relative rate, after capture against H", ""),
    Variable("speed_error", "m/s", "norm of v - v_des", ""),
    Variable("captured", "1", "1 from the tick of capture on", ""),
)
