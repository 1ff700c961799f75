"""The paper's "second-order" sliding mode: constant plus proportional reaching law."""

from __future__ import annotations

from typing import Annotated

from detumble.scenario.laws.base import GAIN, SLOPE, Channel, Gain, Law, TwoForms, layer
from detumble.scenario.quantity import Axes


def _slope(unit: str) -> Gain:
    return Gain(unit, "slope of the surface", lambda c: 1 / c.time, symbol="c", aliases=SLOPE[1:])


def _gain(unit: str) -> Gain:
    return Gain(unit, "constant reaching rate", lambda c: c.acceleration, symbol="K", aliases=GAIN[1:])


def _proportional() -> Gain:
    return Gain("1/s", "proportional reaching rate", lambda c: 1 / c.time, symbol="alpha", aliases=("α",))


class SosmcTranslation(Channel):
    """s = e_v + slope e_r; s' = -gain sat(s/layer) - proportional s."""

    slope: Annotated[Axes, _slope("1/s")]
    gain: Annotated[Axes, _gain("m/s^2")]
    proportional: Annotated[Axes, _proportional()]
    layer: Annotated[Axes, layer("m/s")]


class SosmcRotation(Channel):
    """s = e_w + slope eps; s' = -gain sat(s/layer) - proportional s."""

    slope: Annotated[Axes, _slope("rad/s")]
    gain: Annotated[Axes, _gain("rad/s^2")]
    proportional: Annotated[Axes, _proportional()]
    layer: Annotated[Axes, layer("rad/s")]


class Sosmc(Law[SosmcTranslation, SosmcRotation], TwoForms):
    """The paper's "second-order" sliding mode: constant plus proportional reaching law."""

    title = "SOSMC"
    colour = "#009E73"
    dashes = (0, (6.0, 1.5, 1.2, 1.5))
    marker = "D"
