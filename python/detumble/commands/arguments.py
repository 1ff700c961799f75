"""Arguments that several commands take."""

from __future__ import annotations

from pathlib import Path

from detumble.errors import RequestError


def folder(text: str) -> Path:
    """Read the folder given with --out.

    Raises:
        RequestError: it has no name; as a path that would be the current folder.
    """
    if not text.strip():
        raise RequestError('--out "": names no folder; the current one is "."')
    return Path(text)


def percentile(statistic: str) -> float | None:
    """Read --statistic: `mean`, which is None, or a percentile such as `p95`.

    Raises:
        RequestError: it is neither.
    """
    if statistic == "mean":
        return None
    try:
        return float(statistic.removeprefix("p"))
    except ValueError:
        raise RequestError(f"--statistic {statistic}: must be mean, or a percentile such as p95") from None
