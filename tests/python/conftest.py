from __future__ import annotations

import pytest

import detumble
from detumble.scenario import Scenario, with_settings


@pytest.fixture
def paper() -> Scenario:
    return detumble.load("paper")


@pytest.fixture(scope="session")
def short() -> Scenario:
    """The paper's case, cut to a minute, without noise."""
    quiet = ["time.duration=60.0", "sensors={}"]
    return with_settings(detumble.load("paper"), quiet)
