"""Terminal sliding mode. Its exponent p/q of odd numbers is above 1 as printed, below 1 in the corrected form."""

from __future__ import annotations

from typing import Annotated, ClassVar

from detumble.scenario.laws.base import GAIN, SLOPE, Channel, Gain, GainByForm, Law, OddFraction, Scale, TwoForms, layer
from detumble.scenario.quantity import Axes, Quantity
from detumble.scenario.section import Relation

EXPONENT = GainByForm(
    "exponent",
    "p/q of the terminal surface",
    {
        "printed": OddFraction(("p", "q"), (1.0, 3.0)),
        "corrected": OddFraction(("p_corrected", "q_corrected"), (1.0 / 3.0, 1.0)),
    },
)

_ABOVE_ONE = 'must be greater than 1: the printed form flies it; form = "corrected" flies p_corrected/q_corrected'
_BELOW_ONE = 'must be less than 1: the corrected form flies it; form = "printed" flies p/q'


def _odd(meaning: str) -> Quantity:
    return Quantity("", meaning, provenance="ours", shape="odd", least=1, most=99)


def _slope(unit: str, scale: Scale) -> Gain:
    return Gain(unit, "slope of the terminal surface", scale, symbol="alpha", aliases=("α", *SLOPE))


def _gain(unit: str) -> Gain:
    return Gain(unit, "constant reaching rate", lambda c: c.acceleration, symbol="beta", aliases=("β", *GAIN))


class TsmcExponents(Channel):
    """Terminal exponents p/q: above 1 as printed, below 1 in the corrected form."""

    p: Annotated[int, _odd("numerator of the printed exponent p/q > 1")] = 5
    q: Annotated[int, _odd("denominator of the printed exponent")] = 3
    p_corrected: Annotated[int, _odd("numerator of the corrected exponent p/q < 1")] = 3
    q_corrected: Annotated[int, _odd("denominator of the corrected exponent")] = 5

    by_form: ClassVar[tuple[GainByForm, ...]] = (EXPONENT,)
    relations: ClassVar[tuple[Relation, ...]] = (
        Relation("p", ("p", "q"), lambda p, q: None if p > q else f"p/q = {p}/{q} {_ABOVE_ONE}"),
        Relation(
            "p_corrected",
            ("p_corrected", "q_corrected"),
            lambda p, q: None if p < q else f"p_corrected/q_corrected = {p}/{q} {_BELOW_ONE}",
        ),
    )


class TsmcTranslation(TsmcExponents):
    """s = e_v + slope sgn(e_r) |e_r|^(p/q); s' = -gain sat(s/layer)."""

    slope: Annotated[Axes, _slope("m^(1-p/q)/s", lambda c: c.speed / c.length ** c["exponent"])]
    gain: Annotated[Axes, _gain("m/s^2")]
    layer: Annotated[Axes, layer("m/s")]


class TsmcRotation(TsmcExponents):
    """s = e_w + slope sgn(eps) |eps|^(p/q); s' = -gain sat(s/layer)."""

    slope: Annotated[Axes, _slope("rad/s", lambda c: 1 / c.time)]
    gain: Annotated[Axes, _gain("rad/s^2")]
    layer: Annotated[Axes, layer("rad/s")]


class Tsmc(Law[TsmcTranslation, TsmcRotation], TwoForms):
    """Terminal sliding mode."""

    title = "TSMC"
    colour = "#CC79A7"
    dashes = (0, (3.0, 1.2))
    marker = "v"
