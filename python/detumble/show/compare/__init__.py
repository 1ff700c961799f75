"""Pictures of a comparison: when each entry captures, how far from the bound, who minds what, and every pair."""

from __future__ import annotations

from typing import TYPE_CHECKING

from detumble.results import results_folder
from detumble.show.compare.changes import draw_changes
from detumble.show.compare.pairs import draw_pairs
from detumble.show.compare.times import draw_times
from detumble.show.style import save, styled

if TYPE_CHECKING:
    from pathlib import Path

    from detumble.analysis.comparing.result import Comparison

__all__ = ["draw"]


def draw(comparison: Comparison, folder: Path) -> list[Path]:
    """Write all pictures into a folder; older ones are replaced.

    Args:
        comparison: what is shown.
        folder: made if it is not there.

    Returns:
        The files.

    Raises:
        RequestError: they cannot be written.
    """
    pictures = {"capture-times": draw_times, "pairs": draw_pairs}
    if comparison.plan.robust:
        pictures["robustness"] = draw_changes
    with results_folder(folder, [f"{name}.png" for name in pictures]), styled():
        return [save(picture(comparison), [folder / f"{name}.png"])[0] for name, picture in pictures.items()]
