"""Probability of success over two drawn parameters, with the interval of each cell."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from detumble.intervals import clopper_pearson
from detumble.show.axes import label_decades
from detumble.show.campaign.frame import Caption, counted, page
from detumble.show.series import Array
from detumble.show.style import LIMIT, heading

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

FEWEST = 30
"""Runs that a cell needs to be coloured."""
AIM = 50
"""Runs that the emptiest cell shall have, if the two parameters do not depend on each other."""
MOST_BINS = 40
WIDE = 0.1
"""Half width of an interval from which a cell is marked."""
TAIL = 5e-4
"""Share of the runs on either side that may lie beyond the axes, if they lie far out."""
DECADES_FROM = 30.0
"""A positive parameter that varies by more than this factor is shown in decades."""
COLOURS = "viridis"


def plot_success_map(
    x: Array, y: Array, success: NDArray[np.bool_], labels: tuple[str, str], caption: Caption
) -> Figure:
    """Plot the probability of success over two parameters, and over each of them alone; within `styled()`.

    Args:
        x: (n,) drawn values of the parameter to the right; n at least 1.
        y: (n,) of the one upwards.
        success: (n,) of each run.
        labels: of the two parameters, with units.
        caption: what was flown.
    """
    (across, log_across), (up, log_up) = edges(x), edges(y)
    runs, good = cells(x, y, success, across, up)
    low, high = clopper_pearson(good, runs)
    half, known = 0.5 * (high - low), runs >= FEWEST
    figure = page(caption, 9.5, 8.2, _note(half, known))
    grid = figure.add_gridspec(2, 3, width_ratios=(1.0, 0.26, 0.04), height_ratios=(0.26, 1.0))
    axes = figure.add_subplot(grid[1, 0])
    axes.set_xscale("log" if log_across else "linear")
    axes.set_yscale("log" if log_up else "linear")
    for axis, log in ((axes.xaxis, log_across), (axes.yaxis, log_up)):
        if log:
            label_decades(axis)
    _map(axes, figure.add_subplot(grid[1, 2]), (across, up), np.where(known, good / np.maximum(runs, 1), np.nan))
    wide = np.argwhere(known & (half > WIDE))
    middle = [_middle(part, log) for part, log in ((across, log_across), (up, log_up))]
    axes.plot(middle[0][wide[:, 1]], middle[1][wide[:, 0]], "o", color="white", markersize=3.2, markeredgecolor="black")
    axes.set_xlim(across[0], across[-1])
    axes.set_ylim(up[0], up[-1])
    axes.set_xlabel(heading(labels[0], 70), parse_math=False)
    axes.set_ylabel(heading(labels[1], 70), parse_math=False)
    axes.grid(visible=False)
    top, right = figure.add_subplot(grid[0, 0], sharex=axes), figure.add_subplot(grid[1, 1], sharey=axes)
    overall = float(np.mean(success))
    limits = _margin(top, across, middle[0], (good.sum(axis=0), runs.sum(axis=0)), overall, flat=True)
    limits += _margin(right, up, middle[1], (good.sum(axis=1), runs.sum(axis=1)), overall, flat=False)
    least, most = min(limits), max(limits)
    pad = 0.05 * max(most - least, 1e-6)
    top.set_ylim(least - pad, most + pad)
    right.set_xlim(least - pad, most + pad)
    top.set_ylabel("probability\nof success [–]")
    right.set_xlabel("probability\nof success [–]")
    top.tick_params(labelbottom=False)
    right.tick_params(labelleft=False)
    right.locator_params(axis="x", nbins=3)
    return figure


def edges(values: Array) -> tuple[Array, bool]:
    """Choose bins of one parameter: equally wide, in decades where it spans several, those with few runs merged.

    The smallest share that a bin may hold is √(AIM/n): cells of two such bins then hold about `AIM` runs. The first and
    the last bin also take what lies beyond them.

    Args:
        values: (n,) as drawn; n at least 1.

    Returns:
        The edges, ascending, and whether the axis shall count decades.
    """
    least, most = float(values.min()), float(values.max())
    if most - least <= 1e-9 * max(abs(least), abs(most)):  # one value, but for round-off
        room = 0.05 * abs(least) or 1.0
        return np.array([least - room, least + room]), False
    low, high = (float(edge) for edge in np.quantile(values, [TAIL, 1.0 - TAIL]))
    if most - least <= 1.1 * (high - low) or not high > low:
        low, high = least, most
    decades = 0.0 < DECADES_FROM * low < high
    share = max(math.sqrt(AIM / len(values)), 0.8 / MOST_BINS)
    count = 2 * max(1, int(0.8 / share))  # of an even spread, two each are merged whatever the draws
    even = np.geomspace(low, high, count + 1) if decades else np.linspace(low, high, count + 1)
    filled = np.bincount(_bins(values, even), minlength=count)
    kept, held = [float(even[0])], 0
    for runs, edge in zip(filled, even[1:], strict=True):
        held += int(runs)
        if held >= share * len(values):
            kept.append(float(edge))
            held = 0
    kept[max(len(kept) - 1, 1) :] = [float(even[-1])]  # a remainder is merged into the bin before it
    return np.array(kept), decades


def cells(
    x: Array, y: Array, success: NDArray[np.bool_], across: Array, up: Array
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Count runs and successes in each cell.

    Args:
        x: (n,) values to the right.
        y: (n,) values upwards.
        success: (n,).
        across: (a + 1,) edges of x.
        up: (b + 1,) edges of y.

    Returns:
        runs and successes, each (b, a).
    """
    shape = (len(up) - 1, len(across) - 1)
    cell = _bins(y, up) * shape[1] + _bins(x, across)
    runs, good = (np.bincount(part, minlength=shape[0] * shape[1]).reshape(shape) for part in (cell, cell[success]))
    return runs, good


def _bins(values: Array, bounds: Array) -> NDArray[np.int64]:
    """Index of the bin of each value; what lies beyond goes to the outermost."""
    return np.searchsorted(bounds[1:-1], values, side="right")


def _map(axes: Axes, bar: Axes, bounds: tuple[Array, Array], share: Array) -> None:
    from matplotlib.collections import PolyCollection

    across, up = bounds
    least, most = colour_limits(share)
    mesh = axes.pcolormesh(across, up, share, cmap=COLOURS, vmin=least, vmax=most)
    mesh.set_rasterized(True)
    thin = [
        [(across[i], up[j]), (across[i + 1], up[j]), (across[i + 1], up[j + 1]), (across[i], up[j + 1])]
        for j, i in np.argwhere(np.isnan(share))
    ]
    hatched = PolyCollection(thin, facecolor="white", edgecolor="#A0A0A0", hatch="////", linewidth=0.0)
    axes.add_collection(hatched, autolim=False)
    axes.figure.colorbar(mesh, cax=bar, label="probability of success in a cell [–]")


def colour_limits(share: Array) -> tuple[float, float]:
    """Round the range of shares outwards to what reads well; NaN does not count."""
    known = share[np.isfinite(share)]
    if not known.size:
        return 0.0, 1.0
    least, most = float(known.min()), float(known.max())
    step = next((step for step in (0.001, 0.01) if most - least <= 10.0 * step), 0.1)
    if most == least:
        step = 0.1
    low, high = math.floor(least / step + 1e-9) * step, math.ceil(most / step - 1e-9) * step
    return (low, high) if high > low else (max(high - step, 0.0), max(high, step))


def _margin(
    axes: Axes,
    bounds: Array,
    middle: Array,
    counts: tuple[NDArray[np.int64], NDArray[np.int64]],
    overall: float,
    *,
    flat: bool,
) -> list[float]:
    """Plot the probability over one parameter with its intervals, from successes and runs; give their ends."""
    good, runs = counts
    low, high = clopper_pearson(good, runs)
    share = np.where(runs > 0, good / np.maximum(runs, 1), np.nan)
    bars, whiskers, line = (
        (axes.hlines, axes.vlines, axes.axhline) if flat else (axes.vlines, axes.hlines, axes.axvline)
    )
    line(overall, **LIMIT)
    bars(share, bounds[:-1], bounds[1:], color="black", linewidth=2.0)
    whiskers(middle, low, high, color="black", linewidth=1.0)
    return [float(low.min()), float(high.max())]


def _middle(bounds: Array, log: bool) -> Array:
    middle: Array = np.sqrt(bounds[:-1] * bounds[1:]) if log else 0.5 * (bounds[:-1] + bounds[1:])
    return middle


def _note(half: Array, known: NDArray[np.bool_]) -> str:
    parts = [f"hatched: fewer than {counted(FEWEST, 'run')}"]
    if known.any():
        parts.insert(0, f"cells are known to ±{float(np.median(half[known])):.2g} (median, 95 %)")
    if (known & (half > WIDE)).any():
        parts.append(f"dot: wider than ±{WIDE:g}")
    return "   ·   ".join([*parts, "outermost cells take what lies beyond"])
