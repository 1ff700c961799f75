"""The gains of each law that can be searched for, and their ranges.

A coordinate x in [0, 1] of the search stands for a gain g between the ends of its range, which are natural scales of the channel
(`detumble.scenario.laws.Natural`) times the gain's span:

    g = low (high / low)^x             gains: log-uniform
    g = low + (high - low) x           alpha of PRRL, exponent of TSMC

A channel is measured by the acceleration a that its weakest axis gives, a length ℓ and an inertia m. Before capture ℓ is the
distance of the nominal start from the goal, at least the capture distance; for the stack's own set it is the capture distance;
in rotation it is 1. m is the mass, or the largest moment of inertia, of what flies. LQR's r stays: only ratios of weights act.

The exponent is snapped to the nearest fraction of odd numbers up to 21, so that what is flown is what a file can say.

A gain is one number for all axes. Scenario paths here are those within the law's table: `translation.kp`, `stack.rotation.kd`,
`alpha`, and `translation.exponent` for TSMC's p/q.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from detumble.checking import choice
from detumble.errors import RequestError
from detumble.scenario.core import axes, case, design
from detumble.scenario.faults import quantity_of, section_at, section_of
from detumble.scenario.laws import EXPONENTS, LAWS, Gain, Natural, Prrl, Scale, Span, TsmcExponents
from detumble.scenario.model import Scenario
from detumble.scenario.physics import tensor

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from detumble.scenario.laws import Form

Array = NDArray[np.float64]
CHANNELS = ("translation", "rotation")
EXPONENT = "exponent"
_MOST = 21
"""Of numerator and denominator of an exponent."""
_ODD_PAIRS = [(p, q) for q in range(1, _MOST + 1, 2) for p in range(1, _MOST + 1, 2) if math.gcd(p, q) == 1]


@dataclass(frozen=True)
class Tunable:
    """A gain that can be searched for.

    Attributes:
        path: within the law's table: `translation.kp`, `alpha`.
        unit: SI; empty for pure numbers.
        meaning: one phrase.
        scale: its natural scale; None where the range is one of plain numbers.
        span: ends of the range, in natural scales.
    """

    path: str
    unit: str
    meaning: str
    scale: Scale | None
    span: Span

    @property
    def channel(self) -> str:
        """`translation`, `rotation`, `stack.translation`, `stack.rotation`; empty for alpha, which all of them share."""
        return self.path.rpartition(".")[0]

    def range(self, natural: Natural | None) -> Span:
        """Give the ends of the range, in the gain's unit."""
        scale = self.scale(natural) if self.scale and natural else 1.0
        return self.span[0] * scale, self.span[1] * scale

    def value(self, x: float, natural: Natural | None) -> float:
        """Give the gain at a coordinate in [0, 1]."""
        low, high = self.range(natural)
        return low * (high / low) ** x if self.scale else low + (high - low) * x

    def coordinate(self, value: float, natural: Natural | None) -> float:
        """Undo `value`; outside of the range it gives its nearer end."""
        low, high = self.range(natural)
        inside = min(max(value, low), high)
        return math.log(inside / low) / math.log(high / low) if self.scale else (inside - low) / (high - low)


def gains_of(
    law: str, form: Form = "printed", stack: Sequence[str] = (), powers: Sequence[str] = ()
) -> tuple[Tunable, ...]:
    """Name the gains of a law that can be searched for.

    Args:
        law: one of `LAWS`.
        form: decides the range of TSMC's exponent.
        stack: channels of which the stack has a set of its own.
        powers: channels of PRRL with an alpha of their own, `rotation`, `stack.rotation`; the others share one.

    Raises:
        RequestError: there is no such law.
    """
    section = section_at(Scenario, ("laws", choice("law", law, LAWS)))
    assert section is not None
    paths = (*CHANNELS, *(f"stack.{channel}" for channel in CHANNELS if channel in stack))
    shared = [""] if section is Prrl and not set(paths) <= set(powers) else []
    found = [
        Tunable(f"{path}.alpha".lstrip("."), "", "power of the reaching law", None, Prrl.searched)
        for path in (*shared, *(path for path in paths if path in powers))
    ]
    for path in paths:
        channel = section_of(section.model_fields[path.removeprefix("stack.")].annotation)
        assert channel is not None
        for name, field in channel.model_fields.items():
            quantity = quantity_of(field)
            if isinstance(quantity, Gain):
                found.append(Tunable(f"{path}.{name}", quantity.unit, quantity.meaning, quantity.scale, quantity.span))
        if issubclass(channel, TsmcExponents):
            found.append(Tunable(f"{path}.{EXPONENT}", "", "p/q of the terminal surface", None, EXPONENTS[form]))
    return tuple(found)


def gains_in(law: str, table: Mapping[str, Any]) -> tuple[Tunable, ...]:
    """Name the gains of a law as a scenario has them: its form, its sets, its powers.

    Args:
        law: one of `LAWS`.
        table: of the law, as its file has it.
    """
    stack: Mapping[str, Any] = table.get("stack", {})
    own = {
        **{channel: table[channel] for channel in CHANNELS},
        **{f"stack.{channel}": stack[channel] for channel in stack},
    }
    powers = [path for path, gains in own.items() if "alpha" in gains] if law == "prrl" else []
    return gains_of(law, table["form"], tuple(stack), powers)


def odd_fraction(exponent: float, form: Form) -> tuple[int, int]:
    """Give the fraction p/q of odd numbers up to 21, on the form's side of 1, that is nearest to an exponent."""
    low, high = EXPONENTS[form]
    allowed = [(p, q) for p, q in _ODD_PAIRS if p != q and low * q - 1e-9 <= p <= high * q + 1e-9]
    return min(allowed, key=lambda pair: (abs(pair[0] / pair[1] - exponent), pair[1]))


def natural_of(scenario: Scenario, channel: str, r: float = 1.0) -> Natural:
    """Give what the gains of a channel are measured by; see above.

    Args:
        scenario: nominal.
        channel: `translation`, `rotation`, `stack.translation` or `stack.rotation`.
        r: weight of LQR's input.

    Raises:
        RequestError: the channel has no limit on any axis.
    """
    after = channel.startswith("stack.")
    kind: Literal["force", "torque"] = "force" if channel.endswith("translation") else "torque"
    weakest = float(_limits(scenario, kind).min())
    body = "stack" if after else "chaser"
    if kind == "torque":
        inertia = design(f"{body}_inertia", scenario.at) if after else tensor(scenario.chaser.inertia)
        moment = float(np.linalg.eigvalsh(np.array(inertia)).max())
        return Natural(moment, weakest / moment, 1.0, r)
    mass = design(f"{body}_mass", scenario.at)
    length = scenario.capture.distance if after else max(_distance(scenario), scenario.capture.distance)
    return Natural(mass, weakest / mass, length, r)


def mean_acceleration(scenario: Scenario) -> float:
    """Give the mean over the axes of the most that each accelerates the chaser, m/s².

    Raises:
        RequestError: force is limited on no axis.
    """
    mass: float = design("chaser_mass", scenario.at)
    return float(_limits(scenario, "force").mean()) / mass


def _limits(scenario: Scenario, kind: Literal["force", "torque"]) -> Array:
    """What the actuators give on each axis, (3,); an infinite limit counts as the largest finite one."""
    actuators = scenario.actuators
    limits = np.multiply(axes(getattr(actuators, f"{kind}_limit")), axes(getattr(actuators, f"{kind}_gain")))
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
