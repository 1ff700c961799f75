"""Values, units and suggestions as a person reads them."""

from __future__ import annotations

from decimal import Decimal
from typing import Any

from detumble.checking import plain
from detumble.text import printable


def number(value: float) -> str:
    """Write a float with the fewest digits that read back to the same bits, the way TOML does: 0.05, 700e3, 6.871e6."""
    text = repr(value)
    if text in ("inf", "-inf", "nan") or 1e-3 <= abs(value) < 1e5 or value == 0.0:
        return text
    sign, digits, exponent = Decimal(text).normalize().as_tuple()
    figures, power = "".join(map(str, digits)), int(exponent) + len(digits) - 1
    thousands = power - power % 3
    if power > 0 and len(figures) <= power - thousands + 1:
        whole, fraction, power = figures.ljust(power - thousands + 1, "0"), "", thousands
    else:
        whole, fraction = figures[0], figures[1:]
    return f"{'-' if sign else ''}{whole}{'.' + fraction if fraction else ''}e{power}"


def shown(value: Any, width: int = 72) -> str:
    """Write a value much as TOML would, rounded and shortened to fit a line."""
    value = plain(value)
    if isinstance(value, bool):
        text = str(value).lower()
    elif isinstance(value, float):
        text = number(float(f"{value:.10g}")).removesuffix(".0")
    elif isinstance(value, str):
        text = '"' + printable(value, keep="") + '"'
    elif isinstance(value, list | tuple):
        text = "[" + ", ".join(shown(element, width) for element in value) + "]"
    elif isinstance(value, dict):
        text = "{" + ", ".join(f"{key} = {shown(element, width)}" for key, element in value.items()) + "}"
    else:
        text = " ".join(printable(str(value), keep="").split())
    return text if len(text) <= width else text[: width - 3] + "..."


def pretty(unit: str) -> str:
    """Write powers in a unit as raised digits: kg m², s⁴/m²."""
    return unit.replace("^2", "²").replace("^3", "³").replace("^4", "⁴")
