"""Text from a user: made printable for files, pictures and terminals, and compared with known words."""

from __future__ import annotations

import difflib
import unicodedata
from collections.abc import Iterable

_MARKS = {chr(code) for code in (*range(0x202A, 0x202F), *range(0x2066, 0x206A))}
"""Marks that turn the direction of what follows them on a terminal."""


def printable(text: str, keep: str = "\n\t") -> str:
    r"""Write characters that control a terminal, or that no file can hold, as escapes: \x1b.

    Args:
        text: any.
        keep: characters that stay nevertheless.
    """
    return "".join(
        character if character in keep or not _controls(character) else repr(character)[1:-1] for character in text
    )


def unprintable(text: str, keep: str = "") -> str:
    """Give the first character that controls a terminal, or that no file can hold, as an escape; empty where there is none.

    Args:
        text: any.
        keep: characters that are fine nevertheless.
    """
    return next(
        (printable(character, keep) for character in text if character not in keep and _controls(character)), ""
    )


def _controls(character: str) -> bool:
    return unicodedata.category(character) in ("Cc", "Cs", "Zl", "Zp") or character in _MARKS


def did_you_mean(word: str, choices: Iterable[str]) -> str:
    """Suggest the nearest of the choices: `; did you mean x?`, or nothing."""
    folded = {choice.lower().replace("_", ""): choice for choice in choices}
    near = difflib.get_close_matches(word.lower().replace("_", "").replace("-", ""), folded, n=1, cutoff=0.6)
    return f"; did you mean {folded[near[0]]}?" if near else ""
