"""Super-twisting sliding mode: of second order, no boundary layer, one form. Not of the paper."""

from __future__ import annotations

from typing import Annotated

from detumble.scenario.laws.base import SLOPE, Channel, Gain, Law
from detumble.scenario.quantity import Axes


def _slope(unit: str) -> Gain:
    return Gain(unit, "slope of the surface", lambda c: 1 / c.time, symbol="Lambda", aliases=("c", *SLOPE[2:]))


def _root(unit: str) -> Gain:
    meaning = "rate per root of the surface; 1.5 sqrt(L) for a disturbance of slope L"
    return Gain(unit, meaning, lambda c: 1.5 * (c.acceleration / c.time) ** 0.5)


def _integral(unit: str) -> Gain:
    meaning = "growth of the integral; 1.1 L for a disturbance of slope L"
    return Gain(unit, meaning, lambda c: 1.1 * c.acceleration / c.time)


class StsmcTranslation(Channel):
    """s = e_v + slope e_r; s' = -k1 |s|^(1/2) sgn s + v, v' = -k2 sgn s."""

    slope: Annotated[Axes, _slope("1/s")]
    k1: Annotated[Axes, _root("(m/s)^(1/2)/s")]
    k2: Annotated[Axes, _integral("m/s^3")]


class StsmcRotation(Channel):
    """s = e_w + slope eps; s' = -k1 |s|^(1/2) sgn s + v, v' = -k2 sgn s."""

    slope: Annotated[Axes, _slope("rad/s")]
    k1: Annotated[Axes, _root("(rad/s)^(1/2)/s")]
    k2: Annotated[Axes, _integral("rad/s^3")]


class Stsmc(Law[StsmcTranslation, StsmcRotation]):
    """Super-twisting sliding mode."""

    title = "STSMC"
    colour = "#7B3FA0"
    dashes = (0, (1.0, 1.0, 4.0, 1.0))
    marker = "X"
