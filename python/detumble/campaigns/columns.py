"""The columns of the table of runs: name, unit and meaning of each, for storage, statistics and figures."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from detumble.metrics import METRICS
from detumble.scenario.dispersions.fitting import fields

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray


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
SCALARS = tuple(metric for metric in METRICS if metric.kind != "axes")
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
"""Results of a run. The drawn values stand between `index` and these, under the paths of their fields."""

COMPONENTS = {
    "vector": ("x", "y", "z"),
    "quaternion": ("w", "x", "y", "z"),
    "inertia": ("xx", "yy", "zz", "xy", "xz", "yz"),
}


def drawn_table(drawn: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    """Give drawn values as columns of the table.

    Args:
        drawn: by path of the field, (runs,) or (runs, numbers), as `runs.draws.draw` gives them.

    Returns:
        (runs,) by name: `chaser.mass`, `chaser.position.x`.
    """
    table: dict[str, NDArray[Any]] = {}
    for path, values in drawn.items():
        if values.ndim == 1 or values.shape[1] == 1:
            table[path] = values.reshape(-1)
            continue
        components = COMPONENTS.get(fields()[path].shape, COMPONENTS["vector"])
        table |= {f"{path}.{component}": values[:, place] for place, component in enumerate(components)}
    return table
