"""Power rate reaching law sliding mode. Its power alpha is shared by all channels that have none of their own."""

from __future__ import annotations

from typing import Annotated, ClassVar

from detumble.scenario.laws.base import GAIN, SLOPE, Channel, Gain, Law, TwoForms, layer, shared_gain
from detumble.scenario.quantity import Axes
from detumble.scenario.section import Relation

_POWER = "power of the reaching law"


def _power(note: str) -> Gain:
    return Gain("", _POWER, note=note, aliases=("α",), shape="number", above=0.0, below=1.0, span=(0.05, 0.95))


def _slope(unit: str) -> Gain:
    return Gain(unit, "slope of the surface", lambda c: 1 / c.time, symbol="Lambda", aliases=("c", *SLOPE[2:]))


def _gain(unit: str) -> Gain:
    scale = lambda c: c.acceleration / c.speed ** c["alpha"]  # noqa: E731  # named to fit a line
    return Gain(unit, "power reaching rate", scale, symbol="K", aliases=GAIN[1:])


class PrrlTranslation(Channel):
    """s = e_v + slope e_r; s' = -gain |s|^alpha sat(s/layer)."""

    slope: Annotated[Axes, _slope("1/s")]
    gain: Annotated[Axes, _gain("(m/s)^(1-alpha)/s")]
    layer: Annotated[Axes, layer("m/s")]
    alpha: Annotated[float, _power(" here; default: that of the law")] | None = None


class PrrlRotation(Channel):
    """s = e_w + slope eps; s' = -gain |s|^alpha sat(s/layer)."""

    slope: Annotated[Axes, _slope("rad/s")]
    gain: Annotated[Axes, _gain("(rad/s)^(1-alpha)/s")]
    layer: Annotated[Axes, layer("rad/s")]
    alpha: Annotated[float, _power(" here; default: that of the law")] | None = None


class Prrl(Law[PrrlTranslation, PrrlRotation], TwoForms):
    """Power rate reaching law sliding mode."""

    title = "PRRL-SMC"
    colour = "#D55E00"
    dashes = "-"
    marker = "o"
    width = 2.0

    alpha: Annotated[float, _power(", in every channel that has none of its own")] | None = None

    relations: ClassVar[tuple[Relation, ...]] = shared_gain("alpha", _POWER)
