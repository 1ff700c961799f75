"""Comparison of control laws with equal tuning on common runs: order, significance, distance from the bound, robustness."""

from detumble.analysis.comparing.comparer import compare
from detumble.analysis.comparing.entries import Entry, entries_of
from detumble.analysis.comparing.plan import Plan
from detumble.analysis.comparing.result import Comparison

__all__ = ["Comparison", "Entry", "Plan", "compare", "entries_of"]
