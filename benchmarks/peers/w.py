"""Workload W as the peers read it: every number comes from detumble's own case, none is repeated here."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Gains:
    """Of one channel of PRRL-SMC, the same on every axis."""

    slope: float
    gain: float
    layer: float
    alpha: float


PLAN = {
    "goal": "fixed",
    "stack_goal": "reached",
    "distance_from": "goal",
    "transition": "none",
    "stack_belief": "design",
    "saturation": "per_axis",
    "attitude_error": "epsilon",
    "surface_rate": "printed",
    "end": "duration",
}
"""The models of the plan that the peers fly."""


@dataclass(frozen=True)
class Workload:
    """Two rigid bodies, PRRL-SMC in both channels, noise (docs/explanation.md). SI; inertias are principal moments."""

    mean_motion: float
    goal: tuple[float, float, float]
    mass: float
    chaser_inertia: tuple[float, float, float]
    debris_inertia: tuple[float, float, float]
    translation: Gains
    rotation: Gains
    force_limit: float
    torque_limit: float
    position_sigma: float
    attitude_sigma: float
    rate_sigma: float
    capture_distance: float
    capture_angle: float
    capture_rate: float
    period: float
    periods: int

    @classmethod
    def of(cls, case: dict[str, Any]) -> Workload:
        """Read a case as `detumble.workload.workload` gives it.

        Raises:
            ValueError: the case asks for something that the peers' implementations leave out.
        """
        plan, law, sensors, actuators = case["plan"], case["law"], case["sensors"], case["actuators"]
        beyond = {name: plan[name] for name, flown in PLAN.items() if plan[name] != flown} | {
            "law": law if (law["kind"], law["form"]) != ("prrl", "printed") else None,
            "velocity noise": sensors["velocity"],
            "actuators' errors": [
                gain - 1.0 for gain in actuators["force_gain"] + actuators["torque_gain"] if gain != 1.0
            ],
            "belief": any(case["belief"][f"chaser_{name}"] != case["chaser"][name] for name in ("mass", "inertia")),
        }
        if any(beyond.values()):
            raise ValueError(f"not workload W: { ({name: value for name, value in beyond.items() if value}) }")
        x, y, z = case["goal"]["position"]
        return cls(
            mean_motion=case["orbit"]["mean_motion"],
            goal=(x, y, z),
            mass=case["chaser"]["mass"],
            chaser_inertia=_principal(case["chaser"]["inertia"]),
            debris_inertia=_principal(case["debris"]["inertia"]),
            translation=_gains(law["before"]["translation"]),
            rotation=_gains(law["before"]["rotation"]),
            force_limit=_on_every_axis(actuators["force"]),
            torque_limit=_on_every_axis(actuators["torque"]),
            position_sigma=sensors["position"],
            attitude_sigma=sensors["attitude"],
            rate_sigma=sensors["rate"],
            capture_distance=case["capture"]["distance"],
            capture_angle=case["capture"]["angle"],
            capture_rate=case["capture"]["rate"],
            period=plan["control_period"],
            periods=plan["periods"],
        )


def _gains(channel: dict[str, Any]) -> Gains:
    slope, gain, layer = (_on_every_axis(channel[name]) for name in ("slope", "gain", "layer"))
    return Gains(slope, gain, layer, channel["alpha"])


def _on_every_axis(values: list[float]) -> float:
    if len(set(values)) != 1:
        raise ValueError(f"not workload W: {values} differ between the axes")
    return values[0]


def _principal(tensor: list[list[float]]) -> tuple[float, float, float]:
    if any(tensor[i][j] for i in range(3) for j in range(3) if i != j):
        raise ValueError(f"not workload W: products of inertia in {tensor}")
    return tensor[0][0], tensor[1][1], tensor[2][2]
