"""The command line, called within this process: quick enough for hundreds of calls."""

from __future__ import annotations

import sys
from contextlib import chdir, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from unittest.mock import patch

from detumble.cli import main


@dataclass(frozen=True)
class Done:
    """What came of a command: its exit code, standard output and standard error."""

    code: int
    out: str
    err: str


def call(*arguments: str | Path, cwd: Path) -> Done:
    """Call `detumble` with these arguments in a folder; what it does not catch is raised."""
    out, err = StringIO(), StringIO()
    with (
        chdir(cwd),
        patch.object(sys, "argv", ["detumble", *map(str, arguments)]),
        redirect_stdout(out),
        redirect_stderr(err),
    ):
        try:
            main()
        except SystemExit as leaving:
            code = leaving.code if isinstance(leaving.code, int) else int(leaving.code is not None)
        else:
            code = 0
    return Done(code, out.getvalue(), err.getvalue())
