"""What a campaign keeps of each run: one register of columns with units, used by storage, statistics and figures alike."""

from __future__ import annotations

from dataclasses import dataclass

from detumble.metrics import METRICS

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
"""Everything that a failed run can be put down to."""


@dataclass(frozen=True)
class Column:
    """A column of the table of runs.

    Attributes:
        name: in the table; units of metrics stand in the name.
        unit: SI; empty where there is none.
        meaning: one line.
    """

    name: str
    unit: str
    meaning: str


INDEX = Column("index", "", "number of the run; with the seed it names all random numbers of the run")
SUCCEEDED = Column("success", "", "captured, and settled where the bodies merge; not diverged")
FAILURE = Column("failure", "", "why the run failed; null for a success")
END_TIME = Column("end_time_s", "s", "time at which the flight was ended")
SCALARS = tuple(metric for metric in METRICS if not metric.name.endswith("_axes"))
EARLY = {
    "settling_time": "from capture to the tick from which angle and rate against H hold to the end of this flight; where "
    "campaign.end is settled, that is campaign.hold later, and what the stack would do after it is not known"
}
"""Definitions that mean something else of a flight that may end before its duration."""
RESULTS = (
    SUCCEEDED,
    FAILURE,
    END_TIME,
    *(Column(metric.key, metric.unit, EARLY.get(metric.name, metric.definition)) for metric in SCALARS),
)
"""What each run ends with; the drawn values stand between `index` and these, under their fields' paths."""

COMPONENTS = {
    "vector": ("x", "y", "z"),
    "quaternion": ("w", "x", "y", "z"),
    "inertia": ("xx", "yy", "zz", "xy", "xz", "yz"),
}


def drawn_names(path: str, shape: str, width: int) -> tuple[str, ...]:
    """Name the columns of one dispersed field.

    Args:
        path: of the field: `chaser.mass`.
        shape: of its quantity.
        width: numbers drawn for it.
    """
    if width == 1:
        return (path,)
    return tuple(f"{path}.{component}" for component in COMPONENTS.get(shape, COMPONENTS["vector"]))
