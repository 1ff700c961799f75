"""Pictures of a campaign: each takes arrays, counts or statistics and gives one figure."""

from detumble.show.campaign.causes import plot_failures
from detumble.show.campaign.frame import Caption
from detumble.show.campaign.influence import plot_sensitivity
from detumble.show.campaign.precision import plot_convergence
from detumble.show.campaign.success import plot_success_map
from detumble.show.campaign.times import plot_capture_times
from detumble.show.campaign.trajectories import Trace, plot_envelope

__all__ = [
    "Caption",
    "Trace",
    "plot_capture_times",
    "plot_convergence",
    "plot_envelope",
    "plot_failures",
    "plot_sensitivity",
    "plot_success_map",
]
