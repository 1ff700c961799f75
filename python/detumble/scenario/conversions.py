"""The conversions from fields of a scenario to numbers of the core, by name.

Those of `NUMBERS` take each field as its numbers stand after `Quantity.numbers`: an array whose last axis holds 1 number, 3 of a
vector, 4 of a unit quaternion, or the 6 of an inertia (xx, yy, zz, xy, xz, yz). They work on one value, shape (k,), and on a
column of draws, shape (n, k), alike, and give as many bits of the same. Those of `PLAN` take the fields as they are.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_TENSOR = [0, 3, 4, 3, 1, 5, 4, 5, 2]
"""Where xx, yy, zz, xy, xz, yz stand in the rows of the tensor."""


def number(value: Array) -> Array:
    """The number or numbers as they are."""
    return value


def degrees(value: Array) -> Array:
    """Degrees to rad: times pi/180."""
    return value * (math.pi / 180.0)


def per_axis(value: Array) -> Array:
    """Three numbers; one number stands for every axis."""
    return np.repeat(value, 3, axis=-1) if value.shape[-1] == 1 else value


def tensor(*inertias: Array) -> Array:
    """The sum of inertias xx, yy, zz, xy, xz, yz as a symmetric 3x3 matrix, row by row."""
    return total(*inertias)[..., _TENSOR]


def total(*values: Array) -> Array:
    """The sum, from left to right."""
    first, *others = values
    for other in others:
        first = first + other
    return first


def ratio(numerator: Array, denominator: Array) -> Array:
    """The first over the second."""
    return numerator / denominator


def mean_motion(mu: Array, *radius: Array) -> Array:
    """sqrt(mu / a^3), rad/s, of a circular orbit whose radius a is the sum of all after the first."""
    a = total(*radius)
    root: Array = np.sqrt(mu / (a * a * a))
    return root


def zeros() -> Array:
    """Three zeros."""
    return np.zeros(3)


def infinite() -> Array:
    """Infinity."""
    return np.array([math.inf])


def unlimited() -> Array:
    """Infinity on each of three axes."""
    return np.full(3, math.inf)


def word(value: Any) -> Any:
    """The word, number or switch as it is."""
    return value


def ticks(duration: float, period: float) -> int:
    """The periods that cover a duration: with c = duration / period the least whole number >= c - 1e-9 max(1, c), at least 0."""
    count = duration / period
    return max(0, math.ceil(count - 1e-9 * max(1.0, count)))


def steps(step: float, period: float) -> int:
    """The fewest equal steps that a period is cut into for none to be longer than `step`: ticks(period, step), at least 1."""
    return max(1, ticks(period, step))


def nearest_tick(time: float, period: float) -> int:
    """The whole number nearest to time / period."""
    return round(time / period)


def tick_within(time: float, duration: float, period: float) -> int:
    """nearest_tick(time, period), at most one tick after the end of the flight: nearest_tick(duration, period) + 1."""
    return min(nearest_tick(time, period), nearest_tick(duration, period) + 1)


def wait(time: float, duration: float, period: float) -> int:
    """The periods that cover a wait: ticks(min(time, end), period) with end = (nearest_tick(duration, period) + 1) period."""
    return ticks(min(time, (nearest_tick(duration, period) + 1) * period), period)


NUMBERS: Mapping[str, Callable[..., Array]] = {
    made.__name__: made
    for made in (number, degrees, per_axis, tensor, total, ratio, mean_motion, zeros, infinite, unlimited)
}
PLAN: Mapping[str, Callable[..., Any]] = {
    made.__name__: made for made in (word, ticks, steps, nearest_tick, tick_within, wait)
}
ALL: Mapping[str, Callable[..., Any]] = {**NUMBERS, **PLAN}
