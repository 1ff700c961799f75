"""Dispersions held against the scenario that they disperse."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from typing import Any

from detumble.errors import Fault
from detumble.scenario.dispersions.base import Dispersion, Misfit, Parameter, Target, Tree
from detumble.scenario.dispersions.correlation import Correlation
from detumble.scenario.dispersions.numbers import Elementwise
from detumble.scenario.faults import Unread
from detumble.scenario.plan import PLAN
from detumble.scenario.quantity import Quantity
from detumble.scenario.reflection import quantity_of, section_at
from detumble.scenario.rules import At, active
from detumble.scenario.section import Section
from detumble.scenario.tables import quantities, readers
from detumble.scenario.wording import pretty, shown
from detumble.text import did_you_mean

FITTING = {
    "number": "normal, truncated_normal, uniform or log_uniform",
    "axes": "normal, truncated_normal, uniform or log_uniform",
    "vector": "normal, truncated_normal, uniform, log_uniform or direction",
    "quaternion": "attitude",
    "inertia": "inertia",
}
_FIXED = frozenset(path for rules in PLAN.values() for rule in rules for path in rule.of)


@cache
def fields() -> dict[str, Quantity]:
    """Name all fields that can be dispersed: numbers that may differ from run to run."""
    read = readers()
    return {path: quantity for path, quantity in quantities().items() if path in read and quantity.shape in FITTING}


def target(path: str, at: At) -> Target:
    """Find the field that is dispersed.

    Args:
        path: dotted.
        at: gives values by path.

    Raises:
        Misfit: there is no such field, or nothing to disperse.
        Unread: its value cannot be read.
    """
    from detumble.scenario.model import Scenario

    quantity = fields().get(path)
    if quantity is None:
        raise Misfit("field", _not_dispersible(path))
    _check_conditions(path, at)
    nominal = at(path)
    if nominal is None:
        from detumble.scenario.core import design

        nominal = design(path, at)
    if nominal is None:
        section, _, name = path.rpartition(".")
        owner = section_at(Scenario, tuple(section.split(".")))
        rivals = "".join(f" or disperse {section}.{other}" for other in (owner.rivals(name) if owner else ()))
        raise Misfit("field", f"is not given here; give it a value{rivals}")
    _check_read(path, at)
    return Target(path, quantity, nominal)


def _check_conditions(path: str, at: At) -> None:
    """Make sure that a rule which reads the field may apply, were the field given."""
    conditions = [rule.when for rules in readers()[path] for rule in rules if path in rule.of]
    unmet = [[(field, value) for field, value in when if at(field) != value] for when in conditions]
    if all(unmet):
        field, value = unmet[0][0]
        raise Misfit("field", f"needs {field} = {shown(value)}; nothing reads it otherwise")


def _check_read(path: str, at: At) -> None:
    """Make sure that a number of the core depends on the field: another may stand in its place."""

    def given(field: str) -> Any:
        return True if field == path else at(field)

    made_by = (active(rules, given).of for rules in readers()[path])
    if not any(path in of for of in made_by):
        beside = {field for rules in readers()[path] for rule in rules if path in rule.of for field in rule.of}
        of = dict.fromkeys(field for rules in readers()[path] for field in active(rules, given).of)
        raise Misfit(
            "field", f"does nothing here; disperse {' or '.join(field for field in of if field not in beside)}"
        )


def _not_dispersible(path: str) -> str:
    from detumble.scenario.model import Scenario

    if path in _FIXED & quantities().keys() or path.startswith("laws.none."):
        return "is the same in every run, as all clocks and open-loop segments are"
    steps = tuple(path.split("."))
    owner = section_at(Scenario, steps[:-1])
    if section_at(Scenario, steps) is not None:
        return "is a table; name one of its numbers"
    if owner is not None and steps[-1] in owner.model_fields:
        return "is nothing that varies from run to run; name a number, vector, attitude or inertia"
    return f"no field has this path{did_you_mean(path, fields())}"


def resolved(dispersion: Dispersion, at: At) -> tuple[Target, Tree]:
    """Give the field of a dispersion, and its distribution as the core takes it.

    Raises:
        Misfit: they do not fit.
        Unread: the field's value cannot be read.
    """
    aim = target(dispersion.field, at)
    if aim.quantity.shape not in dispersion.shapes:
        raise Misfit("distribution", f"does not fit {aim.path}; use {FITTING[aim.quantity.shape]}")
    return aim, {"path": aim.path, "distribution": dispersion.resolve(aim)}


def members(number: int, dispersion: Dispersion, aim: Target) -> dict[str, tuple[int, int]]:
    """Name the numbers of a dispersion that can be correlated: of a vector `chaser.position.x` and so on.

    Args:
        number: of the dispersion.
        dispersion: what is drawn.
        aim: its field.

    Returns:
        Where each stands: dispersion, element.
    """
    if not isinstance(dispersion, Elementwise):
        return {}
    if len(aim.values) == 1:
        return {aim.path: (number, 0)}
    return {f"{aim.path}.{axis}": (number, element) for element, axis in enumerate("xyz")}


def faults(
    dispersions: Iterable[tuple[int, Dispersion]], correlations: Iterable[tuple[int, Correlation]], at: At
) -> list[Fault]:
    """Find what is wrong between dispersions, their fields and their correlations.

    Args:
        dispersions: with their numbers in the file; those that are at fault themselves left out.
        correlations: likewise.
        at: gives values by path.
    """
    found: list[Fault] = []
    known: dict[str, int] = {}
    named: dict[str, tuple[int, int]] = {}
    doubtful: set[str] = set()
    for number, dispersion in dispersions:
        try:
            if dispersion.field in known:
                raise Misfit("field", f"is dispersed by dispersions[{known[dispersion.field]}] already")
            known[dispersion.field] = number
            named |= members(number, dispersion, resolved(dispersion, at)[0])
        except Misfit as misfit:
            found.append(_fault(number, dispersion, misfit))
            doubtful.add(dispersion.field)
        except Unread:
            doubtful.add(dispersion.field)
    grouped: dict[str, int] = {}
    for number, correlation in correlations:
        for name in correlation.fields:
            text = f"is in correlations[{grouped[name]}] already" if name in grouped else _unnamed(name, named, known)
            if text and not {name, name.rpartition(".")[0]} & doubtful:
                found.append(Fault(f"correlations[{number}].fields", text, shown(name)))
            grouped[name] = number
    return found


def _unnamed(name: str, named: Iterable[str], known: Iterable[str]) -> str | None:
    if name in named:
        return None
    if f"{name}.x" in named:
        return f"has three numbers; name one of them, such as {name}.x"
    whole = next((path for path in known if path in (name, name.rpartition(".")[0])), None)
    if whole:
        return f"{whole} is drawn as a whole; only what is drawn number by number can be correlated"
    return f"is not dispersed{did_you_mean(name, named)}"


def _fault(number: int, dispersion: Dispersion, misfit: Misfit) -> Fault:
    value = getattr(dispersion, misfit.key)
    quantity = quantity_of(type(dispersion).model_fields[misfit.key])
    unit = unit_in(dispersion, quantity) if quantity else ""
    met = "" if value is None else f"{shown(value)} {pretty(unit)}".rstrip()
    return Fault(f"dispersions[{number}].{misfit.key}", misfit.text, met)


def unit_in(section: Section, quantity: Quantity) -> str:
    """Give the unit of a quantity; that of a distribution's parameter is its field's."""
    if isinstance(quantity, Parameter) and isinstance(section, Dispersion):
        quantity = fields().get(section.field, quantity)
    return quantity.unit
