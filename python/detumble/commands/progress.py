"""How long work gets on, on the terminal: share, rate, time left, what is known so far. Silent where nobody looks."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from detumble.commands.printing import remark

if TYPE_CHECKING:
    from pathlib import Path
    from types import TracebackType
    from typing import Self

    from detumble.campaigns.statistics.running import Statistics


class Line:
    """A line at the bottom of the terminal, in `with`; on Ctrl-C it says how to go on.

    Args:
        folder: that keeps the work; None where nothing is kept.
    """

    def __init__(self, folder: Path | None) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
        from rich.progress import Progress as Bar

        self._folder = folder
        self._begun = False
        self._bar = Bar(
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[rate]}"),
            TimeRemainingColumn(),
            TextColumn("{task.fields[found]}"),
            console=Console(stderr=True),
            transient=True,
            disable=not sys.stderr.isatty(),
        )

    def begin(self, total: int) -> None:
        """Draw the empty bar."""
        import time

        self._begun = True
        self._began = time.perf_counter()
        self._task = self._bar.add_task("", total=total, rate="", found="")

    def draw(self, done: int, fresh: int, unit: str, found: str) -> None:
        """Draw the bar anew.

        Args:
            done: of the total.
            fresh: of these, how many were done since the bar was begun.
            unit: what is counted, for the rate.
            found: what is known so far.
        """
        import time

        rate = f"{fresh / max(1e-9, time.perf_counter() - self._began):.0f} {unit}/s" if fresh else ""
        self._bar.update(self._task, completed=done, rate=rate, found=found)

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
        if self._begun and self._folder and isinstance(error, SystemExit | KeyboardInterrupt):
            remark(f"stopped; the same command with --resume continues it: {self._folder}")


class Progress(Line):
    """Of a campaign."""

    def now(self, done: int, flown: int, statistics: Statistics) -> None:
        """Draw the bar anew."""
        success = ""
        if statistics.runs:
            estimate = statistics.success
            success = f"success {100 * estimate.share:.2f} ± {100 * estimate.half_width:.2f} %"
        self.draw(done, flown, "runs", success)


class SearchProgress(Line):
    """Of a search for gains.

    Args:
        folder: that keeps the record; None where there is none.
        unit: of the cost.
    """

    def __init__(self, folder: Path | None, unit: str) -> None:
        super().__init__(folder)
        self._unit = unit

    def now(self, done: int, cost: float, share: float) -> None:
        """Draw the bar anew."""
        self.draw(done, done, "candidates", f"best {cost:.4g} {self._unit}, success {100 * share:.1f} %")
