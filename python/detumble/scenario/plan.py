"""The plan of a flight in the core, its clocks and switches: what no dispersion changes.

Besides fields of the scenario the rules read what a flight is asked for: `flight.law`, and `flight.whole`, which is true for a
flight that lasts its whole duration whatever ends the flights of a campaign. `segment.` stands for one open-loop segment.
`time.integration_step` is read as a number: "auto" is replaced by what it stands for (`detumble.scenario.step`).
"""

from __future__ import annotations

from detumble.scenario.rules import Rule, Table, constant

_OPEN_LOOP = ("flight.law", "none")
_PERIOD = "time.control_period"


def _wait(field: str) -> tuple[Rule, ...]:
    return (Rule("wait", (field, "time.duration", _PERIOD)),)


def _word(field: str) -> Rule:
    return Rule("word", (field,))


PLAN: Table = {
    "plan.control_period": (_word(_PERIOD),),
    "plan.steps_per_period": (Rule("steps", ("time.integration_step", _PERIOD)),),
    "plan.periods": (Rule("nearest_tick", ("time.duration", _PERIOD)),),
    "plan.dwell_ticks": _wait("capture.dwell"),
    "plan.hold_ticks": _wait("campaign.hold"),
    "plan.goal": (
        constant("fixed", ("chaser.grasp_point", None)),
        constant("fixed", ("debris.grasp_point", None)),
        constant("grasp_feedforward", ("goal.acceleration_feedforward", True)),
        constant("grasp"),
    ),
    "plan.stack_goal": (constant("reached", ("goal.position_after_capture", None)), constant("given")),
    "plan.distance_from": (_word("capture.distance_from"),),
    "plan.transition": (
        constant("none", _OPEN_LOOP),
        constant("none", ("capture.merge", False)),
        _word("capture.transition"),
    ),
    "plan.stack_belief": (_word("belief.stack"),),
    "plan.saturation": (_word("actuators.saturation"),),
    "plan.attitude_error": (_word("laws.attitude_error"),),
    "plan.surface_rate": (_word("laws.surface_rate"),),
    "plan.disturbances.constant": (
        constant("none", ("disturbances.constant", None)),
        _word("disturbances.constant.axes"),
    ),
    "plan.end": (
        constant("duration", _OPEN_LOOP),
        constant("duration", ("flight.whole", True)),
        _word("campaign.end"),
    ),
}
"""By path of the core."""

SEGMENT: Table = {
    "first_tick": (Rule("tick_within", ("segment.start", "time.duration", _PERIOD)),),
    "end_tick": (Rule("tick_within", ("segment.end", "time.duration", _PERIOD)),),
    "frame": (_word("segment.frame"),),
    "force": (_word("segment.force"),),
    "torque": (_word("segment.torque"),),
}
"""Of one open-loop segment, by key of the core's `law.segments`."""
