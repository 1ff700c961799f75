"""An inertia typed with few digits is flown as the nearest that a body can have: same axes, the two smaller moments kept."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from detumble.scenario.physics import FLAT, inertia_fault, made_exact, tensor

PLATE = (1.0 / 12.0, 1.0 / 12.0 * 0.7, 1.0 / 12.0 * 1.7)


@pytest.mark.parametrize("seed", range(20))
def test_a_turned_plate_keeps_its_axes_and_smaller_moments(seed: int) -> None:
    turn = Rotation.random(random_state=seed).as_matrix()
    typed = turn @ np.diag([PLATE[0], PLATE[1], PLATE[2] * (1.0 + 0.5 * FLAT)]) @ turn.T
    assert inertia_fault(typed.tolist()) is None
    assert made_exact(typed.tolist()) is not None
    flown = turn.T @ np.array(tensor(typed.tolist())) @ turn
    np.testing.assert_allclose(flown, np.diag(PLATE), atol=1e-15)


def test_the_largest_principal_moment_becomes_the_sum_wherever_it_stands() -> None:
    for axis in range(3):
        moments = list(np.roll([0.0833, 0.0833, 0.167], axis))
        flown = np.diag(tensor(moments))
        assert sorted(flown) == pytest.approx([0.0833, 0.0833, 0.1666], abs=1e-16)
        assert int(np.argmax(flown)) == int(np.argmax(moments))


def test_a_belief_is_not_made_a_body() -> None:
    assert tensor([0.1, 0.1, 0.3], rigid=False) == [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.3]]
