"""The laws' gains as a scenario gives them: one class for each channel of each law, since the units differ.

Translation tells m, m/s and N; rotation tells the vector part of the error quaternion (no unit), rad/s and N m.

Each gain tells its natural scale too: what it would be if the error were of the channel's length, and the law asked there for
all that the actuators give. So ranges of gains fit spacecraft of any size; see `Natural`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, ClassVar, Generic, Literal, TypeVar

from pydantic import Field

from detumble.scenario.quantity import Axes, Quantity, Vector
from detumble.scenario.section import Relation, Section

LAWS = ("pd", "lqr", "sosmc", "tsmc", "prrl")
"""The closed-loop laws, in the paper's order; `none` flies open loop."""

TITLES = {"pd": "PD", "lqr": "LQR", "sosmc": "SOSMC", "tsmc": "TSMC", "prrl": "PRRL-SMC", "none": "open loop"}
"""What tables and figures call each law."""

Form = Literal["printed", "corrected"]


@dataclass(frozen=True)
class Natural:
    """What the gains of one channel are measured by.

    Attributes:
        mass: kg, or the largest moment of inertia in kg m².
        acceleration: the most that the weakest axis gives, m/s² or rad/s².
        length: m; 1 in rotation, where the vector part of the error quaternion has no unit.
        r: weight of the input in LQR; only ratios of weights count.
        power: alpha, or the exponent p/q.
    """

    mass: float
    acceleration: float
    length: float
    r: float = 1.0
    power: float = 1.0

    @property
    def time(self) -> float:
        """s: sqrt(length / acceleration)."""
        return math.sqrt(self.length / self.acceleration)

    @property
    def speed(self) -> float:
        """m/s or rad/s: sqrt(length acceleration)."""
        return math.sqrt(self.length * self.acceleration)


Scale = Callable[[Natural], float]
"""Gives a gain's natural scale."""
Span = tuple[float, float]


class Gain(Quantity):
    """A gain: a number for every axis or one for each, not negative, and where to search for it.

    Args:
        unit, meaning: as of any quantity.
        scale: its natural scale.
        above: excluded lower bound; None allows 0.
        span: least and most to search, in natural scales.
    """

    def __init__(
        self, unit: str, meaning: str, scale: Scale, *, above: float | None = None, span: Span = (1e-3, 1e2)
    ) -> None:
        least = 0.0 if above is None else None
        super().__init__(unit, meaning, shape="axes", above=above, least=least, most=1e9)
        self.scale = scale
        self.span = span


_SQUARES = (1e-6, 1e4)
"""Span of weights, whose square roots are gains."""


class PdTranslation(Section):
    """U = -kp e_r - kd e_v."""

    kp: Annotated[Axes, Gain("N/m", "force per position error", lambda c: c.mass * c.acceleration / c.length)]
    kd: Annotated[Axes, Gain("N s/m", "force per velocity error", lambda c: c.mass / c.time)]


class PdRotation(Section):
    """tau = -kp eps - kd w."""

    kp: Annotated[
        Axes, Gain("N m", "torque per vector part of the error quaternion", lambda c: c.mass * c.acceleration)
    ]
    kd: Annotated[Axes, Gain("N m s/rad", "torque per angular rate", lambda c: c.mass / c.time)]


class LqrTranslation(Section):
    """Weights of the Riccati problem whose input is acceleration."""

    q_error: Annotated[
        Axes,
        Gain("1/m^2", "weight of the position error", lambda c: c.r * c.time**-4, above=0.0, span=_SQUARES),
    ]
    q_rate: Annotated[Axes, Gain("s^2/m^2", "weight of the velocity error", lambda c: c.r * c.time**-2, span=_SQUARES)]
    r: Annotated[float, Quantity("s^4/m^2", "weight of the acceleration", above=0.0, most=1e12)]


class LqrRotation(Section):
    """Weights of the Riccati problem whose input is torque."""

    q_error: Annotated[
        Axes,
        Gain(
            "",
            "weight of the vector part of the error quaternion",
            lambda c: c.r * (c.mass * c.acceleration) ** 2,
            above=0.0,
            span=_SQUARES,
        ),
    ]
    q_rate: Annotated[
        Axes, Gain("s^2/rad^2", "weight of the angular rate", lambda c: c.r * (c.mass / c.time) ** 2, span=_SQUARES)
    ]
    r: Annotated[float, Quantity("1/(N m)^2", "weight of the torque", above=0.0, most=1e12)]


class SosmcTranslation(Section):
    """s = e_v + slope e_r; s' = -gain sat(s/layer) - proportional s."""

    slope: Annotated[Axes, Gain("1/s", "c, slope of the surface", lambda c: 1 / c.time)]
    gain: Annotated[Axes, Gain("m/s^2", "K, constant reaching rate", lambda c: c.acceleration)]
    proportional: Annotated[Axes, Gain("1/s", "alpha, proportional reaching rate", lambda c: 1 / c.time)]
    layer: Annotated[Axes, Gain("m/s", "phi, thickness of the boundary layer", lambda c: c.speed, above=0.0)]


class SosmcRotation(Section):
    """s = e_w + slope eps; s' = -gain sat(s/layer) - proportional s."""

    slope: Annotated[Axes, Gain("rad/s", "c, slope of the surface", lambda c: 1 / c.time)]
    gain: Annotated[Axes, Gain("rad/s^2", "K, constant reaching rate", lambda c: c.acceleration)]
    proportional: Annotated[Axes, Gain("1/s", "alpha, proportional reaching rate", lambda c: 1 / c.time)]
    layer: Annotated[Axes, Gain("rad/s", "phi, thickness of the boundary layer", lambda c: c.speed, above=0.0)]


EXPONENTS: dict[Form, Span] = {"printed": (1.0, 3.0), "corrected": (1.0 / 3.0, 1.0)}
"""Where the terminal exponent is searched, 1 itself excluded."""


def _odd(meaning: str) -> Quantity:
    return Quantity("", meaning, shape="odd", least=1, most=99)


_ABOVE_ONE = 'must be greater than 1: the printed form flies it; form = "corrected" flies p_corrected/q_corrected'
_BELOW_ONE = 'must be less than 1: the corrected form flies it; form = "printed" flies p/q'


class TsmcExponents(Section):
    """Terminal exponents p/q: above 1 as printed, below 1 in the corrected form."""

    p: Annotated[int, _odd("numerator of the printed exponent p/q > 1")] = 5
    q: Annotated[int, _odd("denominator of the printed exponent")] = 3
    p_corrected: Annotated[int, _odd("numerator of the corrected exponent p/q < 1")] = 3
    q_corrected: Annotated[int, _odd("denominator of the corrected exponent")] = 5

    relations: ClassVar[tuple[Relation, ...]] = (
        Relation("p", ("p", "q"), lambda p, q: None if p > q else f"p/q = {p}/{q} {_ABOVE_ONE}"),
        Relation(
            "p_corrected",
            ("p_corrected", "q_corrected"),
            lambda p, q: None if p < q else f"p_corrected/q_corrected = {p}/{q} {_BELOW_ONE}",
        ),
    )

    def exponent(self, form: Form) -> tuple[int, int]:
        """Give p and q of the exponent that a form flies."""
        return (self.p, self.q) if form == "printed" else (self.p_corrected, self.q_corrected)


class TsmcTranslation(TsmcExponents):
    """s = e_v + slope sgn(e_r) |e_r|^(p/q); s' = -gain sat(s/layer)."""

    slope: Annotated[
        Axes, Gain("m^(1-p/q)/s", "alpha, slope of the terminal surface", lambda c: c.speed / c.length**c.power)
    ]
    gain: Annotated[Axes, Gain("m/s^2", "beta, constant reaching rate", lambda c: c.acceleration)]
    layer: Annotated[Axes, Gain("m/s", "phi, thickness of the boundary layer", lambda c: c.speed, above=0.0)]


class TsmcRotation(TsmcExponents):
    """s = e_w + slope sgn(eps) |eps|^(p/q); s' = -gain sat(s/layer)."""

    slope: Annotated[Axes, Gain("rad/s", "alpha, slope of the terminal surface", lambda c: 1 / c.time)]
    gain: Annotated[Axes, Gain("rad/s^2", "beta, constant reaching rate", lambda c: c.acceleration)]
    layer: Annotated[Axes, Gain("rad/s", "phi, thickness of the boundary layer", lambda c: c.speed, above=0.0)]


def _power(meaning: str) -> Quantity:
    return Quantity("", meaning, above=0.0, below=1.0)


class PrrlTranslation(Section):
    """s = e_v + slope e_r; s' = -gain |s|^alpha sat(s/layer)."""

    slope: Annotated[Axes, Gain("1/s", "Lambda, slope of the surface", lambda c: 1 / c.time)]
    gain: Annotated[
        Axes, Gain("(m/s)^(1-alpha)/s", "K, power reaching rate", lambda c: c.acceleration / c.speed**c.power)
    ]
    layer: Annotated[Axes, Gain("m/s", "phi, thickness of the boundary layer", lambda c: c.speed, above=0.0)]
    alpha: Annotated[float, _power("power of the reaching law here; default: that of the law")] | None = None


class PrrlRotation(Section):
    """s = e_w + slope eps; s' = -gain |s|^alpha sat(s/layer)."""

    slope: Annotated[Axes, Gain("rad/s", "Lambda, slope of the surface", lambda c: 1 / c.time)]
    gain: Annotated[
        Axes, Gain("(rad/s)^(1-alpha)/s", "K, power reaching rate", lambda c: c.acceleration / c.speed**c.power)
    ]
    layer: Annotated[Axes, Gain("rad/s", "phi, thickness of the boundary layer", lambda c: c.speed, above=0.0)]
    alpha: Annotated[float, _power("power of the reaching law here; default: that of the law")] | None = None


Translation = TypeVar("Translation", bound=Section)
Rotation = TypeVar("Rotation", bound=Section)


class StackGains(Section, Generic[Translation, Rotation]):
    """A second set of gains, flown after capture; a channel without one keeps the first."""

    translation: Translation | None = None
    rotation: Rotation | None = None


class Provenance(Section):
    """How the gains of a law were found by a search; nothing of it is flown."""

    objective: Literal["capture", "settling", "delta_v", "delta_v_total", "pareto"] = Field(
        description="what was made small"
    )
    statistic: str = Field(description="over the starts: `mean`, or a percentile such as `p95`")
    time_s: float | None = Field(None, ge=0.0, allow_inf_nan=False, description="that statistic of the time reached, s")
    delta_v_m_s: float | None = Field(None, ge=0.0, allow_inf_nan=False, description="that of the Δv reached, m/s")
    success: float = Field(ge=0.0, le=1.0, description="share of the starts that succeeded")
    required: float = Field(ge=0.0, le=1.0, description="share that had to")
    until: Literal["settled", "captured", "duration"] = Field(description="how the flights ended")
    horizon_s: float = Field(gt=0.0, allow_inf_nan=False, description="later than this was a failure, s")
    starts: int = Field(ge=1, strict=True, description="runs of the campaign that each candidate flew")
    seed: int = Field(ge=0, strict=True, description="of these runs")
    optimiser_seed: int = Field(ge=0, strict=True, description="of the search")
    evaluations: int = Field(ge=1, strict=True, description="candidates tried")
    version: str = Field(description="of detumble")


class Law(Section, Generic[Translation, Rotation]):
    """One law: its form, its gains, and perhaps other gains for the stack."""

    form: Form = Field("printed", description="as the paper prints the law, or with its slips corrected")
    translation: Translation
    rotation: Rotation
    stack: StackGains[Translation, Rotation] | None = None
    tuned: Provenance | None = None


class Pd(Law[PdTranslation, PdRotation]):
    """Proportional-derivative control."""


class Lqr(Law[LqrTranslation, LqrRotation]):
    """Linear-quadratic regulator: Q = diag(q_error, q_rate), R = r 1."""


class Sosmc(Law[SosmcTranslation, SosmcRotation]):
    """The paper's "second-order" sliding mode: constant plus proportional reaching law."""


class Tsmc(Law[TsmcTranslation, TsmcRotation]):
    """Terminal sliding mode."""


class Prrl(Law[PrrlTranslation, PrrlRotation]):
    """Power rate reaching law sliding mode."""

    alpha: Annotated[float, _power("power of the reaching law, in every channel that has none of its own")] | None = (
        None
    )

    searched: ClassVar[Span] = (0.05, 0.95)
    """Where alpha is searched."""
    relations: ClassVar[tuple[Relation, ...]] = (
        Relation(
            "alpha",
            ("alpha", *(f"{channel}.alpha" for channel in ("translation", "rotation"))),
            lambda shared, *own: _NO_POWER if shared is None and None in own else None,
        ),
        Relation(
            "alpha",
            ("alpha", "stack.translation", "stack.rotation"),
            lambda shared, *own: (
                _NO_POWER if shared is None and any(gains and gains.alpha is None for gains in own) else None
            ),
        ),
    )

    def power(self, channel: str) -> float:
        """Give alpha of a channel: `translation`, `stack.rotation`; a stack without gains of its own keeps the first."""
        gains = self.at(channel) or self.at(channel.removeprefix("stack."))
        own: float | None = gains.alpha
        power = self.alpha if own is None else own
        assert power is not None  # the relations above see to that
        return power


_NO_POWER = "missing; needed: power of the reaching law, for all channels here or in each channel"


class Segment(Section):
    """Force and torque held from `start` to `end`."""

    start: Annotated[float, Quantity("s", "begin, whole control periods", least=0.0)]
    end: Annotated[float, Quantity("s", "end, whole control periods", above=0.0)]
    frame: Literal["lvlh", "body", "command"] = Field(
        "lvlh",
        description="axes in which both vectors are given and held; body axes turn with the chaser; command is the force in "
        "lvlh, the torque in body axes, as laws command",
    )
    force: Annotated[Vector, Quantity("N", "force on the chaser", shape="vector")] = (0.0, 0.0, 0.0)
    torque: Annotated[Vector, Quantity("N m", "torque on the chaser", shape="vector")] = (0.0, 0.0, 0.0)

    relations: ClassVar[tuple[Relation, ...]] = (
        Relation(
            "end",
            ("start", "end"),
            lambda start, end: None if end > start else f"must be later than start ({start:.10g} s)",
        ),
    )


class OpenLoop(Section):
    """Law `none`: open loop; the bodies never merge."""

    segments: list[Segment] = Field(default_factory=list, description="sorted, not overlapping")


class Laws(Section):
    """What every law shares, and the gains of each law that this scenario can fly."""

    attitude_error: Literal["epsilon", "two_epsilon"] = Field(
        "epsilon", description="the laws use the vector part of the error quaternion, or twice it"
    )
    surface_rate: Literal["printed", "exact"] = Field(
        "printed", description="rate of the surface in the sliding laws' compensation"
    )
    pd: Pd | None = None
    lqr: Lqr | None = None
    sosmc: Sosmc | None = None
    tsmc: Tsmc | None = None
    prrl: Prrl | None = None
    none: OpenLoop | None = None

    @property
    def closed_loop(self) -> list[str]:
        """The laws that this scenario has gains for."""
        return [law for law in LAWS if getattr(self, law) is not None]

    @property
    def default(self) -> str:
        """The law that flies where none is named: the only one that has gains, open loop where none has, else PRRL-SMC."""
        laws = self.closed_loop or ["none"]
        return laws[0] if len(laws) == 1 else "prrl"
