"""Files that appear whole or not at all, and folders that are known to take them."""

from __future__ import annotations

import os
from contextlib import contextmanager
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
        temporary.unlink(missing_ok=True) if temporary.parent.is_dir() else None


def write_text(path: Path, text: str) -> None:
    """Write UTF-8 text to `path`, whole or not at all."""
    with whole_file(path) as temporary:
        temporary.write_text(text, encoding="utf-8", newline="\n")


def output_folder(path: Path) -> Path:
    """Create a folder for results and make sure that files can be made in it.

    Args:
        path: the folder; folders above it are created too.

    Returns:
        The same path.

    Raises:
        RequestError: it cannot be created, or takes no files.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
        probe = path / f".detumble.{os.getpid()}"
        probe.touch()
        probe.unlink()
    except OSError as error:
        raise RequestError(f"{path}: cannot be used as an output folder: {reason(error)}") from None
    return path


def reason(error: OSError) -> str:
    """Say an operating-system error in lower-case words, without its number."""
    return (error.strerror or str(error)).lower()
