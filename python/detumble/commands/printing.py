"""What commands print beside tables: one JSON object on standard output, remarks on standard error."""

from __future__ import annotations

import json
import math
import sys
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from detumble.text import printable

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping
    from pathlib import Path


def print_json(values: Mapping[str, Any]) -> None:
    """Print one JSON object on standard output; what is not finite becomes null."""
    print(json_text(values))


def print_result(as_json: bool, numbers: Mapping[str, Any], text: Callable[[], str], files: Iterable[Path]) -> None:
    """Print what a command found: the numbers and the paths of the files as one JSON object, or else the text."""
    if as_json:
        print_json({**numbers, "files": [str(file) for file in files]})
    else:
        print(text())


def remark_written(files: Iterable[Path]) -> None:
    """Remark each file that was written."""
    for file in files:
        remark(f"written: {file}")


def json_text(values: Mapping[str, Any]) -> str:
    """Write an object as JSON, which stays whole in any encoding; what is not finite becomes null."""
    return json.dumps(_finite(values), indent=2, allow_nan=False)


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(element) for key, element in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(element) for element in value]
    if hasattr(value, "tolist"):
        return _finite(value.tolist())
    return None if isinstance(value, float) and not math.isfinite(value) else value


def remark(text: str) -> None:
    """Print a line on standard error; nothing happens where that cannot be written."""
    with suppress(OSError):
        print(printable(text), file=sys.stderr)
