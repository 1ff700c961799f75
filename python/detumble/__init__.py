"""detumble: which control law captures this tumbling target with this chaser, how fast, at what delta-v, and how sure.

    >>> import detumble
    >>> scenario = detumble.load("paper")
    >>> flight = detumble.simulate(scenario, law="prrl", seed=1)
    >>> flight.metrics.capture_time  # s

Everything is loaded when it is first used: `import detumble` costs next to nothing.
"""

from __future__ import annotations

from detumble import surroundings as _surroundings  # noqa: F401  # watches for forks from now on
from detumble.version import __version__

TYPE_CHECKING = False  # as type checkers know it; importing it from typing would cost more than all the rest

if TYPE_CHECKING:
    from typing import Any

    from detumble.analysis.bounds.bound import Bounds, bound
    from detumble.analysis.comparing.comparer import compare
    from detumble.analysis.tuning.tuner import tune
    from detumble.campaigns.campaign import campaign
    from detumble.campaigns.result import CampaignResult, read_campaign
    from detumble.errors import RequestError, ScenarioError
    from detumble.flight import Flight, read_netcdf
    from detumble.recorded import replay_wrench
    from detumble.scenario import LAWS, Scenario, load
    from detumble.scenario import built_in as scenarios
    from detumble.simulation import simulate

_HOMES = {
    "Bounds": ("detumble.analysis.bounds.bound", "Bounds"),
    "LAWS": ("detumble.scenario.laws", "LAWS"),
    "CampaignResult": ("detumble.campaigns.result", "CampaignResult"),
    "Flight": ("detumble.flight", "Flight"),
    "RequestError": ("detumble.errors", "RequestError"),
    "Scenario": ("detumble.scenario.model", "Scenario"),
    "ScenarioError": ("detumble.errors", "ScenarioError"),
    "bound": ("detumble.analysis.bounds.bound", "bound"),
    "campaign": ("detumble.campaigns.campaign", "campaign"),
    "compare": ("detumble.analysis.comparing.comparer", "compare"),
    "read_campaign": ("detumble.campaigns.result", "read_campaign"),
    "load": ("detumble.scenario.files", "load"),
    "read_netcdf": ("detumble.flight", "read_netcdf"),
    "replay_wrench": ("detumble.recorded", "replay_wrench"),
    "scenarios": ("detumble.scenario.files", "built_in"),
    "simulate": ("detumble.simulation", "simulate"),
    "tune": ("detumble.analysis.tuning.tuner", "tune"),
}

__all__ = [
    "LAWS",
    "Bounds",
    "CampaignResult",
    "Flight",
    "RequestError",
    "Scenario",
    "ScenarioError",
    "__version__",
    "bound",
    "campaign",
    "compare",
    "load",
    "read_campaign",
    "read_netcdf",
    "replay_wrench",
    "scenarios",
    "simulate",
    "tune",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'detumble' has no attribute {name!r}")
    from importlib import import_module

    module, attribute = _HOMES[name]
    value = getattr(import_module(module), attribute)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
