"""What gains are worth: finite whatever happened, and never better for too few successes."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import detumble
from detumble.analysis.trials import Results
from detumble.analysis.tuning.objective import Objective
from detumble.errors import RequestError
from detumble.failures import CODES, DIVERGED, DWELL_MISSED, NEVER_CAPTURED, NOT_SETTLED

CEILING = 100.0


def results(failure: np.ndarray, times: np.ndarray) -> Results:
    captured = np.where(failure <= NOT_SETTLED, times, np.nan)
    settling = np.where(failure == 0, 5.0, np.nan)
    delta_v = 0.01 * times
    return Results(
        failure.astype(np.uint8),
        {
            "capture_time": captured,
            "settling_time": settling,
            "delta_v": delta_v,
            "delta_v_to_capture": np.where(np.isnan(captured), np.nan, delta_v),
        },
    )


def one(*codes: int, times: float = 10.0) -> Results:
    failure = np.array([codes])
    return results(failure, np.full(failure.shape, times))


@pytest.mark.parametrize("what", ["capture", "settling", "delta_v", "delta_v_total"])
@pytest.mark.parametrize("percentile", [None, 50.0, 95.0])
def test_too_few_successes_cost_more_than_any_feasible_candidate(what: str, percentile: float | None) -> None:
    generator = np.random.default_rng(3)
    failing = generator.random((4000, 40)) < generator.random((4000, 1)) ** 2
    failure = np.where(failing, generator.choice(CODES, (4000, 40)), 0)
    judged = Objective(what, percentile, required=0.8).judge(
        results(failure, generator.exponential(60.0, (4000, 40))), CEILING
    )
    feasible = (failure == 0).mean(axis=1) >= 0.8
    assert 100 < feasible.sum() < 3900
    assert np.isfinite(judged.cost).all()
    assert judged.cost[feasible].max() <= CEILING < judged.cost[~feasible].min()
    assert np.array_equal(judged.share, (failure == 0).mean(axis=1))


def test_mean_and_percentile_by_hand() -> None:
    failure = np.array([[0, 0, 0, NOT_SETTLED]])
    found = results(failure, np.array([[10.0, 30.0, 20.0, 5.0]]))

    def cost(what: str, percentile: float | None) -> float:
        return float(Objective(what, percentile, required=0.75).judge(found, CEILING).cost[0])

    assert cost("capture", None) == (10.0 + 30.0 + 20.0 + 100.0) / 4
    assert [cost("capture", percent) for percent in (25.0, 50.0, 75.0, 76.0, 100.0)] == [10.0, 20.0, 30.0, 100.0, 100.0]
    assert cost("settling", 50.0) == 25.0
    assert cost("delta_v", 25.0) == pytest.approx(0.1)
    assert cost("delta_v_total", 50.0) == pytest.approx(0.2)
    assert float(Objective(required=0.8).judge(found, CEILING).cost[0]) == pytest.approx(
        CEILING * (1 + 0.05 + 0.25 * 0.2)
    )


def test_the_nearer_to_success_the_cheaper_also_where_nothing_succeeds() -> None:
    never = [NEVER_CAPTURED + bits for bits in (0, 1, 3, 7, 15)]
    order = [0, NOT_SETTLED, DWELL_MISSED, *never, DIVERGED]
    costs = [float(Objective(required=1.0).judge(one(0, code), CEILING).cost[0]) for code in order]
    assert all(first < second for first, second in itertools.pairwise(costs))
    fewer, more = (Objective().judge(one(*codes), CEILING).cost[0] for codes in ((0, 17, 17, 17), (0, 0, 17, 17)))
    assert more < fewer


def test_late_successes_count_for_no_more_than_failures() -> None:
    assert Objective().judge(one(0, 0, times=1e6), CEILING).cost[0] == CEILING


def test_ceiling_of_delta_v_is_all_that_can_be_spent() -> None:
    assert Objective("delta_v").ceiling(60.0, 0.01) == pytest.approx(1.8)
    assert Objective("capture").ceiling(60.0, 0.01) == 60.0


def test_objectives_that_make_no_sense_are_refused() -> None:
    for how, text in (
        ({"what": "fuel"}, "objective 'fuel': must be one of capture, settling, delta_v, delta_v_total"),
        ({"percentile": 0.0}, "percentile 0: must be greater than 0"),
        ({"required": 1.1}, "required 1.1: a share must be"),
        ({"until": "docked"}, "until 'docked': must be"),
    ):
        with pytest.raises(RequestError) as refused:
            Objective(**how)
        assert text in str(refused.value)
    paper = detumble.load("paper")
    with pytest.raises(RequestError, match="flights end at capture"):
        Objective("settling", until="captured").end(paper)
    paper.capture.merge = False
    with pytest.raises(RequestError, match=r"capture\.merge is false"):
        Objective("settling").end(paper)
