"""Why a flight fails: the codes of the core, and what they mean in words."""

from __future__ import annotations

SUCCESS = 0
DIVERGED = 1
NOT_SETTLED = 2
NO_GAINS = 3
NEVER_CAPTURED = 16
"""Plus one bit for each threshold that never held: see `THRESHOLDS`. None: each held at some time, never all at once."""
DWELL_MISSED = 32
"""All thresholds held at once, but never for the whole dwell time."""
THRESHOLDS = {"distance": 1, "angle": 2, "rate": 4, "speed": 8}


def cause(code: int) -> str | None:
    """Say in words why a run failed.

    Args:
        code: as the core gives it.

    Returns:
        One of `CAUSES`; None for a success.
    """
    match code:
        case 0:
            return None
        case 1:
            return "diverged"
        case 2:
            return "captured, not settled"
        case 3:
            return "no gains: the Riccati equation has no solution"
        case 16:
            return "never captured: not all at once"
        case 32:
            return "never captured: dwell"
        case _:
            return "never captured: " + " + ".join(name for name, bit in THRESHOLDS.items() if code & bit)


CODES = (DIVERGED, NO_GAINS, NOT_SETTLED, DWELL_MISSED, *range(NEVER_CAPTURED, NEVER_CAPTURED + 16))
CAUSES = tuple(str(cause(code)) for code in CODES)
"""Every cause of failure, in words."""
