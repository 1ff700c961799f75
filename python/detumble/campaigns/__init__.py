"""Campaigns: many flights of one dispersed scenario, their storage, statistics and distribution over workers."""

FIGURES = tuple(
    f"figures/{name}.png"
    for name in ("capture-times", "failures", "convergence", "envelope", "sensitivity", "success-map")
)
"""Pictures of a campaign, in its folder."""
