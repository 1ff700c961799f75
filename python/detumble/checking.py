"""Checks of the arguments of public calls and scenario fields.

Python's and numpy's numbers count, decimals too, and arrays and sequences of them, xarray's and pandas' own among them. Booleans,
text, bytes, times and numbers that carry another unit do not.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from decimal import Decimal
from numbers import Integral, Real
from typing import Any, TypeVar, cast

from detumble.errors import RequestError
from detumble.text import did_you_mean

MOST_SEED = 2**64 - 1


def plain(value: Any) -> Any:
    """Give numbers as Python's own, arrays and sequences of them as lists; anything else as it is, to be refused.

    Args:
        value: a number, or an array or a list or tuple of numbers, nested as it may be.
    """
    if isinstance(value, bool | str | bytes | bytearray):
        return value
    if isinstance(value, list | tuple):
        return [plain(element) for element in value]
    if hasattr(value, "__array__"):
        import numpy as np

        array = np.asarray(value)
        if array.dtype.kind in "iub" and not np.ma.is_masked(value):
            return array.tolist()
        if array.dtype.kind == "f" and not np.ma.is_masked(value):
            return array.astype(np.float64).tolist()
        if array.dtype.kind == "O":
            return [plain(element) for element in array] if array.ndim else plain(array.item())
        return value
    if isinstance(value, Integral):
        return int(value)
    return float(value) if isinstance(value, Real | Decimal) else value


def unit_of(value: Any) -> str:
    """Give the unit that a value carries, as xarray, pint and astropy do, or one of its elements; empty for none."""
    if isinstance(value, list | tuple):
        return next((unit for element in value if (unit := unit_of(element))), "")
    attributes = getattr(value, "attrs", None)
    carried = attributes.get("units") if isinstance(attributes, dict) else None
    carried = carried or getattr(value, "units", None) or getattr(value, "unit", None)
    return "" if carried is None or callable(carried) or str(carried) in ("1", "dimensionless") else str(carried)


def whole(name: str, value: Any, least: int, most: int, allowed: str = "") -> int:
    """Read a whole number.

    Args:
        name: of the argument.
        value: what was given.
        least, most: ends of the range, both allowed.
        allowed: what the message says is allowed; empty for the range.

    Raises:
        RequestError: the value is no whole number, or lies outside the range.
    """
    number = plain(value)
    if isinstance(number, bool) or not isinstance(number, int) or not least <= number <= most:
        raise RequestError(f"{name} {met(value)}: {allowed or f'must be a whole number from {least} to {most}'}")
    return number


def real(
    name: str,
    value: Any,
    *,
    above: float = -math.inf,
    least: float = -math.inf,
    below: float = math.inf,
    most: float = math.inf,
    unit: str = "",
    what: str = "",
) -> float:
    """Read a finite number.

    Args:
        name: of the argument.
        value: what was given.
        above: lower bound, excluded.
        least: lower bound, allowed.
        below: upper bound, excluded.
        most: upper bound, allowed.
        unit: for the message.
        what: name of the quantity, for the message.

    Raises:
        RequestError: the value is no finite number, carries another unit, or lies outside the bounds.
    """
    number = plain(value)
    if isinstance(number, int) and abs(number) > 10**300:
        number = math.inf  # more than a float holds
    fine = isinstance(number, int | float) and not isinstance(number, bool) and unit_of(value) in ("", unit)
    if not fine or not (math.isfinite(number) and above < number and least <= number <= most and number < below):
        bounds = (("greater than", above), ("at least", least), ("less than", below), ("at most", most))
        said = " and ".join(f"{words} {bound:.10g}" for words, bound in bounds if math.isfinite(bound))
        kind = "" if fine and math.isfinite(number) else "a finite number "
        subject = f"{what} " if what else ""
        suffix = f" {unit}" if unit else ""
        shown = f"{number:.10g}" if fine else met(value)
        limits = f"{said}{suffix}" if said else ""
        raise RequestError(f"{name} {shown}{suffix}: {subject}must be {kind}{limits}".rstrip())
    return float(number)


def seed_number(name: str, value: Any) -> int:
    """Read a seed, 0 to 2^64 - 1.

    Raises:
        RequestError: the value is no such number.
    """
    return whole(name, value, 0, MOST_SEED)


def thread_count(value: Any) -> int | None:
    """Read the argument `threads`: a whole number, or None for all processors.

    Raises:
        RequestError: the value is neither.
    """
    return None if value is None else whole("threads", value, 1, 4096)


Word = TypeVar("Word", bound=str)


def choice(name: str, value: Any, choices: Iterable[Word], more: Mapping[str, str] = {}) -> Word:  # only read
    """Read one of several words.

    Args:
        name: of the argument.
        value: what was given.
        choices: that are allowed.
        more: further words that are allowed, and what each is for.

    Raises:
        RequestError: the value is none of them; the message suggests a similar one.
    """
    known = list(choices)
    if not isinstance(value, str) or value not in (*known, *more):
        hint = did_you_mean(value, (*known, *more)) if isinstance(value, str) else ""
        few = len(known) <= 3 and not more
        said = " or ".join((", ".join(known[:-1]), known[-1])) if few else f"one of {', '.join(known)}"
        said += "".join(f", or {other} {use}" for other, use in more.items())
        raise RequestError(f"{name} {met(value)}: must be {said}{hint}")
    return cast("Word", value)


Kind = TypeVar("Kind")


def instance(name: str, value: object, kind: type[Kind], wanted: str) -> Kind:
    """Check the type of an argument.

    Args:
        name: of the argument.
        value: what was given.
        kind: the type.
        wanted: what is allowed, in words.

    Raises:
        RequestError: the argument is of another type.
    """
    if not isinstance(value, kind):
        raise RequestError(f"{name} {met(value)}: must be {wanted}")
    return value


def flag(name: str, value: object) -> bool:
    """Read true or false.

    Raises:
        RequestError: the value is neither.
    """
    return instance(name, plain(value), bool, "true or false")


def texts(name: str, values: object) -> list[str]:
    """Read a list of texts; one text alone is not taken for a list of its letters.

    Raises:
        RequestError: the value is no such list.
    """
    wanted = "a list of texts"
    if isinstance(values, str | bytes) or not isinstance(values, Iterable):
        raise RequestError(f"{name} {met(values)}: must be {wanted}")
    return [instance(name, value, str, wanted) for value in values]


def met(value: Any) -> str:
    """Write a value that is refused as Python would, shortened to fit a line."""
    text = " ".join(repr(plain(value)).split())
    return text if len(text) <= 72 else text[:69] + "..."
