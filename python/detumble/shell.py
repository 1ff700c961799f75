"""Between the command line and the shell: Ctrl-C, streams that cannot take what is written, messages, exit codes."""

from __future__ import annotations

import atexit
import codecs
import io
import os
import signal
import sys
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

from detumble.errors import RequestError
from detumble.show import drawing
from detumble.writing import reason

if TYPE_CHECKING:
    from collections.abc import Iterator

PLAIN = {"Δ": "d", "–": "-", "─": "-", "…": "...", "°": "deg", "²": "2", "³": "3", "⁴": "4"}
"""What stands for a character that a stream's encoding lacks; a question mark for any other."""


def run() -> None:
    """Run the command line and leave; a mistake of the user's, or a stream that is full, ends in one message.

    Raises:
        SystemExit: always, with the exit code.
    """
    drawing.alone = True
    _keep_readable()
    try:
        with _interruptible():
            from detumble.commands.app import app

            try:
                app()
            finally:
                print(end="", flush=True)
    except RequestError as error:
        _leave(2, str(error))
    except BrokenPipeError:  # whoever reads has seen enough
        _leave(1)
    except OSError as error:
        _leave(1, f"{error.filename or 'standard output'}: cannot be written: {reason(error)}")
    finally:
        _discard_unwritten()


def _leave(code: int, message: str = "") -> None:
    if message:
        with suppress(OSError):
            print(message, file=sys.stderr)
    sys.exit(code)


def _keep_readable() -> None:
    """Let no character stop the output: what a stream's encoding lacks is written plainly."""
    codecs.register_error("plain", _plainly)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="plain")


def _plainly(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(PLAIN.get(character, "?") for character in error.object[error.start : error.end]), error.end


def _discard_unwritten() -> None:
    """Let what a stream cannot take go nowhere: the interpreter would try again at its end, and complain."""
    for stream in filter(None, (sys.__stdout__, sys.__stderr__)):
        try:
            stream.flush()
        except OSError:
            nowhere = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nowhere, stream.fileno())
            os.close(nowhere)


@contextmanager
def _interruptible() -> Iterator[None]:
    """End quietly with exit code 130 on Ctrl-C, and at once on a second one.

    That it was pressed is remembered: during an import a library may swallow the exception, or make an ImportError of it.
    """
    if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:  # ignored, as in the background of a script
        yield
        return
    pressed = False

    def interrupt(*_: object) -> None:
        nonlocal pressed
        pressed = True
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        sys.unraisablehook = lambda _: None  # met within a callback that can raise nothing, it would be printed
        sys.exit(130)

    signal.signal(signal.SIGINT, interrupt)
    try:
        yield
    finally:
        atexit.register(signal.signal, signal.SIGINT, signal.SIG_DFL)  # nothing that is left to do can be interrupted
        signal.signal(signal.SIGINT, signal.default_int_handler)
        if pressed:
            raise SystemExit(130) from None
