"""Pictures of a comparison: when each entry captures, every pair of entries, and how success follows changes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from detumble.results import results_folder
from detumble.show.compare.changes import SweepCurves, plot_changes
from detumble.show.compare.frame import Sheet, looks_of
from detumble.show.compare.pairs import Matrix, Pairs, plot_pairs
from detumble.show.compare.times import CaptureTimes, plot_times
from detumble.show.style import save, styled

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

__all__ = ["CaptureTimes", "Matrix", "Pairs", "Sheet", "SweepCurves", "looks_of", "write_pictures"]


def write_pictures(
    folder: Path, sheet: Sheet, times: CaptureTimes, pairs: Pairs, sweeps: Sequence[SweepCurves]
) -> list[Path]:
    """Write all pictures into a folder; older ones are replaced.

    Args:
        folder: created if it is not there.
        sheet: headline and entries of all pictures.
        times: of `capture-times.png`.
        pairs: of `pairs.png`.
        sweeps: of `robustness.png`; without any it is not written.

    Returns:
        The files.

    Raises:
        RequestError: they cannot be written.
    """
    names = ["capture-times.png", "pairs.png", *(["robustness.png"] if sweeps else [])]
    with results_folder(folder, names), styled():
        figures = [plot_times(sheet, times), plot_pairs(sheet, pairs)]
        figures += [plot_changes(sheet, sweeps)] if sweeps else []
        return [save(figure, [folder / name])[0] for name, figure in zip(names, figures, strict=True)]
