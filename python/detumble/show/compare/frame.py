"""Common parts of the pictures of a comparison: looks of the entries, headline, legend."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from detumble.show.campaign.frame import Caption, below_headline, page
from detumble.show.style import Dashes, look, shortened

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

DASHES: tuple[Dashes, ...] = ("-", (0, (7.0, 1.5, 1.0, 1.5)), (0, (7.0, 1.5, 1.0, 1.5, 1.0, 1.5)))
"""Of the first entry of a law, the second, and all others."""
CORRECTED_DASHES: tuple[Dashes, ...] = ((0, (4.0, 1.6)), (0, (1.2, 1.2)), (0, (4.0, 1.4, 1.2, 1.4)))
"""Likewise, of its corrected form."""
NAME = 26
"""Most characters of the name of an entry; five columns of a legend fit the name of a law and its form."""
_ROW = 0.2
"""Height of a row of the legend, inches."""


@dataclass(frozen=True)
class EntryLook:
    """Appearance of an entry.

    Attributes:
        label: its name, shortened.
        colour: of its law.
        dashes: broken as corrected, else solid.
        marker: of its law.
        fill: of the marker: white as corrected, else the colour.
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


def looks_of(entries: Sequence[tuple[str, str, str | None]]) -> list[EntryLook]:
    """Give the look of every entry, by place.

    Args:
        entries: name, law and form of each; entries of one law and form differ by their dashes, in this order.
    """
    met: dict[tuple[str, str | None], int] = {}
    found = []
    for name, law, form in entries:
        index = met[law, form] = met.get((law, form), -1) + 1
        style, corrected = look(law), form == "corrected"
        dashes = CORRECTED_DASHES if corrected else DASHES
        fill = "white" if corrected else style.colour
        label = shortened(name, NAME)
        found.append(EntryLook(label, style.colour, dashes[min(index, len(dashes) - 1)], style.marker, fill))
    return found


@dataclass(frozen=True)
class Sheet:
    """Headline and entries of the pictures of one comparison; all lists by entry, the best first.

    Attributes:
        caption: title, number of runs, seed.
        goal: second line of the headline.
        looks: of the entries.
        ranks: from 1.
        ties: letters; entries that share one tie.
    """

    caption: Caption
    goal: str
    looks: Sequence[EntryLook]
    ranks: Sequence[int]
    ties: Sequence[str]

    def page(self, width: float, height: float, *notes: str, legend: bool = True) -> Figure:
        """Make a page with headline and legend; panels find their places below.

        Args:
            width: inches.
            height: inches, of the panels alone.
            notes: further lines of the headline.
            legend: put one on top, the entries in their order.
        """
        lines = (self.goal, *notes)
        longest = max(len(known.label) for known in self.looks)
        columns = min(5 if longest < 20 else 4, len(self.looks))
        rows = math.ceil(len(self.looks) / columns) if legend else 0
        room = _ROW * rows + (0.12 if legend else 0.0)
        taken = below_headline(len(lines)) + room
        figure = page(self.caption, width, height + taken, *lines, room=room)
        if legend:
            self._legend(figure, columns, 1.0 - below_headline(len(lines)) / (height + taken))
        return figure

    def _legend(self, figure: Figure, columns: int, top: float) -> None:
        from matplotlib.lines import Line2D

        handles = [
            Line2D([], [], **known.line, **known.point, label=f"{rank}  {known.label}")
            for known, rank in zip(self.looks, self.ranks, strict=True)
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
