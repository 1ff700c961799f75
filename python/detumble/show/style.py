"""Looks of pictures: one colour, line and marker for each law everywhere, and the settings that all figures share.

Colours are those of Okabe & Ito (2008), which stay apart for every common colour blindness; laws also differ by their
dashes and markers, for print in grey. Settings hold within `styled()` only, and figures are made without pyplot.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from detumble import matplotlib_setup
from detumble.matplotlib_setup import load_matplotlib
from detumble.scenario.laws import APPEARANCES
from detumble.scenario.laws.base import Dashes as Dashes
from detumble.writing import whole_file

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DPI = 200


@dataclass(frozen=True)
class Look:
    """Appearance of a law or an axis in every figure.

    Attributes:
        label: its name in legends.
        colour: hexadecimal.
        dashes: line style as matplotlib takes it.
        marker: where a point stands for it.
        width: of lines, points.
    """

    label: str
    colour: str
    dashes: Dashes
    marker: str
    width: float = 1.5


LOOKS = {name: Look(law.title, law.colour, law.dashes, law.marker, law.width) for name, law in APPEARANCES.items()}
"""By law."""

AXIS_LOOKS = (
    Look("x", "#56B4E9", "-", ""),
    Look("y", "#E69F00", (0, (5.0, 1.2)), ""),
    Look("z", "#5B4A1F", (0, (5.0, 1.2, 1.2, 1.2)), ""),
)
"""By component of a vector: colours that no law has."""

LIMIT: dict[str, Any] = {"color": "#404040", "linewidth": 0.9, "linestyle": (0, (3.0, 2.0)), "zorder": 1.5}
"""Lines of limits and thresholds."""

_SETTINGS = {
    "font.size": 9.0,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.titlesize": 9.0,
    "axes.titlelocation": "left",
    "axes.labelsize": 9.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-4, 5),
    "axes.xmargin": 0.0,
    "figure.titlesize": 11.0,
    "figure.titleweight": "bold",
    "grid.color": "#D8D8D8",
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "legend.fontsize": 8.5,
    "legend.handlelength": 3.2,
    "lines.linewidth": 1.5,
    "path.simplify_threshold": 0.2,
    "svg.fonttype": "path",  # looks the same where the font is missing
    "svg.hashsalt": "detumble",  # the same picture gives the same bytes
}


def look(law: str) -> Look:
    """Give the look of a law by its name; one that is not listed looks like open loop, under its own name."""
    known = LOOKS.get(law)
    return known or Look(law, LOOKS["none"].colour, LOOKS["none"].dashes, LOOKS["none"].marker)


@contextmanager
def styled() -> Iterator[None]:
    """Plot with detumble's settings, whatever the user's own are, which are restored afterwards."""
    load_matplotlib()
    import matplotlib.style

    with warnings.catch_warnings(), matplotlib.style.context(["default", _SETTINGS]):
        if matplotlib_setup.own_process:  # a library's warnings about a picture do not help a user of the command line
            warnings.simplefilter("ignore")
        yield


def new_figure(width: float, height: float, layout: Literal["constrained"] | None = "constrained") -> Figure:
    """Make an empty figure.

    Args:
        width, height: inches.
        layout: method that finds the margins; None where they are set.
    """
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), dpi=DPI, layout=layout)


def heading(text: str, width: int = 100) -> str:
    """Bring text from a scenario into the shape of a title: one line, not too long."""
    line = " ".join(text.split())
    return line if len(line) <= width else line[: width - 1].rstrip() + "…"


def shortened(name: str, width: int) -> str:
    """Leave out the middle of a long name: the end often says how it differs from others."""
    return name if len(name) <= width else f"{name[: width // 3]}…{name[-(width - width // 3 - 1) :]}"


def write_figure(plot: Callable[[], Figure], path: Path) -> Path:
    """Plot a figure with detumble's settings and write it.

    Args:
        plot: makes the figure, in memory.
        path: the file, ending in .png or .svg; an older one is replaced.

    Returns:
        The path.

    Raises:
        RequestError: it cannot be written.
    """
    with styled():
        return save(plot(), [path])[0]


def save(figure: Figure, paths: Sequence[Path]) -> list[Path]:
    """Write a figure to each path, each file whole or not at all; call it within `styled()`.

    Args:
        figure: what to write. Its layout is settled by the first file and kept for the others.
        paths: ending in .png or .svg.

    Returns:
        The paths.

    Raises:
        RequestError: a file cannot be written.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    for path in paths:
        with whole_file(path) as temporary, warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="Glyph .* missing from")  # a title in a script without font here
            # straight to the canvas: `savefig` would render everything twice
            if path.suffix == ".svg":
                canvas: Any = FigureCanvasSVG(figure)
                canvas.print_svg(temporary, metadata={"Date": None})
            else:
                canvas = FigureCanvasAgg(figure)
                canvas.print_png(temporary, pil_kwargs={"compress_level": 4})
        figure.set_layout_engine("none")
    return list(paths)
