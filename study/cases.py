"""The scenarios of the study: all with the paper's bodies, limits and noise."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import detumble
from detumble.scenario import Scenario
from detumble.scenario.faults import validated
from detumble.scenario.files import with_settings

PUBLISHED_TIME = 7.6
"""s, the paper's capture time of PRRL-SMC."""


@dataclass(frozen=True)
class Case:
    """A scenario in which all laws are compared.

    Attributes:
        key: names its results and figures.
        title: for figures and tables.
        base: built-in scenario.
        settings: what differs from it, as on the command line.
        objective: that gains are tuned for, and laws ordered by.
    """

    key: str
    title: str
    base: str
    settings: tuple[str, ...] = ()
    objective: Literal["capture", "settling"] = "capture"

    @property
    def scenario(self) -> Scenario:
        """The scenario."""
        return with_settings(detumble.load(self.base), self.settings)

    @property
    def arguments(self) -> str:
        """How a command line names it."""
        objective = () if self.objective == "capture" else (f"--objective {self.objective}",)
        return " ".join((self.base, *(f"--set {setting}" for setting in self.settings), *objective))


CASES = (
    Case("paper", "the paper's case", "paper"),
    Case("dispersed", "dispersed", "paper_dispersed"),
    Case(
        "soft",
        "soft capture, until settled",
        "paper_dispersed",
        ("capture.speed=0.03", "capture.transition=momentum_conserving"),
        "settling",
    ),
)
"""The paper's single start; everything uncertain; and the whole mission: the same with what a gripper asks for, at most
3 cm/s, momentum kept at capture, and judged by the time until the stack is at rest."""


def on_spheres(distance: tuple[float, float], tumble_rate: tuple[float, float]) -> Scenario:
    """Start anywhere at some distance, at rest, any attitudes, against debris that tumbles about any axis.

    Args:
        distance: least and greatest, from the goal, which is the debris' centre here, m; log-uniform.
        tumble_rate: least and greatest, rad/s; log-uniform.

    Returns:
        The paper's case otherwise, its noise included.
    """
    raw = detumble.load("paper").to_dict()
    raw["title"] = "The paper's bodies from anywhere"
    raw["goal"]["position"] = [0.0, 0.0, 0.0]
    raw["chaser"]["position"] = [distance[1], 0.0, 0.0]
    raw["debris"]["tumble_rate"] = [tumble_rate[1], 0.0, 0.0]
    raw["dispersions"] = [
        {"field": "chaser.position", **_any_direction(distance)},
        {"field": "chaser.attitude", "distribution": "attitude"},
        {"field": "debris.attitude", "distribution": "attitude"},
        {"field": "debris.tumble_rate", **_any_direction(tumble_rate)},
    ]
    return validated(raw, raw["title"])


def _any_direction(length: tuple[float, float]) -> dict[str, str | float]:
    low, high = length
    if low == high:  # the nominal one
        return {"distribution": "direction"}
    return {"distribution": "direction", "low": low, "high": high, "magnitude": "log_uniform"}


def with_laws_of(scenario: Scenario, tuned: Scenario) -> Scenario:
    """Give a scenario the laws of another."""
    return scenario.model_copy(update={"laws": tuned.laws}, deep=True)
