"""Statistics of a campaign are what numpy finds, order leaves no trace, and stopping early costs little."""

import functools
import json
import math
import tracemalloc

import numpy as np
import polars as pl
import pytest
from scipy.stats import binom, binomtest

from detumble.campaigns.columns import RESULTS
from detumble.campaigns.statistics.convergence import Prefixes
from detumble.campaigns.statistics.histograms import ACCURACY
from detumble.campaigns.statistics.running import EXTENTS, TIMES, Statistics
from detumble.campaigns.statistics.summaries import PERCENTS
from detumble.failures import CAUSES
from detumble.intervals import Proportion, clopper_pearson, quantile_ranks

PERIOD = 0.1
SHARD = 1000


@functools.cache
def shard(number, rows=SHARD, success_rate=0.9):
    """A shard of made-up runs, in which failures of all kinds occur and every quantity is missing somewhere."""
    rng = np.random.default_rng(number)
    capture = np.round(rng.lognormal(4.0, 0.5, rows)) * PERIOD
    settling = np.round(rng.lognormal(5.0, 0.8, rows)) * PERIOD
    success = rng.random(rows) < success_rate
    causes = rng.choice(CAUSES[:5], rows, p=[0.5, 0.05, 0.2, 0.2, 0.05])
    never = np.array([cause.startswith("never") for cause in causes]) & ~success
    columns = {
        "index": np.arange(number * SHARD, number * SHARD + rows, dtype=np.uint64),
        "chaser.mass": rng.normal(9.0, 0.2, rows),
        "success": success,
        "failure": [None if good else str(cause) for good, cause in zip(success, causes, strict=True)],
        "end_time_s": np.full(rows, 300.0),
        "diverged_time_s": np.where(success | (causes != "diverged"), np.nan, 1.5),
    }
    columns |= {name: rng.lognormal(-3.0, 1.0, rows) for name in EXTENTS}
    columns |= {f"{kind}_saturated_share": rng.random(rows) for kind in ("force", "torque")}
    columns["capture_time_s"] = np.where(never, np.nan, capture)
    columns["settling_time_s"] = np.where(success, settling, np.nan)
    columns["capture_tick"] = columns["capture_time_s"] / PERIOD
    columns["settled_tick"] = (columns["capture_time_s"] + columns["settling_time_s"]) / PERIOD
    columns["final_rate_rad_s"] = np.where(success, columns["final_rate_rad_s"], np.nan)
    assert set(columns) >= {column.name for column in RESULTS}
    return pl.DataFrame(columns, nan_to_null=number % 2 == 0)


def counted(frames):
    statistics = Statistics(PERIOD)
    for frame in frames:
        statistics.add(frame)
    return statistics


def everything(statistics):
    curves = [statistics.ecdf(name) for name in (*TIMES, *EXTENTS)]
    narrow = [statistics.first_narrow_enough(width) for width in (0.03, 0.01, 0.007, 0.001)]
    arrays = [array.tobytes() for curve in (*curves, statistics.convergence()) for array in curve]
    return json.dumps(statistics.to_json()), arrays, narrow


def numbers(frames, name):
    values = pl.concat([frame.select(name) for frame in frames])[name].to_numpy()
    return np.sort(values[~np.isnan(values)])


# --- a campaign --------------------------------------------------------------------------------------------------------


def test_statistics_do_not_depend_on_the_order_of_shards_to_the_bit():
    frames = [shard(number) for number in range(8)]
    expected = everything(counted(frames))
    rng = np.random.default_rng(6)
    for _ in range(3):
        order = rng.permutation(8)
        assert everything(counted(frames[number] for number in order)) == expected


def test_everything_reported_is_what_numpy_finds():
    frames = [shard(number) for number in range(5)]
    statistics = counted(frames)
    table = {name: pl.concat(frames)[name].to_numpy() for name in frames[0].columns}
    success, failure = table["success"], table["failure"]
    report = json.loads(json.dumps(statistics.to_json(), allow_nan=False))
    assert report["runs"] == 5 * SHARD
    assert report["captured"] == np.sum(~np.isnan(table["capture_time_s"]))
    assert report["captured_share"] == report["captured"] / report["runs"]
    assert report["success"] == success.mean()
    interval = binomtest(int(success.sum()), success.size).proportion_ci()
    assert report["success_ci"] == pytest.approx([interval.low, interval.high], rel=1e-12)
    assert report["failures"] == {cause: np.sum(failure == cause) for cause in set(failure[~success])}
    assert list(report["failures"].values()) == sorted(report["failures"].values(), reverse=True)
    over = (table["force_saturated_share"] > 0.5) | (table["torque_saturated_share"] > 0.5)
    assert 0 < report["saturated_failures"] == np.sum(over & ~success) < np.sum(~success)
    table["settled_time_s"] = table["capture_time_s"] + table["settling_time_s"]
    for name in (*TIMES, *EXTENTS):
        values = np.sort(table[name][~np.isnan(table[name])])
        found = report[name]
        assert found["count"] == values.size
        accuracy = 1e-12 if name in TIMES else ACCURACY
        assert (found["min"], found["max"]) == pytest.approx((values[0], values[-1]), rel=1e-15)
        assert found["mean"] == pytest.approx(values.mean(), rel=accuracy)
        assert found["std"] == pytest.approx(values.std(ddof=1), abs=accuracy * 1.01 * math.sqrt(np.mean(values**2)))
        for percent in PERCENTS:
            low, high = quantile_ranks(values.size, percent / 100)
            ranks = [-(-values.size * percent // 100), low, high]
            met = [found[f"p{percent:02}"], *found[f"p{percent:02}_ci"]]
            assert met == pytest.approx([values[rank - 1] for rank in ranks], rel=accuracy)


def test_failures_are_shares_of_all_runs_with_their_exact_intervals():
    statistics = counted([shard(0), shard(1)])
    failures = statistics.failures
    assert sum(failure.count for failure in failures.values()) == statistics.runs - statistics.success.count
    for failure in failures.values():
        assert failure == Proportion.of(failure.count, 2 * SHARD)


def test_nothing_flown_and_nothing_captured_are_reported_without_nan():
    empty = Statistics(PERIOD).to_json()
    assert empty["success"] is None
    assert empty["success_ci"] == [0.0, 1.0]
    assert empty["capture_time_s"]["p50_ci"] == [None, None]
    never = shard(0).with_columns(
        pl.lit(False).alias("success"),
        pl.lit(CAUSES[-1]).alias("failure"),
        pl.lit(None, pl.Float64).alias("capture_time_s"),
        pl.lit(math.nan).alias("settling_time_s"),
    )
    statistics = counted([never])
    report = json.loads(json.dumps(statistics.to_json(), allow_nan=False))
    assert (report["captured"], report["success"], report["capture_time_s"]["count"]) == (0, 0.0, 0)
    assert statistics.ecdf("capture_time_s").values.size == 0
    one = json.loads(json.dumps(counted([shard(0, 1)]).to_json(), allow_nan=False))
    assert one["delta_v_m_s"]["p50"] == pytest.approx(one["delta_v_m_s"]["min"], rel=ACCURACY)
    assert one["delta_v_m_s"]["std"] is None


def test_shards_that_no_campaign_writes_are_refused():
    statistics = counted([shard(3)])
    with pytest.raises(ValueError, match="from run 3000 on was counted before"):
        statistics.add(shard(3))
    with pytest.raises(ValueError, match="from run 4000 on has gaps"):
        statistics.add(shard(4).filter(pl.col("index") != 4500))
    with pytest.raises(ValueError, match="0 have a cause"):
        statistics.add(shard(5).with_columns(pl.lit(None, pl.String).alias("failure")))
    assert statistics.runs == SHARD


def test_distribution_functions_end_where_the_runs_that_never_get_there_begin():
    frames = [shard(number) for number in range(4)]
    statistics = counted(frames)
    curve = statistics.ecdf("capture_time_s")
    times = numbers(frames, "capture_time_s")
    assert curve.fraction[-1] == statistics.captured.share < 1.0
    assert curve.fraction == pytest.approx(
        [np.mean(times <= value + 1e-9) * times.size / 4000 for value in curve.values]
    )
    reach = math.sqrt(math.log(40) / 8000)
    assert curve.high == pytest.approx(np.minimum(curve.fraction + reach, 1.0))
    assert curve.low == pytest.approx(np.maximum(curve.fraction - reach, 0.0))


def test_convergence_follows_the_runs_in_order_of_index():
    frames = [shard(number) for number in range(7)]
    curve = counted(reversed(frames)).convergence()
    assert curve.runs.tolist() == [1, 2, 4, 8, 16, 32, 64, 128, 256, 512, *range(1000, 8000, 1000)]
    success = pl.concat(frames)["success"].to_numpy()
    for runs, share, low, high in zip(*curve, strict=True):
        expected = Proportion.of(int(success[:runs].sum()), int(runs))
        assert (share, low, high) == (expected.share, expected.low, expected.high)


def test_convergence_ends_at_the_first_gap():
    assert counted([shard(0), shard(1), shard(3)]).convergence().runs[-1] == 2000
    assert counted([shard(1)]).convergence().runs.size == 0
    assert counted([shard(0, 1)]).convergence().runs.tolist() == [1]


def test_convergence_of_a_long_campaign_stays_short():
    prefixes = Prefixes(0.95)
    for number in range(2000):
        prefixes.add(4 * number, np.array([True, True, False, True]))
    runs = prefixes.curve().runs
    assert runs[-1] == 8000
    assert 30 < runs.size <= 54
    assert np.all(np.diff(runs) > 0)


def test_memory_does_not_grow_with_the_runs():
    frames = [shard(number) for number in range(12)]
    statistics = counted(frames[:6])
    tracemalloc.start()
    for frame in frames[6:]:
        statistics.add(frame)
    grown, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert grown < 3e6  # rare values open new octaves of 64 kB


# --- flying until the interval is narrow enough ---------------------------------------------------------------------------


def test_enough_runs_are_the_first_end_of_a_shard_with_a_narrow_interval():
    frames = [shard(number) for number in range(8)]
    widths = [counted(frames[:count]).success.half_width for count in range(1, 9)]
    statistics = counted(frames)
    for width in (1.0, 0.02, 0.015, 0.012, 0.008, 0.007):
        expected = next((count for count, reached in enumerate(widths, 1) if reached <= width), None)
        assert statistics.first_narrow_enough(width) == (expected and expected * SHARD)
    assert statistics.first_narrow_enough(0.001) is None


def test_enough_runs_depend_on_those_runs_alone():
    frames = [shard(number) for number in range(8)]
    width = 0.0105
    enough = counted(frames).first_narrow_enough(width)
    assert 2000 <= enough <= 6000
    needed = enough // SHARD
    assert counted(frames[:needed]).first_narrow_enough(width) == enough
    assert counted(frames[: needed - 1]).first_narrow_enough(width) is None
    late = counted([*frames[1:needed], *frames[needed:]])
    assert late.first_narrow_enough(width) is None
    late.add(frames[0])
    assert late.first_narrow_enough(width) == enough


def coverage_when_stopped(p, half_width, runs_in_shard):
    """Exact coverage of the interval at the stop: the law of the failures so far, carried from shard to shard."""
    q = 1.0 - p
    pmf = binom.pmf(np.arange(runs_in_shard + 1), runs_in_shard, q)
    kept = np.flatnonzero(pmf > 1e-17)
    pmf, least = pmf[kept[0] : kept[-1] + 1], int(kept[0])
    law, first, covered, stopped, runs = np.ones(1), 0, 0.0, 0.0, 0
    while stopped < 1.0 - 1e-9:
        law, first, runs = np.convolve(law, pmf), first + least, runs + runs_in_shard
        failures = first + np.arange(law.size)
        low, high = clopper_pearson(failures, np.full(law.size, runs))
        ends = 0.5 * (high - low) <= half_width
        covered += law[ends & (low <= q) & (q <= high)].sum()
        stopped += law[ends].sum()
        law = np.where(ends, 0.0, law)
    return covered


def test_flying_until_the_interval_is_narrow_costs_little_coverage():
    found = [
        coverage_when_stopped(p, math.sqrt(p * (1 - p) / (shards * 16_384)) * 1.96, 16_384)
        for p in (0.5, 0.9, 0.95, 0.996, 0.9998)
        for shards in np.geomspace(1, 12, 25)[::4]
    ]
    assert 0.938 < min(found) < 0.945
    assert max(found) < 0.991
    assert np.mean(found) > 0.95


def test_the_stop_that_was_computed_is_the_stop_that_happens():
    p, width, repetitions = 0.9, 0.011, 1000
    rng = np.random.default_rng(8)
    covered = 0
    for _ in range(repetitions):
        prefixes, flown, successes = Prefixes(0.95), 0, 0
        while prefixes.first_narrow_enough(width) is None:
            success = rng.random(500) < p
            prefixes.add(flown, success)
            flown, successes = flown + 500, successes + int(success.sum())
        assert prefixes.first_narrow_enough(width) == flown
        reached = Proportion.of(successes, flown)
        covered += reached.low <= p <= reached.high
    exact = coverage_when_stopped(p, width, 500)
    assert covered / repetitions == pytest.approx(exact, abs=4 * math.sqrt(exact * (1 - exact) / repetitions))
