"""The scenarios that come with detumble: every law captures and stabilises, and the paper's case matches the paper."""

from __future__ import annotations

import importlib
from pathlib import Path

import numpy as np
import pytest

import detumble
from detumble.analysis.bounds.earliest import minimum_capture_time
from detumble.scenario import LAWS, with_settings
from detumble.scenario.paper import PUBLISHED_CAPTURE_TIMES

SCENARIOS = ("paper", "far_tumble", "twelve_u")
SCRIPTS = Path(__file__).parents[2] / "scripts"


@pytest.mark.parametrize("law", PUBLISHED_CAPTURE_TIMES)
def test_capture_times_match_the_published_ones_for_any_noise(law: str) -> None:
    """Validation: within 2 % of Eng. Proc. 2026, 121(1), 25, by gains identified for it."""
    short = with_settings(detumble.load("paper"), ["time.duration=120.0"])
    times = [detumble.simulate(short, law, seed).metrics.capture_time for seed in range(21)]
    assert times == pytest.approx([PUBLISHED_CAPTURE_TIMES[law]] * 21, rel=0.02)


@pytest.mark.parametrize("name", SCENARIOS)
def test_every_law_captures_and_settles_and_none_beats_the_minimum_time(name: str) -> None:
    scenario = detumble.load(name)
    minimum = minimum_capture_time(scenario)
    assert minimum > 0.0
    for law in LAWS:
        for seed in range(5):
            metrics = detumble.simulate(scenario, law, seed).metrics
            assert metrics.capture_time is not None, (law, seed)
            assert metrics.settling_time is not None, (law, seed)
            assert minimum <= metrics.capture_time, (law, seed)
            assert metrics.capture_time + metrics.settling_time < 0.5 * scenario.time.duration, (law, seed)


@pytest.mark.parametrize("name", SCENARIOS)
def test_no_command_flown_exceeds_a_limit(name: str) -> None:
    scenario = detumble.load(name)
    for law in LAWS:
        metrics = detumble.simulate(scenario, law).metrics
        assert metrics.peak_force is not None
        assert metrics.peak_torque is not None
        assert metrics.peak_force <= scenario.actuators.force_limit
        assert metrics.peak_torque <= scenario.actuators.torque_limit


def test_the_scenarios_ask_for_what_they_are_there_for() -> None:
    """Regression: a minimum time below the fastest published capture; momentum kept; products of inertia, grasp points."""
    paper, far, twelve = (detumble.load(name) for name in SCENARIOS)
    assert minimum_capture_time(paper) < PUBLISHED_CAPTURE_TIMES["prrl"]
    assert {far.capture.transition, twelve.capture.transition} == {"momentum_conserving"}
    assert 10.0 <= sum(x * x for x in far.chaser.position) ** 0.5 <= 20.0
    assert twelve.has_grasp_points
    for body in (twelve.chaser, twelve.debris):
        assert all(body.inertia[i][j] != 0.0 for i in range(3) for j in range(3))


def test_the_dispersed_case_is_the_papers_but_for_its_dispersions() -> None:
    paper, dispersed = (detumble.load(name).to_dict() for name in ("paper", "paper_dispersed"))
    own = {"title", "description", "dispersions", "correlations"}
    assert {name: paper[name] for name in paper.keys() - own} == {
        name: dispersed[name] for name in dispersed.keys() - own
    }
    assert not paper["dispersions"]


def test_the_dispersed_case_fails_seldom_and_for_want_of_torque() -> None:
    """Most runs succeed; the failures tell something: the torque cannot follow a fast tumble, and more torque helps."""
    case = detumble.load("paper_dispersed")
    campaign = detumble.campaign(case, "prrl", runs=2000, seed=1)
    statistics = campaign.statistics
    assert statistics.success.low > 0.9
    assert statistics.success.high < 0.99
    assert len(statistics.failures) >= 3
    assert statistics.saturated_failures > 0.9 * sum(share.count for share in statistics.failures.values())
    runs = campaign.runs.to_polars()
    tumble = np.linalg.norm([runs[f"debris.tumble_rate.{axis}"] for axis in "xyz"], axis=0)
    failed = ~runs["success"].to_numpy()
    assert tumble[failed].min() > 0.3
    assert np.median(tumble[~failed]) < 0.15

    stronger = with_settings(case, ["actuators.torque_limit=0.02"])
    assert detumble.campaign(stronger, "prrl", runs=2000, seed=1).statistics.success.low > statistics.success.share


def test_the_script_finds_the_gains_that_are_shipped(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(SCRIPTS))
    script = importlib.import_module("identify_paper")
    scenario = detumble.load("paper")
    for law, search in script.SEARCHES.items():
        assert script.identify(scenario, law) == getattr(getattr(scenario.laws, law).translation, search.gain), law
