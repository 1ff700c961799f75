"""What the pictures of a comparison have in common: how entries look, the headline, the legend."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from detumble.analysis.tuning.objective import MEANINGS
from detumble.show.campaign.frame import Caption, below_headline, counted, page
from detumble.show.style import Dashes, look, shortened

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from detumble.analysis.comparing.result import Comparison

DASHES: dict[str, tuple[Dashes, ...]] = {
    "printed": ("-", (0, (7.0, 1.5, 1.0, 1.5)), (0, (7.0, 1.5, 1.0, 1.5, 1.0, 1.5))),
    "corrected": ((0, (4.0, 1.6)), (0, (1.2, 1.2)), (0, (4.0, 1.4, 1.2, 1.4))),
}
"""By form: of the first entry of a law, the second, and all others."""
NAME = 26
"""Most characters of the name of an entry; five columns of a legend have room for those of a law and its form."""
_ROW = 0.2
"""Height of a row of the legend, inches."""


@dataclass(frozen=True)
class EntryLook:
    """How an entry is drawn.

    Attributes:
        label: its name, shortened.
        colour: of its law.
        dashes: solid as printed, broken as corrected.
        marker: of its law.
        fill: of the marker: the colour as printed, white as corrected.
    """

    label: str
    colour: str
    dashes: Dashes
    marker: str
    fill: str

    @property
    def line(self) -> dict[str, Any]:
        """Options of a line."""
        return {"color": self.colour, "linestyle": self.dashes}

    @property
    def point(self) -> dict[str, Any]:
        """Options of a point."""
        return {"marker": self.marker, "markerfacecolor": self.fill, "markeredgecolor": self.colour, "markersize": 5.0}


def looks(comparison: Comparison) -> list[EntryLook]:
    """Give the look of every entry, by place."""
    met: dict[tuple[str, str], int] = {}
    found = []
    for judged in comparison.entries:
        entry = judged.entry
        number = met[entry.law, entry.form] = met.get((entry.law, entry.form), -1) + 1
        style, dashes = look(entry.law), DASHES[entry.form]
        fill = style.colour if entry.form == "printed" else "white"
        name = shortened(entry.name, NAME)
        found.append(EntryLook(name, style.colour, dashes[min(number, len(dashes) - 1)], style.marker, fill))
    return found


def sheet(comparison: Comparison, width: float, height: float, *notes: str, legend: bool = True) -> Figure:
    """Make a page with headline and legend; panels find their places below.

    Args:
        comparison: what is shown.
        width: inches.
        height: inches, of the panels alone.
        notes: further lines of the headline.
        legend: put one on top, the entries in their order.
    """
    plan = comparison.plan
    gains = (
        "gains as given"
        if plan.as_given
        else f"{counted(plan.tunings, 'tuning')} each of {counted(plan.budget, 'evaluation')} on {counted(plan.starts, 'start')}"
    )
    goal = f"{plan.objective.statistic} of {MEANINGS[plan.objective.what]}, success at least {100 * plan.objective.required:g} %"
    lines = (f"{goal}   ·   {gains}", *notes)
    longest = max(len(known.label) for known in looks(comparison))
    columns = min(5 if longest < 20 else 4, len(comparison.entries))
    rows = math.ceil(len(comparison.entries) / columns) if legend else 0
    room = _ROW * rows + (0.12 if legend else 0.0)
    taken = below_headline(len(lines)) + room
    caption = Caption(comparison.scenario.title, "", plan.runs, plan.judging)
    figure = page(caption, width, height + taken, *lines, room=room)
    if legend:
        _legend(figure, comparison, columns, 1.0 - below_headline(len(lines)) / (height + taken))
    return figure


def _legend(figure: Figure, comparison: Comparison, columns: int, top: float) -> None:
    from matplotlib.lines import Line2D

    known, ranks = looks(comparison), comparison.ranking.ranks
    handles = [
        Line2D([], [], **known[place].line, **known[place].point, label=f"{ranks[place]}  {known[place].label}")
        for place in comparison.ordered
    ]
    legend = figure.legend(
        handles=handles,
        loc="upper center",
        bbox_to_anchor=(0.5, top),
        ncols=columns,
        borderaxespad=0.0,
        columnspacing=1.6,
    )
    legend.set_in_layout(False)
    for text in legend.get_texts():  # a name is no formula
        text.set_parse_math(False)
