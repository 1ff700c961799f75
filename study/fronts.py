"""Pareto fronts of time against Δv for each law, with equal budgets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from detumble.analysis.comparing.entries import Entry, entries_of
from detumble.analysis.tuning.pareto import pareto_front
from detumble.show.axes import label_decades
from detumble.show.style import look, new_figure, save, styled
from study.cases import Case

SEED = 0
LABELS = {"capture": "mean capture time [s]", "settling": "mean time until settled [s]"}


def search(case: Case, budget: int, starts: int) -> dict[str, Any]:
    """Find each law's front in all of its forms: the case's time in the mean, s, and mean Δv to capture, m/s, fastest first.

    Returns:
        By form, then law; a law that has only one form is among the printed.
    """
    found: dict[str, Any] = {}
    for entry in entries_of():
        found.setdefault(entry.form or "printed", {})[entry.law] = _front(case, entry, budget, starts)
    return found


def _front(case: Case, entry: Entry, budget: int, starts: int) -> dict[str, Any]:
    front = pareto_front(
        case.scenario, entry.law, what=case.objective, budget=budget, starts=starts, seed=SEED, form=entry.form
    )
    return {
        "time_s": [point.time for point in front.points],
        "delta_v_m_s": [point.delta_v for point in front.points],
    }


def draw(found: Mapping[str, Mapping[str, Any]], cases: Sequence[Case], path: Path) -> list[Path]:
    """Plot the fronts, a panel for each scenario."""
    with styled():
        figure = new_figure(3.6 * len(found), 4.2)
        panels = figure.subplots(1, len(found), squeeze=False)[0]
        for axes, case in zip(panels, cases, strict=True):
            fronts = found[case.key]
            for entry in sorted(entries_of(), key=lambda entry: entry.form == "corrected"):
                style, front = look(entry.law), fronts[entry.form or "printed"][entry.law]
                axes.plot(
                    front["time_s"],
                    front["delta_v_m_s"],
                    color=style.colour,
                    linestyle=(0, (4.0, 1.5)) if entry.form == "corrected" else "-",
                    marker=style.marker,
                    markersize=3.5,
                    markerfacecolor="white" if entry.form == "corrected" else style.colour,
                    markevery=max(1, len(front["time_s"]) // 8),
                    label=entry.name,
                    drawstyle="steps-post",
                )
            axes.set(xscale="log", yscale="log")
            for axis in (axes.xaxis, axes.yaxis):
                label_decades(axis)
            axes.set(title=case.title, xlabel=LABELS[case.objective])
            axes.margins(x=0.04)
        panels[0].set_ylabel("mean Δv to capture [m/s]")
        figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=5)
        figure.suptitle("What a sooner capture costs")
        return save(figure, [path])
