"""The data of a pursuit apart from its start: limits, bodies, goal and thresholds, as the bounds need them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from detumble.analysis.bounds.translation import Reach
from detumble.analysis.bounds.turn import Agility
from detumble.compiled import tick_times
from detumble.errors import Fault, ScenarioError
from detumble.quaternions import Array, about_z, multiply
from detumble.states import row_of

if TYPE_CHECKING:
    from detumble.scenario.model import Scenario


def _given(actuators: Mapping[str, Any], what: str) -> Array:
    """Give the most that the actuators deliver on each axis: the limit, off by their gain; shape (3,)."""
    most: Array = np.array(actuators[what], float) * np.array(actuators[f"{what}_gain"], float)
    return most


@dataclass(frozen=True)
class Pursuit:
    """What does not differ from start to start: limits, bodies, goal and thresholds, SI.

    Attributes:
        mean_motion: rad/s.
        lvlh_attitude: (4,) H → N at t = 0.
        acceleration: (3,) largest force given over the chaser's mass, H axes, m/s²; may be inf.
        torque: (3,) largest given, chaser axes, N m; may be inf.
        chaser_inertia, debris_inertia: (3, 3) kg m².
        goal: (3,) r_des in H, m; unused with grasp points.
        grasp_points: chaser's and debris', each (3,) m in its own axes, or None.
        from_debris: distance is |r| instead of |r - r_des|.
        distance, angle, rate, speed: thresholds, m, rad, rad/s, m/s; speed may be inf.
        period: s.
        periods: control periods in the flight.
        dwell_ticks: periods for which the thresholds must have held.
    """

    mean_motion: float
    lvlh_attitude: Array
    acceleration: Array
    torque: Array
    chaser_inertia: Array
    debris_inertia: Array
    goal: Array
    grasp_points: tuple[Array, Array] | None
    from_debris: bool
    distance: float
    angle: float
    rate: float
    speed: float
    period: float
    periods: int
    dwell_ticks: int

    @classmethod
    def of(cls, case: Mapping[str, Any]) -> Pursuit:
        """From the plain case that the core flies (`detumble.scenario.core.case`)."""
        plan, capture, chaser, debris = case["plan"], case["capture"], case["chaser"], case["debris"]
        grasp = (np.array(chaser["grasp_point"], float), np.array(debris["grasp_point"], float))
        return cls(
            mean_motion=float(case["orbit"]["mean_motion"]),
            lvlh_attitude=np.array(case["orbit"]["lvlh_attitude"], float),
            acceleration=_given(case["actuators"], "force") / float(chaser["mass"]),
            torque=_given(case["actuators"], "torque"),
            chaser_inertia=np.array(chaser["inertia"], float),
            debris_inertia=np.array(debris["inertia"], float),
            goal=np.array(case["goal"]["position"], float),
            grasp_points=grasp if plan["goal"] != "fixed" else None,
            from_debris=plan["distance_from"] == "debris",
            distance=float(capture["distance"]),
            angle=float(capture["angle"]),
            rate=float(capture["rate"]),
            speed=float(capture["speed"]),
            period=float(plan["control_period"]),
            periods=int(plan["periods"]),
            dwell_ticks=int(plan["dwell_ticks"]),
        )

    def time_of(self, tick: int) -> float:
        """Give the time of a control tick, s, as flights report it."""
        return float(tick_times(self.period, [tick])[0])

    def lvlh_turned(self, angle: Array) -> Array:
        """Attitudes (n, 4) H → N after H has turned by angles (n,), rad, since t = 0."""
        return multiply(self.lvlh_attitude, about_z(angle))

    @cached_property
    def reach(self) -> Reach:
        """Tables of the translation, shared by all starts."""
        return Reach(self.mean_motion, self.acceleration, self.period)

    @cached_property
    def agility(self) -> Agility:
        """Bounds of the chaser's rate under the torque limits."""
        return Agility.of(self.chaser_inertia, self.torque)


def check_undisturbed(scenario: Scenario) -> None:
    """Make sure that nothing but its actuators moves the chaser, and nothing turns the debris: the bounds know no more.

    Raises:
        ScenarioError: a disturbance acts.
    """
    acting = scenario.disturbances.acting
    if acting:
        faults = [Fault(f"disturbances.{name}", "acts; bounds hold only where no disturbance does") for name in acting]
        raise ScenarioError(scenario.title, faults)


def start_of(case: Mapping[str, Any]) -> Array:
    """The start of a plain case as one row (20,): r, v (H), chaser q, w, debris q, w."""
    return row_of(case["start"])
