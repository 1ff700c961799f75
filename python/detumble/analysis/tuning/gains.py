"""The gains of each law that can be searched for, and their ranges.

A coordinate x in [0, 1] of the search stands for a gain g between the ends of its range, which are natural scales of the channel
(`detumble.scenario.laws.Natural`) times the gain's span:

    g = low (high / low)^x             gains with a natural scale: log-uniform
    g = low + (high - low) x           gains without: alpha of PRRL, the exponent of TSMC

A channel is measured by the acceleration a that its weakest axis gives, a length ℓ and an inertia m. Before capture ℓ is the
distance of the nominal start from the goal, at least the capture distance; for the stack's own set it is the capture distance;
in rotation it is 1. m is the mass, or the largest moment of inertia, of what flies. A gain without a span (LQR's r) stays.

A fraction of odd numbers (TSMC's p/q) is searched under the name that it has in the core, and snapped to the nearest fraction of
odd numbers up to 21, so that what is flown is what a file can say.

A gain is one number for all axes. Scenario paths here are those within the law's table: `translation.kp`, `stack.rotation.kd`,
`alpha`, `translation.exponent`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from detumble.checking import choice
from detumble.errors import RequestError
from detumble.scenario.core import case, design
from detumble.scenario.laws import CHANNELS, FORMS, LAWS, REGISTER, Natural
from detumble.scenario.laws.base import gains_of_section

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from detumble.scenario.laws import Form, Gain, Law
    from detumble.scenario.laws.base import OddFraction, Scale, Span
    from detumble.scenario.model import Scenario

Array = NDArray[np.float64]
STACK_CHANNELS = tuple(f"stack.{channel}" for channel in CHANNELS)


@dataclass(frozen=True)
class Tunable:
    """A gain that can be searched for.

    Attributes:
        path: within the law's table: `translation.kp`, `alpha`.
        unit: SI; empty for pure numbers.
        meaning: one phrase.
        scale: its natural scale; None where the range is one of plain numbers.
        span: ends of the range, in natural scales.
        fraction: how a file writes it, where that is a fraction of odd numbers; None for a plain number.
    """

    path: str
    unit: str
    meaning: str
    scale: Scale | None
    span: Span
    fraction: OddFraction | None = None

    @property
    def channel(self) -> str:
        """`translation`, `rotation`, `stack.translation`, `stack.rotation`; empty for a gain that these share."""
        return self.path.rpartition(".")[0]

    def range(self, natural: Natural | None) -> Span:
        """Give the ends of the range, in the gain's unit."""
        scale = self.scale(natural) if self.scale and natural else 1.0
        return self.span[0] * scale, self.span[1] * scale

    def value(self, x: float, natural: Natural | None) -> float:
        """Give the gain at a coordinate in [0, 1]."""
        low, high = self.range(natural)
        plain = low * (high / low) ** x if self.scale else low + (high - low) * x
        return float(plain) if self.fraction is None else _quotient(self.fraction.nearest(plain))

    def coordinate(self, value: float, natural: Natural | None) -> float:
        """Undo `value`; outside of the range it gives its nearer end."""
        low, high = self.range(natural)
        inside = min(max(value, low), high)
        return math.log(inside / low) / math.log(high / low) if self.scale else (inside - low) / (high - low)

    def fields(self, value: float) -> dict[str, float]:
        """Give the fields that a file says the gain by, by path within the law's table, and their values."""
        if self.fraction is None:
            return {self.path: value}
        named = zip(self.fraction.fields, self.fraction.nearest(value), strict=True)
        return {f"{self.channel}.{name}": number for name, number in named}

    def own(self, law: Law[Any, Any]) -> float:
        """Give the gain of a law; of one that differs from axis to axis the geometric mean."""
        if self.fraction is not None:
            return _quotient(self.fraction.of(law.at(self.channel)))
        value = law.at(self.path)
        return value if isinstance(value, float) else float(np.prod(value)) ** (1.0 / 3.0)


def _quotient(fraction: tuple[int, int]) -> float:
    return fraction[0] / fraction[1]


def _tunable(path: str, gain: Gain) -> Iterator[Tunable]:
    if gain.span is not None:
        yield Tunable(path, gain.unit, gain.meaning, gain.scale, gain.span)


def gains_of(
    law: str, form: Form | None = None, stack: Sequence[str] = (), own: Sequence[str] = ()
) -> tuple[Tunable, ...]:
    """Name the gains of a law that can be searched for.

    Args:
        law: one of `LAWS`.
        form: decides the range of a fraction; None is `printed`.
        stack: channels of which the stack has a set of its own.
        own: gains that channels have of their own where they could share the law's: `rotation.alpha`, `stack.rotation.alpha`.

    Raises:
        RequestError: there is no such law.
    """
    section = REGISTER[choice("law", law, LAWS)]
    channels = (*CHANNELS, *(f"stack.{channel}" for channel in CHANNELS if channel in stack))
    shared = gains_of_section(section)
    found: list[Tunable] = []
    for name, gain in shared.items():
        places = [f"{channel}.{name}" for channel in channels]
        if not set(places) <= set(own):
            found += _tunable(name, gain)
        for place in places:
            found += _tunable(place, gain) if place in own else ()
    for channel in channels:
        declared = section.channel(channel)
        for name, gain in declared.gains().items():
            found += _tunable(f"{channel}.{name}", gain) if name not in shared else ()
        for by_form in declared.by_form:
            fraction = by_form.fractions[form or FORMS[0]]
            path = f"{channel}.{by_form.name}"
            found.append(Tunable(path, "", by_form.meaning, None, fraction.span, fraction))
    return tuple(found)


def gains_in(law: str, table: Mapping[str, Any]) -> tuple[Tunable, ...]:
    """Name the gains of a law as a scenario has them: its form, its sets, what its channels have of their own.

    Args:
        law: one of `LAWS`.
        table: of the law, as its file has it.
    """
    stack: Mapping[str, Any] = table.get("stack", {})
    channels = {channel: table[channel] for channel in CHANNELS} | {f"stack.{name}": stack[name] for name in stack}
    own = [f"{channel}.{name}" for channel, gains in channels.items() for name in gains]
    return gains_of(law, table.get("form"), tuple(stack), own)


def natural_of(scenario: Scenario, channel: str) -> Natural:
    """Give what the gains of a channel are measured by, but for gains that scales depend on; see above.

    Args:
        scenario: nominal.
        channel: `translation`, `rotation`, `stack.translation` or `stack.rotation`.

    Raises:
        RequestError: the channel has no limit on any axis.
    """
    after = channel.startswith("stack.")
    kind: Literal["force", "torque"] = "force" if channel.endswith("translation") else "torque"
    weakest = float(_limits(scenario, kind).min())
    body = "stack" if after else "chaser"
    if kind == "torque":
        inertia = design(f"belief.{body}_inertia", scenario.at)
        moment = float(np.linalg.eigvalsh(np.array(inertia)).max())
        return Natural(moment, weakest / moment, 1.0)
    mass = design(f"belief.{body}_mass", scenario.at)
    length = scenario.capture.distance if after else max(_distance(scenario), scenario.capture.distance)
    return Natural(mass, weakest / mass, length)


def mean_acceleration(scenario: Scenario) -> float:
    """Give the mean over the axes of the most that each accelerates the chaser, m/s².

    Raises:
        RequestError: force is limited on no axis.
    """
    mass: float = design("belief.chaser_mass", scenario.at)
    return float(_limits(scenario, "force").mean()) / mass


def _limits(scenario: Scenario, kind: Literal["force", "torque"]) -> Array:
    """What the actuators give on each axis, (3,); an infinite limit counts as the largest finite one."""
    limit, gain = (getattr(scenario.actuators, f"{kind}_{what}") for what in ("limit", "gain"))
    limits: Array = np.ones(3) * limit * gain
    finite = limits[np.isfinite(limits)]
    if not finite.size:
        raise RequestError(
            f"actuators.{kind}_limit: infinite on every axis; ranges of gains are measured by it: give a finite one"
        )
    return np.where(np.isfinite(limits), limits, finite.max())


def _distance(scenario: Scenario) -> float:
    """From the nominal start to the goal at t = 0, m."""
    if not scenario.has_grasp_points:
        return math.dist(scenario.chaser.position, scenario.goal.position or (0.0, 0.0, 0.0))
    from detumble.quaternions import conjugate, multiply, rotate

    plain = case(scenario, "none")
    from_inertial = conjugate(np.array(plain["orbit"]["lvlh_attitude"]))

    def grasp_point(body: str) -> Array:
        attitude = multiply(from_inertial, np.array(plain["start"][f"{body}_attitude"]))
        return rotate(attitude, np.array(plain[body]["grasp_point"]))

    return float(np.linalg.norm(plain["start"]["position"] + grasp_point("chaser") - grasp_point("debris")))
