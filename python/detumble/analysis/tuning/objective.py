"""Cost of a set of gains: one number for all of its flights, always finite.

Each run i that succeeded has a value v_i: the capture time, that and the settling time, the Δv to capture, or all of the Δv. A
success is the campaign's: captured, and settled where the bodies merge and the flight does not end at capture. Values are
limited to the ceiling C, and a run that failed counts for C: the horizon for times; for Δv all three axes at
full acceleration for the whole horizon.

    J = S(v_i)                            where the share of successes is at least the required one; so J ≤ C
    J = C (1 + (required - share) + g)    where it is not; so J > C

S is the mean, or a percentile as an order statistic: the least value that so many percent of the runs do not exceed. g is the
mean over the runs of a grade of failure, which gives a search a gradient where no run succeeds yet:

    0       success
    0.2     captured, not settled
    0.4     all thresholds held at once, but not for the dwell time
    0.5     each threshold held at some time, never all at once; 0.1 more for each of the four that never held
    1       the state became non-finite, or the weights had no gains
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from detumble.checking import choice, real
from detumble.errors import RequestError
from detumble.failures import DIVERGED, DWELL_MISSED, NEVER_CAPTURED, NO_GAINS, NOT_SETTLED

if TYPE_CHECKING:
    from detumble.analysis.trials import Results
    from detumble.scenario.model import Scenario

Array = NDArray[np.float64]
What = Literal["capture", "settling", "delta_v", "delta_v_total"]
Until = Literal["settled", "captured", "duration"]
MEANINGS: dict[What, str] = {
    "capture": "time to capture",
    "settling": "time until settled",
    "delta_v": "Δv to capture",
    "delta_v_total": "Δv of the flight",
}

_GRADES = np.zeros(256)
_GRADES[[NOT_SETTLED, DWELL_MISSED, DIVERGED, NO_GAINS]] = 0.2, 0.4, 1.0, 1.0
_GRADES[NEVER_CAPTURED : NEVER_CAPTURED + 16] = [0.5 + 0.1 * bits.bit_count() for bits in range(16)]


@dataclass(frozen=True)
class Judgement:
    """Cost and success of candidates; every array is (candidates,).

    Attributes:
        cost: J above, s or m/s.
        share: of the runs that succeeded.
    """

    cost: Array
    share: Array


@dataclass(frozen=True)
class Objective:
    """The quantity that a search minimises.

    Attributes:
        what: `capture`: time of capture; `settling`: time from the start until settled; `delta_v`: Δv to capture;
            `delta_v_total`: Δv of the whole flight.
        percentile: of the starts, in (0, 100]; None is the mean.
        required: share of the starts that must succeed.
        until: how flights end: at capture, when the stack has settled, or never early; None as the scenario's `campaign.end`.
    """

    what: What = "capture"
    percentile: float | None = None
    required: float = 0.95
    until: Until | None = None

    def __post_init__(self) -> None:
        """Check the attributes.

        Raises:
            RequestError: one makes no sense.
        """
        choice("objective", self.what, MEANINGS)
        if self.percentile is not None:
            object.__setattr__(self, "percentile", real("percentile", self.percentile, above=0.0, most=100.0))
        object.__setattr__(self, "required", real("required", self.required, least=0.0, most=1.0, what="a share"))
        if self.until is not None:
            choice("until", self.until, ("settled", "captured", "duration"))

    @property
    def statistic(self) -> str:
        """`mean`, or the percentile as in `p95`."""
        return "mean" if self.percentile is None else f"p{self.percentile:g}"

    @property
    def meaning(self) -> str:
        """What is minimised, in words."""
        return MEANINGS[self.what]

    @property
    def unit(self) -> str:
        """s or m/s."""
        return "m/s" if self.what.startswith("delta_v") else "s"

    def end(self, scenario: Scenario) -> Until:
        """Give how flights end.

        Raises:
            RequestError: the objective is the time until settled, and no flight would get there.
        """
        end = self.until or scenario.campaign.end
        if self.what == "settling" and not scenario.capture.merge:
            raise RequestError("objective settling: capture.merge is false: there is no stack that could settle")
        if self.what == "settling" and end == "captured":
            raise RequestError("objective settling: flights end at capture; --until settled lets them go on")
        return end

    def ceiling(self, horizon: float, acceleration: float) -> float:
        """Give C above.

        Args:
            horizon: s.
            acceleration: largest acceleration of an axis, mean of the three, m/s².
        """
        return 3.0 * acceleration * horizon if self.unit == "m/s" else horizon

    def judge(self, results: Results, ceiling: float) -> Judgement:
        """Judge candidates by their flights.

        Args:
            results: of a trial.
            ceiling: C above.
        """
        good, values = results.succeeded, self.values(results)
        counted = np.where(good, np.fmin(values, ceiling), ceiling)
        share = good.mean(axis=1)
        graded = _GRADES[results.failure].mean(axis=1)
        infeasible = ceiling * (1.0 + np.maximum(self.required - share, 0.0) + graded)
        return Judgement(np.where(share >= self.required, self.summary(counted), infeasible), share)

    def values(self, results: Results) -> Array:
        """Give v of every run, (candidates, runs); NaN where the event did not happen."""
        match self.what:
            case "capture":
                return results["capture_time"]
            case "settling":
                return results["capture_time"] + results["settling_time"]
            case "delta_v":
                return results["delta_v_to_capture"]
            case _:
                return results["delta_v"]

    def summary(self, values: Array) -> Array:
        """Give S of each row of values (candidates, runs)."""
        if self.percentile is None:
            return np.asarray(values.mean(axis=1))
        place = max(math.ceil(self.percentile / 100.0 * values.shape[1] - 1e-9), 1) - 1
        return np.asarray(np.partition(values, place, axis=1)[:, place])
