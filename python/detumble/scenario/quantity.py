"""Physical quantities as field types: unit, meaning and range stand beside the field, and one place checks them.

`Annotated[float, Quantity("kg", "total mass", above=0.0)]` takes a finite number greater than zero. What is refused is
refused in one wording, which names the unit. Vectors are kept as tuples: an element cannot change behind the check.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, GetCoreSchemaHandler, GetJsonSchemaHandler, StrictBool
from pydantic_core import PydanticCustomError, core_schema

from detumble.checking import plain, unit_of
from detumble.scenario import physics
from detumble.scenario.rules import Place
from detumble.scenario.wording import shown

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
Matrix = tuple[Vector, Vector, Vector]
Axes = float | Vector
"""One number for every axis, or one for each."""
Inertia = Vector | Matrix
"""Principal moments, or the full symmetric tensor."""

Switch = Annotated[StrictBool, BeforeValidator(plain)]
"""True or false, and nothing that merely looks like it."""

Shape = Literal["number", "odd", "vector", "axes", "quaternion", "inertia"]
_SHAPES = {"vector": "a list of 3 numbers", "axes": "a number or a list of 3", "quaternion": "a list of 4 numbers"}
_SHAPES["inertia"] = "3 principal moments or a 3x3 list"


class Refusal(Exception):
    """Why a value cannot be taken; becomes a pydantic error at the boundary."""


@dataclass(frozen=True, kw_only=True)
class Range:
    """Bounds of a number; `above` and `below` exclude the bound itself."""

    above: float | None = None
    least: float | None = None
    below: float | None = None
    most: float | None = None
    infinite: bool = False

    def __str__(self) -> str:
        """Say the bounds in words."""
        named = (("greater than", self.above), ("at least", self.least), ("less than", self.below))
        parts = [f"{words} {shown(bound)}" for words, bound in (*named, ("at most", self.most)) if bound is not None]
        return " and ".join(parts)

    def check(self, number: float) -> None:
        """Raise Refusal if the number lies outside."""
        if math.isnan(number):
            raise Refusal("NaN is not a number that can be used here")
        if math.isinf(number) and not (self.infinite and number > 0):
            raise Refusal("must be finite")
        inside = (
            (self.above is None or number > self.above)
            and (self.least is None or number >= self.least)
            and (self.below is None or number < self.below)
            and (self.most is None or number <= self.most or math.isinf(number))
        )
        if not inside:
            raise Refusal(f"must be {self}")

    def json(self) -> dict[str, float]:
        """Give the bounds as JSON Schema keywords."""
        keywords = {
            "exclusiveMinimum": self.above,
            "minimum": self.least,
            "exclusiveMaximum": self.below,
            "maximum": None if self.infinite else self.most,
        }
        return {key: bound for key, bound in keywords.items() if bound is not None}


class Quantity:
    """A field's unit, meaning, shape and range, for use in `Annotated`.

    Args:
        unit: SI unit as printed; empty for pure numbers.
        meaning: one phrase: what the number is, with its frame.
        shape: what the file may hold.
        kilo: a value a thousand times too small was probably meant in the unit's thousands; say so. A number stands for another
            factor: 1e9 where km³/s² may have been meant.
        rigid: an inertia that a real body must be able to have (triangle inequality).
        words: texts that may stand instead of a number.
        note: follows the meaning in descriptions of the field.
        provenance: of the default.
        place: where the field goes in the core; a path, or a `Place` with rules for where the field is absent.
        bounds: as in Range.
    """

    def __init__(
        self,
        unit: str,
        meaning: str,
        *,
        shape: Shape = "number",
        kilo: bool | float = False,
        rigid: bool = True,
        words: tuple[str, ...] = (),
        note: str = "",
        provenance: str = "",
        place: str | Place | None = None,
        above: float | None = None,
        least: float | None = None,
        below: float | None = None,
        most: float | None = None,
        infinite: bool = False,
    ) -> None:
        self.unit = unit
        self.meaning = meaning
        self.shape: Shape = shape
        self.kilo = kilo
        self.rigid = rigid
        self.words = words
        self.note = note
        self.provenance = provenance
        self.place = Place(place) if isinstance(place, str) else place
        self.range = Range(above=above, least=least, below=below, most=most, infinite=infinite)

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        """Check in Python, in our words; pydantic only carries the result."""
        return core_schema.no_info_plain_validator_function(
            self._validated, metadata={"pydantic_js_functions": [self._json_schema]}
        )

    def _validated(self, value: Any) -> Any:
        try:
            return self.read(value)
        except Refusal as refusal:
            context = {"text": str(refusal), "unit": self.unit}
            raise PydanticCustomError("quantity", "{text}", context) from None

    def read(self, value: Any) -> Any:
        """Check a value from a file or an assignment.

        Args:
            value: what was met.

        Returns:
            A float, an int, one of the words, or a tuple of floats (of tuples for a full inertia).

        Raises:
            Refusal: with the reason in words.
        """
        if isinstance(value, str) and value in self.words:
            return value
        carried, value = unit_of(value), plain(value)
        if carried not in ("", self.unit):
            raise Refusal(f"is in {carried}; must be {self._wanted()}")
        if self.shape == "number" or (self.shape == "axes" and not isinstance(value, list)):
            return self._number(value)
        if self.shape == "odd":
            if isinstance(value, bool) or not isinstance(value, int):
                raise Refusal("must be a whole odd number")
            self.range.check(float(max(min(value, 10**9), -(10**9))))
            if value % 2 == 0:
                raise Refusal("must be odd")
            return value
        if not isinstance(value, list):
            raise Refusal(f"must be {self._wanted()}")
        if self.shape == "quaternion":
            return self._quaternion(value)
        if self.shape == "inertia":
            return self._inertia(value)
        return self._numbers(value, 3)

    @property
    def conversion(self) -> str:
        """Name the conversion from the field to a number of the core."""
        by_shape: dict[Shape, str] = {"axes": "per_axis", "inertia": "tensor"}
        return "degrees" if self.unit == "deg" else by_shape.get(self.shape, "number")

    def numbers(self, value: Any) -> list[float]:
        """Give a checked value as the numbers that a campaign would draw of it.

        Args:
            value: as `read` gives it.

        Returns:
            One number, three of a vector, four of a unit quaternion, six of an inertia: xx, yy, zz, xy, xz, yz.
        """
        if self.shape == "inertia":
            (xx, xy, xz), (_, yy, yz), (_, _, zz) = physics.tensor(value, rigid=self.rigid)
            return [xx, yy, zz, xy, xz, yz]
        if self.shape == "quaternion":
            return physics.unit(value)
        return [float(element) for element in value] if isinstance(value, tuple | list) else [float(value)]

    def _wanted(self) -> str:
        what = _SHAPES.get(self.shape, "a plain number")
        words = "".join(f' or "{word}"' for word in self.words)
        return (f"{what} in {self.unit}" if self.unit else what) + words

    def _number(self, value: Any) -> float:
        if isinstance(value, str):
            unit = f" in {self.unit}" if self.unit else ""
            raise Refusal(f"must be {self._wanted()}; write the bare number{unit}, without quotes or unit")
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise Refusal(f"must be {self._wanted()}")
        try:
            number = float(value)
        except OverflowError:
            raise Refusal("is too large") from None
        try:
            self.range.check(number)
        except Refusal as refusal:
            raise Refusal(f"{refusal}{self._thousands(number)}") from None
        return number

    def _thousands(self, number: float) -> str:
        if not self.kilo or not math.isfinite(number):
            return ""
        for factor in (1e3, 1e-3) if self.kilo is True else (self.kilo, 1.0 / self.kilo):
            try:
                self.range.check(number * factor)
            except Refusal:
                continue
            return f"; did you mean {shown(number * factor)}?"
        return ""

    def _numbers(self, value: Sequence[Any], count: int) -> Any:
        if len(value) != count:
            raise Refusal(f"has {len(value)} elements; must be {self._wanted()}")
        return tuple(self._number(element) for element in value)

    def _quaternion(self, value: Sequence[Any]) -> Any:
        numbers = self._numbers(value, 4)
        fault = physics.quaternion_fault(numbers)
        if fault:
            raise Refusal(fault)
        return numbers

    def _inertia(self, value: Sequence[Any]) -> Any:
        if len(value) != 3:
            raise Refusal(f"has {len(value)} elements; must be {self._wanted()}")
        nested = [isinstance(row, list) for row in value]
        if any(nested):
            if not all(nested) or any(len(row) != 3 for row in value):
                raise Refusal(f"must be {self._wanted()}")
            inertia: Any = tuple(tuple(self._number(element) for element in row) for row in value)
        else:
            inertia = self._numbers(value, 3)
        fault = physics.inertia_fault(inertia, rigid=self.rigid)
        if fault:
            raise Refusal(fault)
        return inertia

    def _json_schema(self, _schema: core_schema.CoreSchema, _handler: GetJsonSchemaHandler) -> dict[str, Any]:
        number: dict[str, Any] = {"type": "number", **self.range.json()}
        row = {"type": "array", "items": number, "minItems": 3, "maxItems": 3}
        shapes: dict[Shape, dict[str, Any]] = {
            "number": number,
            "odd": {**number, "type": "integer"},
            "vector": row,
            "axes": {"oneOf": [number, row]},
            "quaternion": {"type": "array", "items": number, "minItems": 4, "maxItems": 4},
            "inertia": {"oneOf": [row, {"type": "array", "items": row, "minItems": 3, "maxItems": 3}]},
        }
        shape = {"oneOf": [shapes[self.shape], {"enum": list(self.words)}]} if self.words else shapes[self.shape]
        return {**shape, "description": self.meaning + self.note, "unit": self.unit or "1"}
