"""Ratio of what an entry achieved to the bound of any controller, run by run: 1 would be perfect.

    time       capture time over the earliest capture from that run's own start          (`bounds.earliest`)
    Δv         Δv to capture over the least Δv of a capture by that run's own time       (`bounds.fuel`), the first runs only
    settling   settling time over the least that the torque needs for the momentum       (`bounds.detumbling`)
               that the run had at its own capture, the first runs only

Each is a share of a lower bound, so a ratio below 1 is impossible: one that is found means that a bound or the core is wrong,
and is reported. Where the bound is 0 (drift alone captures, or the stack is settled at capture) there is no ratio; such runs are
counted.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from detumble.analysis.comparing.judge import Figures

if TYPE_CHECKING:
    from detumble.intervals import Array

ROUND_OFF = 1e-9
"""Relative: times are sums of periods."""
FUEL_RUNS = 200
"""Number of runs whose Δv is divided by its bound."""


@dataclass(frozen=True)
class Ratio:
    """One ratio over the runs that have it.

    Attributes:
        values: (n,) NaN where the run has none.
        free: number of runs whose bound is 0.
        broken: indices of runs that are below their bound.
    """

    values: Array
    free: int
    broken: tuple[int, ...]

    @classmethod
    def of(cls, values: Array, bounds: Array) -> Ratio:
        """Divide values (n,) by lower bounds (n,); NaN in either gives no ratio."""
        known = ~np.isnan(values) & ~np.isnan(bounds)
        free = known & (bounds <= 0.0)
        ratios = np.divide(values, bounds, out=np.full(len(values), np.nan), where=known & ~free)
        beaten = np.flatnonzero(known & (values < bounds * (1.0 - ROUND_OFF)))
        return cls(ratios, int(free.sum()), tuple(int(index) for index in beaten))

    @property
    def figures(self) -> Figures:
        """Quantiles over the runs that have a ratio."""
        return Figures.of(self.values)

    def to_json(self) -> dict[str, Any]:
        """Give it as JSON takes it."""
        return {**self.figures.to_json(), "bound_is_zero": self.free, "beaten": list(self.broken)}
