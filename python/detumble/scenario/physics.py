"""What nature allows: checks of attitudes and inertias, in words."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from detumble.scenario.wording import number

NORM_SLACK = 1e-3
"""A quaternion typed with a few digits is accepted this far from unit norm, and normalised when used."""
LEAST_MOMENT = 1e-9
"""Least principal moment, kg m²: that of a gram a millimetre across. Far below it quotients leave the numbers."""
TRIANGLE_SLACK = 1e-9
"""A flat plate meets the triangle inequality as an equality: rounding must not refuse it."""


def quaternion_fault(quaternion: Sequence[float]) -> str | None:
    """Say why four numbers are no attitude, or None.

    Args:
        quaternion: scalar first, shape (4,).
    """
    norm = math.hypot(*quaternion)
    if norm == 0.0:
        return "is zero, and zero is no attitude; the identity is [1, 0, 0, 0]"
    if abs(norm - 1.0) > NORM_SLACK:
        return f"has norm {norm:.6g}; must be 1 within {NORM_SLACK:g} (scalar first)"
    return None


def inertia_fault(inertia: Sequence[Any], *, rigid: bool = True) -> str | None:
    """Say why an inertia cannot be a body's, or None.

    Args:
        inertia: principal moments (3,), or the tensor (3, 3); kg m².
        rigid: ask for the triangle inequality too.
    """
    if isinstance(inertia[0], Sequence):
        scale = max(abs(element) for row in inertia for element in row)
        if any(abs(inertia[i][j] - inertia[j][i]) > 1e-9 * scale for i, j in ((0, 1), (0, 2), (1, 2))):
            return "must be symmetric"
        import numpy as np  # only a full tensor needs it

        moments = [float(moment) for moment in np.linalg.eigvalsh(np.array(inertia))]
        kind = "positive definite (principal moments {})"
    else:
        moments, kind = sorted(inertia), "positive on every axis"
        scale = max(abs(moment) for moment in inertia)
    if moments[0] <= 1e-12 * scale:
        return "must be " + kind.format(", ".join(f"{moment:.6g}" for moment in moments))
    if moments[0] < LEAST_MOMENT:
        return f"has a principal moment of {moments[0]:.6g}; must be at least {number(LEAST_MOMENT)}"
    others = moments[0] + moments[1]
    if rigid and moments[2] > others * (1.0 + TRIANGLE_SLACK):
        return f"the largest principal moment exceeds the sum of the others ({others:.6g}); no rigid body has that"
    return None


def tensor(inertia: Sequence[Any]) -> list[list[float]]:
    """Give the inertia as a symmetric 3x3 list, kg m².

    Args:
        inertia: principal moments (3,), or the tensor (3, 3).
    """
    if isinstance(inertia[0], Sequence):
        return [[0.5 * (inertia[i][j] + inertia[j][i]) for j in range(3)] for i in range(3)]
    return [[float(inertia[i]) if i == j else 0.0 for j in range(3)] for i in range(3)]


def unit(quaternion: Sequence[float]) -> list[float]:
    """Normalise a quaternion, shape (4,); one that is unit to rounding stays as it is, so drawn ones fly to the bit."""
    norm = math.hypot(*quaternion)
    return [component / norm for component in quaternion] if abs(norm - 1.0) > 1e-15 else list(quaternion)
