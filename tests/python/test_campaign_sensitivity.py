"""Sensitivity from the runs of a campaign: known answers, and inputs without influence stay below the threshold."""

import json
import math
import sys

import numpy as np
import polars as pl
import pytest
from scipy.spatial.transform import Rotation

import detumble
from detumble.campaigns.columns import INDEX, RESULTS
from detumble.campaigns.statistics import sensitivity
from detumble.campaigns.statistics.inputs import START_ERROR, drawn_columns, inputs
from detumble.campaigns.statistics.sensitivity import sensitivities
from detumble.errors import RequestError
from detumble.failures import CAUSES
from detumble.quaternions import rotation_vector

SCENARIO = detumble.load("paper")


@pytest.fixture
def quick(monkeypatch):
    """A threshold from fewer random columns, where no input is near it."""
    monkeypatch.setattr(sensitivity, "DUMMIES", 20)


def table(drawn, success, capture=None):
    """Rows of a campaign: drawn columns, who succeeded, and capture times (those of the failed are taken away)."""
    runs = len(success)
    capture = np.full(runs, 20.0) if capture is None else capture
    rows = {
        "index": np.arange(runs, dtype=np.uint64),
        **drawn,
        "success": success,
        "failure": [None if good else CAUSES[0] for good in success],
        **{column.name: np.ones(runs) for column in RESULTS[2:]},
    }
    return pl.DataFrame(rows | {"capture_time_s": np.where(success, capture, np.nan)})


def random_inputs(runs, *fields, seed=1):
    source = np.random.default_rng(seed)
    return {field: source.random(runs) for field in fields}


def named(found):
    return {influence.field: influence for influence in found.influences}


# --- inputs ------------------------------------------------------------------------------------------------------------


def test_inputs_are_the_columns_that_are_no_results():
    drawn = random_inputs(10, "chaser.mass", "debris.tumble_rate.x")
    assert drawn_columns(table(drawn, np.ones(10, bool)).columns) == list(drawn)
    assert drawn_columns([INDEX.name, *(column.name for column in RESULTS)]) == []


def test_validation_rotation_vectors_are_those_of_scipy():
    turns = Rotation.random(200, rng=np.random.default_rng(2))
    quaternions = turns.as_quat(scalar_first=True)
    assert rotation_vector(quaternions) == pytest.approx(turns.as_rotvec(), abs=1e-12)
    assert rotation_vector(-quaternions) == pytest.approx(turns.as_rotvec(), abs=1e-12)
    tiny = np.array([[1.0, 1e-12, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]])
    assert rotation_vector(tiny) == pytest.approx(np.array([[2e-12, 0, 0], [0, 0, 0]]), rel=1e-12, abs=0.0)


def test_attitudes_become_the_turn_from_nominal_and_the_error_at_the_start():
    scenario = detumble.load("twelve_u")
    nominal = Rotation.from_quat(scenario.chaser.attitude, scalar_first=True)
    debris = Rotation.from_quat(scenario.debris.attitude, scalar_first=True)
    turns = Rotation.from_rotvec(np.random.default_rng(3).normal(0.0, 0.3, (50, 3)))
    q = (nominal * turns).as_quat(scalar_first=True)
    drawn = {f"chaser.attitude.{name}": q[:, place] for place, name in enumerate("wxyz")}
    found, constant = inputs(table(drawn, np.ones(50, bool)), scenario)
    assert list(found) == ["chaser.attitude angle", *(f"chaser.attitude about {a}" for a in "xyz"), START_ERROR]
    about = np.stack([found[f"chaser.attitude about {axis}"] for axis in "xyz"], axis=-1)
    assert about == pytest.approx(turns.as_rotvec(), abs=1e-12)
    assert found["chaser.attitude angle"] == pytest.approx(turns.magnitude(), abs=1e-12)
    assert found[START_ERROR] == pytest.approx((debris.inv() * nominal * turns).magnitude(), abs=1e-9)
    assert constant == ()


def test_vectors_get_their_magnitude_and_constants_are_set_aside():
    source = np.random.default_rng(4)
    direction = source.normal(size=(100, 3))
    direction *= 0.1 / np.linalg.norm(direction, axis=1, keepdims=True)
    drawn = {f"debris.tumble_rate.{axis}": direction[:, place] for place, axis in enumerate("xyz")}
    drawn |= {"chaser.position.x": source.random(100), "chaser.position.y": np.zeros(100)}
    drawn |= {"chaser.position.z": source.random(100), "chaser.mass": np.full(100, 9.0)}
    drawn |= {f"debris.inertia.{entry}": source.random(100) for entry in ("xx", "yy", "zz")}
    found, constant = inputs(table(drawn, np.ones(100, bool)), SCENARIO)
    assert constant == ("|debris.tumble_rate|", "chaser.position.y", "chaser.mass")
    expected = np.hypot(drawn["chaser.position.x"], drawn["chaser.position.z"])
    assert found["|chaser.position|"] == pytest.approx(expected)
    assert found["debris.inertia.yy"].tolist() == drawn["debris.inertia.yy"].tolist()
    assert len(found) == 3 + 3 + 3


# --- known answers -----------------------------------------------------------------------------------------------------


def test_indices_of_outcomes_that_follow_one_input_are_those_of_the_closed_form(quick):
    drawn = random_inputs(2000, "chaser.mass", "debris.mass")
    failure, capture = sensitivities(table(drawn, drawn["chaser.mass"] < 0.7, 10.0 + drawn["debris.mass"]), SCENARIO)
    # X > 0.7 fails: the distributions of X among failed and successful runs do not overlap
    assert named(failure)["chaser.mass"].index == pytest.approx(1.0, abs=0.02)
    assert named(failure)["chaser.mass"].correlation == pytest.approx(math.sqrt(3 * 0.7 * 0.3), abs=0.03)
    # T follows X: slice s of 10 lies max(s, 9 - s)/10 away from the whole, 0.7 in the mean
    assert named(capture)["debris.mass"].index == pytest.approx(0.7, abs=0.01)
    assert named(capture)["debris.mass"].correlation == pytest.approx(1.0)
    for found, other in ((failure, "debris.mass"), (capture, "chaser.mass")):
        assert [influence.field for influence in found.influential] == [found.influences[0].field]
        assert named(found)[other].index < found.threshold < 0.12
        assert named(found)[other].p_value > 0.01
    assert (failure.outcome, capture.outcome) == ("failure", "capture_time_s")
    assert (failure.runs, capture.runs) == (2000, int(np.sum(drawn["chaser.mass"] < 0.7)))


def test_failure_index_is_the_total_variation_between_failed_and_successful_runs(quick):
    drawn = random_inputs(5000, "chaser.mass", "debris.mass", seed=5)
    probability = 1.0 / (1.0 + np.exp(12.0 * (drawn["chaser.mass"] - 0.4)))
    success = np.random.default_rng(6).random(5000) > probability
    failure, _ = sensitivities(table(drawn, success), SCENARIO)
    ranks = np.argsort(np.argsort(drawn["chaser.mass"])) // 500
    failed, succeeded = (np.bincount(ranks[part], minlength=10) / part.sum() for part in (~success, success))
    found = named(failure)["chaser.mass"]
    assert found.index == pytest.approx(0.5 * np.abs(failed - succeeded).sum(), abs=1e-3)
    assert found.correlation < -0.3
    assert found.p_value < 1e-100


def test_influences_come_out_in_the_order_of_their_strength(quick):
    fields = [f"laws.prrl.gain{number}" for number in range(6)]
    drawn = random_inputs(2000, *fields, seed=7)
    strengths = dict(zip(fields, (4.0, 2.0, 1.0, 0.5, 0.0, 0.0), strict=True))
    score = sum(strength * drawn[field] for field, strength in strengths.items())
    source = np.random.default_rng(8)
    success = score + source.logistic(0.0, 0.3, 2000) < np.quantile(score, 0.7)
    for found in sensitivities(table(drawn, success, 20.0 + score + source.normal(0, 0.2, 2000)), SCENARIO):
        assert [influence.field for influence in found.influences][:3] == fields[:3]
        assert {influence.field for influence in found.influential} >= set(fields[:3])
        assert not {influence.field for influence in found.influential} & set(fields[4:])
        first, second = found.influences[:2]
        assert second.index + second.confidence < first.index - first.confidence


def test_validation_ishigami_inputs_without_correlation_are_found(quick):
    runs = 2000
    x = {
        f"x{number}": value
        for number, value in enumerate(np.random.default_rng(9).uniform(-np.pi, np.pi, (4, runs)), 1)
    }
    outcome = np.sin(x["x1"]) + 7.0 * np.sin(x["x2"]) ** 2 + 0.1 * x["x3"] ** 4 * np.sin(x["x1"])
    drawn = {f"chaser.{name}": value for name, value in x.items()}
    _, capture = sensitivities(table(drawn, np.ones(runs, bool), outcome - outcome.min()), SCENARIO)
    # x2 acts symmetrically and x3 only in the spread: no correlation, no first-order variance of x3
    assert {influence.field for influence in capture.influential} == {"chaser.x1", "chaser.x2", "chaser.x3"}
    assert abs(named(capture)["chaser.x3"].correlation) < 0.05
    assert abs(named(capture)["chaser.x2"].correlation) < 0.05


def test_inputs_without_influence_stay_below_the_threshold():
    drawn = random_inputs(1000, *(f"chaser.nothing{number}" for number in range(200)), seed=10)
    columns = np.stack(list(drawn.values()), axis=-1)
    source = np.random.default_rng(11)
    success = source.random(1000) < 0.9
    capture = source.exponential(10.0, 1000)
    few = table({"chaser.nothing0": drawn["chaser.nothing0"]}, success, capture)
    values = ((~success).astype(float), capture[success])
    for found, outcome, rows in zip(sensitivities(few, SCENARIO), values, (slice(None), success), strict=True):
        indices = sensitivity._indices(columns[rows], outcome, found.outcome == "failure")
        assert found.influences[0].index == indices[0]
        assert np.mean(indices > found.threshold) <= 0.005  # 1 of 200
        assert np.median(indices) < found.threshold < 2.5 * np.median(indices)


def test_confidence_is_the_spread_over_campaigns():
    runs, campaigns = 400, 30
    indices, confidences = [], []
    for seed in range(campaigns):
        source = np.random.default_rng(100 + seed)
        mass = source.random((runs, 1))
        failed = (source.random(runs) < 0.4 * mass[:, 0]).astype(float)
        indices.append(sensitivity._indices(mass, failed, True)[0])
        confidences.append(sensitivity._confidence(mass, failed, True)[0])
    assert np.mean(confidences) == pytest.approx(2.26 * np.std(indices, ddof=1), rel=0.4)


def test_failures_as_few_as_allowed_have_a_finite_confidence(quick):
    drawn = random_inputs(1000, "chaser.mass", "debris.mass", seed=16)
    success = np.arange(1000) % 100 != 0  # all in the same place among tens
    failure, _ = sensitivities(table(drawn, success), SCENARIO)
    assert all(math.isfinite(influence.confidence) for influence in failure.influences)
    assert failure.influential == ()


def test_the_magnitude_is_found_where_it_is_what_counts(quick):
    source = np.random.default_rng(12)
    rate = source.normal(0.0, 0.05, (1500, 3))
    drawn = {f"debris.tumble_rate.{axis}": rate[:, place] for place, axis in enumerate("xyz")}
    speed = np.linalg.norm(rate, axis=1)
    for found in sensitivities(table(drawn, speed < 0.11, 10.0 + 100.0 * speed), SCENARIO):
        assert found.influences[0].field == "|debris.tumble_rate|"
        assert found.influences[0].index > 2.0 * found.influences[1].index


def test_the_attitude_error_is_found_where_it_is_what_counts(quick):
    turns = Rotation.random(2000, rng=np.random.default_rng(13))
    q = turns.as_quat(scalar_first=True)
    drawn = {f"debris.attitude.{name}": q[:, place] for place, name in enumerate("wxyz")}
    scenario = detumble.load("paper")
    scenario.chaser.attitude = (0.5, 0.5, 0.5, 0.5)
    error = (Rotation.from_quat([0.5, 0.5, 0.5, 0.5]).inv() * turns).magnitude()
    failure, _ = sensitivities(table(drawn, error < 2.5), scenario)
    assert failure.influences[0].field == START_ERROR
    assert failure.influences[0].index == pytest.approx(1.0, abs=0.15)


# --- what is used, and when there is nothing to say ------------------------------------------------------------------------


def test_rare_failures_are_taken_from_further_on(monkeypatch, quick):
    monkeypatch.setattr(sensitivity, "RUNS", 2000)
    runs = 40_000
    drawn = random_inputs(runs, "chaser.mass", "debris.mass", seed=14)
    success = drawn["chaser.mass"] < 0.9975
    rows = table(drawn, success)
    assert np.sum(~success[:2000]) < 10
    failure, capture = sensitivities(rows.lazy(), SCENARIO)
    assert failure.runs == 2000 + np.sum(~success[2000:])
    assert capture.runs == 2000
    assert failure.influences[0].field == "chaser.mass"
    assert failure.influences[0].index > 0.85
    assert [influence.field for influence in failure.influential] == ["chaser.mass"]


def test_no_more_than_the_sample_is_read(monkeypatch, quick):
    monkeypatch.setattr(sensitivity, "RUNS", 400)
    monkeypatch.setattr(sensitivity, "FAILURES", 100)
    drawn = random_inputs(2000, "chaser.mass", seed=15)
    rows = table(drawn, np.arange(2000) % 4 != 0, 10.0 + drawn["chaser.mass"])
    found = sensitivities(rows, SCENARIO)
    assert [outcome.runs for outcome in found] == [500, 400]
    assert sensitivities(rows.head(800).lazy(), SCENARIO) == found
    assert sensitivities(rows.head(796).lazy(), SCENARIO) != found


@pytest.mark.parametrize(
    ("runs", "failures", "why"),
    [
        (99, 20, "99 runs flown; at least 100 are needed"),
        (500, 0, "none of 500 runs failed; at least 10 are needed"),
        (500, 9, "only 9 of 500 runs failed; at least 10 are needed"),
        (500, 500, "none of 500 runs succeeded; at least 10 are needed"),
    ],
)
def test_too_little_to_go_on_is_said(runs, failures, why):
    success = np.arange(runs) >= failures
    failure, _ = sensitivities(table(random_inputs(runs, "chaser.mass"), success), SCENARIO)
    assert failure.silence == why
    assert (failure.influences, failure.influential, failure.threshold) == ((), (), None)


def test_nothing_to_go_on_for_the_capture_time_is_said(quick):
    drawn = random_inputs(500, "chaser.mass")
    _, same = sensitivities(table(drawn, drawn["chaser.mass"] < 0.5), SCENARIO)
    assert same.silence == "all runs captured at the same time"
    _, few = sensitivities(table(drawn, np.arange(500) < 60, 10.0 + drawn["chaser.mass"]), SCENARIO)
    assert few.silence == "60 runs captured; at least 100 are needed"
    _, none = sensitivities(table(drawn, np.zeros(500, bool)), SCENARIO)
    assert none.silence == "0 runs captured; at least 100 are needed"
    success = np.arange(500) % 2 == 0
    for found in sensitivities(table({}, success, 10.0 + np.arange(500)), SCENARIO):
        assert found.silence == "nothing was dispersed"
    for found in sensitivities(table({"chaser.mass": np.full(500, 9.0)}, success, 10.0 + np.arange(500)), SCENARIO):
        assert (found.silence, found.constant) == ("nothing was dispersed", ("chaser.mass",))


def test_the_result_is_the_same_every_time_and_fit_for_json(quick):
    drawn = random_inputs(500, "chaser.mass", "debris.mass")
    rows = table(drawn, drawn["chaser.mass"] < 0.8, 10.0 + drawn["debris.mass"])
    np.random.seed(0)  # noqa: NPY002 - the state that nothing here may depend on
    first = sensitivities(rows, SCENARIO)
    np.random.seed(1)  # noqa: NPY002
    assert sensitivities(rows.with_columns(pl.col("capture_time_s").fill_nan(None)).lazy(), SCENARIO) == first
    for found in first:
        stored = json.loads(json.dumps(found.to_json(), allow_nan=False))
        assert stored["influences"][0]["field"] == found.influences[0].field
        assert stored["threshold"] == found.threshold


def test_a_missing_salib_is_said_with_what_installs_it(monkeypatch, quick):
    monkeypatch.setitem(sys.modules, "SALib.analyze.pawn", None)
    with pytest.raises(RequestError, match=r"detumble\[sensitivity\]"):
        sensitivity.pawn()
    drawn = random_inputs(500, "chaser.mass")
    with pytest.raises(RequestError, match=r"detumble\[sensitivity\]"):
        sensitivities(table(drawn, drawn["chaser.mass"] < 0.5), SCENARIO)
