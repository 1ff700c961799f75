"""What nature allows: checks of attitudes and inertias, in words."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from detumble.scenario.wording import number

NORM_SLACK = 1e-3
"""A quaternion typed with a few digits is accepted this far from unit norm, and normalised when used."""
LEAST_MOMENT = 1e-9
"""Least principal moment, kg m²: that of a gram a millimetre across. Far below it quotients overflow."""
TYPED = 1e-3
"""Two elements of a tensor that should be equal may differ by this share of the largest; their mean is flown."""
FLAT = 5e-3
"""What rounding to three digits, as people type, makes of a flat plate: up to this share of the sum of the others the largest
moment may exceed it, and becomes their sum."""
ROUND_OFF = 1e-9
"""Relative error of computed inertias: below it there is nothing to make exact."""


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
    """Say why an inertia cannot be a body's, or None. Rounding as people type it (`TYPED`, `FLAT`) is no fault.

    Args:
        inertia: principal moments (3,), or the tensor (3, 3); kg m².
        rigid: ask for the triangle inequality too.
    """
    if isinstance(inertia[0], Sequence):
        scale = max(abs(element) for row in inertia for element in row)
        for i, j in _PAIRS:
            if abs(inertia[i][j] - inertia[j][i]) > TYPED * scale:
                names = (f"I{'xyz'[i]}{'xyz'[j]} = {inertia[i][j]!r}", f"I{'xyz'[j]}{'xyz'[i]} = {inertia[j][i]!r}")
                return f"must be symmetric; {names[0]}, but {names[1]}"
        moments = _principal(inertia)
        kind = "positive definite (principal moments {})"
    else:
        moments, kind = sorted(inertia), "positive on every axis"
        scale = max(abs(moment) for moment in inertia)
    if moments[0] <= 1e-12 * scale:
        return "must be " + kind.format(", ".join(f"{moment:.6g}" for moment in moments))
    if moments[0] < LEAST_MOMENT:
        return f"has a principal moment of {moments[0]:.6g}; must be at least {number(LEAST_MOMENT)}"
    if rigid and _excess(moments) > FLAT:
        others = moments[0] + moments[1]
        return f"the largest principal moment exceeds the sum of the others ({others:.6g}); no rigid body has that"
    return None


_PAIRS = ((0, 1), (0, 2), (1, 2))


def _principal(inertia: Sequence[Any]) -> list[float]:
    """Give the principal moments of a tensor, ascending."""
    import numpy as np  # only a full tensor needs it

    tensor = np.array(inertia, dtype=np.float64)
    return [float(moment) for moment in np.linalg.eigvalsh(0.5 * (tensor + tensor.T))]


def _excess(moments: Sequence[float]) -> float:
    """Say by how much of their sum the largest of three ascending moments exceeds the sum of the others."""
    return moments[2] / (moments[0] + moments[1]) - 1.0


def made_exact(inertia: Sequence[Any], *, rigid: bool = True) -> str | None:
    """Say what `tensor` changes in an inertia that was typed with few digits, or None where it changes nothing.

    Args:
        inertia: that has no fault.
        rigid: as of `tensor`.
    """
    said = []
    if isinstance(inertia[0], Sequence):
        scale = max(abs(element) for row in inertia for element in row)
        off = max(abs(inertia[i][j] - inertia[j][i]) for i, j in _PAIRS)
        if off > ROUND_OFF * scale:
            said.append(f"is symmetric only to {off:.2g} kg m²; the mean of each pair is flown")
    moments = _principal(inertia) if isinstance(inertia[0], Sequence) else sorted(inertia)
    if rigid and _excess(moments) > ROUND_OFF:
        said.append(
            f"has a largest principal moment of {moments[2]:.10g} kg m², more than the sum of the others, which a flat plate "
            f"has; {moments[0] + moments[1]:.10g} kg m² is flown"
        )
    return ", and ".join(said) or None


def tensor(inertia: Sequence[Any], *, rigid: bool = True) -> list[list[float]]:
    """Give the inertia as a symmetric 3x3 list, kg m².

    Args:
        inertia: principal moments (3,), or the tensor (3, 3).
        rigid: where the largest moment exceeds the sum of the others by the rounding of what was typed, it becomes their sum.
    """
    if not isinstance(inertia[0], Sequence):
        moments = [float(moment) for moment in inertia]
        if rigid and _excess(sorted(moments)) > ROUND_OFF:
            largest = max(range(3), key=lambda axis: moments[axis])
            moments[largest] = sum(moment for axis, moment in enumerate(moments) if axis != largest)
        return [[moments[i] if i == j else 0.0 for j in range(3)] for i in range(3)]
    symmetric = [[0.5 * (inertia[i][j] + inertia[j][i]) for j in range(3)] for i in range(3)]
    if rigid and _excess(_principal(symmetric)) > ROUND_OFF:
        import numpy as np

        values, axes = np.linalg.eigh(np.array(symmetric))
        excess = float(values[2] - values[0] - values[1])
        lowered = np.array(symmetric) - excess * np.outer(axes[:, 2], axes[:, 2])
        symmetric = [[0.5 * float(lowered[i, j] + lowered[j, i]) for j in range(3)] for i in range(3)]
    return symmetric


def unit(quaternion: Sequence[float]) -> list[float]:
    """Normalise a quaternion, shape (4,); one that is unit to rounding stays as it is, so drawn ones fly to the bit."""
    norm = math.hypot(*quaternion)
    return [component / norm for component in quaternion] if abs(norm - 1.0) > 1e-15 else list(quaternion)
