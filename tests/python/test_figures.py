"""Figures: every file there and whole, axes with units, one look for each law, and no flight too odd to draw."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from itertools import combinations
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

import detumble
from detumble.errors import RequestError
from detumble.flight import Flight
from detumble.scenario import Scenario, with_settings
from detumble.scenario.laws import LAWS
from detumble.show import figures
from detumble.show import flight as page
from detumble.show.series import capture_row, round_up, spans, thinned, until_capture
from detumble.show.style import AXIS_LOOKS, LOOKS, save, styled, write_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

NAMES = [*figures.APPROACH, figures.SUMMARY]
CATEGORIES = {figures.SUMMARY: 3}
"""Panels of a figure whose vertical axis names laws, and so has no unit."""


@pytest.fixture(scope="module")
def flights(short: Scenario) -> dict[str, Flight]:
    """PD does not capture within this minute; the others do."""
    return {law: detumble.simulate(short, law) for law in LAWS}


@pytest.fixture(scope="module")
def odd(short: Scenario) -> dict[str, Flight]:
    return odd_flights(short)


@pytest.fixture(scope="module")
def drawn(flights: dict[str, Flight]) -> Iterator[dict[str, Figure]]:
    with styled():
        yield figures.build(flights, 3.0)


def odd_flights(short: Scenario) -> dict[str, Flight]:
    runaway = ["actuators.force_limit=inf", "laws.pd.translation={kp = 1e6, kd = 1e5}"]
    inside = ["capture.distance=100", "capture.angle_deg=180", "capture.rate=10"]
    pushes = ["laws.none.segments=[{start=1.0, end=2.0, force=[0.01, 0, 0], frame='body'}]"]
    title = [f'title="$\\\\frac{{ 日本 {"x" * 200}"']
    scenarios = {
        "tumbling": (short, "none"),
        "pushed": (with_settings(short, pushes), "none"),
        "never captured": (with_settings(short, ["time.duration=2.0"]), "pd"),
        "one period": (with_settings(short, ["time.duration=0.1"]), "prrl"),
        "diverged": (with_settings(short, runaway), "pd"),
        "captured at once": (with_settings(short, inside), "prrl"),
        "two bodies": (with_settings(short, ["capture.merge=false"]), "tsmc"),
        "momentum": (with_settings(short, ["capture.transition='momentum_conserving'"]), "sosmc"),
        "no limits": (with_settings(short, ["actuators={force_limit = inf, torque_limit = inf}"]), "lqr"),
        "strange title": (with_settings(short, title), "prrl"),
    }
    return {name: detumble.simulate(scenario, law) for name, (scenario, law) in scenarios.items()}


def axes_of(figure: Figure) -> list[Axes]:
    return list(figure.get_axes())


def test_every_figure_is_written_as_png_and_svg_and_nothing_else(flights: dict[str, Flight], tmp_path: Path) -> None:
    files = figures.paper_figures(flights, tmp_path, 3.0)
    assert [file.name for file in files] == [f"{name}.{kind}" for name in NAMES for kind in ("png", "svg")]
    assert sorted(tmp_path.iterdir()) == sorted(files)
    for file in files:
        head = file.read_bytes()[:16]
        assert head.startswith(b"\x89PNG\r\n" if file.suffix == ".png" else b"<?xml")
        assert file.stat().st_size > 10_000


def test_the_same_flights_give_the_same_bytes(flights: dict[str, Flight], tmp_path: Path) -> None:
    one = {"prrl": flights["prrl"]}
    with styled():
        for (name, first), second in zip(
            figures.build(one, 3.0).items(), figures.build(one, 3.0).values(), strict=True
        ):
            files = [
                save(figure, [tmp_path / f"{name}{kind}"])[0] for kind, figure in (("a.svg", first), ("b.svg", second))
            ]
            assert files[0].read_bytes() == files[1].read_bytes()


def test_a_users_own_settings_neither_matter_nor_are_changed(flights: dict[str, Flight], tmp_path: Path) -> None:
    import matplotlib as mpl

    path = tmp_path / "flight.svg"
    before = write_figure(lambda: page.plot_flight(flights["prrl"]), path).read_bytes()
    with mpl.rc_context({"font.size": 30.0, "lines.linewidth": 9.0}):
        assert write_figure(lambda: page.plot_flight(flights["prrl"]), path).read_bytes() == before
        assert mpl.rcParams["font.size"] == 30.0


def test_a_folder_that_takes_no_file_is_one_clear_message(flights: dict[str, Flight], tmp_path: Path) -> None:
    with pytest.raises(RequestError, match="cannot be written"):
        write_figure(lambda: page.plot_flight(flights["prrl"]), tmp_path / "no" / "flight.png")


@pytest.mark.parametrize("name", NAMES)
def test_every_axis_carries_its_unit(drawn: dict[str, Figure], name: str) -> None:
    panels = axes_of(drawn[name])
    left = [axes.get_ylabel() for axes in panels if axes.get_ylabel()]
    below = [axes.get_xlabel() for axes in panels if axes.get_xlabel()]
    assert left
    assert below
    assert all(label.endswith("]") for label in (*left, *below))
    for axes in panels[CATEGORIES.get(name, 0) :]:
        shared = axes.get_shared_y_axes().get_siblings(axes)
        assert any(sibling.get_ylabel() for sibling in shared)  # type: ignore[attr-defined]


def test_captures_are_vertical_lines_in_the_laws_colours(drawn: dict[str, Figure], flights: dict[str, Flight]) -> None:
    for name in list(figures.APPROACH)[:5]:
        found = {
            (line.get_color(), float(np.asarray(line.get_xdata())[0]))
            for axes in axes_of(drawn[name])
            for line in axes.lines
            if len(np.asarray(line.get_xdata())) == 2
        }
        for law, flight in flights.items():
            time = flight.metrics.capture_time
            assert time is None or (LOOKS[law].colour, time) in found


def test_each_law_has_one_look_and_no_other_thing_has_it() -> None:
    assert set(LOOKS) == {*LAWS, "none"}
    for one, other in combinations([LOOKS[law] for law in LAWS], 2):
        assert one.colour != other.colour
        assert one.dashes != other.dashes
        assert one.marker != other.marker
    assert not {look.colour for look in LOOKS.values()} & {look.colour for look in AXIS_LOOKS}


def test_lines_are_drawn_in_the_looks_of_their_laws(drawn: dict[str, Figure]) -> None:
    legend = drawn["fig1_relative_position_x"].legends[0]
    for law, handle, text in zip(LAWS, legend.get_lines(), legend.get_texts(), strict=True):
        assert handle.get_color() == LOOKS[law].colour
        assert text.get_text().startswith(LOOKS[law].label)


def test_odd_flights_are_plotted_without_a_warning(odd: dict[str, Flight], tmp_path: Path) -> None:
    for number, (name, flight) in enumerate(odd.items()):
        path = tmp_path / f"{name}.{('png', 'svg')[number % 2]}"
        assert write_figure(lambda flight=flight: page.plot_flight(flight), path) == path
        assert path.stat().st_size > 10_000


def test_figures_of_the_case_take_odd_flights_too(odd: dict[str, Flight]) -> None:
    cases = [
        {"pd": odd["diverged"], "prrl": odd["captured at once"], "lqr": odd["no limits"]},
        {"tsmc": odd["two bodies"], "prrl": odd["one period"]},
        {"pd": odd["never captured"]},
    ]
    with styled():
        for case in cases:
            for figure in figures.build(case, float("inf")).values():
                figure.draw_without_rendering()


def test_the_page_of_a_flight_carries_units(flights: dict[str, Flight]) -> None:
    with styled():
        panels = axes_of(page.plot_flight(flights["prrl"]))
    assert len(panels) == 6
    assert all(axes.get_ylabel().endswith("]") for axes in panels)
    assert all(axes.get_xlabel().endswith("]") for axes in panels[-2:])


def test_the_line_until_capture_ends_with_what_was_judged(short: Scenario) -> None:
    flight = detumble.simulate(with_settings(short, ["capture.transition='momentum_conserving'"]), "prrl")
    row = capture_row(flight)
    assert row is not None
    time, angle = until_capture(flight, "angle_error")
    assert (time[-1], angle[-1]) == (flight.metrics.capture_time, flight.metrics.capture_angle)
    assert angle[-1] != flight.history["angle_error"][row]
    event = flight.event("captured")
    assert event is not None
    assert until_capture(flight, "chaser_rate", 1)[1][-1] == event.details["before"]["chaser_rate"][1]


def test_thinning_keeps_ends_peaks_and_order() -> None:
    time = np.arange(100_000) * 0.1
    values = np.sin(time)
    values[[777, 54_321]] = 5.0, -7.0
    kept, thin = thinned(time, values)
    assert len(kept) <= 4100
    assert (np.diff(kept) > 0.0).all()
    assert (kept[0], kept[-1]) == (time[0], time[-1])
    assert (thin.max(), thin.min()) == (5.0, -7.0)
    assert np.array_equal(thinned(time, values, end=100.0)[1], values[:1002])


def test_the_early_part_is_shown_apart_only_where_that_helps() -> None:
    assert [span.end for span in spans([104.4, 24.6, 28.1, 51.2, 7.6], 600.0, "whole")] == [35.0, 120.0]
    assert [span.end for span in spans([20.0, 25.0], 600.0, "whole")] == [30.0]
    assert [span.end for span in spans([7.6, None], 600.0, "whole")] == [9.0, 600.0]
    assert [span.end for span in spans([None], 60.0, "whole")] == [60.0]
    assert [span.end for span in spans([0.0], 0.0, "whole")] == [1.0]
    assert [round_up(length) for length in (0.0, 7.6, 11.1, 114.8, 0.031)] == [1.0, 8.0, 12.0, 120.0, 0.035]


def test_matplotlib_is_not_imported_before_something_is_drawn() -> None:
    code = "import sys, detumble.show.figures, detumble.show.flight; sys.exit('matplotlib' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
