"""Pareto fronts of time against Δv for each law, with equal budgets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Any

from detumble.analysis.comparing.entries import FORMS
from detumble.analysis.tuning.pareto import pareto_front
from detumble.scenario.laws import LAWS, Form
from detumble.show.axes import label_decades
from detumble.show.style import look, new_figure, save, styled
from study.cases import Case

SEED = 0
LABELS = {"capture": "mean capture time [s]", "settling": "mean time until settled [s]"}


def search(case: Case, budget: int, starts: int) -> dict[str, Any]:
    """Find each law's front in both forms: the case's time in the mean, s, and mean Δv to capture, m/s, fastest first."""
    return {form: {law: _front(case, law, form, budget, starts) for law in LAWS} for form in FORMS}


def _front(case: Case, law: str, form: Form, budget: int, starts: int) -> dict[str, Any]:
    front = pareto_front(case.scenario, law, what=case.objective, budget=budget, starts=starts, seed=SEED, form=form)
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
            for form, law in product(FORMS, LAWS):
                style, front = look(law), fronts[form][law]
                axes.plot(
                    front["time_s"],
                    front["delta_v_m_s"],
                    color=style.colour,
                    linestyle="-" if form == "printed" else (0, (4.0, 1.5)),
                    marker=style.marker,
                    markersize=3.5,
                    markerfacecolor=style.colour if form == "printed" else "white",
                    markevery=max(1, len(front["time_s"]) // 8),
                    label=style.label + ("" if form == "printed" else ", corrected"),
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
