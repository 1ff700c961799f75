"""Plan of a comparison, the same for every entry."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from detumble.analysis.tuning import Objective
from detumble.analysis.tuning.setting import BUDGET, STARTS
from detumble.checking import MOST_SEED, real, seed_number, whole
from detumble.errors import RequestError

SPREAD = 10_000
"""Held-out runs, the first, on which the tunings that were not chosen are judged."""

RECORDS = "records"
"""Folder of the records of the searches, within that of the comparison."""


@dataclass(frozen=True)
class Plan:
    """Budget of every entry, and the runs that it is judged on.

    Attributes:
        objective: gains are tuned for it, and entries ordered by it.
        horizon: s, of the flights of the tuning; None as `analysis.tuning.horizon` has it.
        budget: candidates of each tuning.
        starts: runs that each candidate flies.
        tunings: independent searches of each entry.
        seed: of the training starts; the searches have the seeds from this one on.
        held_out: seed of the runs that entries are judged on; None is `seed` + 1.
        runs: number of runs that entries are judged on.
        robust: number of these that are flown again with each deviation from the scenario; 0 leaves that out.
        as_given: whether the scenario's own gains are judged, and nothing is tuned.
    """

    objective: Objective = field(default_factory=Objective)
    horizon: float | None = None
    budget: int = 800
    starts: int = 128
    tunings: int = 3
    seed: int = 0
    held_out: int | None = None
    runs: int = 100_000
    robust: int = 10_000
    as_given: bool = False

    def __post_init__(self) -> None:
        """Check the attributes.

        Raises:
            RequestError: one makes no sense.
        """
        seed = seed_number("seed", self.seed)
        held_out = (seed + 1) % (MOST_SEED + 1) if self.held_out is None else seed_number("held_out", self.held_out)
        if held_out == seed:
            raise RequestError(f"held_out {held_out}: must not be the seed of the training starts")
        read: dict[str, Any] = {"seed": seed, "held_out": held_out}
        ranges = {"budget": BUDGET, "starts": STARTS, "tunings": (1, 100), "runs": (1, 10**7), "robust": (0, 10**7)}
        for name, (least, most) in ranges.items():
            read[name] = whole(name, getattr(self, name), least, most)
        if self.horizon is not None:
            read["horizon"] = real("horizon", self.horizon, above=0.0, unit="s")
        for name, value in read.items():
            object.__setattr__(self, name, value)

    @property
    def judging(self) -> int:
        """Seed of the held-out runs."""
        assert self.held_out is not None
        return self.held_out

    def to_json(self) -> dict[str, Any]:
        """Give it as JSON takes it."""
        tuned = {"budget": self.budget, "starts": self.starts, "tunings": self.tunings, "seed": self.seed}
        return {
            "objective": self.objective.what,
            "statistic": self.objective.statistic,
            "required": self.objective.required,
            "unit": self.objective.unit,
            "horizon_s": self.horizon,
            "as_given": self.as_given,
            **({} if self.as_given else tuned),
            "held_out_seed": self.judging,
            "runs": self.runs,
            "robustness_runs": self.robust,
        }
