"""Files that appear whole or not at all, and folders that are known to take them."""

from __future__ import annotations

import os
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from detumble.errors import RequestError

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Give a temporary path beside `path`; put it in place at the end, or take it away if anything failed.

    Args:
        path: where the finished file shall stand.

    Yields:
        The path to write to, with the same ending.

    Raises:
        RequestError: the folder does not take the file.
    """
    temporary = path.with_name(f".{path.stem}.{os.getpid()}{path.suffix}")
    try:
        yield temporary
        temporary.replace(path)
    except OSError as error:
        raise RequestError(f"{path}: cannot be written: {reason(error)}") from None
    finally:
        with suppress(OSError):
            temporary.unlink()


def write_bytes(path: Path, content: bytes | memoryview) -> None:
    """Write `path`, whole or not at all."""
    with whole_file(path) as temporary:
        temporary.write_bytes(content)


def write_text(path: Path, text: str) -> None:
    """Write UTF-8 text to `path`, whole or not at all."""
    write_bytes(path, text.encode("utf-8"))


@contextmanager
def output_folder(path: Path | None) -> Iterator[None]:
    """Create a folder for results and make sure that files can be made in it, before the work that fills it begins.

    Args:
        path: the folder; folders above it are created too. None asks for no folder.

    Yields:
        Nothing. If the work fails, folders that were created for it and are still empty are taken away again.

    Raises:
        RequestError: it cannot be created, or takes no files.
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
        yield
    except BaseException:
        for folder in created:
            with suppress(OSError):
                folder.rmdir()
        raise


def reason(error: OSError) -> str:
    """Say an operating-system error in lower-case words, without its number."""
    return (error.strerror or str(error)).lower()
