"""Trials: every candidate meets the starts and the noise of the campaign's own runs."""

import numpy as np
import pytest

import detumble
from detumble.analysis.trials import Change, Trials
from detumble.scenario.core import case
from detumble.scenario.faults import validated


@pytest.fixture(scope="module")
def scenario():
    return detumble.load("paper_dispersed")


def slopes(*values):
    column = np.repeat(np.array(values, float)[:, None], 3, axis=1)
    return {"law.before.translation.slope": column, "law.after.translation.slope": column}


def test_every_candidate_meets_the_runs_of_the_campaign(scenario):
    rows = detumble.campaign(scenario, "prrl", 40, seed=3).runs.to_polars()
    own = scenario.laws.prrl.translation.slope
    flown = Trials(scenario, 3, 0, 40).fly("prrl", slopes(0.05, own, 0.3))
    assert np.array_equal(flown["capture_time"][1], rows["capture_time_s"].to_numpy(), equal_nan=True)
    assert np.array_equal(flown["delta_v"][1], rows["delta_v_m_s"].to_numpy(), equal_nan=True)
    assert np.array_equal(flown.succeeded[1], rows["success"].to_numpy())
    assert not np.array_equal(flown["capture_time"][0], flown["capture_time"][2], equal_nan=True)


def test_neither_company_nor_threads_reach_a_candidate(scenario):
    trials = Trials(scenario, 5, 7, 30, horizon=60.0, end="captured")
    together = trials.fly("prrl", slopes(0.1, 0.2, 0.4), threads=2)
    alone = trials.fly("prrl", slopes(0.4), threads=1)
    for name, values in alone.columns.items():
        assert np.array_equal(values[0], together[name][2], equal_nan=True), name


def test_equal_candidates_meet_equal_noise():
    flown = Trials(detumble.load("paper"), 1, 0, 20).fly("prrl", slopes(0.14, 0.14))
    assert np.array_equal(flown["delta_v"][0], flown["delta_v"][1])
    assert len(np.unique(flown["delta_v"][0])) == 20


def test_horizon_breaks_a_flight_off_and_changes_nothing_before(scenario):
    whole, short = (Trials(scenario, 2, 0, 40, horizon=h, end="captured").fly("pd") for h in (None, 30.0))
    early = whole["capture_time"] <= 30.0
    assert 0 < early.sum() < 40
    assert np.array_equal(short["capture_time"][early], whole["capture_time"][early])
    assert np.isnan(short["capture_time"][~early]).all()
    assert short["end_time"].max() == pytest.approx(30.0)


def test_change_is_what_it_says():
    scenario = detumble.load("paper_dispersed")
    plain = case(scenario, "lqr", until_the_end=False)
    trials = Trials(scenario, 1, 0, 5, change=Change(belief=1.3, noise=3.0, control_period=0.25))
    changed, columns = trials.nominal("lqr"), trials.columns("lqr")
    for name in ("chaser_inertia", "stack_inertia"):
        assert np.allclose(changed["belief"][name], 1.3 * np.array(plain["belief"][name]), rtol=1e-15)
        assert f"belief.{name}" not in columns
    assert changed["chaser"] == plain["chaser"]
    assert changed["sensors"]["position"] == pytest.approx(3.0 * plain["sensors"]["position"])
    assert np.allclose(columns["sensors.rate"], 3.0 * Trials(scenario, 1, 0, 5).columns("lqr")["sensors.rate"])
    assert (changed["plan"]["control_period"], changed["plan"]["periods"]) == (0.25, 2400)
    assert changed["plan"]["steps_per_period"] == 5


def test_beliefs_that_are_dispersed_are_changed_too():
    scenario = detumble.load("paper_dispersed")
    raw = scenario.to_dict()
    raw["dispersions"] = [
        {"field": "belief.chaser_inertia", "distribution": "inertia", "relative": 0.1, "axes_sigma": 0.01}
    ]
    believed = validated(raw, "believed")
    plain, changed = (
        Trials(believed, 1, 0, 5, change=change).columns("prrl") for change in (Change(), Change(belief=1.3))
    )
    assert np.ptp(plain["belief.chaser_inertia"], axis=0).max() > 0.0
    assert np.allclose(changed["belief.chaser_inertia"], 1.3 * plain["belief.chaser_inertia"], rtol=1e-15)


def test_wrong_belief_moves_a_law_that_uses_it_and_no_other():
    scenario = detumble.load("paper")
    believed = {
        law: Trials(scenario, 1, 0, 4, change=Change(belief=1.5)).fly(law)["torque_impulse"] for law in ("pd", "prrl")
    }
    straight = {law: Trials(scenario, 1, 0, 4).fly(law)["torque_impulse"] for law in ("pd", "prrl")}
    assert np.array_equal(believed["pd"], straight["pd"])
    assert not np.isclose(believed["prrl"], straight["prrl"]).any()
