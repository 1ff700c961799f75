"""Pictures of a campaign: each takes arrays, counts or statistics and writes one file."""

from detumble.show.campaign.causes import failures
from detumble.show.campaign.frame import Caption
from detumble.show.campaign.influence import sensitivity
from detumble.show.campaign.precision import convergence
from detumble.show.campaign.success import success_map
from detumble.show.campaign.times import capture_times
from detumble.show.campaign.trajectories import Trace, envelope

__all__ = [
    "Caption",
    "Trace",
    "capture_times",
    "convergence",
    "envelope",
    "failures",
    "sensitivity",
    "success_map",
]
