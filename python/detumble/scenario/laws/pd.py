"""Proportional-derivative control."""

from __future__ import annotations

from typing import Annotated

from detumble.scenario.laws.base import Channel, Gain, Law, TwoForms
from detumble.scenario.quantity import Axes


class PdTranslation(Channel):
    """U = -kp e_r - kd e_v."""

    kp: Annotated[
        Axes, Gain("N/m", "force per position error", lambda c: c.mass * c.acceleration / c.length, symbol="K_p")
    ]
    kd: Annotated[Axes, Gain("N s/m", "force per velocity error", lambda c: c.mass / c.time, symbol="K_d")]


class PdRotation(Channel):
    """tau = -kp eps - kd w."""

    kp: Annotated[
        Axes,
        Gain("N m", "torque per vector part of the error quaternion", lambda c: c.mass * c.acceleration, symbol="K_p"),
    ]
    kd: Annotated[Axes, Gain("N m s/rad", "torque per angular rate", lambda c: c.mass / c.time, symbol="K_d")]


class Pd(Law[PdTranslation, PdRotation], TwoForms):
    """Proportional-derivative control."""

    title = "PD"
    colour = "#000000"
    dashes = (0, (1.2, 1.2))
    marker = "s"
