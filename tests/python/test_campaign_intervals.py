"""Intervals cover what they promise whatever the distribution, and histograms are as accurate as they say."""

import math
from decimal import Decimal

import numpy as np
import pytest
from scipy.stats import binom, binomtest

from detumble.campaigns.statistics.histograms import ACCURACY, LogHistogram, TickHistogram
from detumble.campaigns.statistics.summaries import CURVE, PERCENTS, Ecdf, Summary
from detumble.intervals import Proportion, clopper_pearson, dkw_half_width, quantile_ranks

PERIOD = 0.1


# --- intervals ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("confidence", [0.9, 0.95, 0.999])
def test_validation_intervals_of_proportions_are_those_of_scipy(confidence):
    for count, runs in ((0, 1), (1, 1), (0, 50), (50, 50), (3, 17), (970, 1000), (99_999_000, 100_000_000)):
        theirs = binomtest(count, runs).proportion_ci(confidence, "exact")
        ours = Proportion.of(count, runs, confidence)
        assert (ours.low, ours.high) == pytest.approx((theirs.low, theirs.high), rel=1e-9, abs=1e-15)
        assert ours.low <= ours.share <= ours.high


def test_nothing_is_known_from_no_runs():
    nothing = Proportion.of(0, 0)
    assert math.isnan(nothing.share)
    assert (nothing.low, nothing.high) == (0.0, 1.0)


@pytest.mark.parametrize("p", [0.5, 0.9, 0.99, 0.999])
def test_intervals_of_proportions_cover_what_they_promise(p):
    runs = 20_000
    counts = np.arange(runs + 1)
    low, high = clopper_pearson(counts, np.full(runs + 1, runs))
    covered = (low <= p) & (p <= high)
    exact = binom.pmf(counts, runs, p)[covered].sum()
    assert 0.95 <= exact < 0.965
    drawn = np.random.default_rng(1).binomial(runs, p, 20_000)
    assert covered[drawn].mean() == pytest.approx(exact, abs=5 * math.sqrt(exact * (1 - exact) / 20_000))
    assert 0.93 < covered[drawn].mean() < 0.97


@pytest.mark.parametrize("distribution", ["exponential", "lognormal"])
def test_intervals_of_quantiles_cover_what_they_promise_whatever_the_distribution(distribution):
    runs, repetitions = 2000, 4000
    rng = np.random.default_rng(2)
    if distribution == "exponential":
        samples, true = rng.exponential(1.0, (repetitions, runs)), [-math.log1p(-p / 100) for p in PERCENTS]
    else:
        normal = {5: -1.6448536269514722, 25: -0.6744897501960817, 50: 0.0, 75: 0.6744897501960817}
        normal |= {95: 1.6448536269514722, 99: 2.3263478740408408}
        samples, true = rng.lognormal(0.0, 1.0, (repetitions, runs)), [math.exp(normal[p]) for p in PERCENTS]
    samples.sort(axis=1)
    for percent, quantile in zip(PERCENTS, true, strict=True):
        low, high = quantile_ranks(runs, percent / 100)
        coverage = np.mean((samples[:, low - 1] <= quantile) & (quantile <= samples[:, high - 1]))
        assert 0.93 < coverage < 0.97, percent


def test_ranks_of_quantiles_are_the_narrowest_that_leave_half_the_risk_on_each_side():
    for runs in (1, 7, 20, 100, 1234):
        for p in (0.05, 0.5, 0.95, 0.99):
            low, high = quantile_ranks(runs, p)
            below = binom(runs, p)
            assert below.cdf(low - 1) <= 0.025 < below.cdf(low)
            assert below.sf(high - 1) <= 0.025 < below.sf(high - 2)


def test_quantiles_that_too_few_runs_bound_have_an_open_side():
    histogram = TickHistogram(PERIOD)
    histogram.add(np.arange(1, 21) * PERIOD)
    found = Summary.of(histogram, 0.95).quantiles
    assert found[5].low is None
    assert found[5].high == pytest.approx(0.4)
    assert found[99].high is None
    assert found[50].low is not None
    assert found[50].high is not None


def test_the_band_holds_the_whole_distribution_function_at_once():
    runs, repetitions = 400, 4000
    drawn = np.sort(np.random.default_rng(3).random((repetitions, runs)), axis=1)
    reach = dkw_half_width(runs)
    steps = np.arange(runs + 1) / runs
    for end in (1.0, 0.7):  # beyond 0.7 of the values are "never": the function is known up to there
        seen = np.where(drawn < end, drawn, end)
        farthest = np.maximum(steps[1:] - seen, seen - steps[:-1]) * (drawn < end)
        at_end = np.abs((drawn < end).mean(axis=1) - end)
        inside = np.maximum(farthest.max(axis=1), at_end) <= reach
        assert inside.mean() >= 0.95 - 2 * math.sqrt(0.05 * 0.95 / repetitions)
    assert dkw_half_width(0) == 1.0


# --- sketches ----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("spread", [0.01, 1.0, 6.0])
def test_quantiles_of_a_sketch_are_as_accurate_as_promised(spread):
    values = np.random.default_rng(4).lognormal(-2.0, spread, 100_001)
    histogram = LogHistogram()
    histogram.add(values)
    found, counts = histogram.table()
    assert ACCURACY < 1e-4
    assert np.all(np.abs(np.repeat(found, counts) / np.sort(values) - 1.0) <= ACCURACY)
    for percent, quantile in Summary.of(histogram, 0.95).quantiles.items():
        assert quantile.value == pytest.approx(np.quantile(values, percent / 100, method="inverted_cdf"), rel=1e-4)


def test_a_sketch_takes_every_number_from_zero_to_infinity():
    values = np.array([0.0, -0.0, 5e-324, 3e-308, 1e-300, 1.0, np.nextafter(2.0, 0.0), 2.0, 1e300, np.finfo(float).max])
    histogram = LogHistogram()
    histogram.add(values)
    found, counts = histogram.table()
    assert np.repeat(found, counts) == pytest.approx(values, rel=ACCURACY, abs=1e-307)
    assert found[0] == 0.0
    assert np.all(np.diff(found) > 0)
    assert counts[0] == 3  # 5e-324 too is as good as zero
    assert (histogram.smallest, histogram.largest) == (0.0, np.finfo(float).max)
    assert Summary.of(histogram, 0.95).mean == pytest.approx(np.finfo(float).max / 10, rel=1e-4)
    histogram.add(np.array([np.inf]))
    assert histogram.table()[0][-1] == np.inf
    assert Summary.of(histogram, 0.95).to_json()["max"] is None
    assert Summary.of(histogram, 0.95).mean is None


def test_a_negative_zero_is_zero():
    histogram = LogHistogram()
    histogram.add(np.array([-0.0]))
    assert math.copysign(1.0, histogram.smallest) == 1.0
    histogram.add(np.array([0.0]))
    assert histogram.table()[1].tolist() == [2]


def test_values_that_are_bins_ends_are_counted_once():
    ends = np.ldexp(1.0 + np.arange(8192) / 8192, 3)
    histogram = LogHistogram()
    histogram.add(ends)
    histogram.add(np.nextafter(ends, 0.0))
    found, counts = histogram.table()
    assert counts.sum() == 2 * ends.size
    assert np.all(
        np.abs(np.repeat(found, counts) / np.sort(np.concatenate((ends, np.nextafter(ends, 0.0)))) - 1) <= ACCURACY
    )


def test_times_are_counted_exactly():
    ticks = np.random.default_rng(5).integers(0, 6000, 50_000)
    histogram = TickHistogram(0.05)
    histogram.add(ticks[:100] * 0.05)
    histogram.add(ticks[100:] * 0.05 + 1e-12)  # differences of times carry round-off
    found = Summary.of(histogram, 0.95)
    ordered = np.sort(ticks)
    for percent, quantile in found.quantiles.items():
        low, high = quantile_ranks(ticks.size, percent / 100)
        expected = [ordered[-(-ticks.size * percent // 100) - 1], ordered[low - 1], ordered[high - 1]]
        assert [quantile.value, quantile.low, quantile.high] == [
            float(Decimal("0.05") * int(tick)) for tick in expected
        ]
    assert found.mean == pytest.approx(np.mean(ticks) * 0.05, rel=1e-12)
    assert found.deviation == pytest.approx(np.std(ticks, ddof=1) * 0.05, rel=1e-12)


@pytest.mark.parametrize("bad", [[-0.1], [math.nan], [0.1, -math.inf]])
def test_histograms_refuse_what_is_no_magnitude(bad):
    for histogram in (LogHistogram(), TickHistogram(PERIOD)):
        with pytest.raises(ValueError, match="from 0 on"):
            histogram.add(np.array(bad))
        assert histogram.table()[0].size == 0


@pytest.mark.parametrize("bad", [0.15, math.inf])
def test_times_that_are_no_whole_periods_are_refused(bad):
    with pytest.raises(ValueError, match=r"whole control periods of 0\.1 s"):
        TickHistogram(PERIOD).add(np.array([0.2, bad]))


def test_thinned_distribution_functions_keep_body_and_tail():
    values = np.sort(np.random.default_rng(7).lognormal(0.0, 1.0, 200_000))
    histogram = LogHistogram()
    histogram.add(values)
    curve = Ecdf.of(histogram, 250_000, 0.95)
    assert 1000 < curve.values.size <= CURVE
    assert np.all(np.diff(curve.values) > 0)
    assert np.all(np.diff(curve.fraction) > 0)
    assert np.diff(curve.fraction).max() < 2 / CURVE * 1.2
    assert np.sum(curve.values > np.quantile(values, 0.999)) > 20
    true = np.searchsorted(values, curve.values * (1 + ACCURACY)) / 250_000
    assert np.abs(curve.fraction - true).max() < 1e-4
    assert (curve.values[0], curve.values[-1]) == pytest.approx((values[0], values[-1]), rel=ACCURACY)
