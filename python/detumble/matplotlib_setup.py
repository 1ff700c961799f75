"""Import of matplotlib, independent of the user's settings where they would make it fail or change a picture."""

from __future__ import annotations

import os
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

own_process = False
"""Whether this process runs the command line. In any other, a user's settings with which matplotlib can be imported hold."""


def load_matplotlib() -> None:
    """Import matplotlib; must be called before anything else imports it.

    In a Python process of the user's the user's settings hold, unless the import fails with them; `show.style.styled` keeps
    them out of detumble's pictures. The import fails with a backend that is not installed here (`MPLBACKEND`, which a process
    started from a notebook inherits), and with rc or style files that cannot be read.
    """
    if not own_process:
        try:
            import matplotlib.style
        except Exception:  # whatever error those settings cause
            pass
        else:
            return
    with _without_settings():
        import matplotlib

        found, matplotlib.get_configdir = matplotlib.get_configdir, matplotlib.get_data_path
        try:
            import matplotlib.style  # reads the style files of that folder
        finally:
            matplotlib.get_configdir = found


@contextmanager
def _without_settings() -> Iterator[None]:
    """Let an import of matplotlib find no rc file and no choice of a backend."""
    import logging

    log, exists = logging.getLogger("matplotlib"), os.path.exists
    level = log.level
    own = {"MPLBACKEND": "agg", "MATPLOTLIBRC": os.devnull}
    before = {name: os.environ.get(name) for name in own}
    log.setLevel(logging.CRITICAL)  # of folders that it cannot use
    os.environ |= own
    # the file in the current folder would come first, and other threads may count on that folder
    os.path.exists = lambda path: path != "matplotlibrc" and exists(path)
    try:
        yield
    finally:
        os.path.exists = exists
        for name, value in before.items():
            os.environ.pop(name, None) if value is None else os.environ.update({name: value})
        if not own_process:
            log.setLevel(level)
