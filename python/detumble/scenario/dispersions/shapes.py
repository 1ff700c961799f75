"""Vectors, attitudes and inertias drawn as a whole."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from detumble.scenario import physics
from detumble.scenario.dispersions.base import CUT, Dispersion, Misfit, Parameter, Target, Tree, normal
from detumble.scenario.dispersions.numbers import bounds_fault
from detumble.scenario.quantity import Quantity
from detumble.scenario.section import Relation


def _magnitude_fault(magnitude: str, low: float | None, high: float | None) -> str | None:
    if magnitude == "log_uniform" and low == 0.0:
        return "needs low greater than 0"
    return (
        'needs low and high; "uniform" is the default' if magnitude == "log_uniform" and low is high is None else None
    )


class Direction(Dispersion):
    """A vector by direction, uniform on the sphere or on a cap of it, and by length, nominal unless given."""

    distribution: Literal["direction"] = Field("direction", description="of a vector")
    cone_deg: (
        Annotated[float, Quantity("deg", "half angle of the cap about the nominal direction", above=0.0, most=180.0)]
        | None
    ) = None
    low: Annotated[float, Parameter("least length", shape="number", least=0.0)] | None = None
    high: Annotated[float, Parameter("greatest length", shape="number", least=0.0)] | None = None
    magnitude: Literal["uniform", "log_uniform"] = Field("uniform", description="distribution of the length")

    shapes = ("vector",)
    relations: ClassVar[tuple[Relation, ...]] = (
        Relation(
            "low",
            ("low", "high"),
            lambda low, high: (
                "low and high are given together, or neither" if (low is None) != (high is None) else None
            ),
        ),
        Relation("high", ("low", "high"), bounds_fault),
        Relation("magnitude", ("magnitude", "low", "high"), _magnitude_fault),
    )

    def resolve(self, target: Target) -> Tree:
        """Give cone and length."""
        x, y, z = target.nominal
        length = math.sqrt(x * x + y * y + z * z)
        if length == 0.0 and self.cone_deg is not None:
            raise Misfit("cone_deg", f"{target.path} is zero, and so has no direction to be about")
        if length == 0.0 and self.low is None:
            raise Misfit("low", f"missing; {target.path} is zero, so the length needs low and high")
        low, high = length if self.low is None else self.low, length if self.high is None else self.high
        target.hold("field" if self.high is None else "high", high)
        return {
            "kind": "direction",
            "about": [0.0, 0.0, 1.0] if self.cone_deg is None else list(target.nominal),
            "cone": math.pi if self.cone_deg is None else math.radians(self.cone_deg),
            "magnitude": {"kind": self.magnitude, "low": low, "high": high},
        }


class Attitude(Dispersion):
    """An attitude: uniform over all, or turned off the nominal by a small random rotation vector."""

    distribution: Literal["attitude"] = Field("attitude", description="of a quaternion")
    sigma: (
        Annotated[
            float,
            Quantity("rad", "of each component of the turn, body axes; default: all attitudes", above=0.0, most=3.2),
        ]
        | None
    ) = None

    shapes = ("quaternion",)

    def resolve(self, target: Target) -> Tree:
        """Give the turn off the nominal attitude."""
        turn = {"kind": "uniform"} if self.sigma is None else {"kind": "vector", "component": normal(0.0, self.sigma)}
        return {"kind": "attitude", "nominal": list(target.nominal), "turn": turn}


class InertiaSpread(Dispersion):
    """An inertia that some rigid body has: principal second moments of mass scaled, principal axes turned."""

    distribution: Literal["inertia"] = Field("inertia", description="of an inertia")
    relative: (
        Annotated[
            float,
            Quantity("", "each principal second moment of mass times exp(relative z), z normal", above=0.0, most=1.0),
        ]
        | None
    ) = None
    axes_sigma: (
        Annotated[float, Quantity("rad", "of each component of the principal axes' turn", above=0.0, most=3.2)] | None
    ) = None
    axes: Literal["uniform"] | None = Field(None, description="every orientation of the principal axes alike")

    shapes = ("inertia",)
    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (("axes_sigma", "axes"),)
    relations: ClassVar[tuple[Relation, ...]] = (
        Relation(
            "relative",
            ("relative", "axes_sigma", "axes"),
            lambda *given: "relative, axes_sigma or axes must be given" if all(key is None for key in given) else None,
        ),
        Relation(
            "axes",
            ("axes_sigma", "axes"),
            lambda sigma, axes: (
                None if sigma is None or axes is None else "stands instead of axes_sigma; give one of them"
            ),
        ),
    )

    def resolve(self, target: Target) -> Tree:
        """Give the spread of the second moments and the turn of their axes."""
        fault = physics.inertia_fault(target.nominal)
        if fault:
            raise Misfit("field", f"{target.path} {fault}")
        self._hold(target)
        turn: Tree = {"kind": self.axes or "none"}
        if self.axes_sigma is not None:
            turn = {"kind": "vector", "component": normal(0.0, self.axes_sigma)}
        log_scale = normal(0.0, self.relative or 0.0)
        return {"kind": "inertia", "nominal": physics.tensor(target.nominal), "log_scale": log_scale, "turn": turn}

    def _hold(self, target: Target) -> None:
        """Make sure that no draw is smaller or larger than an inertia may be: its moments are sums of second moments."""
        import numpy as np  # only here

        moments = np.linalg.eigvalsh(np.array(physics.tensor(target.nominal)))
        farthest = math.exp(CUT * (self.relative or 0.0))
        least, greatest = float(moments[0]) / farthest, float(moments[2]) * farthest
        how = f"; at {CUT:g} sigma"
        target.hold("relative", greatest, how)
        fault = physics.inertia_fault([least, greatest, greatest])
        if fault:
            text = f"draws reach principal moments of {target.worded(least)} beside {target.worded(greatest)}{how}"
            raise Misfit("relative", f"{text}: {target.path} {fault}")
