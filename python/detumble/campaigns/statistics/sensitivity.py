"""Which of the dispersed parameters failures and capture times depend on, from the runs as they were flown.

For each input the runs are cut into ten slices of equal size by its value, and each slice's outcomes are held against
those of all runs. The index is the mean over the slices of the distance between the two distributions, the PAWN index of
Pianosi & Wagener (Environmental Modelling & Software 67, 2015; 108, 2018): 0 without influence, at most 1, with no
assumption on how the outcome depends on the input.

- Capture time: the distance is that of Kolmogorov and Smirnov.
- Failure: it is |P(failed | slice) - P(failed)|. Divided by 2 P(failed) P(succeeded), its mean is the total variation
  between the input's distributions among the failed and among the successful runs, cut into the same slices. That does
  not shrink with the failures' share, so that rare failures may be taken in larger number than they occur.

An index estimated from n runs is never 0. Its level for an input without influence is measured, not assumed: columns of
independent random numbers go through the same computation, and about one in a thousand of them exceeds the threshold.
Inputs are judged one by one: a parameter that matters only together with another one may stay below the threshold.
"""

from __future__ import annotations

import warnings
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import polars as pl

from detumble.campaigns.columns import FAILURE, INDEX, SUCCEEDED
from detumble.campaigns.statistics.inputs import drawn_columns, inputs
from detumble.errors import RequestError

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from detumble.scenario.model import Scenario

Array: TypeAlias = "NDArray[np.float64]"

CAPTURE_TIME = "capture_time_s"

RUNS = 12_000
"""Most runs that an index is estimated from, the first of the campaign: enough to distinguish 0.03 from 0."""
FAILURES = 6_000
"""Most failures from further on that are added to them for the index of failure."""
FEWEST_RUNS = 100
FEWEST_OF_A_KIND = 10
"""Fewest failures, and fewest successes, that the index of failure is estimated from."""
SLICES = 10
DUMMIES = 100
"""Columns of random numbers; with a third of them the threshold itself scatters by a third of what it adds to their mean."""
CLEAR = 4.0
"""Distance of the threshold from the mean index of these columns, in standard deviations."""
GROUPS = 10
"""Parts of the sample, each left out once for the confidence."""


@dataclass(frozen=True)
class Influence:
    """Influence of one input on the outcome.

    Attributes:
        field: path of the field, its component or what is derived from it: `|debris.tumble_rate|`.
        index: 0 to 1, see above.
        confidence: half width of the index's interval of 95 %.
        correlation: Spearman's, with the capture time or with failing (positive: more of the input, more failures).
        p_value: of that correlation, two-sided; of this input alone.
    """

    field: str
    index: float
    confidence: float
    correlation: float
    p_value: float


@dataclass(frozen=True)
class Sensitivity:
    """Influences on one outcome.

    Attributes:
        outcome: `failure` or `capture_time_s`.
        runs: that it was estimated from.
        influences: of every input that varies, the largest index first.
        threshold: an index up to this is no sign of an influence; None where there are no indices.
        constant: inputs that were the same in all runs.
        silence: why there are no indices; empty where there are.
    """

    outcome: str
    runs: int
    influences: tuple[Influence, ...] = ()
    threshold: float | None = None
    constant: tuple[str, ...] = ()
    silence: str = ""

    @property
    def influential(self) -> tuple[Influence, ...]:
        """The influences above the threshold."""
        return tuple(found for found in self.influences if found.index > (self.threshold or 0.0))

    def to_json(self) -> dict[str, Any]:
        """Give it as JSON takes it."""
        return asdict(self)


def sensitivities(runs: pl.LazyFrame | pl.DataFrame, scenario: Scenario) -> tuple[Sensitivity, Sensitivity]:
    """Say which inputs failure and capture time depend on.

    Args:
        runs: in order of index, columns as in `campaigns.columns`. For failure the first `RUNS` are used and the next
            `FAILURES` that failed, for the capture time the first `RUNS` that captured.
        scenario: what was dispersed.

    Returns:
        For failure (over all runs) and for the capture time (over the runs that captured).

    Raises:
        RequestError: SALib is not installed.
    """
    lazy = runs.lazy()
    failed = ~pl.col(SUCCEEDED.name)
    wanted = lazy.select(INDEX.name, SUCCEEDED.name, CAPTURE_TIME, *drawn_columns(lazy.collect_schema().names()))
    late = pl.col(INDEX.name) >= RUNS
    captured = pl.col(CAPTURE_TIME).is_not_nan()  # null is not kept either
    # streaming: reading ends as soon as there are enough, however long the campaign
    first, further, captures = (
        part.collect(engine="streaming")
        for part in (
            wanted.filter(~late),
            wanted.filter(late & failed).head(FAILURES),
            wanted.filter(captured).head(RUNS),
        )
    )
    return _of_failure(pl.concat([first, further]), scenario), _of_capture_time(captures, scenario)


def pawn() -> Callable[..., Any]:
    """Give SALib's PAWN analysis; a call before the work starts reports early that it is missing.

    Raises:
        RequestError: SALib is not installed.
    """
    try:
        from SALib.analyze.pawn import analyze  # type: ignore[import-untyped]
    except ImportError:
        raise RequestError(
            "sensitivity needs SALib, which is not installed: pip install 'detumble[sensitivity]'"
        ) from None
    found: Callable[..., Any] = analyze
    return found


def _of_failure(rows: pl.DataFrame, scenario: Scenario) -> Sensitivity:
    failed = ~rows[SUCCEEDED.name].to_numpy()
    total, failures = len(failed), int(np.count_nonzero(failed))
    silence = ""
    for count, what in ((failures, "failed"), (total - failures, "succeeded")):
        if total >= FEWEST_RUNS and count < FEWEST_OF_A_KIND:
            number = f"only {count}" if count else "none"
            silence = f"{number} of {total} runs {what}; at least {FEWEST_OF_A_KIND} are needed"
    return _influences(FAILURE.name, rows, failed.astype(np.float64), scenario, silence)


def _of_capture_time(rows: pl.DataFrame, scenario: Scenario) -> Sensitivity:
    times = rows[CAPTURE_TIME].to_numpy()
    silence = "all runs captured at the same time" if len(times) and np.ptp(times) == 0.0 else ""
    return _influences(CAPTURE_TIME, rows, times, scenario, silence)


def _influences(outcome: str, rows: pl.DataFrame, values: Array, scenario: Scenario, silence: str) -> Sensitivity:
    if rows.height < FEWEST_RUNS:
        what = "captured" if outcome == CAPTURE_TIME else "flown"
        return Sensitivity(
            outcome, rows.height, silence=f"{rows.height} runs {what}; at least {FEWEST_RUNS} are needed"
        )
    varying, constant = inputs(rows, scenario)
    silence = silence or ("" if varying else "nothing was dispersed")
    if silence:
        return Sensitivity(outcome, rows.height, constant=constant, silence=silence)
    from scipy.stats import spearmanr  # type: ignore[import-untyped]  # slow to import

    table = np.stack(list(varying.values()), axis=-1)
    of_failure = outcome == FAILURE.name
    indices = _indices(table, values, of_failure)
    confidence = _confidence(table, values, of_failure)
    dummies = _indices(np.random.default_rng(0).random((rows.height, DUMMIES)), values, of_failure)
    found = []
    for place, (field, column) in enumerate(varying.items()):
        correlation, p_value = spearmanr(column, values)
        found.append(
            Influence(field, float(indices[place]), float(confidence[place]), float(correlation), float(p_value))
        )
    found.sort(key=lambda influence: (-influence.index, influence.field))
    threshold = float(dummies.mean() + CLEAR * dummies.std(ddof=1))
    return Sensitivity(outcome, rows.height, tuple(found), threshold, constant)


def _indices(table: Array, values: Array, of_failure: bool) -> Array:
    """Give the index of each column of a table (n, m) for outcomes (n,): 0 and 1, or times."""
    names = [str(place) for place in range(table.shape[1])]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # of p-values, which are not used
        found: Array = pawn()({"num_vars": len(names), "names": names}, table, values, S=SLICES)["mean"]
    share = float(values.mean())
    return found / (2.0 * share * (1.0 - share)) if of_failure else found


def _confidence(table: Array, values: Array, of_failure: bool) -> Array:
    """Give the half width of each index's interval of 95 %.

    By the jackknife, each group of runs left out once: no random numbers are needed, and the bias of the index cancels.
    """
    from scipy.stats import t  # slow to import

    order = np.argsort(values, kind="stable") if of_failure else np.arange(len(values))
    group = np.empty(len(values), np.int64)
    group[order] = np.arange(len(values)) % GROUPS  # few failures are spread evenly, so that none is left without
    left_out = np.array([_indices(table[group != out], values[group != out], of_failure) for out in range(GROUPS)])
    spread = np.sqrt((GROUPS - 1) * left_out.var(axis=0))
    half_width: Array = t.ppf(0.975, GROUPS - 1) * spread
    return half_width
