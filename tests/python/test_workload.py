"""Workload W is what the yardstick says it is."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

import detumble
from detumble.campaigns.runs.draws import draw
from detumble.workload import random_starts, start_columns, workload

Array = NDArray[np.float64]


def dispersed_starts(count: int, seed: int) -> Array:
    """Draw starts as a campaign of the scenario does."""
    scenario = detumble.load("workload_w")
    drawn = draw(scenario, seed, 0, count)
    assert list(drawn) == ["chaser.position", "chaser.attitude", "debris.attitude", "debris.tumble_rate"]
    position, chaser, debris, tumble = drawn.values()
    velocity, rate = (np.tile(still, (count, 1)) for still in (scenario.chaser.velocity, scenario.chaser.rate))
    return np.hstack([position, velocity, chaser, rate, debris, tumble])


@pytest.mark.parametrize("draws", [random_starts, dispersed_starts])
def test_starts_are_drawn_as_described(draws: Callable[[int, int], Array]) -> None:
    starts = draws(4000, 5)
    assert starts.shape == (4000, 20)
    assert np.array_equal(starts, draws(4000, 5))
    assert np.abs(starts[:, :3]).max() <= 2.0
    assert np.abs(starts[:, :3].mean(axis=0)).max() < 0.1
    assert not starts[:, 3:6].any()
    assert not starts[:, 10:13].any()
    for block in (slice(6, 10), slice(13, 17)):
        assert np.allclose(np.linalg.norm(starts[:, block], axis=1), 1.0)
        assert np.abs(starts[:, block].mean(axis=0)[1:]).max() < 0.05
        assert np.abs((starts[:, block] ** 2).mean(axis=0) - 0.25).max() < 0.02  # whichever sign a quaternion has
    tumble = np.linalg.norm(starts[:, 17:20], axis=1)
    assert tumble.max() <= 0.1
    assert abs(tumble.mean() - 0.05) < 0.003


def test_starts_become_columns_of_the_case() -> None:
    starts = random_starts(3)
    columns = start_columns(starts)
    assert [path.removeprefix("start.") for path in columns] == list(workload()["start"])
    assert np.array_equal(np.hstack(list(columns.values())), starts)


def test_the_case_is_the_yardstick() -> None:
    recipe = workload()
    plan, before = recipe["plan"], recipe["law"]["before"]
    assert (plan["control_period"], plan["steps_per_period"], plan["periods"]) == (0.05, 1, 2400)
    assert plan["transition"] == "none"
    assert before["translation"] == {"slope": [0.15] * 3, "gain": [0.05] * 3, "layer": [0.05] * 3, "alpha": 0.7}
    assert before["rotation"] == {"slope": [0.3] * 3, "gain": [0.2] * 3, "layer": [0.1] * 3, "alpha": 0.7}
    assert recipe["sensors"] == {"position": 1e-3, "velocity": 0.0, "attitude": math.radians(0.1), "rate": 1e-4}
    assert recipe["goal"]["position"] == [0.0, 0.3, 0.0]
    assert math.isclose(recipe["orbit"]["mean_motion"], math.sqrt(3.986004418e14 / 7071e3**3))
