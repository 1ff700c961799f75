"""Bounds that no controller can beat, each with the proof or the trajectory behind it."""
