"""The trajectory behind an upper bound: the soonest capture found, its forces and torques."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from detumble.show.style import AXIS_LOOKS, LIMIT, heading, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from detumble.analysis.bounds.bound import Rendezvous
    from detumble.quaternions import Array


def plot_bound(title: str, found: Rendezvous) -> Figure:
    """Plot position, rotation, acceleration and torque until the capture; call it within `styled()`.

    Args:
        title: of the scenario.
        found: a capture with a translation; without a slew its panels are left out.
    """
    assert found.transfer is not None
    rows: list[tuple[str, Array, Array, bool]] = [
        ("position in LVLH [m]", found.transfer.times, found.transfer.states[:, :3], False),
        ("acceleration [m/s²]", found.transfer.times, found.transfer.acceleration, True),
    ]
    if found.slew is not None:
        rows.append(("chaser rate [rad/s]", found.slew.times, found.slew.rate, False))
        rows.append(("torque [N m]", found.slew.times, found.slew.torque, True))
    figure = new_figure(7.0, 1.6 * len(rows) + 0.9)
    panels = figure.subplots(len(rows), 1, sharex=True)
    for axes, (label, times, values, held) in zip(panels, rows, strict=True):
        _lines(axes, times, values, held)
        axes.set_ylabel(label)
        axes.axvline(found.lower, **LIMIT)
    panels[0].legend(ncols=3, loc="upper right")
    panels[0].set_title(f"captured at {found.upper:.10g} s; no controller before {found.lower:.10g} s (dashed)")
    panels[-1].set_xlabel("time [s]")
    figure.suptitle(heading(title, 62), parse_math=False)
    return figure


def _lines(axes: Any, times: Array, values: Array, held: bool) -> None:
    for axis, style in enumerate(AXIS_LOOKS):
        options = {"color": style.colour, "linestyle": style.dashes, "label": style.label}
        if held:
            axes.step(times, np.append(values[:, axis], values[-1:, axis]), where="post", **options)
        else:
            axes.plot(times, values[:, axis], **options)
