"""Progress on the terminal: share, rate, time left, result so far. Nothing is shown where standard error is no terminal."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING, Any

from detumble.commands.printing import remark
from detumble.progress import Watcher

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path
    from types import TracebackType
    from typing import Self


class Line(Watcher):
    """A line at the bottom of the terminal, in `with`; after Ctrl-C it says how to continue.

    Args:
        folder: that keeps the work for --resume; None where nothing is kept.
        unit: what is counted, for the rate; empty shows no rate.
        describe: gives the result so far, the argument `found` of `Watcher.now`, in words.
    """

    def __init__(self, folder: Path | None, unit: str = "", describe: Callable[[Any], str] | None = None) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

        self._folder, self._unit, self._describe = folder, unit, describe
        self._title = ""
        self._began: float | None = None
        self._bar = Progress(
            TextColumn("{task.description}", markup=False),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[rate]}"),
            TimeRemainingColumn(),
            TextColumn("{task.fields[found]}"),
            console=Console(stderr=True),
            transient=True,
            disable=not sys.stderr.isatty(),
        )
        self._task = self._bar.add_task("", total=None, rate="", found="")

    def stage(self, title: str) -> None:
        """Name the part of the work that begins."""
        self._title = title

    def begin(self, total: int) -> None:
        """Show the empty bar."""
        self._began = time.perf_counter()
        self._bar.reset(self._task, total=total, description=self._title, rate="", found="")

    def now(self, done: int, fresh: int | None = None, found: Any = None) -> None:
        """Update the bar."""
        if self._bar.disable or self._began is None:
            return
        fresh = done if fresh is None else fresh
        rate = (
            f"{fresh / max(1e-9, time.perf_counter() - self._began):.0f} {self._unit}/s" if fresh and self._unit else ""
        )
        said = self._describe(found) if self._describe and found is not None else ""
        self._bar.update(self._task, completed=done, rate=rate, found=said)

    def remark(self, text: str) -> None:
        """Print a line above the bar."""
        if self._bar.disable:
            remark(text)
        else:
            self._bar.console.print(text, highlight=False, markup=False)

    def __enter__(self) -> Self:
        self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.stop()
        if self._began is not None and self._folder and isinstance(error, SystemExit | KeyboardInterrupt):
            remark(f"stopped; the same command with --resume continues it: {self._folder}")
