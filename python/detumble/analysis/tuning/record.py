"""The record of a search: every evaluation in order, so that a search that was stopped continues to the same result.

A file of JSON lines. The first says what is searched; each further one holds the candidates that were flown together, as points
of the unit cube, and their outcomes. A search that continues asks for the same points again, takes the recorded outcomes in
that order, and flies the rest. Each line reaches the disk before the next is begun; an incomplete last line, which a killed
process leaves, is cut off. Numbers are written with as many digits as read back to the same bits.
"""

from __future__ import annotations

import json
import os
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from detumble.checking import flag
from detumble.errors import RequestError
from detumble.locking import Lock
from detumble.scenario.wording import shown
from detumble.writing import named_file, read_bytes, reason

if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import TracebackType
    from typing import Self

Array = NDArray[np.float64]
FORMAT = 1
_MOST_BYTES = 2**33
_SAME = 1e-12
"""Tolerance between recorded points and those asked for again: last bits differ between machines."""


class Record:
    """Evaluations of a search, those of an earlier process first; in `with`, while the folder is locked.

    Args:
        path: the file; None keeps nothing.
        header: what is searched, as JSON takes it.
        resume: continue what the file holds.
        budget: evaluations that are asked for.

    Raises:
        RequestError: the file cannot be used, holds another search, holds this one and `resume` is not set, or holds more of it
            than is asked for; or another process writes in its folder.
    """

    def __init__(
        self, path: str | os.PathLike[str] | None, header: Mapping[str, Any], *, resume: bool = False, budget: int = 0
    ) -> None:
        self.path = named_file(path).absolute() if path is not None else None
        self._budget = budget
        resume = flag("resume", resume)
        self._known: list[tuple[list[float], list[float]]] = []
        self._next = 0
        self._lock: Lock | None = None
        if self.path is None:
            return
        self._lock = Lock(self.path.parent, "tuning here")
        try:
            self._open(self.path, json.loads(json.dumps({"format": FORMAT, **header})), resume)
        except BaseException:
            self._lock.close(forget=True)
            raise

    def _open(self, path: Path, header: dict[str, Any], resume: bool) -> None:
        try:
            content = read_bytes(path, _MOST_BYTES) if path.exists() else b""
        except ValueError as error:
            raise RequestError(f"{path}: {error}") from None
        except OSError as error:
            raise RequestError(f"{path}: cannot be read: {reason(error)}") from None
        whole = content[: content.rfind(b"\n") + 1]
        if not whole and not (json.dumps(header).encode() + b"\n").startswith(content):
            raise RequestError(f"{path}: is no record of a search, and would be replaced; move it away")
        lines = [_parsed(path, number, line) for number, line in enumerate(whole.splitlines(), 1)]
        if lines:
            differing = _differences(lines[0], header)
            if differing:
                raise RequestError(f"{path}: holds another search ({differing})")
            if not resume:
                raise RequestError(f"{path}: holds this search already; --resume continues it")
            recorded = sum(len(line["points"]) for line in lines[1:])
            if recorded > self._budget > 0:
                raise RequestError(
                    f"{path}: holds {recorded} candidates, more than the budget of {self._budget}: what they found would be lost"
                )
        try:
            self._file = path.open("r+b" if path.exists() else "w+b")
            self._file.truncate(len(whole))
            self._file.seek(0, os.SEEK_END)
        except OSError as error:
            raise RequestError(f"{path}: cannot be written: {reason(error)}") from None
        if not lines:
            self._write(header)
        for line in lines[1:]:
            self._known += zip(line["points"], line["outcomes"], strict=True)

    def known(self, points: Array) -> Array:
        """Give the recorded outcomes of the next points that the search asks for.

        Args:
            points: (k, n).

        Returns:
            Outcomes (j, m) of the first j of them, j from 0 to k.

        Raises:
            RequestError: other points were recorded here.
        """
        found = self._known[self._next : self._next + len(points)]
        for point, (recorded, _) in zip(points, found, strict=False):
            if len(point) != len(recorded) or np.any(np.abs(point - recorded) > _SAME):
                raise RequestError(
                    f"{self.path}: recorded by a search with other candidates or other versions of libraries: begin anew"
                )
        self._next += len(found)
        return np.array([outcome for _, outcome in found], float)

    def append(self, points: Array, outcomes: Array) -> None:
        """Add points (k, n) that were flown, and their outcomes (k, m).

        Raises:
            RequestError: they cannot be written.
        """
        if self.path is not None and len(points):
            self._write({"points": points.tolist(), "outcomes": outcomes.tolist()})

    def _write(self, line: Mapping[str, Any]) -> None:
        try:
            self._file.write(json.dumps(line, allow_nan=False).encode() + b"\n")
            self._file.flush()
            os.fsync(self._file.fileno())
        except OSError as error:
            raise RequestError(f"{self.path}: cannot be written: {reason(error)}") from None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._lock:
            try:
                with suppress(OSError):  # a full disk was reported by `_write`
                    self._file.close()
            finally:
                self._lock.close()


def _parsed(path: Path, number: int, line: bytes) -> dict[str, Any]:
    try:
        read: dict[str, Any] = json.loads(line)
        if not isinstance(read, dict):
            raise ValueError("is no record of a search")
        if number > 1:
            points, outcomes = (np.array(read[name], float) for name in ("points", "outcomes"))
            if points.ndim != 2 or outcomes.ndim != 2 or len(points) != len(outcomes):
                raise ValueError("is no list of candidates and their outcomes")
            if not (np.isfinite(points).all() and np.isfinite(outcomes).all()):
                raise ValueError("holds what is no number")
    except (ValueError, KeyError, TypeError, RecursionError, OverflowError) as error:
        raise RequestError(f"{path}: line {number}: broken: {error}") from None
    return read


def _differences(there: Mapping[str, Any], asked: Mapping[str, Any]) -> str:
    """List the entries in which two headers differ."""
    return "; ".join(
        f"{name} {shown(there.get(name))} there, {shown(asked.get(name))} asked for"
        for name in {**there, **asked}
        if there.get(name) != asked.get(name)
    )
