"""The way to matplotlib: no setting of the user's may keep it from being imported, or reach a picture."""

from __future__ import annotations

import os
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

alone = False
"""Whether this process is the command's own. In any other, settings that work are left to whoever made them."""


def load_matplotlib() -> None:
    """Import matplotlib; to be called before anything else imports it.

    In a process of the user's own its settings hold, unless the import fails with them, and `styled` keeps them from our
    pictures. It fails with a backend that is not installed here (`MPLBACKEND`, which whatever is started from a notebook
    inherits), and with rc or style files that cannot be read.
    """
    if not alone:
        try:
            import matplotlib.style
        except Exception:  # whatever those settings bring about
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
        if not alone:
            log.setLevel(level)
