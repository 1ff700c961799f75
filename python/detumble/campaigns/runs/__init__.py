"""Runs of a campaign: what is drawn, what the core flies, on which workers."""
