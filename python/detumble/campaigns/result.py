"""Result of a campaign: statistics, the table of its runs, and the flight of any run again."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

from detumble.campaigns.statistics.running import Statistics
from detumble.campaigns.store.campaign_folder import Store
from detumble.errors import RequestError
from detumble.scenario.accuracy import coarse_step
from detumble.scenario.hints import warnings
from detumble.simulation import INSIDE, cut_off

if TYPE_CHECKING:
    import os
    from collections.abc import Sequence
    from pathlib import Path

    from detumble.campaigns.recipe import Recipe
    from detumble.campaigns.statistics.sensitivity import Sensitivity
    from detumble.campaigns.store.table import Runs
    from detumble.flight import Flight


@dataclass
class Effort:
    """Work of a call: the runs that it flew itself, without those read from the folder.

    Attributes:
        flown: runs.
        ticks: control ticks in them.
        lane_ticks: ticks that the lanes went through, idle ones too.
        seconds: of wall time, writing included.
    """

    flown: int = 0
    ticks: int = 0
    lane_ticks: int = 0
    seconds: float = 0.0

    def count(self, flown: int, ticks: int, lane_ticks: int) -> None:
        """Add the work of a shard."""
        self.flown += flown
        self.ticks += ticks
        self.lane_ticks += lane_ticks

    def to_json(self) -> dict[str, float | int | None]:
        """Give rates as JSON takes them; None where nothing was flown."""
        if not self.flown:
            return {"rate_runs_per_s": None, "steps_per_s": None, "lane_use": None, "flown": 0, "wall_s": self.seconds}
        return {
            "rate_runs_per_s": self.flown / self.seconds,
            "steps_per_s": (self.ticks - self.flown) / self.seconds,
            "lane_use": self.ticks / self.lane_ticks,
            "flown": self.flown,
            "wall_s": self.seconds,
        }


def read_campaign(folder: str | os.PathLike[str]) -> CampaignResult:
    """Read a campaign back, finished or not: the runs from the first on, as far as they are there without a gap.

    Args:
        folder: that it was flown into.

    Raises:
        RequestError: there is no campaign, or none of its runs can be read.
    """
    store = Store.open(folder)
    statistics = Statistics.of(store.recipe.parsed)
    for index in range(store.recipe.shards(store.runs)):
        rows = store.find(index, 1, lambda _: None, all_rows=True)
        if rows is None:
            break
        statistics.add(rows)
        if rows.height < store.recipe.shard:
            break
    if not statistics.runs:
        raise RequestError(f"{store.path(0)}: missing or damaged; --resume flies it")
    return CampaignResult(store, statistics, Effort())


@dataclass(frozen=True, eq=False)
class CampaignResult:
    """A campaign that has been flown.

    Attributes:
        store: its folder.
        statistics: of all its runs.
        effort: work of this call.
    """

    store: Store
    statistics: Statistics
    effort: Effort

    @property
    def folder(self) -> Path:
        """Folder of the runs."""
        return self.store.folder

    @property
    def recipe(self) -> Recipe:
        """What was flown."""
        return self.store.recipe

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences about what limits the validity of the statistics."""
        statistics, found = self.statistics, []
        runs, at_once, fast = statistics.runs, statistics.captured_at_once, statistics.fast_turns
        if at_once and self.recipe.law != "none":
            found.append(f"{INSIDE}, in {at_once} of {runs} runs" if at_once < runs else f"{INSIDE}, in every run")
        if fast and math.isfinite(statistics.summary("largest_rate_rad_s").largest or 0.0):
            rate = statistics.summary("largest_rate_rad_s").largest or 0.0
            duration = self.recipe.parsed.time.duration
            found.append(f"in {fast} of {runs} runs {coarse_step(statistics.inertia, rate, statistics.step, duration)}")
        if self.recipe.law == "none":
            clipped = [what for what in ("force", "torque") if statistics.summary(f"{what}_saturated_share").largest]
            found += [
                f"the {what} commanded is over actuators.{what}_limit in some runs, and cut to it" for what in clipped
            ]
            found += cut_off(self.recipe.parsed)
        return (*found, *warnings(self.recipe.parsed, self.recipe.law))

    @cached_property
    def runs(self) -> Runs:
        """The table of runs: `lazy()`, `to_polars()`, `to_pandas()`, `to_xarray()`."""
        from detumble.campaigns.store.table import Runs  # brings xarray and pandas

        return Runs(self.store, self.statistics.runs)

    def replay(self, index: int, *, backend: str | None = None) -> Flight:
        """Fly a run again, bit for bit, and keep its full history.

        Args:
            index: of the run.
            backend: of the core; None takes one that gives the same bits.

        Raises:
            RequestError: there is no such run.
        """
        from detumble.campaigns.runs.flying import checked_index, fly_again

        return fly_again(self.recipe, checked_index(index, self.statistics.runs), backend=backend)

    def sensitivities(self) -> tuple[Sensitivity, Sensitivity]:
        """Say which of the drawn inputs failure and capture time depend on.

        Returns:
            For failure, and for the capture time.

        Raises:
            RequestError: SALib is not installed.
        """
        from detumble.campaigns.statistics.sensitivity import sensitivities

        return sensitivities(self.runs.lazy(), self.recipe.parsed)

    def figures(self, over: Sequence[str] = (), target: float | None = None) -> list[Path]:
        """Write all pictures into the folder `figures` of the campaign; some of its runs are flown again for it.

        Args:
            over: the two inputs of the success map; none takes the two that matter most.
            target: half width of the success interval that was asked for.

        Returns:
            The files.

        Raises:
            RequestError: there are no such inputs, SALib is not installed, or a file cannot be written.
        """
        from detumble.campaigns.pictures import write_pictures

        return write_pictures(self.store, self.statistics, over, target)

    def to_json(self) -> dict[str, Any]:
        """Give everything in one object, as `detumble campaign --json` prints it."""
        scenario = self.recipe.parsed
        named = {"scenario": scenario.title, "law": self.recipe.law, "seed": self.recipe.seed}
        where = {"warnings": list(self.warnings), "folder": str(self.folder)}
        return {**named, **self.statistics.to_json(), **self.effort.to_json(), **where}
