"""The former home of `detumble.campaigns.runs.draws`."""

import warnings

from detumble.campaigns.runs.draws import draw, drawn_scenario

__all__ = ["draw", "drawn_scenario"]

warnings.warn("detumble.campaigns.draws is now detumble.campaigns.runs.draws", DeprecationWarning, stacklevel=2)
