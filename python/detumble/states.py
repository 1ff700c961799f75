"""States of both bodies as rows of numbers, laid out as the core has them: slices of a row by what they hold.

Units and frames: r and v of the chaser relative to the debris in H, m and m/s; attitudes as quaternions body -> N, scalar
first; rates in body axes, rad/s.
"""

from __future__ import annotations

from itertools import accumulate
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from detumble.compiled import register

if TYPE_CHECKING:
    from collections.abc import Mapping

_ENDS = list(accumulate(width for _, width in register()["state"]))
PARTS = {name: slice(end - width, end) for (name, width), end in zip(register()["state"], _ENDS, strict=True)}
"""By the names that the core gives: `position`, `chaser_attitude`."""
WIDTH = _ENDS[-1]

POSITION, VELOCITY = PARTS["position"], PARTS["velocity"]
CHASER_ATTITUDE, CHASER_RATE = PARTS["chaser_attitude"], PARTS["chaser_rate"]
DEBRIS_ATTITUDE, DEBRIS_RATE = PARTS["debris_attitude"], PARTS["debris_rate"]
TRANSLATION = slice(POSITION.start, VELOCITY.stop)
"""r and v."""
DEBRIS = slice(DEBRIS_ATTITUDE.start, DEBRIS_RATE.stop)
"""Attitude and rate of the debris."""


def row_of(parts: Mapping[str, Any]) -> NDArray[np.float64]:
    """Give a state, a sequence of numbers by name of each part, as a row (`WIDTH`,)."""
    return np.concatenate([np.asarray(parts[name], float) for name in PARTS])


def parts_of(rows: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    """Give the parts of a row, or of rows (n, `WIDTH`), by name; contiguous."""
    return {name: np.ascontiguousarray(rows[..., place]) for name, place in PARTS.items()}
