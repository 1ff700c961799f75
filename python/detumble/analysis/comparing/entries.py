"""Entries of a comparison: a law, in one of its forms where it has several, under a name."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from detumble.checking import choice, instance, texts
from detumble.errors import RequestError
from detumble.scenario.laws import FORMS, LAWS, REGISTER, TITLES, checked_form, form_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from detumble.scenario.laws import Form
    from detumble.scenario.model import Scenario

MOST_CHARACTERS = 60
"""Longest name that fits tables and figures."""


@dataclass(frozen=True)
class Entry:
    """A law that is compared.

    Attributes:
        name: in tables, figures and file names; two entries may be the same law under two names.
        law: one of `LAWS`.
        form: as the paper prints the law, or corrected; None for a law that has only one form.
    """

    name: str
    law: str
    form: Form | None = None

    @classmethod
    def of(cls, law: str, form: Form | None = None) -> Entry:
        """Name a law and its form as tables do: TSMC, or TSMC corrected."""
        return cls(TITLES[law] + (" corrected" if form == "corrected" else ""), law, form)

    @classmethod
    def parsed(cls, text: str, scenario: Scenario) -> Entry:
        """Read `NAME=LAW` or `NAME=LAW:FORM`; without a form it is the scenario's.

        Raises:
            RequestError: it cannot be read, or there is no such law.
        """
        name, equals, rest = text.partition("=")
        law, colon, form = rest.partition(":")
        if not equals or not name.strip() or not law:
            raise RequestError(f"entry {text!r}: must be NAME=LAW or NAME=LAW:FORM")
        given = getattr(scenario.laws, _check(law))
        own = form_of(given) if given else next(iter(REGISTER[law].forms()), None)
        try:
            return cls(name.strip(), law, checked_form(law, form) if colon else own)
        except RequestError as error:
            raise RequestError(f"entry {text!r}: {error}") from None

    @property
    def file(self) -> str:
        """The name as part of a file name: lower case, letters and digits with hyphens between."""
        return re.sub(r"[^a-z0-9]+", "-", self.name.lower()).strip("-")

    def of_scenario(self, scenario: Scenario) -> Scenario:
        """Give a copy of the scenario that flies the law in this form."""
        own = scenario.model_copy(deep=True)
        if self.form is not None:
            getattr(own.laws, self.law).form = self.form
        return own


def entries_of(laws: Iterable[str] = LAWS, forms: Iterable[Form] = FORMS) -> tuple[Entry, ...]:
    """Give an entry for each law and form; one for a law that has only one form.

    Args:
        laws: names.
        forms: of each law that has several.

    Raises:
        RequestError: there is no such law.
    """
    known = [choice("form", form, FORMS) for form in texts("forms", forms)]
    names = map(_check, texts("laws", laws))
    return tuple(Entry.of(law, form) for law in names for form in (known if REGISTER[law].forms() else [None]))


def check_entries(entries: Sequence[Entry], scenario: Scenario, *, as_given: bool) -> None:
    """Check that entries can be compared.

    Args:
        entries: to be compared.
        scenario: what is flown.
        as_given: whether the scenario's own gains are flown.

    Raises:
        RequestError: there are fewer than two, two have one name, a name is too long or cannot be printed or a file's, a law has
            no such form, or no gains that could be flown as given.
    """
    instance("entries", entries, list | tuple, "a list of Entry")  # type: ignore[arg-type]  # a union is no type to mypy
    if len(entries) < 2:
        raise RequestError(f"entries: {len(entries)} given; a comparison needs at least two")
    met: dict[str, str] = {}
    for entry in entries:
        law = _check(instance("entries", entry, Entry, "a list of Entry").law)
        if checked_form(law, entry.form) is None and REGISTER[law].forms():
            raise RequestError(f"entry {entry.name!r}: form: missing; must be {' or '.join(REGISTER[law].forms())}")
        if as_given and getattr(scenario.laws, entry.law) is None:
            known = [law for law in LAWS if getattr(scenario.laws, law) is not None]
            raise RequestError(
                f"entry {entry.name!r}: {scenario.title} has no gains for {entry.law}; it has them for "
                f"{', '.join(known) or 'none'}"
            )
        if not entry.name.isprintable() or len(entry.name) > MOST_CHARACTERS:
            raise RequestError(
                f"entry {entry.name[:MOST_CHARACTERS]!r}: its name has {len(entry.name)} characters; it must be a line of at "
                f"most {MOST_CHARACTERS} that can be printed"
            )
        if not entry.file:
            raise RequestError(f"entry {entry.name!r}: its name must have a letter from a to z or a digit")
        if entry.file in met:
            raise RequestError(
                f"entries {met[entry.file]!r} and {entry.name!r}: the names must differ, also as file names"
            )
        met[entry.file] = entry.name


def _check(law: str) -> str:
    return choice("law", law, LAWS)
