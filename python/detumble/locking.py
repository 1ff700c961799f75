"""One process at a time in a folder."""

from __future__ import annotations

import os
from contextlib import suppress
from typing import TYPE_CHECKING

from detumble.errors import RequestError
from detumble.writing import reason

if TYPE_CHECKING:
    from pathlib import Path


class Lock:
    """Held by the one process that works in a folder; the system frees it however that process ends.

    Args:
        folder: that is worked in.
        doing: what that process does, for whoever comes second: `flying this campaign`.

    Raises:
        RequestError: another process holds it, or the folder takes no files.
    """

    def __init__(self, folder: Path, doing: str) -> None:
        path = folder / ".lock"
        try:
            self._file = path.open("a+b", buffering=0)
        except OSError as error:
            raise RequestError(f"{path}: cannot be written: {reason(error)}") from None
        if not locked(self._file.fileno()):
            self._file.seek(0)
            owner = self._file.read().decode(errors="replace")
            self._file.close()
            raise RequestError(f"{folder}: another process ({owner}) is {doing}")
        with suppress(OSError):
            self._file.truncate(0)
            self._file.write(str(os.getpid()).encode())

    def close(self) -> None:
        """Let others in."""
        self._file.close()


def locked(descriptor: int) -> bool:
    """Try to lock; where system or file system know no locks, nothing is locked, and nobody is kept out."""
    try:
        import fcntl
    except ImportError:
        return True
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        pass
    return True
