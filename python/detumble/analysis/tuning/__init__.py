"""Search for the best gains of a law: what can be searched, the objective, and the search."""

from detumble.analysis.tuning.objective import Objective
from detumble.analysis.tuning.pareto import Front, pareto_front
from detumble.analysis.tuning.search import Generation
from detumble.analysis.tuning.tuner import Tuned, Worth, held_out, tune

__all__ = ["Front", "Generation", "Objective", "Tuned", "Worth", "held_out", "pareto_front", "tune"]
