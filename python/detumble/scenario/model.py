"""The scenario: bodies, orbit, goal, capture, hardware, beliefs and laws. SI units; each field tells its own unit and range.

Frames: N inertial, H the target orbit's LVLH frame, C chaser, D debris. Quaternions scalar first, body -> N.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from detumble.errors import Fault
from detumble.scenario.accuracy import AUTOMATIC_ERROR, MOST_STEPS
from detumble.scenario.bodies import Belief, Chaser, Debris, Goal, Orbit
from detumble.scenario.dispersions import AnyDispersion, Correlation
from detumble.scenario.disturbances import Disturbances
from detumble.scenario.hardware import Actuators, Sensors
from detumble.scenario.laws import Laws, Segment
from detumble.scenario.quantity import Quantity, Switch
from detumble.scenario.rules import Place, Rule
from detumble.scenario.section import Relation, Section, lines, one_line
from detumble.scenario.wording import shown

MOST_PERIODS = 2_000_000
"""Keeps the history of one flight within a laptop's memory."""


def whole(count: float) -> bool:
    """Tell whether a ratio of two times is a whole number, to rounding (relative 1e-9)."""
    return math.isfinite(count) and abs(count - round(count)) <= 1e-9 * max(1.0, abs(count))


def _duration_fault(duration: float, period: float) -> str | None:
    count = duration / period
    if not whole(count) or round(count) < 1:
        return f"{duration:.10g} s: must be a whole number of control periods ({period:.10g} s)"
    if count > MOST_PERIODS:
        return f"{duration:.10g} s: is {count:.4g} control periods; at most {MOST_PERIODS} can be flown"
    return None


class Time(Section):
    """The clocks of a flight."""

    duration: Annotated[float, Quantity("s", "length of the flight, whole control periods", above=0.0, most=1e8)]
    control_period: Annotated[float, Quantity("s", "time between commands", above=0.0, most=1e4)]
    integration_step: Annotated[
        float | Literal["auto"],
        Quantity(
            "s",
            "longest step; a period is cut into the fewest equal steps; "
            f"auto: the longest for which attitudes are estimated to err by at most {shown(AUTOMATIC_ERROR)} rad",
            words=("auto",),
            above=0.0,
            most=1e4,
        ),
    ] = "auto"

    relations: ClassVar[tuple[Relation, ...]] = (
        Relation("duration", ("duration", "control_period"), _duration_fault),
        Relation(
            "integration_step",
            ("integration_step", "control_period"),
            lambda step, period: (
                None
                if step == "auto" or step <= period
                else f"{step:.10g} s: must not be longer than control_period ({period:.10g} s)"
            ),
        ),
        Relation(
            "integration_step",
            ("integration_step", "control_period"),
            lambda step, period: (
                None
                if step == "auto" or period <= MOST_STEPS * (1.0 + 1e-9) * step
                else f"{step:.10g} s: must be at least a 100000th of control_period ({period:.10g} s)"
            ),
        ),
    )


class Capture(Section):
    """The thresholds, strict, all at once; and what becomes of the two bodies."""

    distance: Annotated[
        float,
        Quantity("m", "from the goal (or between the grasp points)", place="capture.distance", above=0.0, most=1e6),
    ]
    angle_deg: Annotated[
        float, Quantity("deg", "attitude error against the debris", place="capture.angle", above=0.0, most=180.0)
    ]
    rate: Annotated[
        float, Quantity("rad/s", "norm of the relative angular rate", place="capture.rate", above=0.0, most=100.0)
    ]
    speed: (
        Annotated[
            float,
            Quantity("m/s", "relative speed in H", place=Place("capture.speed", Rule("infinite")), above=0.0, most=1e4),
        ]
        | None
    ) = None
    dwell: Annotated[float, Quantity("s", "how long all must have held", least=0.0, most=1e7)] = 0.0
    distance_from: Literal["goal", "debris"] = Field("goal", description="distance is |r - r_des|, or |r|")
    transition: Literal["approximate", "momentum_conserving"] = Field(
        "approximate", description="the stack takes the chaser's state, or what momentum leaves"
    )
    merge: Switch = Field(True, description="false: the first capture is recorded, the bodies stay two")

    @classmethod
    def never(cls) -> Capture:
        """Give thresholds below which nothing lies: those of a scenario that is flown in open loop alone."""
        return cls.model_construct(_fields_set=set(), distance=0.0, angle_deg=0.0, rate=0.0, merge=False)


class Settled(Section):
    """When the stack counts as stabilised: both hold until the end of the flight."""

    angle_deg: Annotated[
        float, Quantity("deg", "stack axes against H", provenance="ours", place="settled.angle", above=0.0, most=180.0)
    ] = 5.0
    rate: Annotated[
        float, Quantity("rad/s", "rate relative to H", provenance="ours", place="settled.rate", above=0.0, most=100.0)
    ] = 0.005


class Campaign(Section):
    """How a campaign's flights end; a single flight lasts its whole duration."""

    end: Literal["settled", "captured", "duration"] = Field(
        "settled",
        description="when the stack has been settled for `hold` (at capture, if nothing merges), at capture, or never early",
    )
    hold: Annotated[float, Quantity("s", "how long the stack must have been settled", least=0.0, most=1e7)] = 60.0


def _grasp_fault(chaser: object, debris: object) -> str | None:
    return None if (chaser is None) == (debris is None) else "both bodies carry a grasp point, or neither does"


def _goal_fault(position: object, chaser: object, debris: object, laws: Laws) -> str | None:
    grasp = chaser is not None and debris is not None
    if position is None and chaser is None and debris is None and laws.closed_loop:
        return "missing; without grasp points the goal needs a position in m"
    return "must not be given with grasp points: they are the goal" if grasp and position is not None else None


def _needed_fault(table: Section, laws: Laws) -> str | None:
    return "missing; needed: a table" if laws.closed_loop and not table.model_fields_set else None


def _feedforward_fault(feedforward: bool, chaser: object, debris: object) -> str | None:
    return "needs grasp points: a fixed goal has no acceleration" if feedforward and chaser is debris is None else None


def _segments_fault(segments: list[Segment] | None, period: float) -> str | None:
    latest = 0.0
    for number, segment in enumerate(segments or []):
        for time in (segment.start, segment.end):
            if not whole(time / period):
                return f"[{number}]: {time:.10g} s is not a whole number of control periods ({period:.10g} s)"
        if segment.start < latest - 1e-9 * period:
            return f"[{number}]: starts at {segment.start:.10g} s, before the one ahead of it ends ({latest:.10g} s)"
        latest = segment.end
    return None


class Scenario(Section):
    """Everything that a flight needs but the choice of the law and the seed, and what a campaign draws at random."""

    title: Annotated[str, one_line] = Field(
        min_length=1, max_length=500, description="one line for tables and figures, 500 characters at most"
    )
    description: Annotated[str, lines] = Field("", description="what this case is for, and where its numbers come from")
    time: Time
    orbit: Orbit
    chaser: Chaser
    debris: Debris
    goal: Goal = Field(default_factory=Goal)
    capture: Capture = Field(default_factory=Capture.never, description="needed by every law; open loop does without")
    settled: Settled = Field(default_factory=Settled)
    actuators: Actuators = Field(
        default_factory=Actuators.unlimited, description="needed by every law; open loop does without"
    )
    sensors: Sensors = Field(default_factory=Sensors)
    disturbances: Disturbances = Field(default_factory=Disturbances)
    belief: Belief = Field(default_factory=Belief)
    laws: Laws = Field(default_factory=Laws)
    campaign: Campaign = Field(default_factory=Campaign)
    dispersions: list[AnyDispersion] = Field(
        default_factory=list, description="what a campaign draws anew for each run"
    )
    correlations: list[Correlation] = Field(default_factory=list, description="groups of dispersed numbers")

    checks_relations_on_assignment: ClassVar[bool] = False
    relations: ClassVar[tuple[Relation, ...]] = (
        Relation("chaser.grasp_point", ("chaser.grasp_point", "debris.grasp_point"), _grasp_fault),
        Relation("goal.position", ("goal.position", "chaser.grasp_point", "debris.grasp_point", "laws"), _goal_fault),
        Relation("capture", ("capture", "laws"), _needed_fault),
        Relation("actuators", ("actuators", "laws"), _needed_fault),
        Relation(
            "goal.acceleration_feedforward",
            ("goal.acceleration_feedforward", "chaser.grasp_point", "debris.grasp_point"),
            _feedforward_fault,
        ),
        Relation("laws.none.segments", ("laws.none.segments", "time.control_period"), _segments_fault),
    )

    @classmethod
    def table(cls) -> str:
        """Name nothing: the scenario is the file itself."""
        return ""

    def broken(self) -> list[Fault]:
        """Find the relations between sections that do not hold, and dispersions that do not fit their fields."""
        from detumble.scenario.dispersions.fitting import faults

        return super().broken() + faults(enumerate(self.dispersions), enumerate(self.correlations), self.at)

    @property
    def has_grasp_points(self) -> bool:
        """Tell whether the goal is to bring two grasp points together."""
        return self.chaser.grasp_point is not None and self.debris.grasp_point is not None

    def check(self) -> None:
        """Make sure that the scenario can be flown after all that was assigned.

        Raises:
            ScenarioError: sections contradict each other.
        """
        from detumble.scenario.faults import validated

        validated(self.to_dict(), self.title)

    def to_dict(self) -> dict[str, Any]:
        """Give the scenario as the plain tables of its file; what is absent is left out."""
        absent = {name for name in ("capture", "actuators") if not getattr(self, name).model_fields_set}
        # a table that was appended to a list as a plain dict is read like one of the file
        return self.model_dump(exclude_none=True, exclude=absent, warnings=False)

    @property
    def warnings(self) -> tuple[str, ...]:
        """What a reader of the numbers ought to look at again: each can be meant, and seldom is."""
        from detumble.scenario.hints import warnings

        return warnings(self)

    def to_toml(self) -> str:
        """Give the scenario as the text of its file, units beside the values."""
        from detumble.scenario.files import given
        from detumble.scenario.toml import text_of

        return text_of(given(self))

    def save(self, path: str | Path) -> None:
        """Write the scenario as TOML, whole or not at all.

        Args:
            path: the file to write; an older one is replaced.

        Raises:
            ScenarioError: the scenario contradicts itself.
            RequestError: the file cannot be written.
        """
        from detumble.scenario.files import save

        save(self, path)

    @classmethod
    def schema(cls, *_: Any, **__: Any) -> dict[str, Any]:
        """Give the JSON Schema of a scenario file; each quantity tells its `unit`."""
        from detumble.scenario.schema import schema_of

        return schema_of(cls)
