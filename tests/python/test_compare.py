"""Comparisons from tuning to ranking, on few runs; bounds of the runs of a campaign."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import binom

import detumble
from detumble.analysis.bounds import runs as bounds_of_runs
from detumble.analysis.bounds.earliest import minimum_capture_time
from detumble.analysis.bounds.runs import capture_bounds, delta_v_bounds, settling_bounds
from detumble.analysis.comparing import Comparison, Entry, Plan, compare, comparer
from detumble.analysis.comparing.judge import Verdict, fly
from detumble.analysis.comparing.judged import Judged
from detumble.analysis.comparing.pairs import OBJECTIVES, pairs_of
from detumble.analysis.comparing.ranking import Score
from detumble.analysis.comparing.robustness import sweeps_of
from detumble.analysis.trials import Trials
from detumble.analysis.tuning import Objective
from detumble.analysis.tuning.objective import What
from detumble.campaigns.runs.draws import drawn_scenario
from detumble.cli import main
from detumble.commands.progress import Line
from detumble.errors import RequestError
from detumble.progress import Watcher
from detumble.scenario import Scenario, with_settings

TWINS = (Entry("One", "prrl", "printed"), Entry("Other", "prrl", "printed"), Entry("PD", "pd", "corrected"))
SMALL = Plan(budget=20, starts=16, tunings=2, runs=200, robust=20)


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    return with_settings(detumble.load("paper_dispersed"), ["time.duration=200.0", "campaign.hold=20.0"])


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("compare")


@pytest.fixture(autouse=True, scope="module")
def little_fuel() -> Iterator[None]:
    """Bounds of Δv take longest."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(comparer, "FUEL_RUNS", 12)
        yield


@pytest.fixture(scope="module")
def small(scenario: Scenario, folder: Path) -> Comparison:
    return compare(scenario, TWINS, SMALL, out=folder)


@pytest.fixture(scope="module")
def as_given(scenario: Scenario) -> Comparison:
    return compare(scenario, plan=Plan(as_given=True, runs=300, robust=0))


def test_one_law_under_two_names_ties_to_the_bit(small: Comparison) -> None:
    one, other, _ = small.entries
    assert one.tuning.gains == other.tuning.gains
    assert np.array_equal(one.runs["delta_v"], other.runs["delta_v"], equal_nan=True)
    assert set(small.pair(0, 1).adjusted.values()) == {1.0}
    assert small.ranking.ranks[0] == small.ranking.ranks[1]
    assert set(small.ranking.letters[0]) & set(small.ranking.letters[1])


def test_one_law_under_independent_noise_ties_as_a_rule() -> None:
    paper, entry, mistaken = detumble.load("paper"), TWINS[0], 0
    for repetition in range(30):
        flown = [fly(Trials(paper, 2 * repetition + place, 0, 150), "prrl") for place in range(2)]
        twins = [
            Judged(entry, (), 0, runs, np.minimum(runs.capture_time, 100.0), Verdict.of(runs), Score(False, 0.0))
            for runs in flown
        ]
        assert not np.array_equal(flown[0]["delta_v"], flown[1]["delta_v"])
        mistaken += any(p < 0.05 for p in pairs_of(twins)[0].adjusted.values())
    assert mistaken <= binom.ppf(0.999, 30, 0.05)


def test_everybody_is_given_the_same(small: Comparison) -> None:
    for judged in small.entries:
        assert [tuning.optimiser_seed for tuning in judged.tunings] == [0, 1]
        costs = [tuning.cost for tuning in judged.tunings]
        assert judged.tuning.cost == min(costs)
        for tuning in judged.tunings:
            told = getattr(tuning.scenario.laws, judged.entry.law).tuned
            assert (told.evaluations, told.starts, told.seed) == (20, 16, 0)
            assert told.horizon_s == small.plan.horizon
            assert tuning.verdict is not None
            assert tuning.verdict.success.runs == 200
        assert len(judged.runs) == 200


def test_interrupted_comparison_goes_on_to_the_same_end(small: Comparison, scenario: Scenario, folder: Path) -> None:
    with pytest.raises(RequestError, match="--resume"):
        compare(scenario, TWINS, SMALL, out=folder)
    record = folder / "records" / "pd-1" / "record.jsonl"
    whole = record.read_bytes()
    record.write_bytes(whole[: len(whole) // 2])
    again = compare(scenario, TWINS, SMALL, out=folder, resume=True, threads=1)
    assert again.to_json() == small.to_json()
    assert record.read_bytes() == whole


def test_folder_holds_numbers_and_gains_that_fly(small: Comparison, folder: Path) -> None:
    told = json.loads((folder / "comparison.json").read_text(), parse_constant=pytest.fail)
    assert told == json.loads(json.dumps(small.to_json()))
    own = detumble.load(folder / "tuned" / "pd.toml")
    flown = Trials(own, small.plan.judging, 0, 50).fly("pd")["capture_time"][0]
    assert np.array_equal(flown, small.entries[2].runs["capture_time"][:50], equal_nan=True)


def test_a_watcher_follows_every_stage_to_its_end(scenario: Scenario) -> None:
    class Noted(Watcher):
        def __init__(self) -> None:
            self.stages: dict[str, tuple[int, int]] = {}

        def stage(self, title: str) -> None:
            self.title = title

        def begin(self, total: int) -> None:
            self.stages[self.title] = (total, 0)

        def now(self, done: int, fresh: int | None = None, found: object = None) -> None:
            total, before = self.stages[self.title]
            assert before <= done <= total
            self.stages[self.title] = (total, done)

    noted = Noted()
    compare(scenario, TWINS[1:], Plan(budget=9, starts=8, tunings=1, runs=20, robust=5), watcher=noted)
    assert [title for title in noted.stages if title.startswith("PD")] == [
        "PD: tuning 1 of 1",
        "PD: held-out runs",
        "PD: robustness",
    ]
    assert noted.stages["PD: tuning 1 of 1"] == (9, 9)
    assert noted.stages["least capture time of every run"] == (20, 20)


def test_largest_seed_has_further_searches_too() -> None:
    paper, largest = detumble.load("paper"), 2**64 - 1
    result = compare(paper, TWINS[1:], Plan(seed=largest, budget=2, starts=2, tunings=2, runs=5, robust=0))
    assert [tuning.optimiser_seed for tuning in result.entries[0].tunings] == [largest, 0]


@pytest.mark.parametrize("begun", [True, False])
def test_stopping_says_how_to_go_on_where_there_is_something_to_go_on_with(
    begun: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    line = Line(tmp_path, "runs")
    if begun:
        line.begin(3)
    with pytest.raises(KeyboardInterrupt), line:
        raise KeyboardInterrupt
    assert ("--resume" in capsys.readouterr().err) is begun


def test_figures_are_drawn_for_few_and_for_failing_runs(small: Comparison, tmp_path: Path) -> None:
    files = small.figures(tmp_path / "figures")
    assert {file.name for file in files} == {"capture-times.png", "pairs.png", "robustness.png"}
    assert all(file.read_bytes().startswith(b"\x89PNG") for file in files)
    hopeless = with_settings(small.scenario, ["capture.distance=1e-6"])
    nobody = compare(hopeless, TWINS, Plan(as_given=True, runs=5, robust=2))
    assert nobody.ranking.ranks == (1, 1, 1)
    assert len(nobody.figures(tmp_path / "nobody")) == 3


def test_judgement_is_that_of_the_campaign(as_given: Comparison, scenario: Scenario) -> None:
    for place, form in ((4, "printed"), (5, "corrected")):
        own = scenario.model_copy(deep=True)
        own.laws.sosmc.form = form
        statistics = detumble.campaign(own, "sosmc", 300, seed=1).statistics
        verdict = as_given.entries[place].verdict
        assert verdict.success == statistics.success
        assert verdict.captured == statistics.captured
        assert verdict.failures == {cause: share.count for cause, share in statistics.failures.items()}
        told, expected = (
            verdict.figures["delta_v_to_capture_m_s"].median,
            statistics.summary("delta_v_to_capture_m_s").quantiles[50],
        )
        assert told is not None
        assert told.value == pytest.approx(expected.value, rel=1e-4)
        assert told.low == pytest.approx(expected.low, rel=1e-4)


def test_no_run_beats_a_bound(as_given: Comparison) -> None:
    assert as_given.broken == []
    for judged in as_given.entries:
        for name, ratio in judged.ratios.items():
            known = ratio.values[~np.isnan(ratio.values)]
            assert len(known), (judged.entry.name, name)
            assert known.min() >= 1.0 - 1e-9, (judged.entry.name, name)


@pytest.mark.parametrize("what", ["settling", "delta_v", "delta_v_total"])
def test_order_follows_the_objective(what: What, scenario: Scenario) -> None:
    entries = (Entry("quick", "prrl", "printed"), Entry("frugal", "tsmc", "printed"))
    result = compare(scenario, entries, Plan(Objective(what, required=0.5), as_given=True, runs=60, robust=0))
    expected = [1, 2] if what == "settling" else [2, 1]
    assert list(result.ranking.ranks) == expected
    first, second = (result.entries[place] for place in result.ordered)
    assert first.score < second.score
    assert result.pair(0, 1).better(result.ordered[0], OBJECTIVES[what])


def test_failed_runs_count_as_never(as_given: Comparison) -> None:
    printed = as_given.entries[0]
    share = printed.verdict.success.share
    assert share < 0.95
    high = printed.verdict.figures["capture_time_s"].high
    assert high is not None
    assert math.isinf(high.value)
    assert printed.to_json()["capture_time_s"]["p95"] is None
    assert printed.score.short


def test_own_value_of_a_sweep_is_not_flown_again_and_noise_harms(small: Comparison) -> None:
    for judged in small.entries:
        belief, noise, period = judged.curves
        own = belief.verdicts[belief.sweep.values.index(1.0)]
        assert own is noise.verdicts[0] is period.verdicts[period.sweep.values.index(0.1)]
        assert own.success.runs == 20
        assert own.success.count == int(judged.runs.succeeded[:20].sum())
    assert any(
        judged.curves[1].verdicts[2].success.share < judged.curves[1].verdicts[0].success.share
        for judged in small.entries
    )


def test_periods_that_the_scenario_cannot_be_flown_with_are_left_out(scenario: Scenario) -> None:
    assert sweeps_of(scenario)[2].values == (0.05, 0.1, 0.2, 0.5, 1.0)
    long = with_settings(scenario, ["time.duration=2e5", "time.integration_step=0.1"])
    assert sweeps_of(long)[2].values == (0.1, 0.2, 0.5, 1.0)


def test_bound_of_a_run_is_that_of_its_own_scenario(scenario: Scenario) -> None:
    bounds = capture_bounds(Trials(scenario, 5, 10, 6), processes=1)
    assert bounds.tolist() == [minimum_capture_time(drawn_scenario(scenario, 5, index)) for index in range(10, 16)]


def test_bounds_do_not_depend_on_who_computes_them(scenario: Scenario, monkeypatch: pytest.MonkeyPatch) -> None:
    trials = Trials(scenario, 5, 0, 150)
    alone = capture_bounds(trials, processes=1)
    monkeypatch.setattr(bounds_of_runs, "FEW", 0)
    seen: list[int] = []
    shared = capture_bounds(trials, processes=2, progress=seen.append)
    assert np.array_equal(alone, shared)
    assert seen == [64, 128, 150]
    monkeypatch.setattr(sys, "executable", "/nowhere/python")  # nobody helps
    with pytest.raises(OSError, match="nowhere"):
        capture_bounds(trials, processes=2)


def test_files_of_the_user_do_not_reach_those_who_help(
    scenario: Scenario, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(bounds_of_runs, "FEW", 0)
    (tmp_path / "signal.py").write_text("raise SystemExit('not meant for you')\n")
    monkeypatch.chdir(tmp_path)
    capture_bounds(Trials(scenario, 5, 0, 150), processes=2)
    assert capfd.readouterr().err == ""


def test_bounds_can_be_stopped(scenario: Scenario, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bounds_of_runs, "FEW", 0)

    def stop(_: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        capture_bounds(Trials(scenario, 5, 0, 1000), processes=2, progress=stop)


def test_runs_from_one_start_share_one_bound() -> None:
    paper = detumble.load("paper")
    seen: list[int] = []
    bounds = capture_bounds(Trials(paper, 0, 0, 5000), progress=seen.append)
    assert seen == [5000]
    assert set(bounds.tolist()) == {minimum_capture_time(paper)}


def test_runs_that_begin_captured_are_drawn_as_soon_as_any_controller_could(scenario: Scenario) -> None:
    wide = with_settings(scenario, ["capture.distance=100.0", "capture.angle_deg=179.0", "capture.rate=0.3"])
    judged = compare(wide, TWINS[:2], Plan(as_given=True, runs=60, robust=0)).entries[0]
    begun = judged.runs.capture_time == 0.0
    assert 0 < judged.ratios["time"].free < 60
    drawn = judged.times_over_least
    assert np.all(drawn[begun] == 1.0)
    assert np.all(drawn >= 1.0)
    assert np.array_equal(np.isinf(drawn), ~judged.runs.succeeded)


def test_least_delta_v_falls_with_time_and_is_none_without_any(scenario: Scenario) -> None:
    trials = Trials(scenario, 2, 0, 5)
    least = delta_v_bounds(trials, np.array([[20.0] * 5, [60.0] * 5, [math.nan, math.inf] + [20.0] * 3]))
    assert np.all(least[0] >= least[1] - 1e-12)
    assert np.array_equal(np.isnan(least[2]), [True, True, False, False, False])
    assert np.array_equal(least[2, 2:], least[0, 2:])


def test_settling_bound_is_momentum_over_torque(scenario: Scenario) -> None:
    trials = Trials(scenario, 2, 0, 3)
    own = drawn_scenario(scenario, 2, 1)
    torque = 0.01 * np.ones(3) * own.actuators.torque_gain
    stack = np.array(own.chaser.inertia) + np.array(own.debris.inertia)
    slowest = own.orbit.mean_motion + own.settled.rate
    expected = (0.5 - np.linalg.eigvalsh(stack)[-1] * slowest) / np.linalg.norm(torque)
    found = settling_bounds(trials, np.full((1, 3), 0.5))[0, 1]
    assert found == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--laws", "pid"], "pd"),
        (["--entry", "x"], "NAME=LAW"),
        (["--entry", "a=pd", "--entry", "A=lqr"], "differ"),
        (["--entry", "a=pd"], "at least two"),
        (["--laws", "pd", "--entry", "a=pd"], "only one"),
        (["--entry", "a=pd:literal", "--entry", "b=pd"], "printed or corrected"),
        (["--seed", "3", "--held-out", "3"], "training"),
        (["--runs", "0"], "runs 0"),
        (["--resume"], "--out"),
        (["--threads", "-1"], "threads -1"),
        (["--entry", "ä=pd", "--entry", "b=pd"], "from a to z"),
    ],
)
def test_requests_that_cannot_be_met_are_refused(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "argv", ["detumble", "compare", "paper", *arguments])
    with pytest.raises(SystemExit) as leaving:
        main()
    told = capsys.readouterr()
    assert leaving.value.code == 2
    assert said in told.err
    assert not told.out


@pytest.mark.parametrize("as_json", [False, True])
def test_command_prints_tables_or_one_object(
    as_json: bool, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    arguments = [
        "paper",
        "--entry",
        "Mine=prrl",
        "--entry",
        "Slow=pd:printed",
        "--as-given",
        "--runs",
        "20",
        "--robust",
        "4",
    ]
    monkeypatch.setattr(
        sys, "argv", ["detumble", "compare", *arguments, *(["--json", "--out", str(tmp_path)] if as_json else [])]
    )
    with pytest.raises(SystemExit) as leaving:
        main()
    told = capsys.readouterr()
    assert leaving.value.code == 0
    if as_json:
        result = json.loads(told.out, parse_constant=pytest.fail)
        assert [place["name"] for place in result["ranking"]] == ["Mine", "Slow"]
        assert result["entries"][0]["ratios"]["time"]["p50"] >= 1.0
        assert len(result["files"]) == 3
        assert (tmp_path / "tuned" / "slow.toml").exists()
    else:
        assert "Mine against" in told.out
        assert "noise x 10" in told.out
