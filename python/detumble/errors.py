"""Errors of requests that cannot be carried out: a user's mistake ends in one of these, never in a traceback."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable


class RequestError(Exception):
    """A request that cannot be carried out as it stands; the message says what is wrong and what would do."""


@dataclass(frozen=True)
class Fault:
    """One thing that is wrong with a scenario.

    Attributes:
        path: the field, dotted as in TOML: `chaser.inertia`.
        text: what is wrong, and what is allowed.
        value: what was met, with its unit; empty where nothing was.
    """

    path: str
    text: str
    value: str = ""


class ScenarioError(RequestError, ValueError):
    """A scenario that cannot be flown. One message lists every fault.

    Attributes:
        source: the file, or the built-in name, or what else the scenario came from.
        faults: the faults in the order of the file; empty where the file itself could not be read.
    """

    def __init__(self, source: str, faults: Iterable[Fault] = (), problem: str = "") -> None:
        self.source = source
        self.faults = tuple(faults)
        self.problem = problem
        super().__init__(self._message())

    def __reduce__(self) -> tuple[type[ScenarioError], tuple[str, tuple[Fault, ...], str], dict[str, object]]:
        """Let a copy, also one from another process, be made of the parts and not of the message; notes stay."""
        return type(self), (self.source, self.faults, self.problem), self.__dict__

    def _message(self) -> str:
        if not self.faults:
            return f"{self.source}: {self.problem}"
        count = len(self.faults)
        width = max(len(fault.path) for fault in self.faults)
        lines = [f"{self.source}: {count} problem{'s' if count > 1 else ''}"]
        for fault in self.faults:
            met = f"{fault.value}: " if fault.value else ""
            lines.append(f"  {fault.path.ljust(width)}  {met}{fault.text}")
        return "\n".join(lines)
