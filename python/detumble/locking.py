"""One process at a time in a folder."""

from __future__ import annotations

import os
import stat
from contextlib import suppress
from typing import TYPE_CHECKING

from detumble.errors import RequestError
from detumble.writing import reason

if TYPE_CHECKING:
    from pathlib import Path


_MOST_DIGITS = 20
"""Of the number of a process, which is all that a lock file holds."""
_ATTEMPTS = 10
"""To lock a file that other processes remove meanwhile."""


class Lock:
    """Held by the one process that works in a folder; the system frees it however that process ends.

    Args:
        folder: that is worked in.
        doing: what that process does, for the message of a second process: `flying this campaign`.

    Raises:
        RequestError: another process holds it, or the folder is not writable.
    """

    def __init__(self, folder: Path, doing: str) -> None:
        self._path = folder / ".lock"
        self._made = not self._path.exists()
        for _ in range(_ATTEMPTS):
            descriptor = self._opened()
            owner = self._file.read(_MOST_DIGITS + 1)
            if owner and not (owner.isdigit() and len(owner) <= _MOST_DIGITS):
                self._file.close()
                raise RequestError(f"{self._path}: not written by detumble, and would be replaced; move it away")
            if not locked(descriptor):
                self._file.close()
                raise RequestError(f"{folder}: another process ({owner.decode()}) is {doing}")
            with suppress(FileNotFoundError):
                if os.path.samestat(os.fstat(descriptor), self._path.lstat()):
                    break
            self._file.close()  # another process has just removed this file
        else:
            raise RequestError(f"{folder}: other processes are {doing}")
        with suppress(OSError):
            self._file.seek(0)
            self._file.truncate(0)
            self._file.write(str(os.getpid()).encode())

    def _opened(self) -> int:
        flags = os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
        try:
            descriptor = os.open(self._path, flags, 0o666)
        except OSError as error:
            raise RequestError(f"{self._path}: cannot be written: {reason(error)}") from None
        self._file = os.fdopen(descriptor, "r+b", buffering=0)
        if not stat.S_ISREG(os.fstat(descriptor).st_mode):
            self._file.close()
            raise RequestError(f"{self._path}: cannot be written: is no regular file")
        return descriptor

    def close(self, *, forget: bool = False) -> None:
        """Release the lock.

        Args:
            forget: remove the file if it was made here: nothing was done in the folder.
        """
        if forget and self._made:
            with suppress(OSError):
                self._path.unlink()
        self._file.close()


def locked(descriptor: int) -> bool:
    """Try to lock; where the system or file system has no locks, it succeeds without one."""
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
