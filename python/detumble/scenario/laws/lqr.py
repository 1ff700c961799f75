"""Linear-quadratic regulator: Q = diag(q_error, q_rate), R = r 1. Only ratios of weights act, so a search leaves r as it is."""

from __future__ import annotations

from typing import Annotated

from detumble.scenario.laws.base import SQUARES, Channel, Gain, Law, TwoForms
from detumble.scenario.quantity import Axes


def _input(unit: str, meaning: str) -> Gain:
    return Gain(unit, meaning, aliases=("R",), shape="number", above=0.0, most=1e12, span=None)


class LqrTranslation(Channel):
    """Weights of the Riccati problem whose input is acceleration."""

    q_error: Annotated[
        Axes,
        Gain(
            "1/m^2",
            "weight of the position error",
            lambda c: c["r"] * c.time**-4,
            aliases=("q_r", "q_e", "q_x", "Q"),
            above=0.0,
            span=SQUARES,
        ),
    ]
    q_rate: Annotated[
        Axes,
        Gain("s^2/m^2", "weight of the velocity error", lambda c: c["r"] * c.time**-2, aliases=("q_v",), span=SQUARES),
    ]
    r: Annotated[float, _input("s^4/m^2", "weight of the acceleration")]


class LqrRotation(Channel):
    """Weights of the Riccati problem whose input is torque."""

    q_error: Annotated[
        Axes,
        Gain(
            "",
            "weight of the vector part of the error quaternion",
            lambda c: c["r"] * (c.mass * c.acceleration) ** 2,
            aliases=("q_eps", "q_ε", "q_q", "q_theta", "q_θ", "q_r", "Q"),
            above=0.0,
            span=SQUARES,
        ),
    ]
    q_rate: Annotated[
        Axes,
        Gain(
            "s^2/rad^2",
            "weight of the angular rate",
            lambda c: c["r"] * (c.mass / c.time) ** 2,
            aliases=("q_w", "q_omega", "q_ω"),
            span=SQUARES,
        ),
    ]
    r: Annotated[float, _input("1/(N m)^2", "weight of the torque")]


class Lqr(Law[LqrTranslation, LqrRotation], TwoForms):
    """Linear-quadratic regulator: Q = diag(q_error, q_rate), R = r 1."""

    title = "LQR"
    colour = "#0072B2"
    dashes = (0, (6.0, 1.8))
    marker = "^"
