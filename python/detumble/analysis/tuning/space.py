"""From points of the unit cube to gains of a law in a scenario, and back. What the coordinates mean is said in `gains`."""

from __future__ import annotations

import copy
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from detumble.analysis.tuning.gains import STACK_CHANNELS, Tunable, gains_in, gains_of, natural_of
from detumble.campaigns.runs.overlay import overlay
from detumble.checking import choice, flag, instance, real
from detumble.errors import RequestError
from detumble.scenario.faults import validated
from detumble.scenario.laws import CHANNELS, LAWS, REGISTER, checked_form
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
    form = checked_form(choice("law", law, LAWS), form)
    if stack is not None:
        stack = flag("stack", stack)
    if fixed is not None:
        instance("fixed", fixed, dict, "a dict of gains by path")
    raw = copy.deepcopy(scenario.to_dict())
    laws = raw.setdefault("laws", {})
    if law not in laws:
        laws[law] = _middle(raw, law, form)
    table = laws[law]
    table.pop("tuned", None)
    if form is not None:
        table["form"] = form
    if stack is False:
        table.pop("stack", None)
    elif stack:
        own = table.setdefault("stack", {})
        for channel in CHANNELS:
            own.setdefault(channel, dict(table[channel]))
    tunables = {tunable.path: tunable for tunable in gains_in(law, table)}
    for path, value in (fixed or {}).items():
        instance("fixed", path, str, "a dict of gains by path")
        if path not in tunables:
            there = ", ".join(tunables)
            raise RequestError(f"{path}: is no gain of {law}{did_you_mean(path, tunables)}; there are {there}")
        if value is not None:
            held = real(path, value)
            _check_held(law, tunables[path], held, table.get("form"))
            put(table, tunables[path], held)
    searched = tuple(tunable for path, tunable in tunables.items() if path not in (fixed or {}))
    if not searched:
        raise RequestError(f"{law}: every gain is held; nothing is left to search for")
    for number, dispersion in enumerate(scenario.dispersions):
        if dispersion.field in {f"laws.{law}.{tunable.path}" for tunable in searched}:
            raise RequestError(
                f"dispersions[{number}].field: {dispersion.field} is drawn at random: it cannot be tuned"
            )
    return Space(validated(raw, scenario.title), law, searched)


def _check_held(law: str, tunable: Tunable, value: float, form: Form | None) -> None:
    """Make sure that a fraction is one that the form can have: a scenario checks all other gains, but not those.

    Raises:
        RequestError: it is not.
    """
    if tunable.fraction is not None and not tunable.fraction.takes(value):
        low, high = tunable.fraction.span
        raise RequestError(
            f"{tunable.path} {value!r}: the {form} form of {law} takes {low:.4g} to {high:.4g}, 1 excluded"
        )


def _middle(raw: dict[str, Any], law: str, form: Form | None) -> dict[str, Any]:
    """Give the table of a law that the scenario has no gains for."""
    tunables = gains_of(law, form)
    anything: dict[str, Any] = {"form": form} if form else {}
    for channel in CHANNELS:
        gains = REGISTER[law].channel(channel).gains()
        anything[channel] = {name: 1.0 for name, gain in gains.items() if gain.span is None}
    for tunable in tunables:
        if tunable.fraction is None:  # a fraction has its default
            put(anything, tunable, 0.5)
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
        """What each channel is measured by, but for gains that scales depend on."""
        channels = {tunable.channel for tunable in self.tunables} - {""}
        return {channel: natural_of(self.base, channel) for channel in sorted(channels)}

    @property
    def _law(self) -> Law[Any, Any]:
        law: Law[Any, Any] = getattr(self.base.laws, self.law)
        return law

    @cached_property
    def _unscaled(self) -> dict[str, float]:
        """The scenario's own gains without a scale, those not searched for too, by path."""
        law = self._law
        tunables = gains_in(self.law, law.model_dump(exclude_none=True))
        found = {tunable.path: tunable.own(law) for tunable in tunables if tunable.scale is None}
        for channel in (*CHANNELS, *STACK_CHANNELS):
            own = law.at(channel)
            fixed = [name for name, gain in own.gains().items() if gain.span is None] if own else []
            found |= {f"{channel}.{name}": getattr(own, name) for name in fixed}
        return found

    def natural(self, tunable: Tunable, chosen: Mapping[str, float]) -> Natural | None:
        """Give what a gain is measured by, among the gains without a scale that have been chosen."""
        if not tunable.channel:
            return None
        gains = {}
        for path, own in self._unscaled.items():  # what the channels share comes first, a channel's own takes its place
            channel, _, name = path.rpartition(".")
            if channel in ("", tunable.channel):
                gains[name] = chosen.get(path, own)
        return replace(self.naturals[tunable.channel], gains=gains)

    def values(self, point: Sequence[float]) -> dict[str, float]:
        """Give the gains at a point of the unit cube, by path.

        Args:
            point: coordinates, one for each of `tunables`. They are taken one number at a time, so that the bits of a candidate
                do not depend on how many are looked at together.
        """
        chosen: dict[str, float] = {}
        # those without a scale first: the scales of others depend on them
        order = sorted(range(len(self.tunables)), key=lambda place: self.tunables[place].scale is not None)
        for place in order:
            tunable = self.tunables[place]
            chosen[tunable.path] = tunable.value(float(point[place]), self.natural(tunable, chosen))
        return {tunable.path: chosen[tunable.path] for tunable in self.tunables}

    def point(self, values: Mapping[str, float]) -> Array:
        """Give the point of the unit cube that is nearest to given gains; shape (n,)."""
        return np.array(
            [tunable.coordinate(values[tunable.path], self.natural(tunable, values)) for tunable in self.tunables]
        )

    @cached_property
    def own(self) -> dict[str, float]:
        """The scenario's own gains by path; of one that differs from axis to axis the geometric mean."""
        return {tunable.path: tunable.own(self._law) for tunable in self.tunables}

    def columns(self, points: Array) -> dict[str, Array]:
        """Give the gains at points (k, n) of the unit cube as the core takes them: by path, (k, width)."""
        drawn: dict[str, list[float]] = {}
        for point in points:
            chosen = self.values(point)
            for tunable in self.tunables:
                for path, value in tunable.fields(chosen[tunable.path]).items():
                    drawn.setdefault(f"laws.{self.law}.{path}", []).append(value)
        return overlay(self.base, self.law, {path: np.array(values, float) for path, values in drawn.items()})

    def scenario(self, values: Mapping[str, float]) -> Scenario:
        """Give the scenario with other gains, everything else untouched."""
        raw = self.base.to_dict()
        for tunable in self.tunables:
            if tunable.path in values:
                put(raw["laws"][self.law], tunable, values[tunable.path])
        return validated(raw, self.base.title)


def put(table: dict[str, Any], tunable: Tunable, value: float) -> None:
    """Set a gain in the plain table of a law, as its file has it."""
    for path, number in tunable.fields(value).items():
        *steps, name = path.split(".")
        inner = table
        for step in steps:
            inner = inner[step]
        inner[name] = number
