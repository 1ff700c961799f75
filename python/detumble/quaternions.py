"""Arithmetic of attitude quaternions: scalar first, Hamilton product, unit norm, body → reference, v_N = q ⊗ v_B ⊗ q*."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]


def multiply(p: Array, q: Array) -> Array:
    """Hamilton product p ⊗ q of quaternions (..., 4)."""
    p0, p1, p2, p3 = np.moveaxis(p, -1, 0)
    q0, q1, q2, q3 = np.moveaxis(q, -1, 0)
    return np.stack(
        (
            p0 * q0 - p1 * q1 - p2 * q2 - p3 * q3,
            p0 * q1 + p1 * q0 + p2 * q3 - p3 * q2,
            p0 * q2 - p1 * q3 + p2 * q0 + p3 * q1,
            p0 * q3 + p1 * q2 - p2 * q1 + p3 * q0,
        ),
        axis=-1,
    )


def conjugate(q: Array) -> Array:
    """Conjugate q* of quaternions (..., 4)."""
    conjugated: Array = q * np.array([1.0, -1.0, -1.0, -1.0])
    return conjugated


def rotate(q: Array, v: Array) -> Array:
    """Vectors v (..., 3) in body axes, rotated by attitudes q (..., 4) into the reference axes."""
    scalar, vector = q[..., :1], q[..., 1:]
    twice = 2.0 * np.cross(vector, v)
    rotated: Array = v + scalar * twice + np.cross(vector, twice)
    return rotated


def about_z(angle: Array) -> Array:
    """Rotations (n, 4) about the third axis by angles (n,), rad."""
    half = 0.5 * angle[:, None]
    return np.concatenate((np.cos(half), np.sin(half) * np.array([0.0, 0.0, 1.0])), axis=-1)


def rotation_angle(q: Array) -> Array:
    """Angles (...), rad, of quaternions (..., 4), the short way round: 0 to π."""
    angle: Array = 2.0 * np.arctan2(np.linalg.norm(q[..., 1:], axis=-1), np.abs(q[..., 0]))
    return angle


def rotation_vector(q: Array) -> Array:
    """Axis times angle (..., 3), rad, of quaternions (..., 4), the short way round."""
    scalar, vector = q[..., :1], q[..., 1:]
    length = np.linalg.norm(vector, axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(length, np.abs(scalar))
    turned: Array = np.where(scalar < 0.0, -1.0, 1.0) * vector * angle / np.where(length > 0.0, length, 1.0)
    return turned
