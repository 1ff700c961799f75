"""From drawn fields of a scenario to the numbers of the core that they become, run by run.

The paths on the core's side are those of its case: `chaser.mass`, `start.position`, `law.before.rotation.gain`.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from collections.abc import Mapping

    from detumble.scenario.laws import Prrl
    from detumble.scenario.model import Scenario

Array = NDArray[np.float64]

RENAMED = {
    "chaser.position": "start.position",
    "chaser.velocity": "start.velocity",
    "chaser.attitude": "start.chaser_attitude",
    "chaser.rate": "start.chaser_rate",
    "debris.attitude": "start.debris_attitude",
    "debris.tumble_rate": "start.debris_rate",
    "goal.position_after_capture": "goal.after_capture",
    "capture.angle_deg": "capture.angle",
    "settled.angle_deg": "settled.angle",
    "actuators.force_limit": "actuators.force",
    "actuators.torque_limit": "actuators.torque",
    "sensors.position_sigma": "sensors.position",
    "sensors.velocity_sigma": "sensors.velocity",
    "sensors.attitude_sigma": "sensors.attitude",
    "sensors.rate_sigma": "sensors.rate",
}
_TENSOR = [0, 3, 4, 3, 1, 5, 4, 5, 2]
"""Where xx, yy, zz, xy, xz, yz stand in the rows of the tensor."""
_MEAN_MOTION = ("altitude", "radius", "earth_radius", "mu")


def overlay(scenario: Scenario, law: str, drawn: Mapping[str, Array]) -> dict[str, Array]:
    """Give the numbers of the core that differ from run to run.

    Args:
        scenario: the nominal case.
        law: the law that flies; gains of others are left out.
        drawn: by path of the scenario, as `draws.draw` gives it: (n,) or (n, k).

    Returns:
        By path of the core, (n, k), C-contiguous, SI.
    """
    columns: dict[str, Array] = {}
    for path, values in drawn.items():
        section, _, name = path.partition(".")
        if section == "orbit" and name in _MEAN_MOTION:
            if name != "earth_radius" or scenario.orbit.radius is None:
                columns["orbit.mean_motion"] = _mean_motion(scenario, drawn)
        elif section == "laws":
            columns |= {gain: _on_axes(gain, values) for gain in _gains(scenario, law, name)}
        else:
            columns[RENAMED.get(path, path)] = _converted(path, values)
    if "goal.position" in drawn and scenario.goal.position_after_capture is None:
        columns["goal.after_capture"] = columns["goal.position"]
    return {path: np.ascontiguousarray(values.reshape(len(values), -1)) for path, values in columns.items()}


def _converted(path: str, values: Array) -> Array:
    if path.endswith("_deg"):
        return values * (math.pi / 180.0)
    if path.endswith("inertia"):
        return values[:, _TENSOR]
    return _on_axes(path, values) if path.startswith("actuators.") else values


def _on_axes(path: str, values: Array) -> Array:
    """Give one number for each axis, unless the core takes a single one."""
    single = path.rpartition(".")[2] in ("alpha", "r")
    return values if single or values.ndim == 2 else np.repeat(values[:, None], 3, axis=1)


def _mean_motion(scenario: Scenario, drawn: Mapping[str, Array]) -> Array:
    def field(name: str) -> Array:
        return drawn.get(f"orbit.{name}", np.asarray(getattr(scenario.orbit, name)))

    radius = field("radius") if scenario.orbit.radius is not None else field("earth_radius") + field("altitude")
    return np.asarray(np.sqrt(field("mu") / (radius * radius * radius)))


def _gains(scenario: Scenario, law: str, path: str) -> list[str]:
    """Name the core's gains that a field of `laws` becomes: before capture, after it, in one channel or both."""
    owner, _, rest = path.partition(".")
    if owner != law:
        return []
    if rest == "alpha":
        return [f"law.{phase}.{channel}.alpha" for phase, channel in _sharing(getattr(scenario.laws, law))]
    if rest.startswith("stack."):
        return [f"law.after.{rest.removeprefix('stack.')}"]
    stack = getattr(scenario.laws, law).stack
    own_set_after = stack is not None and getattr(stack, rest.partition(".")[0]) is not None
    return [f"law.before.{rest}"] + ([] if own_set_after else [f"law.after.{rest}"])


def _sharing(law: Prrl) -> list[tuple[str, str]]:
    """Name phase and channel of the gains that have no alpha of their own."""
    places = [(phase, channel) for phase in ("before", "after") for channel in ("translation", "rotation")]
    own = {channel: law.at(channel) for _, channel in places}
    stack = {channel: law.at(f"stack.{channel}") or own[channel] for _, channel in places}
    return [place for place in places if (own if place[0] == "before" else stack)[place[1]].alpha is None]
