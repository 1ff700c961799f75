"""Drawn values as inputs that an outcome can depend on: components, and quantities derived from them.

- Vectors keep their components; their magnitude comes to them: `|debris.tumble_rate|`.
- An attitude's four components are replaced by the angle from the nominal attitude, the components of that turn
  (rotation vector, body axes), and the attitude error between the bodies at the start.
- All other values are inputs as they are.
"""

from __future__ import annotations

from collections import defaultdict
from operator import attrgetter
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from detumble.campaigns.columns import COMPONENTS, INDEX, RESULTS
from detumble.quaternions import conjugate, multiply, rotation_vector

if TYPE_CHECKING:
    from collections.abc import Iterable

    import polars as pl
    from numpy.typing import NDArray

    from detumble.scenario.model import Scenario

Array: TypeAlias = "NDArray[np.float64]"

START_ERROR = "attitude error at start"


def drawn_columns(names: Iterable[str]) -> list[str]:
    """Pick the columns that were drawn from those of a campaign's table."""
    others = {INDEX.name, *(column.name for column in RESULTS)}
    return [name for name in names if name not in others]


def inputs(rows: pl.DataFrame, scenario: Scenario) -> tuple[dict[str, Array], tuple[str, ...]]:
    """Give the inputs of runs.

    Args:
        rows: (n runs) of a campaign's table.
        scenario: what was dispersed.

    Returns:
        The inputs (n,) that vary, in SI units, angles in rad, and the names of those that were the same in all runs.
    """
    drawn = {name: rows[name].to_numpy() for name in drawn_columns(rows.columns)}
    fields: defaultdict[str, list[str]] = defaultdict(list)
    for name in drawn:
        field, _, component = name.rpartition(".")
        fields[field].append(component)
    found: dict[str, Array] = {}
    attitudes: dict[str, Array] = {}
    for field, components in fields.items():
        values = np.stack([drawn[f"{field}.{component}"] for component in components], axis=-1)
        if tuple(components) == COMPONENTS["quaternion"]:
            attitudes[field] = values
            turn = rotation_vector(multiply(conjugate(_nominal(scenario, field)), values))
            found[f"{field} angle"] = np.linalg.norm(turn, axis=-1)
            found |= {f"{field} about {axis}": turn[:, place] for place, axis in enumerate("xyz")}
            continue
        found |= {f"{field}.{component}": values[:, place] for place, component in enumerate(components)}
        if tuple(components) == COMPONENTS["vector"] and sum(_varies(values[:, place]) for place in range(3)) > 1:
            found[f"|{field}|"] = np.linalg.norm(values, axis=-1)
    if attitudes.keys() & {"chaser.attitude", "debris.attitude"}:
        chaser, debris = (attitudes.get(at, _nominal(scenario, at)) for at in ("chaser.attitude", "debris.attitude"))
        found[START_ERROR] = np.linalg.norm(rotation_vector(multiply(conjugate(debris), chaser)), axis=-1)
    varying = {name: values for name, values in found.items() if _varies(values)}
    return varying, tuple(name for name in found if name not in varying)


def _nominal(scenario: Scenario, field: str) -> Array:
    q = np.array(attrgetter(field)(scenario), np.float64)
    return q / np.linalg.norm(q)


def _varies(values: Array) -> bool:
    """Distinguish a spread from round-off: the norm of a turned vector of one length is not the same to the bit."""
    return float(np.ptp(values)) > 1e-9 * float(np.abs(values).max())
