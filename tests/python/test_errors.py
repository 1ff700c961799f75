"""Exceptions are the same after a copy, also one that went to another process."""

from __future__ import annotations

import copy
import pickle
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import pytest

import detumble
from detumble.errors import Fault
from detumble.scenario.dispersions.base import Misfit
from detumble.scenario.quantity import Refusal

FAULTS = [Fault("chaser.mass", "must be finite", "inf kg"), Fault("x", "unknown key")]
ERRORS = [
    detumble.ScenarioError("my.toml", FAULTS),
    detumble.ScenarioError("my.toml", problem="no such file"),
    detumble.RequestError("runs 0: must be at least 1"),
    Misfit("sigma", "too large"),
    Refusal("must be finite"),
]


@pytest.mark.parametrize("error", ERRORS, ids=lambda error: type(error).__name__)
def test_a_copy_has_the_same_message_and_parts(error: Exception) -> None:
    for again in (pickle.loads(pickle.dumps(error)), copy.copy(error), copy.deepcopy(error)):
        assert type(again) is type(error)
        assert str(again) == str(error)
        assert again.__dict__ == error.__dict__


def test_notes_and_attributes_go_along() -> None:
    error = detumble.ScenarioError("my.toml", FAULTS)
    error.add_note("seen in run 3")
    error.where = 5  # type: ignore[attr-defined]
    for again in (pickle.loads(pickle.dumps(error)), copy.deepcopy(error)):
        assert again.__notes__ == ["seen in run 3"]
        assert again.where == 5


def test_an_error_comes_back_from_a_worker() -> None:
    with ProcessPoolExecutor(1, get_context("spawn")) as workers, pytest.raises(detumble.ScenarioError) as caught:
        workers.submit(detumble.load, "nowhere.toml").result()
    assert str(caught.value).startswith("nowhere.toml: no such file")
    assert caught.value.problem
