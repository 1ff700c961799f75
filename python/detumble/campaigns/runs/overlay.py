"""From drawn fields of a scenario to the numbers of the core that they become, run by run.

The paths on the core's side are those of its case: `chaser.mass`, `start.position`, `law.before.rotation.gain`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from detumble.scenario.core import converted
from detumble.scenario.rules import active
from detumble.scenario.tables import body_rules, law_rules

if TYPE_CHECKING:
    from collections.abc import Mapping

    from detumble.scenario.model import Scenario

Array = NDArray[np.float64]


def overlay(scenario: Scenario, law: str, drawn: Mapping[str, Array]) -> dict[str, Array]:
    """Give the numbers of the core that differ from run to run.

    Args:
        scenario: the nominal case.
        law: the law that flies; gains of others are left out.
        drawn: by path of the scenario, as `draws.draw` gives it: (n,) or (n, k).

    Returns:
        By path of the core, (n, k), C-contiguous, SI.
    """
    rows = {path: values.reshape(len(values), -1) for path, values in drawn.items()}

    def at(field: str) -> Any:
        """Give what is drawn of a field, which the scenario itself may leave to a default; else the scenario's value."""
        return rows[field] if field in rows else scenario.at(field)

    columns: dict[str, Array] = {}
    for path, rules in (body_rules() | law_rules(law)).items():
        rule = active(rules, at)
        if not rule.design and not rows.keys().isdisjoint(rule.of):
            columns[path] = np.ascontiguousarray(converted(rule, scenario.at, rows.get))
    return columns
