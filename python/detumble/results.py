"""Folders of results: only files that were written there before, and not changed since, are replaced.

`written.json` keeps a hash of every file that was written. It is written ahead of the file itself, so that a process that is
killed in between leaves no file that is missing in it.
"""

from __future__ import annotations

import hashlib
import json
import os
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from pathlib import Path
from typing import TYPE_CHECKING

from detumble.errors import RequestError
from detumble.locking import locked
from detumble.writing import before_replacing, output_folder, read_bytes, reason

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

WRITTEN = "written.json"
"""Name of the file that keeps the hashes."""
_WHAT = "files that detumble wrote here, by the SHA-256 of their content"
_MOST_BYTES = 2**24
"""Of that file."""


@contextmanager
def results_folder(
    folder: Path | None, files: Sequence[str], source: str | os.PathLike[str] = "", *, stale: Sequence[str] = ()
) -> Iterator[None]:
    """Work in a folder of results: it is created and locked, and files of others in it are not changed.

    Every file that is written by `detumble.writing` meanwhile, in the folder or beneath, is entered in `written.json`.

    Args:
        folder: of the results; None asks for none.
        files: patterns of what will be written, relative to the folder: refused now rather than after long work.
        source: file that the work reads; it is not replaced either.
        stale: patterns likewise: what was written here before, and is not written now, is removed when the work is done.

    Raises:
        RequestError: the folder is not writable, a file of that name stands there that was not written here or was changed
            since, or another process writes here.
    """
    if folder is None:
        yield
        return
    with output_folder(folder):
        refuse_foreign(folder, files, source)
        if _covering(folder) is not None:
            yield
            return
        with _exclusively(folder):
            written = _Written(folder)
            tokens = _open.set(written), before_replacing.set(written.enter)
            try:
                yield
                written.remove_stale(stale)
            finally:
                _open.reset(tokens[0])
                before_replacing.reset(tokens[1])


_open: ContextVar[_Written | None] = ContextVar("_open", default=None)
"""Of the folder that is being worked in."""


def _covering(folder: Path) -> _Written | None:
    """Give the record that is open, if the folder is its own or lies within."""
    written = _open.get()
    return written if written is not None and folder.resolve().is_relative_to(written.folder) else None


def refuse_foreign(folder: Path, files: Sequence[str], source: str | os.PathLike[str] = "") -> None:
    """Make sure that files of a folder may be replaced.

    Args:
        folder: need not exist.
        files: patterns, relative to the folder.
        source: file that the work reads.

    Raises:
        RequestError: naming the files that must stay.
    """
    there = sorted({path for pattern in files for path in folder.glob(pattern)})
    with suppress(OSError, ValueError):
        for path in there:
            if source and path.samefile(source):
                raise RequestError(f"{path}: is read here, and would be replaced; choose another folder")
    written = _covering(folder) or _Written(folder)
    foreign = [path for path in there if not written.knows(path)]
    if foreign:
        named = ", ".join(path.relative_to(folder).as_posix() for path in foreign[:3])
        more = f" and {len(foreign) - 3} more" if len(foreign) > 3 else ""
        raise RequestError(f"{folder}: {_FOREIGN.format(named + more)}")


_FOREIGN = "{}: not written by detumble, or changed since, and would be replaced; move it away or choose another folder"


class _Written:
    """Record of the files that were written into a folder and beneath it.

    Args:
        folder: the folder.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder.resolve()
        self._hashes: dict[str, list[str]] = {}
        self._written_now: set[str] = set()
        path = folder / WRITTEN
        if not path.exists() and not path.is_symlink():
            return
        try:
            found = json.loads(read_bytes(path, _MOST_BYTES))
            if path.is_symlink() or found["what"] != _WHAT:
                raise ValueError
            self._hashes = {str(name): list(map(str, hashes)) for name, hashes in found["files"].items()}
        except (OSError, ValueError, TypeError, KeyError, AttributeError, RecursionError):
            raise RequestError(f"{folder}: {_FOREIGN.format(WRITTEN)}") from None

    def knows(self, path: Path) -> bool:
        """Tell whether a file is as it was written here."""
        if not path.is_file():
            return False
        try:
            found = _hash(path)
        except OSError:
            return False
        return found in self._hashes.get(self._name(path), ()) or any(
            found in other._hashes.get(other._name(path), ()) for other in self._others(path)
        )

    def _others(self, path: Path) -> Iterator[_Written]:
        """Open the records of other folders that a file lies in: pictures of a comparison may have been written separately."""
        for folder in path.resolve().parents:
            if folder != self.folder and (folder / WRITTEN).is_file():
                with suppress(RequestError):
                    yield _Written(folder)

    def enter(self, path: Path, finished: Path) -> None:
        """Enter a file that is about to be put in place.

        Raises:
            RequestError: another file stands there, or `written.json` cannot be written.
        """
        if not path.resolve().is_relative_to(self.folder):
            return
        new = _hash(finished)
        old = [_hash(path)] if path.is_file() else []
        if old and old != [new] and not self.knows(path):
            raise RequestError(f"{self.folder}: {_FOREIGN.format(path.name)}")
        self._hashes[self._name(path)] = sorted({*old, new})
        self._written_now.add(self._name(path))
        temporary = self.folder / f".{WRITTEN}.{os.getpid()}"
        try:
            temporary.write_text(json.dumps({"what": _WHAT, "files": self._hashes}, indent=1) + "\n", encoding="utf-8")
            temporary.replace(self.folder / WRITTEN)
        finally:
            with suppress(OSError):
                temporary.unlink()

    def remove_stale(self, patterns: Sequence[str]) -> None:
        """Remove what was written here before by these patterns, and not now."""
        for path in {path for pattern in patterns for path in self.folder.glob(pattern)}:
            if self._name(path) not in self._written_now and self.knows(path):
                try:
                    path.unlink()
                except OSError as error:
                    raise RequestError(f"{path}: cannot be removed: {reason(error)}") from None

    def _name(self, path: Path) -> str:
        found = path.parent.resolve() / path.name
        return found.relative_to(self.folder).as_posix() if found.is_relative_to(self.folder) else str(found)


def _hash(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


@contextmanager
def _exclusively(folder: Path) -> Iterator[None]:
    """Keep other processes from writing results here; where folders cannot be locked, they are not kept out."""
    try:
        descriptor = os.open(folder, os.O_RDONLY)
    except PermissionError:  # Windows opens no folder
        yield
        return
    except OSError as error:
        raise RequestError(f"{folder}: cannot be used as an output folder: {reason(error)}") from None
    try:
        if not locked(descriptor):
            raise RequestError(f"{folder}: another process is writing results here")
        yield
    finally:
        os.close(descriptor)
