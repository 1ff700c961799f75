"""Pictures of a campaign: what they show is what they were given, and no campaign is too odd to draw."""

from __future__ import annotations

import subprocess
import sys
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest
from matplotlib.collections import PolyCollection, QuadMesh
from matplotlib.colors import to_hex

from detumble.campaigns.statistics.convergence import Convergence
from detumble.campaigns.statistics.sensitivity import Influence, Sensitivity
from detumble.campaigns.statistics.summaries import Ecdf
from detumble.errors import RequestError
from detumble.failures import CAUSES
from detumble.intervals import Proportion, clopper_pearson, dkw_half_width
from detumble.show.campaign import Caption, Trace
from detumble.show.campaign import causes as causes_page
from detumble.show.campaign.causes import plot_failures
from detumble.show.campaign.frame import PLAIN, percent
from detumble.show.campaign.influence import MOST, plot_sensitivity, ranking
from detumble.show.campaign.precision import plot_convergence
from detumble.show.campaign.success import AIM, FEWEST, WIDE, cells, colour_limits, edges, plot_success_map
from detumble.show.campaign.times import plot_capture_times, time_of
from detumble.show.campaign.trajectories import FEW, plot_envelope, quantiles
from detumble.show.style import LOOKS, save, styled, write_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.text import Text
    from numpy.typing import NDArray

LABELS = ("chaser.mass [kg]", "|debris.tumble_rate| [rad/s]")
STRANGE = f"$\\frac{{ a campaign{' of many words' * 20}"
MEDIANS = {"pd": 104.0, "lqr": 24.6, "sosmc": 28.1, "tsmc": 51.1, "prrl": 7.6}


def caption(runs: int, law: str = "prrl", scenario: str = "6U chaser, tumbling 3U, 700 km") -> Caption:
    return Caption(scenario, law, runs, seed=7)


def ecdf(times: NDArray[np.float64], runs: int) -> Ecdf:
    values, counts = np.unique(np.round(times, 1), return_counts=True)
    fraction, reach = np.cumsum(counts) / runs, dkw_half_width(runs)
    return Ecdf(values, fraction, np.maximum(fraction - reach, 0.0), np.minimum(fraction + reach, 1.0))


def five_laws(runs: int = 4000) -> tuple[dict[str, Ecdf], dict[str, Ecdf]]:
    rng, captured, settled = np.random.default_rng(3), {}, {}
    for share, (law, median) in zip((0.9, 0.97, 0.995, 0.93, 1.0), MEDIANS.items(), strict=True):
        times = median * np.exp(0.3 * rng.normal(size=int(share * runs)))
        captured[law] = ecdf(times, runs)
        settled[law] = ecdf(times[: int(0.98 * len(times))] + 13.0, runs)
    return captured, settled


def drawn_runs(runs: int) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
    """Masses, log-uniform tumble rates, the true probability of each run and how it ended."""
    rng = np.random.default_rng(5)
    mass, rate = rng.normal(9.0, 0.2, runs), 10.0 ** rng.uniform(-2.0, -0.3, runs)
    truth = 1.0 / (1.0 + np.exp(8.0 * (rate - 0.3) + 2.0 * (mass - 9.0)))
    return mass, rate, truth, rng.random(runs) < truth


def flights(count: int = 60, times: int = 1200) -> tuple[NDArray[np.float64], list[Trace]]:
    rng, time = np.random.default_rng(6), 0.05 * np.arange(times)
    pace = 10.0 * np.exp(0.4 * rng.normal(size=(count, 1)))
    over = time > np.clip(3.0 * pace, 0.0, None)
    sizes = {"distance to the goal [m]": 3.0, "attitude error [°]": 120.0, "relative rate [rad/s]": 0.15}
    traces = []
    for label, size in sizes.items():
        values = size * rng.uniform(0.2, 1.0, (count, 1)) * np.exp(-time / (0.6 * pace))
        traces.append(Trace(label, np.where(over, np.nan, values), {f"capture below {size / 6:g}": size / 6}))
    return time, traces


def known(share: float, runs: int) -> Convergence:
    sizes = np.unique(np.r_[2 ** np.arange(15), np.geomspace(16384, 1e6, 50).astype(int)])
    sizes = sizes[sizes <= runs]
    reached = np.cumsum(np.random.default_rng(8).random(runs) < share)[sizes - 1]
    return Convergence(sizes, reached / sizes, *clopper_pearson(reached, sizes))


def influences(outcome: str, fields: list[str], seed: int) -> Sensitivity:
    rng = np.random.default_rng(seed)
    found = [Influence(field, rng.exponential(0.1), 0.01, rng.uniform(-0.6, 0.6), 0.01) for field in fields]
    return Sensitivity(outcome, 12_000, tuple(sorted(found, key=lambda one: -one.index)), 0.04)


FIELDS = ["chaser.mass", "|debris.tumble_rate|", "debris.attitude about x", "attitude error at start"]
LONG = [f"sensors.some_part.chaser_rate_bias_stability_number_{number}.x" for number in range(60)]


def usual() -> dict[str, Figure]:
    failed = {"captured, not settled": Proportion.of(812, 99_000), CAUSES[-1]: Proportion.of(12, 99_000)}
    mass, rate, _, success = drawn_runs(4000)
    return {
        "times": plot_capture_times(*five_laws(), caption(4000, "")),
        "success": plot_success_map(mass, rate, success, LABELS, caption(4000)),
        "envelope": plot_envelope(*flights(), caption(4000)),
        "failures": plot_failures(Proportion.of(98_176, 99_000), failed, caption(99_000)),
        "convergence": plot_convergence(known(0.98, 100_000), caption(100_000), 0.001),
        "sensitivity": plot_sensitivity(
            [influences("failure", FIELDS, 1), influences("capture_time_s", FIELDS, 2)], caption(12_000)
        ),
    }


def odd() -> dict[str, Figure]:
    strange, one = caption(1000, "someone's", STRANGE), np.ones(1)
    nobody = ecdf(np.empty(0), 1000)
    everything = {
        f"{cause} {'and so on ' * 5 * (place % 2)}": Proportion.of(50, 1000) for place, cause in enumerate(CAUSES)
    }
    mass, rate, _, success = drawn_runs(2000)
    none = Sensitivity("failure", 12_000, silence="none of 12000 runs failed; at least 10 are needed")
    time, traces = flights(1)
    wild = np.where(np.arange(1200) > 600, 1e300, 1.0)[None].repeat(3, axis=0)
    wild[2, 700:] = np.inf
    return {
        "one run captured": plot_capture_times({"lqr": ecdf(24.6 * one, 1)}, {}, caption(1, "lqr")),
        "captured at once": plot_capture_times({"lqr": ecdf(0.0 * one, 1)}, {}, caption(1, "lqr")),
        "nobody captured": plot_capture_times({"someone's": nobody}, {"someone's": nobody}, strange),
        "map of one run": plot_success_map(one, 0.0 * one, one > 0.0, LABELS, caption(1)),
        "map of successes": plot_success_map(mass, rate, success | True, LABELS, caption(2000)),
        "map of failures": plot_success_map(mass, -rate, success & False, (STRANGE, STRANGE), strange),
        "map of two values": plot_success_map(np.round(rate / rate.max()), mass, success, LABELS, caption(2000)),
        "map of one mass": plot_success_map(9.0 + 1e-15 * np.round(rate), rate, success, LABELS, caption(2000)),
        "one flight": plot_envelope(time, traces, caption(1)),
        "flights that diverged": plot_envelope(time, [Trace("distance [m]", wild)], strange),
        "nothing flown": plot_envelope(time, [Trace("distance [m]", wild * np.nan, {"goal": 1.0})], strange),
        "no failures": plot_failures(Proportion.of(1000, 1000), {}, caption(1000)),
        "one run failed": plot_failures(Proportion.of(0, 1), {"diverged": Proportion.of(1, 1)}, caption(1)),
        "failures of every kind": plot_failures(Proportion.of(50, 1000), everything, strange),
        "known after one run": plot_convergence(known(1.0, 1), caption(1), 0.01),
        "nothing known": plot_convergence(Convergence(np.empty(0, np.int64), *np.empty((3, 0))), caption(1)),
        "always the same": plot_convergence(known(0.0, 1000), strange),
        "no failure to explain": plot_sensitivity([none, influences("capture_time_s", FIELDS, 2)], caption(1000)),
        "nothing to explain": plot_sensitivity([none, none], caption(1)),
        "many parameters": plot_sensitivity(
            [influences("failure", LONG, 1), influences("capture_time_s", LONG, 2)], strange
        ),
    }


@pytest.fixture(scope="module")
def drawn() -> dict[str, Figure]:
    with styled():
        return usual()


def words(figure: Figure) -> list[str]:
    from matplotlib.text import Text

    found = figure.findobj(lambda artist: isinstance(artist, Text) and artist.get_visible())
    return [text.get_text() for text in found if isinstance(text, Text) and text.get_text()]


def said(figure: Figure) -> str:
    return "\n".join(words(figure)).replace("\u2009", " ")


def line_through(axes: Axes, x: NDArray[np.float64], y: NDArray[np.float64]) -> str | None:
    """Colour of the line that holds all these points, if there is one."""
    for line in axes.lines:
        points = np.column_stack([np.asarray(line.get_xdata(), float), np.asarray(line.get_ydata(), float)])
        if len(points) >= len(x) and all(
            np.isclose(points, point).all(axis=1).any() for point in zip(x, y, strict=True)
        ):
            return str(line.get_color())
    return None


def test_headlines_say_what_was_flown(drawn: dict[str, Figure]) -> None:
    for name, figure in drawn.items():
        found = said(figure)
        assert "6U chaser, tumbling 3U, 700 km" in found
        assert "seed 7" in found
        assert " runs" in found
        assert "PRRL-SMC" in found, name


def test_every_axis_carries_its_unit(drawn: dict[str, Figure]) -> None:
    for figure in drawn.values():
        labels = [label for axes in figure.get_axes() for label in (axes.get_xlabel(), axes.get_ylabel()) if label]
        assert labels
        assert all(label.endswith("]") for label in labels)


def test_files_are_png_and_svg_and_the_same_each_time(tmp_path: Path) -> None:
    with styled():
        for name in ("first", "second"):
            for kind in ("png", "svg"):
                figure = plot_success_map(*(drawn_runs(2000)[place] for place in (0, 1, 3)), LABELS, caption(2000))
                save(figure, [tmp_path / f"{name}.{kind}"])
    for kind, head in (("png", b"\x89PNG\r\n"), ("svg", b"<?xml")):
        files = [tmp_path / f"{name}.{kind}" for name in ("first", "second")]
        assert files[0].read_bytes().startswith(head)
        assert files[0].read_bytes() == files[1].read_bytes()


def test_a_folder_that_takes_no_file_is_one_clear_message(tmp_path: Path) -> None:
    def none_failed() -> Figure:
        return plot_failures(Proportion.of(3, 3), {}, caption(3))

    with pytest.raises(RequestError, match="cannot be written"):
        write_figure(none_failed, tmp_path / "no" / "failures.png")
    assert write_figure(none_failed, tmp_path / "failures.png").stat().st_size > 5000


def test_no_text_leaves_the_page_or_meets_another(drawn: dict[str, Figure]) -> None:
    with styled():
        for name, figure in (drawn | odd()).items():
            figure.draw_without_rendering()  # pytest makes errors of warnings
            page, boxes = figure.bbox.padded(3.0), []
            for text in shown_texts(figure):
                box = text.get_window_extent()
                assert page.x0 <= box.x0 and box.x1 <= page.x1, (name, text.get_text())  # noqa: PT018
                assert page.y0 <= box.y0 and box.y1 <= page.y1, (name, text.get_text())  # noqa: PT018
                boxes.append((text.get_text(), box.padded(-1.0)))
            for (first, one), (second, other) in combinations(boxes, 2):
                assert not one.overlaps(other), (name, first, second)


def shown_texts(figure: Figure) -> list[Text]:
    """Every text that can be seen: ticks outside of the axes' limits and axes switched off do not count."""
    found = list(figure.texts) + ([figure._suptitle] if figure._suptitle else [])  # type: ignore[attr-defined]
    for axes in figure.get_axes():
        found += axes.texts
        if axes.axison:
            found += [axes.title, axes._left_title, axes.xaxis.label, axes.yaxis.label]  # type: ignore[attr-defined]
            for axis in (axes.xaxis, axes.yaxis):
                low, high = sorted(axis.get_view_interval())
                found += [
                    tick.label1
                    for tick in axis.get_major_ticks()
                    if tick.label1.get_visible() and low <= tick.get_loc() <= high
                ]
    return [text for text in dict.fromkeys(found) if text.get_text().strip()]


def test_capture_times_are_the_distributions_given(drawn: dict[str, Figure]) -> None:
    left, right, *_ = drawn["times"].get_axes()
    for law, curve in five_laws()[0].items():
        every = slice(None, None, 25)
        assert line_through(left, curve.values[every], curve.fraction[every]) == LOOKS[law].colour
        assert line_through(right, curve.values[:-1:25], 1.0 - curve.fraction[:-1:25]) == LOOKS[law].colour
        end = left.get_xlim()[1]
        assert line_through(left, np.array([end]), curve.fraction[-1:]) is not None


def test_median_and_95th_percentile_of_all_runs_are_marked() -> None:
    runs = 1000
    times = np.r_[np.random.default_rng(1).normal(30.0, 4.0, 970).round(1), np.full(30, np.inf)]  # 30 never capture
    curve = ecdf(times[:970], runs)
    with styled():
        figure = plot_capture_times({"lqr": curve}, {}, caption(runs, "lqr"))
    for share in (0.5, 0.95):
        time = time_of(curve, share)
        assert time == np.quantile(times, share, method="inverted_cdf")
        assert f"{time:.1f} s" in words(figure)
        assert line_through(figure.get_axes()[0], np.array([time]), np.array([share])) == LOOKS["lqr"].colour
    assert time_of(curve, 0.98) is None
    assert percent(Proportion.of(30, runs)) in words(figure)
    assert percent(Proportion.of(30, runs)).startswith("3.0 % (2.0–")


def test_those_that_never_capture_stay_visible_however_few() -> None:
    runs = 1_000_000
    times = np.random.default_rng(2).normal(30.0, 4.0, runs - 3)
    with styled():
        right = plot_capture_times({"prrl": ecdf(times, runs)}, {}, caption(runs)).get_axes()[1]
    assert right.get_yscale() == "log"
    assert right.get_ylim()[0] < 3e-6
    end = float(right.get_xlim()[1])
    assert line_through(right, np.array([end]), np.array([3e-6])) == LOOKS["prrl"].colour


def test_a_million_runs_are_few_points(tmp_path: Path) -> None:
    time, traces = flights(200, 6000)
    mass, rate, _, success = drawn_runs(1_000_000)
    with styled():
        pictures = [
            plot_envelope(time, traces, caption(1_000_000)),
            plot_success_map(mass, rate, success, LABELS, caption(1_000_000)),
        ]
        for figure in pictures:
            assert save(figure, [tmp_path / "thin.svg"])[0].stat().st_size < 1_000_000


def test_the_map_shows_the_share_of_each_cell_and_hatches_what_few_runs_tell() -> None:
    rng = np.random.default_rng(4)
    x = rng.uniform(0.3, 0.5, 5000)
    y = x + 0.02 * rng.normal(size=5000)
    success = rng.random(5000) < 0.7
    with styled():
        axes = plot_success_map(x, y, success, LABELS, caption(5000)).get_axes()[0]
    across, up = edges(x)[0], edges(y)[0]
    bounds = [np.r_[-np.inf, part[1:-1], np.inf] for part in (up, across)]  # the outermost take what lies beyond
    runs, good = (np.histogram2d(y[chosen], x[chosen], bounds)[0] for chosen in (slice(None), success))
    mesh = next(part for part in axes.collections if isinstance(part, QuadMesh))
    hatched = next(part for part in axes.collections if type(part) is PolyCollection)
    thin = runs < FEWEST
    assert 0 < thin.sum() < thin.size
    assert len(hatched.get_paths()) == thin.sum()
    assert hatched.get_hatch() == "////"
    shares = np.ma.getdata(mesh.get_array()).reshape(runs.shape)  # type: ignore[arg-type]
    assert np.array_equal(np.isnan(shares), thin)
    assert np.allclose(shares[~thin], (good / np.maximum(runs, 1.0))[~thin])
    low, high = clopper_pearson(good, runs)
    dots = [line for line in axes.lines if line.get_marker() == "o"]
    assert len(np.asarray(dots[0].get_xdata())) == (~thin & (high - low > 2.0 * WIDE)).sum() > 0


def test_the_map_finds_the_probability_that_was_put_in() -> None:
    mass, rate, truth, success = drawn_runs(100_000)
    (across, _), (up, log) = edges(mass), edges(rate)
    assert log
    runs, good = cells(mass, rate, success, across, up)
    expected = cells(mass, rate, np.ones_like(success), across, up)[0]
    assert np.array_equal(runs, expected)
    assert runs.sum() == 100_000
    assert runs.min() >= FEWEST  # independent parameters
    assert runs.size > 300
    column, row = np.searchsorted(across[1:-1], mass, "right"), np.searchsorted(up[1:-1], rate, "right")
    mean = np.zeros(runs.shape)
    np.add.at(mean, (row, column), truth)
    low, high = clopper_pearson(good, runs)
    inside = (low <= mean / runs) & (mean / runs <= high)
    assert inside.mean() > 0.94


@pytest.mark.parametrize("runs", [2, 60, 1000, 30_000])
def test_bins_ascend_and_hold_enough_runs(runs: int) -> None:
    rng = np.random.default_rng(9)
    for values in (
        rng.normal(size=runs),
        rng.uniform(size=runs),
        rng.integers(0, 2, runs) * 1.0,
        rng.pareto(1.0, runs),
    ):
        bounds, _ = edges(values)
        assert (np.diff(bounds) > 0.0).all()
        held = np.bincount(np.searchsorted(bounds[1:-1], values, "right"), minlength=len(bounds) - 1)
        assert len(bounds) == 2 or held.min() ** 2 >= AIM * runs
    even, log = edges(np.linspace(1.0, 2.0, runs))
    assert not log
    assert np.allclose(np.diff(even), np.diff(even)[0])


def test_colours_span_what_was_found() -> None:
    assert colour_limits(np.array([np.nan])) == (0.0, 1.0)
    assert colour_limits(np.array([1.0, np.nan])) == pytest.approx((0.9, 1.0))
    assert colour_limits(np.array([0.0])) == pytest.approx((0.0, 0.1))
    assert colour_limits(np.array([0.93, 0.98])) == pytest.approx((0.93, 0.98))
    assert colour_limits(np.array([0.13, 0.98])) == pytest.approx((0.1, 1.0))


def test_quantiles_of_flights_under_way_are_numpys() -> None:
    values = flights(37, 500)[1][0].values.copy()
    values[3, 100:120] = np.inf
    levels = (0.0, 0.05, 0.5, 0.95, 1.0)
    values[:, 450:] = np.nan
    found = quantiles(values, levels)
    assert np.isnan(found[:, 450:]).all()
    finite = np.where(np.isfinite(values), values, np.nan)[:, :450]
    assert np.allclose(found[:, :450], np.nanquantile(finite, levels, axis=0), rtol=1e-12, atol=0.0)


def test_the_envelope_shows_median_band_extremes_and_thresholds(drawn: dict[str, Figure]) -> None:
    time, traces = flights()
    panels = drawn["envelope"].get_axes()
    every = slice(0, None, 2)  # 1200 times become 600
    for axes, trace in zip(panels, traces, strict=False):
        values = trace.values[:, every]
        enough = np.isfinite(values).sum(axis=0) >= FEW
        assert 0 < enough.sum() < len(enough)
        median = np.nanmedian(values[:, enough], axis=0)
        assert line_through(axes, time[every][enough][::20], median[::20]) == LOOKS["prrl"].colour
        assert line_through(axes, time[:1], values[:, 0].max(keepdims=True)) == LOOKS["prrl"].colour
        ((text, level),) = trace.thresholds.items()
        assert text in [found.get_text() for found in axes.texts]
        assert any(np.allclose(np.asarray(line.get_ydata(), float), level) for line in axes.lines)
        assert axes.get_yscale() == "log"
        assert axes.get_ylim()[0] < 0.2 * level
    under_way = panels[-1].collections[0].get_paths()[0].vertices
    assert np.max(np.asarray(under_way)[:, 1]) == 60


def test_failures_are_bars_with_exact_whiskers(drawn: dict[str, Figure]) -> None:
    from scipy.stats import binomtest

    above, below = drawn["failures"].get_axes()
    assert to_hex(above.patches[0].get_facecolor()).upper() == LOOKS["prrl"].colour
    assert [bar.get_width() for bar in below.patches] == [812 / 99_000, 12 / 99_000]  # type: ignore[attr-defined]
    for count, line in zip((812, 12), below.lines, strict=True):
        exact = binomtest(count, 99_000).proportion_ci(0.95, "exact")
        assert np.allclose(np.asarray(line.get_xdata(), float), exact, rtol=1e-9, atol=0.0)
    names = [label.get_text().replace("\n", " ") for label in below.get_yticklabels()]
    assert names == ["captured, not settled", CAUSES[-1]]
    assert below.get_ylim()[0] > below.get_ylim()[1]  # the first cause on top
    assert "812   0.820 % (0.765–0.878)" in words(drawn["failures"])


def test_no_failure_still_bounds_its_probability() -> None:
    with styled():
        found = said(plot_failures(Proportion.of(10_000, 10_000), {}, caption(10_000)))
    bound = 100.0 * (1.0 - 0.025 ** (1.0 / 10_000))  # closed form of Clopper and Pearson
    assert f"no failure in 10 000 runs: its probability is below {bound:.2g} %" in found
    assert "100 % (above 99.963)" in found


def test_shares_carry_the_digits_that_they_are_worth() -> None:
    assert percent(Proportion(5, 10, 0.5, 0.19, 0.81)) == "50 % (19–81)"
    assert percent(Proportion(1, 10, 0.123456, 0.1229, 0.1240)) == "12.346 % (12.290–12.400)"
    assert percent(Proportion.of(0, 1)) == "0 % (below 98)"
    assert percent(Proportion.of(1, 1)) == "100 % (above 2.5)"
    assert "100" not in percent(Proportion.of(999_999, 1_000_000)).split("(")[0]


def test_long_names_of_causes_are_wrapped() -> None:
    with styled():
        figure = plot_failures(Proportion.of(1, 2), {"a cause " * 50: Proportion.of(1, 2)}, caption(2))
    name = figure.get_axes()[1].get_yticklabels()[0].get_text()
    assert name.count("\n") == 2
    assert all(len(line) <= causes_page.LINE for line in name.split("\n"))
    assert name.endswith("…")


def test_convergence_ends_in_its_last_interval_and_shows_when_it_was_narrow_enough() -> None:
    curve = known(0.98, 100_000)
    half = 0.5 * (curve.high - curve.low)
    with styled():
        above, below = plot_convergence(curve, caption(100_000), 0.002).get_axes()
        unmet = plot_convergence(curve, caption(100_000), 1e-5)
    assert line_through(above, curve.runs[::5].astype(float), curve.share[::5]) == LOOKS["prrl"].colour
    span = above.patches[0].get_extents().transformed(above.transData.inverted())
    assert (span.y0, span.y1) == pytest.approx((curve.low[-1], curve.high[-1]))
    assert above.get_xscale() == below.get_xscale() == "log"
    met = int(curve.runs[half <= 0.002][0])
    assert any(np.allclose(np.asarray(line.get_xdata(), float), met) for line in below.lines)
    assert f"met at {met:,} runs".replace(",", "\u2009") in below.texts[0].get_text()
    assert "not yet met" in said(unmet)
    assert unmet.get_axes()[1].get_ylim()[0] < 1e-5


def test_influences_stand_in_rows_of_the_same_parameter(drawn: dict[str, Figure]) -> None:
    outcomes = [influences("failure", FIELDS, 1), influences("capture_time_s", FIELDS, 2)]
    panels = drawn["sensitivity"].get_axes()
    order = ranking(outcomes)
    assert [label.get_text() for label in panels[0].get_yticklabels()] == order
    assert sorted(order) == sorted(FIELDS)
    strongest = max((one for outcome in outcomes for one in outcome.influences), key=lambda one: one.index)
    assert order[0] == strongest.field
    for axes, outcome in zip(panels, outcomes, strict=True):
        found = {one.field: one for one in outcome.influences}
        shades = set()
        for bar, field in zip(axes.patches, order, strict=True):
            assert bar.get_width() == found[field].index  # type: ignore[attr-defined]
            colour = to_hex(bar.get_facecolor()).upper()
            assert colour == (LOOKS["prrl"].colour if found[field].index > 0.04 else PLAIN)
            shades.add(colour)
        assert any(np.allclose(np.asarray(line.get_xdata(), float), 0.04) for line in axes.lines)
        texts = [text.get_text().replace("−", "-") for text in axes.texts]
        assert texts == [f"ρ {found[field].correlation:+.2f}" for field in order]
    assert {to_hex(bar.get_facecolor()).upper() for axes in panels for bar in axes.patches} == {
        LOOKS["prrl"].colour,
        PLAIN,
    }


def test_where_there_is_nothing_to_explain_the_reason_stands() -> None:
    silence = "none of 12000 runs failed; at least 10 are needed"
    with styled():
        figure = plot_sensitivity(
            [Sensitivity("failure", 12_000, silence=silence), influences("x", FIELDS, 2)], caption(1)
        )
        many = plot_sensitivity([influences("failure", LONG, 1)], caption(1))
    assert silence in words(figure)
    assert [label.get_text() for label in figure.get_axes()[1].get_yticklabels()] == ranking(
        [influences("x", FIELDS, 2)]
    )
    assert len(many.get_axes()[0].patches) == MOST
    names = [label.get_text() for label in many.get_axes()[0].get_yticklabels()]
    assert len(set(names)) == MOST  # what tells long names apart is left
    assert f"{len(LONG) - MOST} weaker ones not shown" in said(many)


def test_matplotlib_is_not_imported_before_something_is_drawn() -> None:
    code = "import sys, detumble.show.campaign; sys.exit(bool({'matplotlib', 'scipy', 'polars'} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
