"""Law `none`: no feedback, wrenches that the scenario gives."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from detumble.scenario.laws.base import Appearance
from detumble.scenario.quantity import Quantity, Vector
from detumble.scenario.section import Relation, Section


class Segment(Section):
    """Force and torque held from `start` to `end`."""

    start: Annotated[float, Quantity("s", "begin, whole control periods", least=0.0)]
    end: Annotated[float, Quantity("s", "end, whole control periods", above=0.0)]
    frame: Literal["lvlh", "body", "command"] = Field(
        "lvlh",
        description="axes in which both vectors are given and held; body axes turn with the chaser; command is the force in "
        "lvlh, the torque in body axes, as laws command",
    )
    force: Annotated[Vector, Quantity("N", "force on the chaser", shape="vector")] = (0.0, 0.0, 0.0)
    torque: Annotated[Vector, Quantity("N m", "torque on the chaser", shape="vector")] = (0.0, 0.0, 0.0)

    relations: ClassVar[tuple[Relation, ...]] = (
        Relation(
            "end",
            ("start", "end"),
            lambda start, end: None if end > start else f"must be later than start ({start:.10g} s)",
        ),
    )


class OpenLoop(Appearance):
    """Law `none`: open loop; the bodies never merge."""

    title = "open loop"
    colour = "#707070"
    dashes = "-"
    marker = "P"

    segments: list[Segment] = Field(default_factory=list, description="sorted, not overlapping")
