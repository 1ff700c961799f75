"""Several laws with equal means on the same runs: which is better, at what, how surely, and how far from the bound."""

from detumble.analysis.comparing.comparer import compare
from detumble.analysis.comparing.entries import Entry, entries_of
from detumble.analysis.comparing.plan import Plan
from detumble.analysis.comparing.result import Comparison

__all__ = ["Comparison", "Entry", "Plan", "compare", "entries_of"]
