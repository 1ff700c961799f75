"""The scenario: what is flown, in SI units, with its check, its file and its built-in library."""

from detumble.errors import Fault, ScenarioError
from detumble.scenario.files import built_in, from_toml, load, with_settings
from detumble.scenario.laws import LAWS
from detumble.scenario.model import Scenario

__all__ = ["LAWS", "Fault", "Scenario", "ScenarioError", "built_in", "from_toml", "load", "with_settings"]
