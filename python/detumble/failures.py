"""Why a flight fails: the codes of the core, and what they mean in words."""

from __future__ import annotations

from detumble.compiled import register

_CODES: dict[str, int] = dict(register()["codes"])
SUCCESS, DIVERGED, NOT_SETTLED, NO_GAINS, DWELL_MISSED, NEVER_CAPTURED = (
    _CODES[name] for name in ("success", "diverged", "not_settled", "no_gains", "dwell_missed", "never_captured")
)
"""A flight that is never captured has `NEVER_CAPTURED` plus the bit of each threshold that never held."""
THRESHOLDS: dict[str, int] = dict(register()["thresholds"])
"""Bits by name."""

_CAUSES: dict[int, str] = dict(register()["causes"])
CODES = tuple(_CAUSES)
CAUSES = tuple(_CAUSES.values())
"""Every cause of failure, in words."""


def cause(code: int) -> str | None:
    """Say in words why a run failed.

    Args:
        code: as the core gives it.

    Returns:
        One of `CAUSES`; None for a success.
    """
    return None if code == SUCCESS else _CAUSES[code]
