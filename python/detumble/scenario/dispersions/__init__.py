"""What is uncertain about a scenario: distributions of its fields, one class for each, and correlations between them.

A campaign draws each dispersed field anew for every run; a single flight flies the values written in the file. No draw
leaves the range of its field: bounds are checked, and distributions that could leave it are refused.
"""

from typing import Annotated

from pydantic import Field

from detumble.scenario.dispersions.base import Dispersion
from detumble.scenario.dispersions.correlation import Correlation
from detumble.scenario.dispersions.numbers import LogUniform, Normal, TruncatedNormal, Uniform
from detumble.scenario.dispersions.shapes import Attitude, Direction, InertiaSpread

AnyDispersion = Annotated[
    Normal | TruncatedNormal | Uniform | LogUniform | Direction | Attitude | InertiaSpread,
    Field(discriminator="distribution"),
]

DISTRIBUTIONS: dict[str, type[Dispersion]] = {
    "normal": Normal,
    "truncated_normal": TruncatedNormal,
    "uniform": Uniform,
    "log_uniform": LogUniform,
    "direction": Direction,
    "attitude": Attitude,
    "inertia": InertiaSpread,
}

__all__ = [
    "DISTRIBUTIONS",
    "AnyDispersion",
    "Attitude",
    "Correlation",
    "Direction",
    "Dispersion",
    "InertiaSpread",
    "LogUniform",
    "Normal",
    "TruncatedNormal",
    "Uniform",
]
