"""The integration step that is flown: the scenario's own, or chosen so that the rotation is accurate in every run.

What is chosen depends on bounds of what is dispersed, not on draws, so all runs of a campaign have one step. Assumptions:

- The debris is free, and turns at most √(1 + κ²) times as fast as at the start, which holds for any free body.
- The chaser turns no faster than it did at the start, or than the debris that it follows; nor does the stack. A slew is quicker
  for seconds, which adds little. Open-loop torques are not looked at. A flight's warnings judge the rates that were met.
- A stack whose inertias are summed is no more asymmetric than the bodies; one that conserves momentum may be like a rod.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from detumble.scenario.accuracy import (
    ANY_BODY,
    AUTOMATIC_ERROR,
    MOST_TURN,
    asymmetry,
    attitude_error,
    most_asymmetric,
    principal_moments,
    steps,
)
from detumble.scenario.physics import tensor

if TYPE_CHECKING:
    from collections.abc import Sequence

    from detumble.scenario.model import Scenario

Distributions = dict[str, dict[str, Any]]
"""Distributions by the path of their field, as the core takes them."""


def steps_per_period(scenario: Scenario) -> int:
    """Count the integration steps that a control period is cut into.

    Args:
        scenario: what is flown, dispersions included; sound.
    """
    from detumble.scenario import conversions

    time = scenario.time
    if isinstance(time.integration_step, float):
        return conversions.steps(time.integration_step, time.control_period)
    inertia, rate = worst_body(scenario)
    return steps(
        time.control_period,
        lambda step: rate * step <= MOST_TURN and attitude_error(inertia, rate, step, time.duration) <= AUTOMATIC_ERROR,
    )


def integration_step(scenario: Scenario) -> float:
    """Give the integration step that is flown, s."""
    return scenario.time.control_period / steps_per_period(scenario)


def worst_body(scenario: Scenario) -> tuple[Sequence[float], float]:
    """Give the most asymmetric inertia and the largest rate that a body may have in any run of a campaign.

    Args:
        scenario: what is flown, dispersions included; sound.

    Returns:
        Principal moments (3,), kg m², and a norm of angular rate, rad/s.
    """
    from detumble.scenario.dispersions.fitting import resolved

    drawn: Distributions = {}
    for dispersion in scenario.dispersions:
        if dispersion.field.split(".")[-1] in ("inertia", "rate", "tumble_rate"):
            aim, resolved_one = resolved(dispersion, scenario.at)
            drawn[aim.path] = resolved_one["distribution"]
    chaser, debris = _inertia(scenario, drawn, "chaser"), _inertia(scenario, drawn, "debris")
    rate = max(_rate(scenario, drawn, "chaser.rate", chaser), _rate(scenario, drawn, "debris.tumble_rate", debris))
    bodies = [chaser]
    if scenario.capture.merge and scenario.capture.transition == "momentum_conserving":
        bodies.append(ANY_BODY)
    if scenario.capture.merge or "debris.inertia" in drawn or not flown_exactly(scenario):
        bodies.append(debris)
    return most_asymmetric(*bodies), rate


def flown_exactly(scenario: Scenario) -> bool:
    """Tell whether the debris is a free symmetric top about its z axis, which the core flies in closed form."""
    if scenario.disturbances.acting:
        return False
    full = tensor(scenario.debris.inertia)
    return full[0][0] == full[1][1] and not any(full[i][j] for i, j in ((0, 1), (0, 2), (1, 2)))


def _inertia(scenario: Scenario, drawn: Distributions, body: str) -> Sequence[float]:
    """Give the moments of a body, of all that it may have the most asymmetric: its second moments are drawn apart."""
    moments = principal_moments(scenario.at(f"{body}.inertia"))
    distribution = drawn.get(f"{body}.inertia")
    if distribution is None:
        return moments
    scale = distribution["log_scale"]
    second = [0.5 * sum(moments) - moment for moment in moments]  # falling
    large, middle, small = second[0] * math.exp(scale["high"]), second[1], second[2] * math.exp(scale["low"])
    return (middle + small, large + small, large + middle)


def _rate(scenario: Scenario, drawn: Distributions, path: str, inertia: Sequence[float]) -> float:
    """Give the largest rate that a body may reach by itself, rad/s."""
    distribution = drawn.get(path)
    if distribution is None:
        start = math.hypot(*scenario.at(path))
    elif distribution["kind"] == "direction":
        start = distribution["magnitude"]["high"]
    else:
        start = math.hypot(*(max(-element["low"], element["high"]) for element in distribution["elements"]))
    return start * math.hypot(1.0, asymmetry(inertia))
