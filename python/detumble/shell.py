"""Interface of the command line to the shell: signals, streams, messages, exit codes."""

from __future__ import annotations

import atexit
import codecs
import io
import os
import signal
import sys
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

from detumble import matplotlib_setup
from detumble.errors import RequestError
from detumble.text import printable
from detumble.writing import reason

if TYPE_CHECKING:
    from collections.abc import Iterator

PLAIN = {"Δ": "d", "–": "-", "─": "-", "…": "...", "°": "deg", "²": "2", "³": "3", "⁴": "4"}
"""Replacement of a character that a stream's encoding lacks; a question mark for any other."""

IGNORED = ("SOURCE_DATE_EPOCH", "HDF5_DRIVER", "HDF5_VOL_CONNECTOR", "POLARS_PANIC_ON_ERR", "_DETUMBLE_COMPLETE")
"""Environment variables that would make libraries write other files than asked for, or end the process."""
WIDTH = "TERMINAL_WIDTH"
"""Of the help, in characters."""
TRACEBACK = "DETUMBLE_TRACEBACK"
"""Set to anything, it shows where an unforeseen error comes from."""
_ENDING = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGUSR1", "SIGUSR2", "SIGXCPU", "SIGALRM")
ENDING = [getattr(signal, name) for name in _ENDING if hasattr(signal, name)]
"""Ctrl-C, the end of a job or of the machine, the end of a terminal, and what schedulers send before they kill a job."""
DEFAULT_HANDLERS = (signal.default_int_handler, signal.SIG_DFL)
"""Handlers of these signals that no user has replaced."""


def run() -> None:
    """Run the command line and exit; a user's mistake, or a stream that cannot be written, ends in one message.

    Raises:
        SystemExit: always, with the exit code.
    """
    matplotlib_setup.own_process = True
    _settle_environment()
    _open_closed_streams()
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
    except BrokenPipeError:  # the reader has closed the pipe
        _leave(1)
    except OSError as error:
        _leave(1, f"{error.filename or 'standard output'}: cannot be written: {reason(error)}")
    except MemoryError:
        _leave(1, "there is not enough memory for this")
    except (SystemExit, KeyboardInterrupt):
        raise
    except BaseException as error:
        if TRACEBACK in os.environ:
            raise
        said = " ".join(str(error).split())
        _leave(1, f"{type(error).__name__}: {said}; this was not foreseen: {TRACEBACK}=1 shows where it comes from")
    finally:
        _discard_unwritten()


def _settle_environment() -> None:
    for name in IGNORED:
        os.environ.pop(name, None)
    width = os.environ.get(WIDTH, "80")
    if not (width.isascii() and width.isdecimal() and 0 < len(width) < 5):
        del os.environ[WIDTH]


def _leave(code: int, message: str = "") -> None:
    if message:
        with suppress(OSError):
            print(printable(message), file=sys.stderr)
    sys.exit(code)


def _open_closed_streams() -> None:
    """Replace closed streams, so that no file opened later gets their descriptors.

    On standard output every write fails, as on the closed one; on standard error it is discarded.
    """
    for number, (name, mode) in enumerate((("stdin", "r"), ("stdout", "w"), ("stderr", "w"))):
        if getattr(sys, name) is None:
            opened = os.open(os.devnull, os.O_WRONLY if name == "stderr" else os.O_RDONLY)
            os.dup2(opened, number)
            if opened != number:
                os.close(opened)
            os.set_inheritable(number, True)
            stream = open(number, mode, encoding="utf-8", closefd=False)  # noqa: SIM115  # for as long as this runs
            setattr(sys, name, stream)
            setattr(sys, f"__{name}__", stream)


def _keep_readable() -> None:
    """Replace characters that a stream's encoding lacks, instead of failing."""
    codecs.register_error("plain", _plainly)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="plain")


def _plainly(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(PLAIN.get(character, "?") for character in error.object[error.start : error.end]), error.end


def _discard_unwritten() -> None:
    """Discard what a stream cannot write: the interpreter would try again at its exit, and report an error."""
    for stream in filter(None, (sys.__stdout__, sys.__stderr__)):
        try:
            stream.flush()
        except OSError:
            null = os.open(os.devnull, os.O_WRONLY)
            os.dup2(null, stream.fileno())
            os.close(null)


@contextmanager
def _interruptible() -> Iterator[None]:
    """On a terminating signal, exit orderly with code 128 + its number; on a second one, at once.

    The signal is recorded: during an import a library may suppress the exception, or turn it into an ImportError.
    """
    received = 0
    # one that is ignored stays ignored: under nohup, or in the background of a script
    before = {number: found for number in ENDING if (found := signal.getsignal(number)) in DEFAULT_HANDLERS}

    def end(number: int, _: object) -> None:
        nonlocal received
        received = number
        for each in before:
            signal.signal(each, signal.SIG_DFL)
        sys.unraisablehook = lambda _: (
            None
        )  # raised within a callback that cannot propagate it, the exit would be printed
        sys.exit(128 + number)

    for number in before:
        signal.signal(number, end)
    try:
        yield
    finally:
        for number, found in before.items():
            atexit.register(signal.signal, number, signal.SIG_DFL)  # the rest of the exit cannot be interrupted
            signal.signal(number, found)
        if received:
            raise SystemExit(128 + received) from None
