"""Numbers drawn one by one: a number, or independently each element of a vector."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from detumble.scenario.dispersions.base import CUT, FARTHEST, Dispersion, Misfit, Parameter, Target, Tree, normal
from detumble.scenario.quantity import Axes, Quantity
from detumble.scenario.section import Relation
from detumble.scenario.wording import shown


class Elementwise(Dispersion):
    """Numbers drawn one by one: a number, or independently each element of a vector.

    Parameters are one number for all elements, or one for each.
    """

    shapes = ("number", "vector", "axes")

    def resolve(self, target: Target) -> Tree:
        """Give every element's distribution."""
        return {"kind": "elements", "elements": [self.marginal(target, k) for k in range(len(target.values))]}

    def marginal(self, target: Target, element: int) -> Tree:
        """Give the distribution of one element as the core takes it."""
        raise NotImplementedError

    def number(self, key: str, target: Target, element: int) -> float:
        """Give a parameter for one element."""
        value: Axes = getattr(self, key)
        if isinstance(value, float):
            return value
        if len(target.values) == 1:
            every = ", for all axes alike" if target.quantity.shape == "axes" else ""
            raise Misfit(key, f"has 3 elements, but {target.path} is one number{every}")
        return value[element]


def _pairs(low: Axes, high: Axes) -> Iterator[tuple[float, float]]:
    low, high = ((bound,) * 3 if isinstance(bound, float) else bound for bound in (low, high))
    return zip(low, high, strict=True)


def bounds_fault(low: Axes | None, high: Axes | None) -> str | None:
    """Say why two bounds, both given, have nothing between them; else None."""
    if low is None or high is None or all(below < above for below, above in _pairs(low, high)):
        return None
    return f"must be greater than low ({shown(low)})"


def _spread_fault(low: Axes, high: Axes) -> str | None:
    pairs = list(_pairs(low, high))
    if all(below <= above for below, above in pairs) and any(below < above for below, above in pairs):
        return None
    several = (
        "" if isinstance(low, float) and isinstance(high, float) else "; an axis whose bounds are equal stays fixed"
    )
    return f"must be greater than low ({shown(low)}){several}"


_SIGMA_OR_RELATIVE = Relation(
    "sigma",
    ("sigma", "relative"),
    lambda sigma, relative: (
        "exactly one of sigma and relative must be given" if (sigma is None) == (relative is None) else None
    ),
)


class Gaussian(Elementwise):
    """Mean and standard deviation."""

    sigma: Annotated[Axes, Parameter("standard deviation; or give relative", least=0.0)] | None = None
    relative: (
        Annotated[Axes, Quantity("", "standard deviation as a share of the nominal", shape="axes", least=0.0)] | None
    ) = None
    mean: Annotated[Axes, Parameter("default: the nominal value")] | None = None

    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (("sigma", "relative"),)
    relations: ClassVar[tuple[Relation, ...]] = (_SIGMA_OR_RELATIVE,)

    def resolve(self, target: Target) -> Tree:
        """Give every element's distribution, if there is any spread."""
        if any(map(math.isinf, target.values)):
            raise Misfit("field", "is inf, and nothing lies about that; give it a finite value, or use uniform")
        if not any(self._sigma(target, k) for k in range(len(target.values))):
            if self.sigma is None and any(self.relative if isinstance(self.relative, tuple) else (self.relative,)):
                raise Misfit("relative", f"a share of {target.path} = {shown(target.nominal)} is nothing; use sigma")
            raise Misfit(self._spread, "must be greater than 0")
        return super().resolve(target)

    @property
    def _spread(self) -> str:
        return "relative" if self.sigma is None else "sigma"

    def _sigma(self, target: Target, element: int) -> float:
        spread = self.number(self._spread, target, element)
        return spread * abs(target.values[element]) if self.sigma is None else spread

    def _mean(self, target: Target, element: int) -> float:
        return target.values[element] if self.mean is None else self.number("mean", target, element)


class Normal(Gaussian):
    """Normal about the nominal value, cut off at 7 sigma; the field's range must reach that far."""

    distribution: Literal["normal"] = Field("normal", description="of every number by itself")

    def marginal(self, target: Target, element: int) -> Tree:
        """Give one element's distribution; its range must reach as far as its draws."""
        drawn = normal(self._mean(target, element), self._sigma(target, element))
        for bound in (drawn["low"], drawn["high"]):
            target.hold(self._spread, bound, f"; at {CUT:g} sigma; use truncated_normal with low and high")
        return drawn


class TruncatedNormal(Gaussian):
    """The part of a normal distribution between two bounds. Without one of them that side is as in `normal`."""

    distribution: Literal["truncated_normal"] = Field("truncated_normal", description="of every number by itself")
    low: Annotated[Axes, Parameter("least value")] | None = None
    high: Annotated[Axes, Parameter("greatest value")] | None = None

    relations: ClassVar[tuple[Relation, ...]] = (
        _SIGMA_OR_RELATIVE,
        Relation("high", ("low", "high"), bounds_fault),
        Relation(
            "low",
            ("low", "high"),
            lambda low, high: "low or high must be given, or both" if low is high is None else None,
        ),
    )

    def marginal(self, target: Target, element: int) -> Tree:
        """Give one element's distribution, with both bounds."""
        mean, sigma = self._mean(target, element), self._sigma(target, element)
        if sigma == 0.0:
            raise Misfit(self._spread, f"of {target.path} must be greater than 0 on every axis")
        low, high = (
            None if getattr(self, key) is None else self.number(key, target, element) for key in ("low", "high")
        )
        for key, bound, beyond in (("low", low, 1.0), ("high", high, -1.0)):
            if bound is None:
                continue
            target.hold(key, bound)
            if beyond * (bound - mean) > FARTHEST * sigma:
                text = f"lies {beyond * (bound - mean) / sigma:.4g} sigma beyond the mean; at most {FARTHEST:g}"
                raise Misfit(key, text)
        if low is None:
            low = min(mean, mean if high is None else high) - CUT * sigma
            target.hold(self._spread, low, f"; at {CUT:g} sigma; give low")
        if high is None:
            high = max(mean, low) + CUT * sigma
            target.hold(self._spread, high, f"; at {CUT:g} sigma; give high")
        return {"kind": "truncated_normal", "mean": mean, "sigma": sigma, "low": low, "high": high}


class Between(Elementwise):
    """Two bounds."""

    low: Annotated[Axes, Parameter("least value")]
    high: Annotated[Axes, Parameter("greatest value")]

    relations: ClassVar[tuple[Relation, ...]] = (Relation("high", ("low", "high"), _spread_fault),)

    def marginal(self, target: Target, element: int) -> Tree:
        """Give one element's distribution."""
        low, high = self.number("low", target, element), self.number("high", target, element)
        target.hold("low", low)
        target.hold("high", high)
        return {"kind": self.distribution, "low": low, "high": high}


class Uniform(Between):
    """Uniform between two bounds."""

    distribution: Literal["uniform"] = Field("uniform", description="of every number by itself")


class LogUniform(Between):
    """Uniform in the logarithm between two bounds."""

    distribution: Literal["log_uniform"] = Field("log_uniform", description="of every number by itself")
    low: Annotated[Axes, Parameter("least value", above=0.0)]
    high: Annotated[Axes, Parameter("greatest value", above=0.0)]
