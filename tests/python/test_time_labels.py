"""Every time that is reported is the double nearest to the decimal k T, so that it can be written, looked up and compared."""

from __future__ import annotations

from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest

import detumble
from detumble.analysis.bounds.earliest import minimum_capture_time
from detumble.campaigns.statistics.histograms import TickHistogram
from detumble.compiled import tick_times
from detumble.scenario import Scenario, with_settings

PERIODS = (0.1, 0.05, 0.02, 1 / 3, 1e-3, 0.7, 30.0, 1e-7, 2.5e-323, 1e4)


def label(tick: int, period: float) -> float:
    return float(Decimal(repr(period)) * tick)


@pytest.mark.parametrize("period", PERIODS)
def test_a_label_is_the_nearest_double_of_the_decimal(period: float) -> None:
    rng = np.random.default_rng(1)
    ticks = np.unique(np.concatenate((np.arange(2000), rng.integers(0, 2_000_000, 5000), [2**40 + 1, 2**63])))
    assert tick_times(period, ticks.astype(np.uint64)).tolist() == [label(int(tick), period) for tick in ticks]


@pytest.mark.parametrize("period", [0.1, 0.05, 1 / 3, 0.7])
def test_every_time_of_a_flight_is_a_label_of_its_axis(short: Scenario, period: float) -> None:
    settings = [f"time.control_period={period!r}", f"time.integration_step={min(period, 0.05)}"]
    flight = detumble.simulate(with_settings(short, [*settings, f"time.duration={180 * period!r}"]), law="prrl")
    times, metrics = flight.history["time"], flight.metrics
    assert times.tolist() == [label(tick, period) for tick in range(181)]
    captured = flight.event("captured")
    assert captured is not None
    assert metrics.capture_tick is not None
    assert type(metrics.capture_tick) is int
    tick = metrics.capture_tick
    assert captured.details["tick"] == tick
    assert captured.time == captured.details["time"] == metrics.capture_time == times[tick] == label(tick, period)
    assert int(np.argmax(flight.history["captured"])) == tick
    if metrics.settled_tick is not None:
        settled = flight.event("settled")
        assert settled is not None
        assert settled.time == times[metrics.settled_tick]
        assert metrics.settling_time == label(metrics.settled_tick - tick, period)


def test_what_a_person_writes_is_found(paper: Scenario) -> None:
    flight = detumble.simulate(paper)
    assert flight.metrics.capture_time == 7.6
    assert flight.data.sel(time=7.6).captured == 1.0
    assert flight.metrics.to_json()["capture_tick"] == 76
    assert minimum_capture_time(paper) == 5.6


def test_a_diverging_flight_tells_the_label_of_the_next_tick(paper: Scenario) -> None:
    runaway = ["actuators.force_limit=inf", "laws.pd.translation={kp = 1e6, kd = 1e5}", "time.duration=60.0"]
    flight = detumble.simulate(with_settings(paper, runaway), law="pd")
    assert flight.metrics.diverged_time == label(len(flight.history["time"]), 0.1)


def test_a_campaign_counts_labels(tmp_path: Path) -> None:
    result = detumble.campaign("paper_dispersed", runs=300, seed=1, out=tmp_path)
    table = result.runs.to_polars()
    settled = table.drop_nulls("settled_tick")
    for rows, time, tick in (
        (table.drop_nulls("capture_tick"), "capture_time_s", "capture_tick"),
        (settled.with_columns(since=settled["settled_tick"] - settled["capture_tick"]), "settling_time_s", "since"),
    ):
        assert rows.height > 200
        assert rows[time].to_list() == [label(int(count), 0.1) for count in rows[tick]]
    assert all(label(round(time / 0.1), 0.1) == time for time in table["end_time_s"])
    summary = result.statistics.summary("settled_time_s")
    told = [summary.smallest, summary.largest, *(quantile.value for quantile in summary.quantiles.values())]
    assert set(told) <= {label(int(tick), 0.1) for tick in settled["settled_tick"]}
    assert "capture_tick" not in result.statistics.to_json()
    assert np.isnan(result.runs.to_pandas()["capture_tick"]).sum() == table["capture_tick"].null_count()
    assert result.runs.to_xarray()["settled_tick"].dtype == np.float64


def test_a_histogram_tells_labels_of_sums_that_were_off_by_rounding() -> None:
    histogram = TickHistogram(0.1)
    histogram.add(np.array([0.1 + 0.2, 0.7 + 0.1]))
    assert (histogram.smallest, histogram.largest) == (0.3, 0.8)
    assert histogram.table()[0].tolist() == [0.3, 0.8]
