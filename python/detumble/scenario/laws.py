"""The laws' gains as a scenario gives them: one class for each channel of each law, since the units differ.

Translation tells m, m/s and N; rotation tells the vector part of the error quaternion (no unit), rad/s and N m.
"""

from __future__ import annotations

from typing import Annotated, ClassVar, Generic, Literal, TypeVar

from pydantic import Field

from detumble.scenario.quantity import Axes, Quantity, Vector
from detumble.scenario.section import Relation, Section

LAWS = ("pd", "lqr", "sosmc", "tsmc", "prrl")
"""The closed-loop laws, in the paper's order; `none` flies open loop."""

TITLES = {"pd": "PD", "lqr": "LQR", "sosmc": "SOSMC", "tsmc": "TSMC", "prrl": "PRRL-SMC", "none": "open loop"}
"""What tables and figures call each law."""

Form = Literal["printed", "corrected"]


def gain(unit: str, meaning: str, *, above: float | None = None) -> Quantity:
    """Describe a gain: a number for every axis or one for each, not negative."""
    least = 0.0 if above is None else None
    return Quantity(unit, meaning, shape="axes", above=above, least=least, most=1e9)


class PdTranslation(Section):
    """U = -kp e_r - kd e_v."""

    kp: Annotated[Axes, gain("N/m", "force per position error")]
    kd: Annotated[Axes, gain("N s/m", "force per velocity error")]


class PdRotation(Section):
    """tau = -kp eps - kd w."""

    kp: Annotated[Axes, gain("N m", "torque per vector part of the error quaternion")]
    kd: Annotated[Axes, gain("N m s/rad", "torque per angular rate")]


class LqrTranslation(Section):
    """Weights of the Riccati problem whose input is acceleration."""

    q_error: Annotated[Axes, gain("1/m^2", "weight of the position error", above=0.0)]
    q_rate: Annotated[Axes, gain("s^2/m^2", "weight of the velocity error")]
    r: Annotated[float, Quantity("s^4/m^2", "weight of the acceleration", above=0.0, most=1e12)]


class LqrRotation(Section):
    """Weights of the Riccati problem whose input is torque."""

    q_error: Annotated[Axes, gain("", "weight of the vector part of the error quaternion", above=0.0)]
    q_rate: Annotated[Axes, gain("s^2/rad^2", "weight of the angular rate")]
    r: Annotated[float, Quantity("1/(N m)^2", "weight of the torque", above=0.0, most=1e12)]


class SosmcTranslation(Section):
    """s = e_v + slope e_r; s' = -gain sat(s/layer) - proportional s."""

    slope: Annotated[Axes, gain("1/s", "c, slope of the surface")]
    gain: Annotated[Axes, gain("m/s^2", "K, constant reaching rate")]
    proportional: Annotated[Axes, gain("1/s", "alpha, proportional reaching rate")]
    layer: Annotated[Axes, gain("m/s", "phi, thickness of the boundary layer", above=0.0)]


class SosmcRotation(Section):
    """s = e_w + slope eps; s' = -gain sat(s/layer) - proportional s."""

    slope: Annotated[Axes, gain("rad/s", "c, slope of the surface")]
    gain: Annotated[Axes, gain("rad/s^2", "K, constant reaching rate")]
    proportional: Annotated[Axes, gain("1/s", "alpha, proportional reaching rate")]
    layer: Annotated[Axes, gain("rad/s", "phi, thickness of the boundary layer", above=0.0)]


def _odd(meaning: str) -> Quantity:
    return Quantity("", meaning, shape="odd", least=1, most=99)


class TsmcExponents(Section):
    """Terminal exponents p/q: above 1 as printed, below 1 in the corrected form."""

    p: Annotated[int, _odd("numerator of the printed exponent p/q > 1")] = 5
    q: Annotated[int, _odd("denominator of the printed exponent")] = 3
    p_corrected: Annotated[int, _odd("numerator of the corrected exponent p/q < 1")] = 3
    q_corrected: Annotated[int, _odd("denominator of the corrected exponent")] = 5

    relations: ClassVar[tuple[Relation, ...]] = (
        Relation(
            "p", ("p", "q"), lambda p, q: None if p > q else f"p/q = {p}/{q} must be greater than 1 (printed form)"
        ),
        Relation(
            "p_corrected",
            ("p_corrected", "q_corrected"),
            lambda p, q: None if p < q else f"p/q = {p}/{q} must be less than 1 (corrected form)",
        ),
    )


class TsmcTranslation(TsmcExponents):
    """s = e_v + slope sgn(e_r) |e_r|^(p/q); s' = -gain sat(s/layer)."""

    slope: Annotated[Axes, gain("m^(1-p/q)/s", "alpha, slope of the terminal surface")]
    gain: Annotated[Axes, gain("m/s^2", "beta, constant reaching rate")]
    layer: Annotated[Axes, gain("m/s", "phi, thickness of the boundary layer", above=0.0)]


class TsmcRotation(TsmcExponents):
    """s = e_w + slope sgn(eps) |eps|^(p/q); s' = -gain sat(s/layer)."""

    slope: Annotated[Axes, gain("rad/s", "alpha, slope of the terminal surface")]
    gain: Annotated[Axes, gain("rad/s^2", "beta, constant reaching rate")]
    layer: Annotated[Axes, gain("rad/s", "phi, thickness of the boundary layer", above=0.0)]


class PrrlTranslation(Section):
    """s = e_v + slope e_r; s' = -gain |s|^alpha sat(s/layer)."""

    slope: Annotated[Axes, gain("1/s", "Lambda, slope of the surface")]
    gain: Annotated[Axes, gain("(m/s)^(1-alpha)/s", "K, power reaching rate")]
    layer: Annotated[Axes, gain("m/s", "phi, thickness of the boundary layer", above=0.0)]


class PrrlRotation(Section):
    """s = e_w + slope eps; s' = -gain |s|^alpha sat(s/layer)."""

    slope: Annotated[Axes, gain("rad/s", "Lambda, slope of the surface")]
    gain: Annotated[Axes, gain("(rad/s)^(1-alpha)/s", "K, power reaching rate")]
    layer: Annotated[Axes, gain("rad/s", "phi, thickness of the boundary layer", above=0.0)]


Translation = TypeVar("Translation", bound=Section)
Rotation = TypeVar("Rotation", bound=Section)


class StackGains(Section, Generic[Translation, Rotation]):
    """A second set of gains, flown after capture; a channel without one keeps the first."""

    translation: Translation | None = None
    rotation: Rotation | None = None


class Law(Section, Generic[Translation, Rotation]):
    """One law: its form, its gains, and perhaps other gains for the stack."""

    form: Form = Field("printed", description="as the paper prints the law, or with its slips corrected")
    translation: Translation
    rotation: Rotation
    stack: StackGains[Translation, Rotation] | None = None


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

    alpha: Annotated[float, Quantity("", "power of the reaching law", above=0.0, below=1.0)]


class Segment(Section):
    """Force and torque held from `start` to `end`."""

    start: Annotated[float, Quantity("s", "begin, whole control periods", least=0.0)]
    end: Annotated[float, Quantity("s", "end, whole control periods", above=0.0)]
    frame: Literal["lvlh", "body"] = Field(
        "lvlh", description="axes in which both vectors are given and held; body axes turn with the chaser"
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
