"""The declarations of fields, rules and laws as plain data: the key `x-core` of the JSON Schema.

They are what a program without Python needs to make the core's case, and the columns of a campaign, from a scenario.
"""

from __future__ import annotations

import inspect
import math
from itertools import chain
from typing import TYPE_CHECKING, Any, get_args

from detumble.scenario import conversions
from detumble.scenario.dispersions.fitting import fields as dispersible
from detumble.scenario.laws import APPEARANCES, REGISTER, Segment
from detumble.scenario.laws.base import Gain
from detumble.scenario.plan import PLAN, SEGMENT
from detumble.scenario.reflection import quantity_of
from detumble.scenario.section import Section
from detumble.scenario.tables import body_rules, law_rules, law_words, leaves

if TYPE_CHECKING:
    from pydantic.fields import FieldInfo

    from detumble.scenario.quantity import Quantity
    from detumble.scenario.rules import Table

_READING = """\
A number of the core stands at its path in the core's case; the first of its rules that applies gives it. A rule applies where
all fields in `when` have these values (null: absent) and all fields in `of` are given or have a default. It gives its
`value`, or what its conversion makes of the fields in `of`. A default holds where the field's table is given; tables at the
top of the file count as given, and a required field has a default only for a table that open loop leaves out.

`numbers` and `laws.<law>.numbers` take a field as a list of numbers, by its shape. number: 1. vector: 3. axes: 1 or 3.
quaternion: 4, divided by their norm unless that is within 1e-15 of 1. inertia: 6, xx, yy, zz, xy, xz, yz; products are the
mean of the two mirrored elements, zero for three principal moments; the largest principal moment of a `rigid` one that
exceeds the sum of the others relatively by more than 1e-9 becomes their sum. A conversion that gives nine numbers gives a 3x3
matrix, row by row.

`plan` and `laws.<law>.plan` take fields as they are. They also read `flight.law`, the law that flies, and `flight.whole`,
true for a flight that lasts its whole duration; `time.integration_step` must be a number: an estimate of accuracy, which is
not described here, replaces "auto". In open loop `segment` gives one element of the list `law.segments` for each of
`laws.none.segments`.

A campaign draws fields as their lists of numbers, which stand in place of the scenario's, one row a run. A number of the core
is a column if its rule reads a drawn field; a rule with `design` never is, and takes the scenario's own values in every run."""


def declarations() -> dict[str, Any]:
    """Give all declarations: nested dicts and lists of texts, finite numbers, bools and None."""
    return {
        "description": _READING,
        "conversions": {name: inspect.getdoc(made) for name, made in conversions.ALL.items()},
        "fields": _all_fields(),
        "numbers": _plain(body_rules()),
        "plan": _plain(PLAN),
        "segment": _plain(SEGMENT),
        "laws": {name: _law(name) for name in APPEARANCES},
    }


def _plain(table: Table) -> dict[str, list[dict[str, Any]]]:
    return {path: [rule.json() for rule in rules] for path, rules in table.items()}


def _law(name: str) -> dict[str, Any]:
    look = APPEARANCES[name]
    return {
        "title": look.title,
        "colour": look.colour,
        "dashes": [] if look.dashes == "-" else list(look.dashes[1]),
        "marker": look.marker,
        "width": look.width,
        "forms": list(REGISTER[name].forms()) if name in REGISTER else [],
        "plan": _plain(law_words(name)),
        "numbers": _plain(law_rules(name)),
    }


def _all_fields() -> dict[str, dict[str, Any]]:
    """Describe the fields that are quantities or that a rule reads, by path; those of a segment as `segment.start`."""
    segment = {f"segment.{name}": field for name, field in Segment.model_fields.items()}
    places = _places()
    return {
        path: _field(path, field, places.get(path, []))
        for path, field in (leaves() | segment).items()
        if path in places or quantity_of(field)
    }


def _places() -> dict[str, list[str]]:
    """Give the paths of the core that a field has a part in, by the path of the field."""
    segment = {f"law.segments.{key}": rules for key, rules in SEGMENT.items()}
    tables = (body_rules(), PLAN, segment, *(law_words(law) | law_rules(law) for law in APPEARANCES))
    places: dict[str, list[str]] = {}
    for core, rules in chain(*(table.items() for table in tables)):
        for path in dict.fromkeys(path for rule in rules for path in (*rule.of, *dict(rule.when))):
            places.setdefault(path, []).append(core)
    return places


def _field(path: str, field: FieldInfo, places: list[str]) -> dict[str, Any]:
    quantity = quantity_of(field)
    default = _default(path, field)
    return {
        **(_quantity(quantity) if quantity else _word(field)),
        **({} if default is None else {"default": default}),
        **({"required": True} if field.is_required() else {}),
        "core": places,
        **({"dispersible": True} if path in dispersible() else {}),
    }


def _quantity(quantity: Quantity) -> dict[str, Any]:
    return {
        "shape": quantity.shape,
        "unit": quantity.unit or "1",
        "meaning": quantity.meaning + quantity.note,
        **quantity.range.json(),
        **({"rigid": quantity.rigid} if quantity.shape == "inertia" else {}),
        **({"words": list(quantity.words)} if quantity.words else {}),
        **({"provenance": quantity.provenance} if quantity.provenance else {}),
        **(_gain(quantity) if isinstance(quantity, Gain) else {}),
    }


def _gain(gain: Gain) -> dict[str, Any]:
    """Describe what is special to a gain; `search` is least and most, in natural scales or in the number itself."""
    scaled = {"in": "number" if gain.scale is None else "natural scale"}
    return {"symbols": list(gain.symbols), **({"search": {"span": list(gain.span), **scaled}} if gain.span else {})}


def _word(field: FieldInfo) -> dict[str, Any]:
    words = get_args(field.annotation)
    choice = all(isinstance(word, str) for word in words) and words
    return {
        "shape": "word" if choice else "switch",
        "meaning": field.description or "",
        **({"words": list(words)} if choice else {}),
    }


def _default(path: str, field: FieldInfo) -> Any:
    """Give the default of a field, for a required one that of its table; None where there is none that is finite."""
    from detumble.scenario.model import Scenario

    value = field.get_default(call_default_factory=True)
    if field.is_required():
        table, _, name = path.partition(".")
        section = Scenario.model_fields[table].get_default(call_default_factory=True) if table != "segment" else None
        value = section.at(name) if isinstance(section, Section) else None
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return list(value) if isinstance(value, tuple) else value
