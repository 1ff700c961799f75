"""Actuators and sensors."""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field

from detumble.scenario.quantity import Axes, Quantity
from detumble.scenario.rules import Place, Rule
from detumble.scenario.section import Section


def _limit(kind: str) -> Place:
    return Place(f"actuators.{kind}", Rule("unlimited"))


def _noise(sensor: str) -> Place:
    return Place(f"sensors.{sensor}")


class Actuators(Section):
    """Generators of force and torque, with limits and a gain that may be off."""

    force_limit: Annotated[
        Axes,
        Quantity("N", "limit per axis", place=_limit("force"), shape="axes", above=0.0, most=1e6, infinite=True),
    ]
    torque_limit: Annotated[
        Axes,
        Quantity("N m", "limit per axis", place=_limit("torque"), shape="axes", above=0.0, most=1e6, infinite=True),
    ]
    force_gain: Annotated[
        Axes,
        Quantity(
            "",
            "force given per force commanded, after the limit",
            place="actuators.force_gain",
            shape="axes",
            above=0.0,
            most=10.0,
        ),
    ] = 1.0
    torque_gain: Annotated[
        Axes,
        Quantity(
            "",
            "torque given per torque commanded, after the limit",
            place="actuators.torque_gain",
            shape="axes",
            above=0.0,
            most=10.0,
        ),
    ] = 1.0
    saturation: Literal["per_axis", "scaled"] = Field(
        "per_axis", description="each axis is clipped, or the whole vector is scaled until it fits"
    )

    @classmethod
    def unlimited(cls) -> Actuators:
        """Give actuators without limits."""
        return cls.model_construct(_fields_set=set(), force_limit=math.inf, torque_limit=math.inf)


class Sensors(Section):
    """Standard deviations of white Gaussian noise per axis, drawn anew at each control tick."""

    position_sigma: Annotated[
        float, Quantity("m", "relative position", place=_noise("position"), least=0.0, most=1e4)
    ] = 0.0
    velocity_sigma: Annotated[
        float, Quantity("m/s", "relative velocity", place=_noise("velocity"), least=0.0, most=1e3)
    ] = 0.0
    attitude_sigma: Annotated[
        float, Quantity("rad", "chaser attitude, small angle", place=_noise("attitude"), least=0.0, most=1.0)
    ] = 0.0
    rate_sigma: Annotated[float, Quantity("rad/s", "chaser rate", place=_noise("rate"), least=0.0, most=10.0)] = 0.0
