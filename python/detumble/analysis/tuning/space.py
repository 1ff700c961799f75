"""From points of the unit cube to gains of a law in a scenario, and back. What the coordinates mean is said in `gains`."""

from __future__ import annotations

import copy
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from detumble.analysis.tuning.gains import CHANNELS, EXPONENT, Tunable, gains_in, gains_of, natural_of, odd_fraction
from detumble.campaigns.runs.overlay import overlay
from detumble.checking import choice, flag, instance, real
from detumble.errors import RequestError
from detumble.scenario.faults import validated
from detumble.scenario.laws import EXPONENTS, LAWS, Prrl, Tsmc
from detumble.text import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from detumble.scenario.laws import Form, Law, Natural
    from detumble.scenario.model import Scenario

Array = NDArray[np.float64]


def space_of(
    scenario: Scenario,
    law: str,
    *,
    form: Form | None = None,
    stack: bool | None = None,
    fixed: Mapping[str, float | None] | None = None,
) -> Space:
    """Say what is searched for.

    Args:
        scenario: nominal; one without gains for the law begins in the middle of their ranges.
        law: one of `LAWS`.
        form: of the law; None as the scenario says.
        stack: search for the stack's own gains in both channels (True) or in none (False: the stack flies the first set); None as
            the scenario has them.
        fixed: gains that are held, by path; None holds one at what the scenario says.

    Raises:
        RequestError: no such law or form; no such gain to hold; nothing is left to search for, or it is dispersed; a limit is
            infinite.
        ScenarioError: a held value is none that the gain can have.
    """
    if form is not None:
        choice("form", form, EXPONENTS)
    choice("law", law, LAWS)
    if stack is not None:
        stack = flag("stack", stack)
    if fixed is not None:
        instance("fixed", fixed, dict, "a dict of gains by path")
    raw = copy.deepcopy(scenario.to_dict())
    laws = raw.setdefault("laws", {})
    if law not in laws:
        laws[law] = _middle(raw, law, form or "printed")
    table = laws[law]
    table.pop("tuned", None)
    table["form"] = form or table["form"]
    if stack is False:
        table.pop("stack", None)
    elif stack:
        own = table.setdefault("stack", {})
        for channel in CHANNELS:
            own.setdefault(channel, dict(table[channel]))
    tunables = gains_in(law, table)
    known = [tunable.path for tunable in tunables]
    for path, value in (fixed or {}).items():
        instance("fixed", path, str, "a dict of gains by path")
        if path not in known:
            raise RequestError(f"{path}: is no gain of {law}{did_you_mean(path, known)}; there are {', '.join(known)}")
        if value is not None:
            held = real(path, value)
            _check_held(law, path, held, table["form"])
            put(table, path, held)
    searched = tuple(tunable for tunable in tunables if tunable.path not in (fixed or {}))
    if not searched:
        raise RequestError(f"{law}: every gain is held; nothing is left to search for")
    for number, dispersion in enumerate(scenario.dispersions):
        if dispersion.field in {f"laws.{law}.{tunable.path}" for tunable in searched}:
            raise RequestError(
                f"dispersions[{number}].field: {dispersion.field} is drawn at random: it cannot be tuned"
            )
    return Space(validated(raw, scenario.title), law, searched)


def _check_held(law: str, path: str, value: float, form: Form) -> None:
    """Make sure that an exponent is one that the form can have: a scenario checks all other gains, but no p/q.

    Raises:
        RequestError: it is not.
    """
    if not path.endswith(EXPONENT):
        return
    low, high = EXPONENTS[form]
    if not (low <= value <= high and value != 1.0):
        raise RequestError(f"{path} {value!r}: the {form} form of {law} takes {low:.4g} to {high:.4g}, 1 excluded")


def _middle(raw: dict[str, Any], law: str, form: Form) -> dict[str, Any]:
    """Give the table of a law that the scenario has no gains for."""
    tunables = gains_of(law, form)
    anything: dict[str, Any] = {"form": form, **{channel: {"r": 1.0} if law == "lqr" else {} for channel in CHANNELS}}
    for tunable in tunables:
        if not tunable.path.endswith(EXPONENT):
            put(anything, tunable.path, 0.5)
    begun = validated(raw | {"laws": raw["laws"] | {law: anything}}, str(raw["title"]))
    space = Space(begun, law, tunables)
    table: dict[str, Any] = space.scenario(space.values([0.5] * len(tunables))).to_dict()["laws"][law]
    return table


@dataclass(frozen=True)
class Space:
    """The gains of one law in one scenario that are searched for.

    Attributes:
        base: the scenario with the law's form, held gains and sets as they are flown; what the search begins with.
        law: name of the law.
        tunables: what is searched for, in the order of the coordinates.
    """

    base: Scenario
    law: str
    tunables: tuple[Tunable, ...]

    @cached_property
    def naturals(self) -> dict[str, Natural]:
        """What each channel is measured by, but for the power."""
        gains = self._law

        def r_of(channel: str) -> float:
            return float(getattr(gains.at(channel), "r", 1.0))

        channels = {tunable.channel for tunable in self.tunables} - {""}
        return {channel: natural_of(self.base, channel, r_of(channel)) for channel in sorted(channels)}

    @property
    def _law(self) -> Law[Any, Any]:
        law: Law[Any, Any] = getattr(self.base.laws, self.law)
        return law

    def natural(self, tunable: Tunable, chosen: Mapping[str, float]) -> Natural | None:
        """Give what a gain is measured by, among the powers that have been chosen."""
        if not tunable.channel:
            return None
        plain = self.naturals[tunable.channel]
        return replace(plain, power=self._power(tunable.channel, chosen))

    def _power(self, channel: str, chosen: Mapping[str, float]) -> float:
        law = self._law
        if isinstance(law, Prrl):
            own = f"{channel}.alpha" if law.at(channel).alpha is not None else "alpha"
            return chosen.get(own, law.power(channel))
        return chosen.get(f"{channel}.{EXPONENT}", exponent_of(law, channel)) if isinstance(law, Tsmc) else 1.0

    def values(self, point: Sequence[float]) -> dict[str, float]:
        """Give the gains at a point of the unit cube, by path.

        Args:
            point: coordinates, one for each of `tunables`. They are taken one number at a time, so that the bits of a candidate
                do not depend on how many are looked at together.
        """
        chosen: dict[str, float] = {}
        # powers first: natural scales depend on them
        order = sorted(range(len(self.tunables)), key=lambda place: self.tunables[place].scale is not None)
        for place in order:
            tunable = self.tunables[place]
            value = tunable.value(float(point[place]), self.natural(tunable, chosen))
            if tunable.path.endswith(EXPONENT):
                p, q = odd_fraction(value, self._law.form)
                value = p / q
            chosen[tunable.path] = value
        return {tunable.path: chosen[tunable.path] for tunable in self.tunables}

    def point(self, values: Mapping[str, float]) -> Array:
        """Give the point of the unit cube that is nearest to given gains; shape (n,)."""
        return np.array(
            [tunable.coordinate(values[tunable.path], self.natural(tunable, values)) for tunable in self.tunables]
        )

    @cached_property
    def own(self) -> dict[str, float]:
        """The scenario's own gains by path; of one that differs from axis to axis the geometric mean."""
        return {tunable.path: _mean(self._law, tunable.path) for tunable in self.tunables}

    def columns(self, points: Array) -> dict[str, Array]:
        """Give the gains at points (k, n) of the unit cube as the core takes them: by path, (k, width)."""
        chosen = [self.values(point) for point in points]
        named = {f"laws.{self.law}.{path}": np.array([each[path] for each in chosen]) for path in self.own}
        widened = overlay(self.base, self.law, named)
        return {
            path: np.ascontiguousarray(column[:, :1]) if path.endswith(EXPONENT) else column
            for path, column in widened.items()
        }

    def scenario(self, values: Mapping[str, float]) -> Scenario:
        """Give the scenario with other gains, everything else untouched."""
        raw = self.base.to_dict()
        for path, value in values.items():
            put(raw["laws"][self.law], path, value)
        return validated(raw, self.base.title)


def exponent_of(law: Law[Any, Any], channel: str) -> float:
    """Give the terminal exponent p/q of a channel that the law's form flies."""
    p, q = law.at(channel).exponent(law.form)
    return float(p) / float(q)


def put(table: dict[str, Any], path: str, value: float) -> None:
    """Set a gain in the plain table of a law, as its file has it."""
    *steps, name = path.split(".")
    channel = table
    for step in steps:
        channel = channel[step]
    if name == EXPONENT:
        ending = "" if table["form"] == "printed" else "_corrected"
        channel[f"p{ending}"], channel[f"q{ending}"] = odd_fraction(value, table["form"])
    else:
        channel[name] = value


def _mean(law: Law[Any, Any], path: str) -> float:
    if path.endswith(EXPONENT):
        return exponent_of(law, path.rpartition(".")[0])
    value = law.at(path)
    return value if isinstance(value, float) else float(np.prod(value)) ** (1.0 / 3.0)
