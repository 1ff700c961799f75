"""Correlations between dispersed numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Any, ClassVar

from pydantic import BeforeValidator, Field

from detumble.checking import plain
from detumble.scenario.section import Relation, Section

_SLACK = 1e-9
"""A matrix computed elsewhere is symmetric to rounding."""
_LEAST_PIVOT = 1e-10
"""Below it one field follows from the others, to rounding."""

Matrix = tuple[tuple[Annotated[float, Field(strict=True, allow_inf_nan=False)], ...], ...]


def factor(matrix: Sequence[Sequence[float]]) -> list[list[float]] | None:
    """Give the lower triangular L with L Lᵀ = matrix (Cholesky), or None where the matrix is not positive definite.

    Args:
        matrix: symmetric, shape (n, n).
    """
    lower: list[list[float]] = []
    for i, given in enumerate(matrix):
        row = [0.0] * len(matrix)
        for j in range(i + 1):
            rest = given[j]
            for k in range(j):
                rest -= row[k] * (lower[j][k] if j < i else row[k])
            if j < i:
                row[j] = rest / lower[j][j]
            elif rest < _LEAST_PIVOT:
                return None
            else:
                row[j] = math.sqrt(rest)
        lower.append(row)
    return lower


def _fields_fault(fields: Sequence[str]) -> str | None:
    if len(fields) < 2:
        return "must name two fields or more"
    twice = next((name for name in fields if fields.count(name) > 1), None)
    return f"names {twice} twice" if twice else None


def _matrix_fault(fields: Sequence[str], matrix: Matrix) -> str | None:
    count = len(fields)
    if len(matrix) != count or any(len(row) != count for row in matrix):
        return f"must be {count}x{count}, a row and a column for each field"
    if any(abs(matrix[i][i] - 1.0) > _SLACK for i in range(count)):
        return "must have ones on its diagonal: it holds correlations, not covariances"
    if any(abs(matrix[i][j] - matrix[j][i]) > _SLACK for i in range(count) for j in range(i)):
        return "must be symmetric"
    return None if factor(matrix) else "must be positive definite"


class Correlation(Section):
    """Dispersed numbers that vary together.

    The matrix correlates the normal numbers beneath the distributions (a Gaussian copula). Between normal distributions it is
    the correlation itself; between others the correlation of ranks is 6/π asin(ρ/2), at most 0.02 off.
    """

    fields: tuple[str, ...] = Field(
        description="dispersed numbers, by path; of a vector one element: chaser.position.x",
        json_schema_extra={"minItems": 2},
    )
    matrix: Annotated[Matrix, BeforeValidator(plain)] = Field(
        description="correlations, symmetric, ones on the diagonal, positive definite"
    )

    relations: ClassVar[tuple[Relation, ...]] = (
        Relation("fields", ("fields",), _fields_fault),
        Relation("matrix", ("fields", "matrix"), _matrix_fault),
    )

    def resolved(self, members: dict[str, tuple[int, int]]) -> dict[str, Any]:
        """Give the group as the core takes it.

        Args:
            members: where each number stands: which dispersion, which element.
        """
        return {"members": [members[name] for name in self.fields], "factor": factor(self.matrix)}
