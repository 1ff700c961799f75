"""Time against Δv: nothing on the front is beaten, and each point flies as it says."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import detumble
from detumble.analysis.trials import Trials
from detumble.analysis.tuning import Front, pareto_front
from detumble.analysis.tuning.pareto import _measure, undominated
from detumble.errors import RequestError
from detumble.scenario import Scenario, from_toml

SMALL = {"budget": 160, "weights": 4, "starts": 16, "horizon": 60.0, "until": "captured", "required": 0.75}
CEILINGS = np.array([60.0, 2.0])


@pytest.fixture(scope="module")
def dispersed() -> Scenario:
    return detumble.load("paper_dispersed")


@pytest.fixture(scope="module")
def front(dispersed: Scenario) -> Front:
    return pareto_front(dispersed, "prrl", **SMALL)


def test_the_front_is_what_no_candidate_beats() -> None:
    """Against comparing all with all."""
    costs = np.random.default_rng(0).integers(0, 30, (400, 2)) * np.array([3.0, 0.1])
    feasible = (costs <= CEILINGS).all(axis=1)
    beaten = [
        any(feasible[j] and (costs[j] <= costs[i]).all() and (costs[j] < costs[i]).any() for j in range(400))
        for i in range(400)
    ]
    wanted = {tuple(costs[i]) for i in range(400) if feasible[i] and not beaten[i]}
    found = undominated(costs, CEILINGS)
    assert {tuple(costs[i]) for i in found} == wanted
    assert len(found) == len(wanted)
    assert (np.diff(costs[found, 0]) > 0).all()
    assert (np.diff(costs[found, 1]) < 0).all()
    assert undominated(costs + CEILINGS + 1e-9, CEILINGS) == []


@pytest.mark.parametrize("weight", [0.0, 0.3, 1.0])
def test_by_any_weight_too_few_successes_are_worse(weight: float) -> None:
    generator = np.random.default_rng(1)
    good = generator.random((200, 2)) * CEILINGS
    bad = CEILINGS * (1.0 + 1e-9 + generator.random((200, 1)))
    close = np.array([[10.0, 0.5], [10.1, 0.499]])
    for seen in (good[:20], good[:1], close, np.empty((0, 2))):
        measure = _measure(seen, CEILINGS, weight)
        assert measure(good).max() < measure(bad).min()


def test_a_front_goes_from_fast_to_least_delta_v_and_each_point_flies_as_it_says(
    front: Front, dispersed: Scenario
) -> None:
    assert len(front.points) >= 3
    times, efforts = ([getattr(point, name) for point in front.points] for name in ("time", "delta_v"))
    assert (np.diff(times) > 0).all()
    assert (np.diff(efforts) < 0).all()
    assert times[-1] > 1.3 * times[0]
    for place in (0, len(front.points) - 1):
        scenario = from_toml(front.scenario(place).to_toml())
        told = scenario.laws.prrl.tuned
        assert (told.objective, told.time_s, told.delta_v_m_s) == ("pareto", times[place], efforts[place])
        flown = Trials(scenario, 0, 0, 16, 60.0, "captured").fly("prrl")
        captured = flown.succeeded[0]
        assert captured.mean() == told.success
        late = np.where(captured, flown["capture_time"][0], 60.0)
        assert late.mean() == pytest.approx(times[place], rel=1e-12)


def test_equal_seeds_give_the_same_front_also_when_it_is_continued(
    front: Front, dispersed: Scenario, tmp_path: Path
) -> None:
    record = tmp_path / "record.jsonl"
    whole = pareto_front(dispersed, "prrl", record=record, **SMALL)
    assert whole.points == front.points
    lines = record.read_bytes().splitlines(keepends=True)
    record.write_bytes(b"".join(lines[: len(lines) // 2]) + lines[len(lines) // 2][:30])
    assert pareto_front(dispersed, "prrl", record=record, resume=True, **SMALL).points == front.points
    with pytest.raises(RequestError, match=r"holds another search .*weights 4 there, 5 asked for"):
        pareto_front(dispersed, "prrl", record=record, resume=True, **(SMALL | {"weights": 5}))


def test_points_chosen_from_a_front_hold_both_ends(front: Front) -> None:
    chosen = front.spread(3)
    assert chosen[0] == 0
    assert chosen[-1] == len(front.points) - 1
    assert len(chosen) <= 3
    assert front.spread(1000) == list(range(len(front.points)))
