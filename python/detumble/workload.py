"""Workload W, the yardstick of speed: the scenario `workload_w` flown from random starts.

r uniform within ±2 m per axis, v = 0, uniform random attitudes, the chaser at rest, the debris tumbling about a random
direction at up to 0.1 rad/s.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from detumble.scenario.core import case
from detumble.scenario.files import load
from detumble.states import parts_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

FLOP_PER_STEP = 1635
"""Arithmetic of one period of one trajectory: one RK4 step, the law, the noise."""
LAW = "prrl"


def workload() -> dict[str, Any]:
    """Give the case of workload W for the core."""
    return case(load("workload_w"), LAW)


def random_starts(count: int, seed: int = 0) -> NDArray[np.float64]:
    """Draw starts of workload W.

    Args:
        count: how many.
        seed: of the draw.

    Returns:
        Position, velocity, chaser attitude, chaser rate, debris attitude, debris rate: shape (count, 20).
    """
    generator = np.random.default_rng(seed)
    position = generator.uniform(-2.0, 2.0, (count, 3))
    attitudes = [_directions(generator, count, 4) for _ in ("chaser", "debris")]
    tumble = _directions(generator, count, 3) * generator.uniform(0.0, 0.1, (count, 1))
    still = np.zeros((count, 3))
    return np.hstack((position, still, attitudes[0], still, attitudes[1], tumble))


def start_columns(starts: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
    """Give starts as the columns of numbers that the core takes.

    Args:
        starts: as `random_starts` gives them, shape (n, 20).
    """
    return {f"start.{name}": part for name, part in parts_of(starts).items()}


def _directions(generator: np.random.Generator, count: int, size: int) -> NDArray[np.float64]:
    normals = generator.standard_normal((count, size))
    unit: NDArray[np.float64] = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    return unit
