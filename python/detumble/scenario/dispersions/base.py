"""What every dispersion is: a field, a distribution, and the check that each draw lies within the field's range."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from pydantic import Field, GetJsonSchemaHandler
from pydantic_core import core_schema

from detumble.scenario.quantity import Quantity, Refusal, Shape
from detumble.scenario.section import Section
from detumble.scenario.wording import pretty, shown

Tree = dict[str, Any]

CUT = 7.0
"""Normal numbers are cut off this many sigma from the mean: that moves 2.6e-12 of them, and gives every draw a bound."""
FARTHEST = 35.0
"""Bounds of a truncated normal lie at most this many sigma out; the share of the distribution beyond is 1e-268."""


class Misfit(Exception):
    """Why a dispersion does not fit its field: the key at fault, and the reason in words."""

    def __init__(self, key: str, text: str) -> None:
        super().__init__(key, text)
        self.key = key
        self.text = text


@dataclass(frozen=True)
class Target:
    """A field that is dispersed.

    Attributes:
        path: dotted.
        quantity: its unit, shape and range.
        nominal: its value in the file; what a law believes where the file does not say.
    """

    path: str
    quantity: Quantity
    nominal: Any

    @property
    def values(self) -> tuple[float, ...]:
        """The nominal numbers of a number, axes or vector, one by one."""
        return self.nominal if isinstance(self.nominal, tuple) else (self.nominal,)

    def hold(self, key: str, number: float, how: str = "") -> None:
        """Make sure that a draw may be as small, or as large, as this number.

        Raises:
            Misfit: at the key; `how` says how draws come there.
        """
        # A number is read as from the file: that also asks whether kilometres were meant.
        check = self.quantity.read if self.quantity.shape == "number" and not how else self.quantity.range.check
        try:
            check(number)
        except Refusal as refusal:
            reached = f"draws reach {self.worded(number)}, but " if how else ""
            raise Misfit(key, f"{reached}{self.path} {refusal}{how}") from None

    def worded(self, number: float) -> str:
        """Write a number with the field's unit."""
        return pretty(f"{shown(float(f'{number:.6g}'))} {self.quantity.unit}".rstrip())


class Parameter(Quantity):
    """A number of a distribution, or one for each axis, in the unit of the field that is dispersed."""

    def __init__(self, meaning: str, *, shape: Shape = "axes", above: float | None = None, least: float | None = None):
        super().__init__("", meaning, shape=shape, above=above, least=least)

    def _json_schema(self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler) -> Tree:
        return super()._json_schema(schema, handler) | {"unit": "field's unit"}


def normal(mean: float, sigma: float) -> Tree:
    """Describe a normal number as the core takes it."""
    return {"kind": "normal", "mean": mean, "sigma": sigma, "low": mean - CUT * sigma, "high": mean + CUT * sigma}


class Dispersion(Section):
    """A field, and the distribution that its values are drawn from."""

    field: str = Field(description="path of a number, vector, attitude or inertia of this file: chaser.mass")
    distribution: str

    shapes: ClassVar[tuple[Shape, ...]]
    """What it can disperse."""

    def resolve(self, target: Target) -> Tree:
        """Give the distribution as the core takes it, resolved against its field.

        Raises:
            Misfit: it does not fit the field.
        """
        raise NotImplementedError
