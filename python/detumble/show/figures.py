"""All figures of the paper's case, as PNG and SVG."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from detumble.show import approach
from detumble.show.stack import stack_after_capture
from detumble.show.style import save, styled
from detumble.show.summary import summary

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from detumble.flight import Flight

APPROACH = {
    "fig1_relative_position_x": approach.relative_position_x,
    "fig2_relative_velocity_x": approach.relative_velocity_x,
    "fig3_chaser_rate": approach.chaser_rate,
    "fig4_debris_rate": approach.debris_rate,
    "fig5_attitude_error": approach.attitude_error,
    "fig6_force_x": approach.force_x,
    "fig7_torque_x": approach.torque_x,
    "fig8_stack_after_capture": stack_after_capture,
}
"""Figures that need nothing but the flights, by file name."""

SUMMARY = "fig9_summary"


def build(flights: Mapping[str, Flight], minimum_time: float) -> dict[str, Figure]:
    """Plot every figure, in memory; call it within `styled()`.

    Args:
        flights: of one scenario, by law; at least one.
        minimum_time: before that no controller can capture, s; inf where none can at all.

    Returns:
        Figures by file name, in order.
    """
    plotted = {name: plot(flights) for name, plot in APPROACH.items()}
    return plotted | {SUMMARY: summary(flights, minimum_time)}


def paper_figures(flights: Mapping[str, Flight], out: Path, minimum_time: float) -> list[Path]:
    """Write the figures of the paper's case: its own seven, the stack after capture, and one that sums up.

    Args:
        flights: of one scenario, by law; at least one.
        out: an existing folder.
        minimum_time: before that no controller can capture, s; inf where none can at all.

    Returns:
        The files: PNG and SVG of each figure, in order.

    Raises:
        RequestError: a file cannot be written.
    """
    with styled():
        figures = build(flights, minimum_time)
        written = [save(figure, [out / f"{name}.png", out / f"{name}.svg"]) for name, figure in figures.items()]
    return [path for pair in written for path in pair]
