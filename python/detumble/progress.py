"""Progress of long work: campaigns, searches for gains, comparisons, bounds of many runs. One protocol serves them all."""

from __future__ import annotations

from typing import Any


class Watcher:
    """Follows long work. Every method does nothing: a subclass overrides those it needs.

    An exception that a method raises ends the work.
    """

    def stage(self, title: str) -> None:
        """Begin a part of work that has several; the next `begin` belongs to it."""

    def begin(self, total: int) -> None:
        """Begin to count: runs of a campaign, candidates of a search.

        Args:
            total: number of units that will be done.
        """

    def now(self, done: int, fresh: int | None = None, found: Any = None) -> None:
        """Report what is done.

        Args:
            done: units, of the total.
            fresh: of these, how many were done since `begin`; the others were read from a folder. None: all of them.
            found: result so far: `Statistics` of a campaign, `Generation` of a search, None of other work.
        """

    def remark(self, text: str) -> None:
        """Report a remark for the user."""
