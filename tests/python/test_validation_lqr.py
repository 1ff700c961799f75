"""Validation: the core's LQR gains against SciPy's Riccati solver, and against closed forms where there are any.

SciPy's gain is itself good to about 1e-12 of the largest element over these weights; element by element neither solver
is, where the weights of one axis are many decades below another's, and the comparison is with the closed form.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.linalg import solve_continuous_are

from detumble import _core

Array = NDArray[np.float64]


def riccati(a: Array, b: Array, q: Sequence[float] | Array, r: float) -> Array:
    return np.asarray(b.T @ solve_continuous_are(a, b, np.diag(q), r * np.eye(3)) / r)


def weights(rng: np.random.Generator, decades: float = 6.0) -> tuple[list[float], list[float], float]:
    """Each between 10^-decades and 10^3, independent axis by axis."""
    q_error, q_rate = (10.0 ** rng.uniform(-decades, 3.0, (2, 3))).tolist()
    return q_error, q_rate, float(10.0 ** rng.uniform(-3.0, 4.0))


def random_inertia(rng: np.random.Generator) -> Array:
    """A body's, with products of inertia, 1e-3 to 1e3 kg m²."""
    moments = np.sort(rng.uniform(0.2, 1.0, 3))
    moments[2] = min(moments[2], 0.99 * (moments[0] + moments[1]))
    axes, _ = np.linalg.qr(rng.standard_normal((3, 3)))
    tensor = axes @ np.diag(moments * 10.0 ** rng.uniform(-3.0, 3.0)) @ axes.T
    return np.asarray(0.5 * (tensor + tensor.T))


def difference(ours: tuple[Any, Any], theirs: Array) -> float:
    return float(np.abs(np.hstack(ours) - theirs).max() / np.abs(theirs).max())


def test_validation_translation_gain_matches_scipy() -> None:
    rng = np.random.default_rng(1)
    for _ in range(200):
        q_error, q_rate, r = weights(rng)
        n = float(10.0 ** rng.uniform(-4.2, -2.5))  # from beyond GEO to the atmosphere, and more
        a = np.zeros((6, 6))
        a[:3, 3:] = np.eye(3)
        a[3, 0], a[3, 4], a[4, 3], a[5, 2] = 3.0 * n * n, 2.0 * n, -2.0 * n, -n * n
        b = np.vstack([np.zeros((3, 3)), np.eye(3)])
        expected = riccati(a, b, [*q_error, *q_rate], r)
        assert difference(_core.lqr_translation(q_error, q_rate, r, n), expected) < 1e-9


@pytest.mark.parametrize("two_epsilon", [False, True])
def test_validation_rotation_gain_matches_scipy(two_epsilon: bool) -> None:
    rng = np.random.default_rng(2)
    for _ in range(200):
        q_error, q_rate, r = weights(rng)
        inertia = random_inertia(rng)
        a = np.zeros((6, 6))
        a[:3, 3:] = np.eye(3) * (1.0 if two_epsilon else 0.5)
        b = np.vstack([np.zeros((3, 3)), np.linalg.inv(inertia)])
        expected = riccati(a, b, [*q_error, *q_rate], r)
        ours = _core.lqr_rotation(q_error, q_rate, r, inertia.tolist(), two_epsilon)
        assert difference(ours, expected) < 1e-9
        closed = a - b @ np.hstack(ours)
        assert np.linalg.eigvals(closed).real.max() < 0.0


@pytest.mark.parametrize("two_epsilon", [False, True])
def test_validation_gain_about_principal_axes_matches_the_closed_form(two_epsilon: bool) -> None:
    """Each axis by itself: k_ε = √(q_ε/r), k_ω = √(q_ω/r + 2 c I k_ε), c = ½ or 1; now element by element."""
    rng = np.random.default_rng(3)
    for number in range(200):
        q_error, q_rate, r = weights(rng, decades=3.0)
        if number % 4 == 0:
            q_rate = [0.0] * 3
        moments = rng.uniform(0.6, 1.0, 3) * 10.0 ** rng.uniform(-3.0, 3.0)
        ours = [
            np.array(gain) for gain in _core.lqr_rotation(q_error, q_rate, r, np.diag(moments).tolist(), two_epsilon)
        ]
        of_error = np.sqrt(np.array(q_error) / r)
        of_rate = np.sqrt(np.array(q_rate) / r + 2.0 * (1.0 if two_epsilon else 0.5) * moments * of_error)
        for gain, expected in zip(ours, (of_error, of_rate), strict=True):
            assert np.abs(np.diag(gain) / expected - 1.0).max() < 1e-9
            assert np.abs(gain - np.diag(np.diag(gain))).max() == 0.0


def test_validation_cross_track_gain_matches_the_closed_form() -> None:
    """z'' = -n² z + u: k = -n² + √(n⁴ + q/r), written without cancellation; k_v = √(q_v/r + 2 k)."""
    rng = np.random.default_rng(4)
    for _ in range(200):
        q_error, q_rate, r = weights(rng, decades=3.0)
        n = float(10.0 ** rng.uniform(-4.2, -2.5))
        of_error, of_rate = (np.array(gain)[2] for gain in _core.lqr_translation(q_error, q_rate, r, n))
        weight = q_error[2] / r
        expected = weight / (n * n + np.sqrt(n**4 + weight))
        assert of_error[2] == pytest.approx(expected, rel=1e-9)
        assert of_rate[2] == pytest.approx(np.sqrt(q_rate[2] / r + 2.0 * expected), rel=1e-9)
        assert not of_error[:2].any()
        assert not of_rate[:2].any()
