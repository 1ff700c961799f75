"""The scenario as the core takes it: plain numbers, everything resolved, nothing left to default."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from detumble.checking import choice
from detumble.errors import Fault, ScenarioError
from detumble.scenario.laws import LAWS, Prrl, TsmcExponents
from detumble.scenario.physics import tensor, unit
from detumble.scenario.step import steps_per_period

if TYPE_CHECKING:
    from collections.abc import Callable

    from detumble.scenario.laws import Law, OpenLoop
    from detumble.scenario.model import Scenario
    from detumble.scenario.quantity import Axes
    from detumble.scenario.section import Section

Tree = dict[str, Any]


def case(scenario: Scenario, law: str, *, until_the_end: bool = True) -> Tree:
    """Give everything that the core needs for one flight.

    Args:
        scenario: what is flown; checked here once more as a whole.
        law: one of `LAWS`, or `none` for open loop.
        until_the_end: fly the whole duration, whatever the scenario says of the flights of its campaigns.

    Returns:
        Nested dicts of floats, ints, bools and lists, SI, quaternions normalised, inertias 3x3.

    Raises:
        RequestError: there is no such law.
        ScenarioError: the scenario contradicts itself, or has no gains for the law.
    """
    choice("law", law, LAWS, {"none": "for open loop"})
    scenario.check()
    chaser, debris = scenario.chaser, scenario.debris
    orbit: Tree = {"mean_motion": scenario.orbit.mean_motion, "lvlh_attitude": unit(scenario.orbit.lvlh_attitude)}
    return {
        "orbit": orbit,
        "chaser": _body(chaser.mass, chaser.inertia, chaser.grasp_point),
        "debris": _body(debris.mass, debris.inertia, debris.grasp_point),
        "start": {
            "position": list(chaser.position),
            "velocity": list(chaser.velocity),
            "chaser_attitude": unit(chaser.attitude),
            "chaser_rate": list(chaser.rate),
            "debris_attitude": unit(debris.attitude),
            "debris_rate": list(debris.tumble_rate),
        },
        "goal": _goal(scenario),
        "capture": {
            "distance": scenario.capture.distance,
            "angle": math.radians(scenario.capture.angle_deg),
            "rate": scenario.capture.rate,
            "speed": math.inf if scenario.capture.speed is None else scenario.capture.speed,
        },
        "settled": {"angle": math.radians(scenario.settled.angle_deg), "rate": scenario.settled.rate},
        "actuators": {
            "force": axes(scenario.actuators.force_limit),
            "torque": axes(scenario.actuators.torque_limit),
            "force_gain": axes(scenario.actuators.force_gain),
            "torque_gain": axes(scenario.actuators.torque_gain),
        },
        "sensors": {
            "position": scenario.sensors.position_sigma,
            "velocity": scenario.sensors.velocity_sigma,
            "attitude": scenario.sensors.attitude_sigma,
            "rate": scenario.sensors.rate_sigma,
        },
        "belief": _belief(scenario),
        "law": _open_loop(scenario) if law == "none" else _law(scenario, law),
        "plan": _plan(scenario, law, until_the_end),
    }


def axes(value: Axes) -> list[float]:
    """Give one number for each axis."""
    return [value] * 3 if isinstance(value, float) else [float(element) for element in value]


def ticks(duration: float, period: float) -> int:
    """Count the periods needed to cover a duration; a duration of whole periods gives their number despite rounding."""
    count = duration / period
    return max(0, math.ceil(count - 1e-9 * max(1.0, count)))


def _body(mass: float, inertia: Any, grasp_point: Any) -> Tree:
    return {"mass": mass, "inertia": tensor(inertia), "grasp_point": list(grasp_point or (0.0, 0.0, 0.0))}


def _goal(scenario: Scenario) -> Tree:
    position = scenario.goal.position or (0.0, 0.0, 0.0)
    return {"position": list(position), "after_capture": list(scenario.goal.position_after_capture or position)}


def design(name: str, at: Callable[[str], Any]) -> Any:
    """Give what the laws believe of the bodies unless they are told otherwise: their design.

    Args:
        name: of a field of `belief`: a mass, or an inertia.
        at: gives the scenario's values by path.

    Returns:
        kg, or kg m² as a 3x3 list.
    """
    alone = name.startswith("chaser")
    if name.endswith("mass"):
        return at("chaser.mass") if alone else at("chaser.mass") + at("debris.mass")
    of_chaser = tensor(at("chaser.inertia"))
    if alone:
        return of_chaser
    of_debris = tensor(at("debris.inertia"))
    return [[of_chaser[i][j] + of_debris[i][j] for j in range(3)] for i in range(3)]


BELIEFS = ("chaser_mass", "chaser_inertia", "stack_mass", "stack_inertia")


def _belief(scenario: Scenario) -> Tree:
    given = {name: scenario.at(f"belief.{name}") for name in BELIEFS}
    resolved = {name: design(name, scenario.at) if value is None else value for name, value in given.items()}
    return {name: value if name.endswith("mass") else tensor(value, rigid=False) for name, value in resolved.items()}


def _open_loop(scenario: Scenario) -> Tree:
    period = scenario.time.control_period
    after = round(scenario.time.duration / period) + 1  # what lies after the flight's last tick does not act
    open_loop: OpenLoop | None = scenario.laws.none
    segments = [
        {
            "first_tick": min(round(segment.start / period), after),
            "end_tick": min(round(segment.end / period), after),
            "frame": segment.frame,
            "force": list(segment.force),
            "torque": list(segment.torque),
        }
        for segment in (open_loop.segments if open_loop else ())
    ]
    return {"kind": "none", "segments": segments}


def _law(scenario: Scenario, name: str) -> Tree:
    law = getattr(scenario.laws, name)
    if law is None:
        given = [other for other in LAWS if getattr(scenario.laws, other) is not None]
        text = f"missing; this scenario has gains for {', '.join(given) or 'no law'}"
        raise ScenarioError(scenario.title, [Fault(f"laws.{name}", text)])
    phases = {
        phase: {channel: _gains(law, f"{table}{channel}") for channel in ("translation", "rotation")}
        for phase, table in (("before", ""), ("after", "stack."))
    }
    return {"kind": name, "form": law.form, **phases}


def _gains(law: Law[Any, Any], channel: str) -> Tree:
    """Give the gains of one channel; a stack without its own keeps those of before."""
    gains: Section = law.at(channel) or law.at(channel.removeprefix("stack."))
    fields = gains.model_dump()
    if isinstance(gains, TsmcExponents):
        p, q = gains.exponent(law.form)
        for name in TsmcExponents.model_fields:
            del fields[name]
        return {name: axes(value) for name, value in fields.items()} | {"exponent": p / q}
    if isinstance(law, Prrl):
        fields["alpha"] = law.power(channel)
    return {name: value if name in ("r", "alpha") else axes(value) for name, value in fields.items()}


def _plan(scenario: Scenario, law: str, until_the_end: bool) -> Tree:
    time, capture, laws = scenario.time, scenario.capture, scenario.laws
    periods = round(time.duration / time.control_period)

    def counted(wait: float) -> int:
        """Count the ticks of a wait; one longer than the flight never ends, however long it is."""
        return ticks(min(wait, (periods + 1) * time.control_period), time.control_period)

    return {
        "control_period": time.control_period,
        "steps_per_period": steps_per_period(scenario),
        "periods": periods,
        "dwell_ticks": counted(capture.dwell),
        "goal": _goal_kind(scenario),
        "stack_goal": "reached" if scenario.goal.position_after_capture is None else "given",
        "distance_from": capture.distance_from,
        "transition": capture.transition if capture.merge and law != "none" else "none",
        "stack_belief": scenario.belief.stack,
        "saturation": scenario.actuators.saturation,
        "attitude_error": laws.attitude_error,
        "surface_rate": laws.surface_rate,
        "end": "duration" if until_the_end or law == "none" else scenario.campaign.end,
        "hold_ticks": counted(scenario.campaign.hold),
    }


def _goal_kind(scenario: Scenario) -> str:
    if not scenario.has_grasp_points:
        return "fixed"
    return "grasp_feedforward" if scenario.goal.acceleration_feedforward else "grasp"
