"""`detumble.intervals` under its former name."""

from detumble.intervals import Proportion, clopper_pearson, dkw_half_width, quantile_ranks

__all__ = ["Proportion", "clopper_pearson", "dkw_half_width", "quantile_ranks"]
