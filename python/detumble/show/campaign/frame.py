"""Common parts of the pictures of a campaign: the page with its headline, and text of counts and shares."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from detumble.show.style import heading, look, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from detumble.intervals import Proportion

QUIET = "#404040"
"""Colour of remarks."""
PLAIN = "#8C8C8C"
"""Colour of bars that belong to no law."""

_TITLE, _LINE = 0.32, 0.21
"""Height of the title and of each line below it, inches."""


@dataclass(frozen=True)
class Caption:
    """What was flown, as it stands above a picture.

    Attributes:
        scenario: its title.
        law: name of the law; empty where a picture shows several.
        runs: of the campaign, of each law's where there are several.
        seed: of the campaign.
    """

    scenario: str
    law: str
    runs: int
    seed: int

    @property
    def colour(self) -> str:
        """Colour of the law."""
        return look(self.law).colour

    def line(self) -> str:
        """Write all but the title in one line."""
        runs = f"{counted(self.runs, 'run')}{'' if self.law else ' each'}"
        return "   ·   ".join([*([look(self.law).label] if self.law else []), runs, f"seed {self.seed}"])


def page(caption: Caption, width: float, height: float, *notes: str, room: float = 0.0) -> Figure:
    """Make a figure with its headline; panels find their places below it.

    Args:
        caption: title and first line.
        width: inches.
        height: inches, the headline included.
        notes: further lines, one each.
        room: left free below them, inches.
    """
    figure = new_figure(width, height)
    figure.suptitle(heading(caption.scenario, int(9.5 * width)), y=1.0 - 0.5 * _TITLE / height, parse_math=False)
    for place, text in enumerate((caption.line(), *notes)):
        at = 1.0 - (_TITLE + (place + 0.4) * _LINE) / height
        size = 9.5 if place == 0 else 8.5
        figure.text(0.5, at, text, ha="center", va="center", fontsize=size, color=QUIET, parse_math=False)
    taken = (below_headline(len(notes)) + room) / height
    engine = figure.get_layout_engine()
    assert engine is not None
    engine.set(rect=(0.0, 0.0, 1.0, 1.0 - taken))  # type: ignore[call-arg]  # of the constrained one
    return figure


def below_headline(notes: int) -> float:
    """Give the height that a headline with so many notes takes, inches."""
    return _TITLE + (1 + notes) * _LINE + 0.05


def show_message(axes: Axes, text: str) -> None:
    """Write into an empty panel why it is empty, without axes."""
    axes.set_axis_off()
    axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center", va="center", color=QUIET, wrap=True)


def counted(number: int, what: str = "") -> str:
    """Write a count in groups of three digits, with what was counted: 1 run, 16 384 runs."""
    digits = f"{number:,}".replace(",", "\u2009")
    return f"{digits} {what}{'' if number == 1 else 's'}" if what else digits


def percent(found: Proportion) -> str:
    """Write a share in percent with its interval, with the digits that the interval justifies: 99.21 % (98.98–99.40).

    Where none or all of the runs have the property, the interval is one-sided: 0 % (below 0.037).
    """
    half = 100.0 * found.half_width
    if found.runs and found.count == 0:
        return f"0 % (below {100.0 * found.high:.2g})"
    if found.runs and found.count == found.runs:
        return f"100 % (above {100.0 * found.low:.{max(1 - math.floor(math.log10(2.0 * half)), 1)}f})"
    digits = min(max(1 - math.floor(math.log10(half)), 0), 9) if half > 0.0 else 0
    share = "–" if math.isnan(found.share) else f"{100.0 * found.share:.{digits}f} %"
    return f"{share} ({100.0 * found.low:.{digits}f}–{100.0 * found.high:.{digits}f})"
