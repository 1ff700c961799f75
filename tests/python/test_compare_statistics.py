"""Paired tests, their adjustment and the order that follows: against scipy, published numbers, and data whose truth is known."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from scipy.stats import binom, binomtest, false_discovery_control, norm, ttest_rel

import detumble
from detumble.analysis.comparing.entries import Entry, check_entries, entries_of
from detumble.analysis.comparing.judge import KEPT, Runs, Verdict
from detumble.analysis.comparing.judged import Judged
from detumble.analysis.comparing.paired import Difference, Shift, holm, quantile, sign_test, t_test
from detumble.analysis.comparing.pairs import pairs_of, ranking_of
from detumble.analysis.comparing.ranking import Score, rank
from detumble.analysis.comparing.ratios import Ratio
from detumble.analysis.tuning.space import space_of
from detumble.errors import RequestError
from detumble.intervals import Proportion
from detumble.scenario.laws import LAWS, REGISTER, Pd
from detumble.show.compare.frame import looks_of
from detumble.show.style import look

PERIOD = 0.1


def runs_of(capture_time: np.ndarray, delta_v: np.ndarray | None = None) -> Runs:
    """Runs with these capture times, NaN for those that fail; they settle a minute later."""
    columns = {name: np.zeros(len(capture_time)) for name in KEPT}
    columns |= {"capture_time": capture_time, "settling_time": capture_time + 60.0}
    columns["delta_v_to_capture"] = np.where(np.isnan(capture_time), np.nan, 0.1 if delta_v is None else delta_v)
    return Runs(np.where(np.isnan(capture_time), 16, 0).astype(np.uint8), columns)


def judged(name: str, runs: Runs, required: float = 0.95) -> Judged:
    success = Proportion.of(int(runs.succeeded.sum()), len(runs))
    verdict = Verdict(success, success, {})
    counted = np.minimum(runs.capture_time, 200.0)
    score = Score.of(runs.succeeded.mean(), required, float(counted.mean()))
    return Judged(Entry(name, "pd", "printed"), (), 0, runs, counted, verdict, score)


def order(*entries: Judged) -> tuple[list[int], list[str]]:
    ranking = ranking_of(entries, pairs_of(entries), "capture", PERIOD)
    return list(ranking.ranks), list(ranking.letters)


def ticks(times: np.ndarray) -> np.ndarray:
    return PERIOD * np.round(times / PERIOD)


@pytest.mark.parametrize(("lower", "higher"), [(0, 0), (0, 6), (1, 9), (59, 121), (500, 500), (4, 3), (3000, 2800)])
def test_sign_test_is_the_exact_binomial_test(lower: int, higher: int) -> None:
    both = lower + higher
    expected = binomtest(lower, both, 0.5).pvalue if both else 1.0
    assert sign_test(lower, higher) == pytest.approx(expected, rel=1e-12)
    assert sign_test(higher, lower) == sign_test(lower, higher)


def test_mcnemar_of_ten_discordant_pairs_in_closed_form() -> None:
    assert sign_test(1, 9) == pytest.approx(2 * (1 + 10) / 2**10)
    a = np.array([1.0] * 1 + [0.0] * 9 + [1.0] * 30 + [0.0] * 60)
    b = np.array([0.0] * 1 + [1.0] * 9 + [1.0] * 30 + [0.0] * 60)
    found = Difference.of(a, b)
    assert (found.higher, found.lower, found.ties) == (1, 9, 90)
    assert found.p == sign_test(1, 9)


def test_holm_as_published_and_for_any_order() -> None:
    p = np.array([0.01, 0.04, 0.03, 0.005])
    assert np.allclose(holm(p), [0.03, 0.06, 0.06, 0.02])  # R: p.adjust(c(.01, .04, .03, .005), "holm")
    generator = np.random.default_rng(1)
    p = generator.random(50) ** 3
    adjusted = holm(p)
    assert np.all(adjusted >= p)
    assert np.all(adjusted <= np.minimum(1.0, 50 * p))  # never worse than Bonferroni
    assert np.all(adjusted >= false_discovery_control(p))  # and always stricter than Benjamini & Hochberg
    assert np.all(np.diff(adjusted[np.argsort(p)]) >= 0.0)


def test_quantiles_take_never_as_a_value() -> None:
    values = np.concatenate([np.arange(1.0, 92.0), np.full(9, np.inf)])
    median, high, most = (quantile(values, share) for share in (0.5, 0.91, 0.95))
    assert median is not None
    assert (median.value, median.low, median.high) == (50.0, 40.0, 61.0)  # ranks of 100 values: Conover, table A3
    assert high is not None
    assert high.value == 91.0
    assert most is not None
    assert math.isinf(most.value)
    assert quantile(np.empty(0), 0.5) is None


def test_failures_on_both_sides_are_ties_and_on_one_side_infinitely_worse() -> None:
    inf = math.inf
    found = Difference.of(np.array([inf, 1.0, inf, 2.0, 3.0]), np.array([inf, inf, 1.0, 2.0 + 1e-13, 1.0]))
    assert (found.lower, found.higher, found.ties) == (1, 2, 2)
    assert found.median is not None
    assert found.median.value == 0.0


def test_interval_of_the_median_difference_covers_a_known_shift() -> None:
    generator = np.random.default_rng(4)
    covered = 0
    for _ in range(300):
        common = generator.normal(20.0, 5.0, 150)
        found = Difference.of(common + 1.0 + generator.standard_t(2, 150), common)
        assert found.median is not None
        covered += found.median.low <= 1.0 <= found.median.high
    assert covered >= binom.ppf(1e-4, 300, 0.95)


def test_equal_laws_tie_exactly() -> None:
    runs = runs_of(ticks(np.random.default_rng(0).gamma(9.0, 2.0, 1000)))
    twins = judged("one", runs), judged("other", runs)
    (pair,) = pairs_of(twins)
    assert all(p == 1.0 for p in pair.adjusted.values())
    assert order(*twins) == ([1, 1], ["a", "a"])


def test_exchangeable_laws_are_distinguished_in_at_most_five_of_a_hundred_comparisons() -> None:
    generator = np.random.default_rng(7)
    repetitions, mistaken, ranked = 300, 0, 0
    for _ in range(repetitions):
        hard = generator.normal(0.0, 1.0, 200)  # what the runs share
        entries = []
        for place in range(5):
            time = ticks(np.exp(3.0 + 0.2 * hard + 0.2 * generator.normal(0.0, 1.0, 200)))
            time[norm.cdf(0.8 * hard + 0.6 * generator.normal(0.0, 1.0, 200)) > 0.98] = np.nan
            entries.append(judged(str(place), runs_of(time, 0.1 + 0.01 * generator.random(200))))
        mistaken += any(p < 0.05 for pair in pairs_of(entries) for p in pair.adjusted.values())
        ranked += max(order(*entries)[0]) > 1
    assert mistaken <= binom.ppf(0.999, repetitions, 0.05)
    assert ranked <= mistaken


def test_clearly_faster_law_ranks_first_though_each_run_varies_more_than_the_laws_do() -> None:
    generator = np.random.default_rng(2)
    common = generator.normal(40.0, 15.0, 400).clip(5.0)
    slow, fast = (
        judged(name, runs_of(ticks(common + shift + generator.normal(0.0, 1.0, 400))))
        for name, shift in (("s", 2.0), ("f", 0.0))
    )
    assert order(slow, fast) == ([2, 1], ["b", "a"])


def test_required_success_comes_before_speed() -> None:
    time = np.full(1000, 30.0)
    rash = np.where(np.arange(1000) < 900, 5.0, np.nan)
    assert order(judged("sure", runs_of(time)), judged("rash", runs_of(rash)))[0] == [1, 2]
    relaxed = [judged("sure", runs_of(time), 0.5), judged("rash", runs_of(rash), 0.5)]
    assert order(*relaxed)[0] == [2, 1]


def test_less_than_a_control_period_is_no_difference_however_significant() -> None:
    time = np.full(1000, 30.0)
    sooner = np.where(np.arange(1000) < 300, time - PERIOD, time)
    entries = judged("a", runs_of(time)), judged("b", runs_of(sooner))
    (pair,) = pairs_of(entries)
    assert pair.adjusted["capture_time_s"] < 1e-50
    assert order(*entries)[0] == [1, 1]
    assert order(entries[0], judged("b", runs_of(time - PERIOD)))[0] == [2, 1]


def test_ahead_in_most_runs_is_not_enough_where_the_mean_hangs_on_a_few_failures() -> None:
    generator = np.random.default_rng(5)
    time = ticks(generator.gamma(9.0, 2.0, 1000))
    slower = time + 2.0 * PERIOD
    time[:10], slower[5:15] = np.nan, np.nan  # as many failures, of which each counts for a thousand times that
    entries = judged("ahead", runs_of(time)), judged("behind", runs_of(slower))
    (pair,) = pairs_of(entries)
    assert pair.better(0, "capture_time_s")
    assert entries[1].score.value - entries[0].score.value > PERIOD
    assert pair.adjusted["statistic"] > 0.5
    assert order(*entries) == ([1, 1], ["a", "a"])


def test_means_are_compared_by_the_paired_t_test() -> None:
    generator = np.random.default_rng(8)
    a, b = generator.gamma(4.0, 5.0, (2, 300))
    found = Shift.of(a, b, None)
    assert found.p == pytest.approx(ttest_rel(a, b).pvalue, rel=1e-9)
    assert found.value == pytest.approx(a.mean() - b.mean())
    assert (t_test(np.zeros(10)), t_test(np.ones(1)), t_test(np.full(9, 0.5))) == (1.0, 1.0, 0.0)


def test_percentile_differs_only_where_that_percentile_does() -> None:
    generator = np.random.default_rng(9)
    a = generator.gamma(4.0, 5.0, 2000)
    sooner, longer = np.where(a < 20.0, 0.8 * a, a), np.where(a > 20.0, 1.3 * a, a)
    assert Shift.of(sooner, a, 95.0).p == 1.0
    assert Shift.of(sooner, a, 25.0).p < 1e-9
    assert Shift.of(longer, a, 25.0).p == 1.0
    assert Shift.of(longer, a, 95.0).p < 1e-9


@pytest.mark.parametrize("percentile", [None, 50.0, 95.0])
def test_statistics_of_exchangeable_laws_seldom_differ(percentile: float | None) -> None:
    generator, repetitions = np.random.default_rng(12), 500
    mistaken = 0
    for _ in range(repetitions):
        common = generator.gamma(9.0, 2.0, 400)
        a, b = common + generator.normal(0.0, 2.0, (2, 400))
        mistaken += Shift.of(a, b, percentile).p < 0.05
    assert mistaken <= binom.ppf(0.999, repetitions, 0.05)


def test_one_good_search_makes_no_ranking() -> None:
    def luck(*values: float) -> list[Score]:
        return [Score(False, value) for value in values]

    apart = rank([luck(10.0, 10.2, 10.1), luck(11.0, 11.4)], lambda *_: True)
    mixed = rank([luck(10.0, 11.2, 10.1), luck(11.0, 11.4)], lambda *_: True)
    assert apart.ranks == (1, 2)
    assert mixed.ranks == (1, 1)
    assert mixed.letters == ("a", "a")


def test_order_is_consistent_whatever_the_tests_say() -> None:
    generator = np.random.default_rng(11)
    for _ in range(200):
        count = int(generator.integers(2, 9))
        scores = [
            [
                Score(bool(short), float(value))
                for short, value in zip(generator.random(2) < 0.3, generator.random(2), strict=True)
            ]
            for _ in range(count)
        ]
        shown = generator.random((count, count)) < 0.6
        found = rank(scores, lambda one, other, shown=shown: bool(shown[one, other]))
        above = found.above
        assert not np.any(above & above.T)
        assert not np.any(np.diag(above))
        assert np.all(above >= (above.astype(int) @ above.astype(int) > 0))  # transitive
        for one, other in itertools.permutations(range(count), 2):
            if above[one, other]:
                assert found.ranks[one] < found.ranks[other]
                assert max(scores[one]) < min(scores[other])
            apart = bool(above[one, other] or above[other, one])
            assert apart != bool(set(found.letters[one]) & set(found.letters[other]))


def test_run_that_beats_its_bound_is_found() -> None:
    ratio = Ratio.of(np.array([4.0, 2.0, np.nan, 1.0, 3.0]), np.array([2.0, 2.0, 1.0, 0.0, 3.1]))
    assert np.array_equal(ratio.values, [2.0, 1.0, np.nan, np.nan, 3.0 / 3.1], equal_nan=True)
    assert (ratio.free, ratio.broken) == (1, (4,))
    assert Ratio.of(np.array([1.0]), np.array([np.inf])).broken == (0,)


def test_default_entries_are_all_laws_in_all_forms() -> None:
    entries = entries_of()
    assert len(entries) == sum(max(1, len(REGISTER[law].forms())) for law in LAWS)
    assert len({entry.file for entry in entries}) == len(entries)
    assert [entry.name for entry in entries[6:8]] == ["TSMC", "TSMC corrected"]


def test_a_law_that_has_only_one_form_is_one_entry(monkeypatch: pytest.MonkeyPatch) -> None:
    paper = detumble.load("paper")
    paper.laws.pd = None
    monkeypatch.setattr(Pd, "forms", classmethod(lambda _: ()))
    assert entries_of(["pd", "lqr"], ["corrected"]) == (Entry("PD", "pd"), Entry("LQR corrected", "lqr", "corrected"))
    assert Entry.parsed("mine=pd", paper) == Entry("mine", "pd")
    check_entries(entries_of(["pd", "lqr"]), paper, as_given=False)
    only_one = "form 'corrected': pd has only one form; leave it out"
    with pytest.raises(RequestError, match=only_one):
        Entry.parsed("mine=pd:corrected", paper)
    with pytest.raises(RequestError, match=only_one):
        check_entries([Entry("a", "pd", "corrected"), Entry("b", "pd")], paper, as_given=False)
    with pytest.raises(RequestError, match=only_one):
        space_of(paper, "pd", form="corrected")
    with pytest.raises(RequestError, match="must be printed or corrected"):
        check_entries([Entry("a", "lqr"), Entry("b", "pd")], paper, as_given=False)
    plain, printed, corrected = looks_of([("PD", "pd", None), ("LQR", "lqr", "printed"), ("C", "pd", "corrected")])
    assert plain.dashes == printed.dashes != corrected.dashes
    assert plain.fill == look("pd").colour
    assert corrected.fill == "white"
