"""What acts on the bodies besides their actuators. Without the table nothing does."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from detumble.scenario.quantity import Quantity, Switch, Vector
from detumble.scenario.rules import Place, Rule
from detumble.scenario.section import Section

_ZERO: Vector = (0.0, 0.0, 0.0)


def _load(body: str, what: Literal["force", "torque"]) -> Quantity:
    place = Place(f"disturbances.constant.{body}_{what}", Rule("zeros"))
    unit, where = ("N", " at its centre of mass") if what == "force" else ("N m", "")
    return Quantity(unit, f"{what} on the {body}{where}", shape="vector", place=place, least=-1e6, most=1e6)


class ConstantLoads(Section):
    """Forces and torques that stay as they are: solar pressure, drag, a leak; they act where this table is, be they zero.

    On the stack the loads of both bodies act, where and in the axes in which they began. What counts before capture is the
    difference of the accelerations; at capture H begins anew at the debris, wherever its own forces have moved it.
    """

    @classmethod
    def table(cls) -> str:
        """Name the section in front of its fields."""
        return "disturbances.constant."

    axes: Literal["lvlh", "body"] = Field(
        "lvlh", description="constant in H, or each in the axes of its body, with which it turns"
    )
    chaser_force: Annotated[Vector, _load("chaser", "force")] = _ZERO
    chaser_torque: Annotated[Vector, _load("chaser", "torque")] = _ZERO
    debris_force: Annotated[Vector, _load("debris", "force")] = _ZERO
    debris_torque: Annotated[Vector, _load("debris", "torque")] = _ZERO


class Disturbances(Section):
    """What acts on chaser, debris and stack besides the actuators. No law knows of it."""

    gravity_gradient: Switch = Field(
        False, description="torque 3 n^2 u x (I u) on chaser, debris and stack, u from the planet to the orbit"
    )
    constant: ConstantLoads | None = None

    @property
    def acting(self) -> tuple[str, ...]:
        """Names of the disturbances that act."""
        return tuple(name for name in type(self).model_fields if getattr(self, name))
