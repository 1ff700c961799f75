"""Logarithmic axes with plain numbers at 1, 2 and 5."""

from __future__ import annotations

from typing import Any


def plain_log(axes: Any) -> None:
    """Make both axes of a panel logarithmic and their labels plain."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axes.set(xscale="log", yscale="log")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axis.set_minor_formatter(NullFormatter())
