"""The former home of `detumble.intervals`."""

import warnings

from detumble.intervals import Proportion, clopper_pearson, dkw_half_width, quantile_ranks

__all__ = ["Proportion", "clopper_pearson", "dkw_half_width", "quantile_ranks"]

warnings.warn("detumble.campaigns.intervals is now detumble.intervals", DeprecationWarning, stacklevel=2)
