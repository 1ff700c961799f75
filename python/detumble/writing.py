"""Files that are written whole or not at all, checks of output folders, and reading with a size limit."""

from __future__ import annotations

import os
import re
import stat
import threading
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from fnmatch import fnmatch
from pathlib import Path
from typing import TYPE_CHECKING

from detumble.errors import RequestError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

before_replacing: ContextVar[Callable[[Path, Path], None] | None] = ContextVar("before_replacing", default=None)
"""Called with a file's path and its finished content (another path) before it is put in place; may refuse."""

_LONGEST_STEM = 40
"""Characters of a file's name that the temporary one keeps: both have to fit what a file system allows."""


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Give a temporary path beside the file; put it in place at the end, or remove it if anything failed.

    A symbolic link is followed and stays; a file that is replaced keeps its mode and, where the system allows it, its owner. Of
    several hard links only this one leads to the new file.

    Args:
        path: of the finished file.

    Yields:
        The path to write to, with the same ending.

    Raises:
        RequestError: the file cannot be written, or the path is no regular file.
    """
    try:
        before = _regular(path)
        place = Path(os.path.realpath(path))
        own = str(os.getpid())
        if threading.current_thread() is not threading.main_thread():
            own += f"-{threading.get_ident()}"
        temporary = place.with_name(f".{place.stem[:_LONGEST_STEM]}.{own}{place.suffix[:_LONGEST_STEM]}")
    except ValueError:
        raise RequestError(f"{str(path)!r}: is no file name") from None
    except OSError as error:
        raise RequestError(f"{path}: cannot be written: {reason(error)}") from None
    try:
        yield temporary
        if before is not None:
            _keep_mode(temporary, before)
        if (refuse := before_replacing.get()) is not None:
            refuse(place, temporary)
        temporary.replace(place)
    except OSError as error:
        raise RequestError(f"{path}: cannot be written: {reason(error)}") from None
    finally:
        with suppress(OSError):
            temporary.unlink()


def leftovers(folder: Path, pattern: str) -> list[Path]:
    """Find temporary files of `whole_file` in a folder, whose writers may have been killed.

    Args:
        folder: to look in; none of those beneath.
        pattern: of the names that the finished files would have had.
    """
    found = []
    for path in folder.glob(".*"):
        parts = re.fullmatch(r"\.(.+)\.\d+(-\d+)?(\.[^.]*)?", path.name)
        if parts and fnmatch(parts[1] + (parts[3] or ""), pattern):
            found.append(path)
    return found


def _regular(path: Path) -> os.stat_result | None:
    """Give what is known of a file that stands there; None where there is none.

    Raises:
        RequestError: it is a folder, a device, a pipe, or has no name; or the path leads to an open file of a process.
    """
    if not path.name:
        raise RequestError(f'"{path}": names no file')
    hop = path
    for _ in range(40):  # as many links as systems follow
        if (place := os.path.realpath(hop.parent)) == "/dev" or f"{place}/".startswith("/proc/"):
            raise RequestError(
                f"{path}: cannot be written: is a device or an open file; only a regular file is replaced"
            )
        if not hop.is_symlink():
            break
        hop = hop.parent / hop.readlink()
    try:
        found = path.stat()
    except FileNotFoundError:
        return None
    if not stat.S_ISREG(found.st_mode):
        raise RequestError(f"{path}: cannot be written: {_kind(found.st_mode)}; only a regular file is replaced")
    return found


def _kind(mode: int) -> str:
    kinds = {stat.S_IFDIR: "is a folder", stat.S_IFIFO: "is a pipe", stat.S_IFSOCK: "is a socket"}
    return kinds.get(stat.S_IFMT(mode), "is a device")


def _keep_mode(temporary: Path, before: os.stat_result) -> None:
    if hasattr(os, "chown"):
        with suppress(OSError):  # the owner may be somebody else
            os.chown(temporary, before.st_uid, before.st_gid)
    temporary.chmod(stat.S_IMODE(before.st_mode))


def write_bytes(path: Path, content: bytes | memoryview) -> None:
    """Write `path`, whole or not at all."""
    with whole_file(path) as temporary:
        temporary.write_bytes(content)


def write_text(path: Path, text: str) -> None:
    """Write UTF-8 text to `path`, whole or not at all."""
    write_bytes(path, text.encode("utf-8"))


def read_bytes(path: Path, most: int) -> bytes:
    """Read a regular file of at most so many bytes; anything else is refused before it can block or fill the memory.

    Raises:
        ValueError: the path can be no file's, the file is too large, or it is no regular file; with the reason in words.
        OSError: it cannot be read.
    """
    try:
        descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    except ValueError:
        raise ValueError("is no file name") from None
    try:
        found = os.fstat(descriptor)
        if not stat.S_ISREG(found.st_mode):
            raise ValueError(f"{_kind(found.st_mode)}; needed: a regular file")
        with os.fdopen(descriptor, "rb", closefd=False) as file:
            content = file.read(most + 1) if found.st_size <= most else b""
    finally:
        os.close(descriptor)
    if found.st_size > most or len(content) > most:
        raise ValueError(f"has {max(found.st_size, len(content))} bytes; at most {most} are read")
    return content


def named_file(name: str | os.PathLike[str]) -> Path:
    """Give the path of a file to write.

    Raises:
        RequestError: it is no path.
    """
    try:
        text = os.fspath(name)
    except TypeError:
        text = None
    if not isinstance(text, str) or not text.strip() or "\0" in text:
        raise RequestError(f"path {name!r}: names no file")
    return Path(text)


def named_folder(name: str | os.PathLike[str], argument: str) -> Path:
    """Give the folder that an argument names.

    Args:
        name: of the folder.
        argument: that holds it, for the message: `out`, `--out`.

    Raises:
        RequestError: it has no name (as a path that would be the current folder), or is no path.
    """
    try:
        text = os.fspath(name)
    except TypeError:
        raise RequestError(f"{argument} {name!r}: must be the path of a folder") from None
    if not isinstance(text, str) or not text.strip() or "\0" in text:
        raise RequestError(f'{argument} {text!r}: names no folder; the current one is "."')
    return Path(text)


@contextmanager
def output_folder(path: Path | None) -> Iterator[None]:
    """Create a folder for results and make sure that files can be made in it, before the work that fills it begins.

    Args:
        path: the folder; folders above it are created too. None asks for no folder.

    Yields:
        Nothing. If the work fails, folders that were created for it and are still empty are removed again.

    Raises:
        RequestError: it cannot be created, or is not writable.
    """
    if path is None:
        yield
        return
    created: list[Path] = []
    try:
        try:
            created += [folder for folder in (path, *path.parents) if not folder.exists()]
            path.mkdir(parents=True, exist_ok=True)
            probe = path / f".detumble.{os.getpid()}"
            probe.touch()
            probe.unlink()
        except OSError as error:
            raise RequestError(f"{path}: cannot be used as an output folder: {reason(error)}") from None
        except ValueError:
            raise RequestError(f"{str(path)!r}: is no folder's name") from None
        yield
    except BaseException:
        for folder in created:
            with suppress(OSError):
                folder.rmdir()
        raise


def reason(error: OSError) -> str:
    """Give the text of an operating-system error in lower case, without its number."""
    return (error.strerror or str(error)).lower()
