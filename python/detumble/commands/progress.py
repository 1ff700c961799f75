"""How a campaign gets on, on the terminal: share, rate, time left, success so far. Silent where nobody looks."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from detumble.commands.printing import remark

if TYPE_CHECKING:
    from pathlib import Path
    from types import TracebackType
    from typing import Self

    from detumble.campaigns.statistics import Statistics


class Progress:
    """A line at the bottom of the terminal, in `with`; on Ctrl-C it says how to go on.

    Args:
        folder: of the campaign.
    """

    def __init__(self, folder: Path) -> None:
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
            TextColumn("{task.fields[success]}"),
            console=Console(stderr=True),
            transient=True,
            disable=not sys.stderr.isatty(),
        )

    def begin(self, runs: int) -> None:
        """Draw the empty bar."""
        import time

        self._begun = True
        self._began = time.perf_counter()
        self._task = self._bar.add_task("", total=runs, rate="", success="")

    def now(self, done: int, flown: int, statistics: Statistics) -> None:
        """Draw the bar anew."""
        import time

        rate = f"{flown / max(1e-9, time.perf_counter() - self._began):.0f} runs/s" if flown else ""
        success = ""
        if statistics.runs:
            estimate = statistics.success
            success = f"success {100 * estimate.share:.2f} ± {100 * estimate.half_width:.2f} %"
        self._bar.update(self._task, completed=done, rate=rate, success=success)

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
        if self._begun and isinstance(error, SystemExit | KeyboardInterrupt):
            remark(f"stopped; the same command with --resume continues it: {self._folder}")
