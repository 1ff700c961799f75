"""The setting of a search: the gains of one law in one scenario, the objectives, the starts, the budget."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from detumble import __version__
from detumble.analysis.tuning.horizon import default_horizon
from detumble.campaigns.recipe import arithmetic
from detumble.checking import real, seed_number, whole
from detumble.compiled import check_gains
from detumble.scenario.core import case
from detumble.scenario.faults import validated
from detumble.scenario.laws import form_of

if TYPE_CHECKING:
    from collections.abc import Mapping

    from detumble.analysis.tuning.objective import Objective
    from detumble.analysis.tuning.space import Space
    from detumble.scenario.laws import Form
    from detumble.scenario.model import Scenario


BUDGET, STARTS = (1, 10**9), (1, 10**6)
"""Fewest and most evaluations, and starts."""
REACHED = {"s": "time_s", "m/s": "delta_v_m_s"}
"""Key of the cost in `[laws.LAW.tuned]`, by its unit."""


@dataclass(frozen=True)
class Setting:
    """Gains that are searched for, how candidates are judged, and from which starts they fly.

    Attributes:
        space: the gains that are searched for, in their scenario.
        objectives: that are minimised, one or several; they agree on required success and on how flights end.
        budget: evaluations; one evaluation is one candidate flown from all starts.
        starts: runs 0 to `starts` - 1 of the campaign.
        seed: of that campaign.
        optimiser_seed: of the search itself.
        horizon: s, after which a run has failed; at most the scenario's duration.
    """

    space: Space
    objectives: tuple[Objective, ...]
    budget: int
    starts: int
    seed: int
    optimiser_seed: int
    horizon: float

    @classmethod
    def of(
        cls,
        space: Space,
        objectives: tuple[Objective, ...],
        *,
        budget: int,
        starts: int,
        seed: int,
        optimiser_seed: int | None,
        horizon: float | None,
    ) -> Setting:
        """Check the arguments of `tune` and `pareto_front`; see there.

        Raises:
            RequestError: an argument makes no sense.
            ScenarioError: the scenario cannot be flown.
        """
        budget, starts = whole("budget", budget, *BUDGET), whole("starts", starts, *STARTS)
        seed = seed_number("seed", seed)
        optimiser_seed = seed if optimiser_seed is None else seed_number("optimiser_seed", optimiser_seed)
        horizon = None if horizon is None else real("horizon", horizon, above=0.0, unit="s")
        for objective in objectives:
            objective.end(space.base)
        check_gains(space.base.title, case(space.base, space.law))
        horizon = default_horizon(space.base, seed, starts) if horizon is None else horizon
        horizon = float(min(horizon, space.base.time.duration))
        return cls(space, objectives, budget, starts, seed, optimiser_seed, horizon)

    @property
    def objective(self) -> Objective:
        """The first of the objectives."""
        return self.objectives[0]

    @property
    def form(self) -> Form | None:
        """Form of the law; None for a law that has only one."""
        return form_of(getattr(self.space.base.laws, self.space.law))

    def scenario(
        self, gains: Mapping[str, float], success: float, reached: Mapping[str, float], what: str = ""
    ) -> Scenario:
        """Give the scenario with the gains found, and `[laws.LAW.tuned]`, which says how they were found.

        Args:
            gains: found, by path; none leaves the scenario's own.
            success: share of the training starts that succeed.
            reached: cost by its unit; empty where too few succeed.
            what: was minimised; empty for what the objective says.
        """
        raw, objective = self.space.scenario(gains).to_dict(), self.objective
        raw["laws"][self.space.law]["tuned"] = {
            "objective": what or objective.what,
            "statistic": objective.statistic,
            "success": success,
            "required": objective.required,
            "until": objective.end(self.space.base),
            "horizon_s": self.horizon,
            "starts": self.starts,
            "seed": self.seed,
            "optimiser_seed": self.optimiser_seed,
            "evaluations": self.budget,
            "version": __version__,
            **{REACHED[unit]: cost for unit, cost in reached.items()},
        }
        return validated(raw, self.space.base.title)

    def header(self, more: Mapping[str, Any] = {}) -> dict[str, Any]:
        """Give the first line of the record: all that the outcomes and the order of the candidates depend on.

        Args:
            more: what one kind of search adds; its entries replace those of the same name. Only read.
        """
        import hashlib
        from importlib.metadata import version

        return {
            "law": self.space.law,
            "gains": [tunable.path for tunable in self.space.tunables],
            "scenario": hashlib.sha256(self.space.base.to_toml().encode()).hexdigest(),
            "objective": asdict(self.objective),
            **more,
            "starts": self.starts,
            "seed": self.seed,
            "optimiser_seed": self.optimiser_seed,
            "horizon_s": self.horizon,
            "detumble": __version__,
            "cma": version("cma"),
            "numpy": np.__version__,
            "arithmetic": arithmetic(None),
        }

    def to_json(self) -> dict[str, Any]:
        """Give the setting as JSON takes it."""
        base, law, objective = self.space.base, self.space.law, self.objective
        return {
            "scenario": base.title,
            "law": law,
            "form": self.form,
            "objective": objective.what,
            "statistic": objective.statistic,
            "required": objective.required,
            "until": objective.end(base),
            "horizon_s": self.horizon,
            "starts": self.starts,
            "seed": self.seed,
            "optimiser_seed": self.optimiser_seed,
            "evaluations": self.budget,
        }


@dataclass(frozen=True)
class SearchResult:
    """Result of a search for gains.

    Attributes:
        setting: of the search.
        seconds: that it took, wall-clock time.
    """

    setting: Setting
    seconds: float

    @property
    def law(self) -> str:
        """Name of the law whose gains they are."""
        return self.setting.space.law

    @property
    def initial(self) -> Scenario:
        """The scenario that the first candidate flew: form, stack's set and held gains as asked for."""
        return self.setting.space.base

    @property
    def objective(self) -> Objective:
        """The objective; of a front, that of the time."""
        return self.setting.objective

    @property
    def horizon(self) -> float:
        """Time after which a run has failed, s."""
        return self.setting.horizon

    @property
    def evaluations(self) -> int:
        """Number of candidates flown."""
        return self.setting.budget

    @property
    def starts(self) -> int:
        """Number of training starts."""
        return self.setting.starts

    @property
    def seed(self) -> int:
        """Seed of the training starts."""
        return self.setting.seed

    @property
    def optimiser_seed(self) -> int:
        """Seed of the search."""
        return self.setting.optimiser_seed
