"""From what pydantic finds to what a person reads: every fault of a scenario in one list, in the wording of the fields."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any, get_args, get_origin

from pydantic import TypeAdapter, ValidationError
from pydantic_core import PydanticUndefined

from detumble.errors import Fault, ScenarioError
from detumble.scenario.dispersions import DISTRIBUTIONS
from detumble.scenario.hints import unknown_key
from detumble.scenario.reflection import quantity_of, section_of
from detumble.scenario.section import Section
from detumble.scenario.wording import pretty, shown
from detumble.text import did_you_mean

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

    from detumble.scenario.model import Scenario

Place = tuple[int | str, ...]


class Unread(Exception):
    """A value is missing from the file, or at fault: what depends on it cannot be checked."""


def validated(raw: Mapping[str, Any], source: str) -> Scenario:
    """Make a scenario of the tables of a file.

    Args:
        raw: the tables as tomllib gives them.
        source: what to call the file in a message.

    Returns:
        The scenario.

    Raises:
        ScenarioError: with every fault found.
    """
    from detumble.scenario.model import Scenario

    try:
        return Scenario.model_validate(raw)
    except ValidationError as error:
        faults = explained(error, Scenario)
        faulty = {fault.path for fault in faults}
        for fault in (*_relations(Scenario, raw, faulty), *_misfits(raw, faulty)):
            if fault not in faults:
                faults.append(fault)
    raise ScenarioError(source, faults)


def explained(error: ValidationError, model: type[Section]) -> list[Fault]:
    """Translate pydantic's findings about one model."""
    faults: list[Fault] = []
    for detail in error.errors(include_url=False):
        if detail["type"] == "relations":
            prefix = _dotted(_walk(model, detail["loc"])[0])
            inner: list[Fault] = detail["ctx"]["faults"]
            faults += [replace(fault, path=f"{prefix}.{fault.path}" if prefix else fault.path) for fault in inner]
        else:
            faults.append(_fault(detail, model))
    meant = {_sibling(fault.path, name) for fault in faults if (name := _suggested(fault))}
    return [fault for fault in faults if not (fault.text.startswith("missing") and fault.path in meant)]


def _suggested(fault: Fault) -> str:
    """Give the field that a misspelt key was probably meant to be: that one is then no second fault."""
    meant = re.match(r"unknown key; did you mean (\w+)", fault.text)
    return meant[1] if meant else ""


def _sibling(path: str, name: str) -> str:
    return ".".join([*path.split(".")[:-1], name])


def _fault(detail: ErrorDetails, model: type[Section]) -> Fault:
    kind, value, context = detail["type"], detail["input"], detail.get("ctx", {})
    place, owner = _walk(model, detail["loc"])
    path, unit = _dotted(place), context.get("unit", "")
    met = f"{shown(value)} {pretty(unit)}".rstrip() if not isinstance(value, str) else shown(value)
    match kind:
        case "missing":
            return Fault(path, f"missing; needed: {_needed(owner, str(place[-1]))}")
        case "extra_forbidden" | "no_such_attribute":
            return Fault(path, unknown_key(owner, str(place[-1]), value))
        case "quantity":
            return Fault(path, pretty(context["text"]), met)
        case "literal_error":
            choices = [choice.strip("'") for choice in context["expected"].replace(" or ", ", ").split(", ")]
            return Fault(path, f"must be {' or '.join(choices)}{did_you_mean(str(value), choices)}", met)
        case "union_tag_not_found":
            return Fault(f"{path}.distribution", f"missing; needed: {' or '.join(DISTRIBUTIONS)}")
        case "union_tag_invalid":
            hint = did_you_mean(context["tag"], DISTRIBUTIONS)
            return Fault(f"{path}.distribution", f"must be {' or '.join(DISTRIBUTIONS)}{hint}", shown(context["tag"]))
        case "model_type" | "model_attributes_type" | "dict_type":
            return Fault(path or "the file", "must be a table", met)
        case "list_type":
            return Fault(path, "must be an array of tables", met)
        case "tuple_type":
            return Fault(path, "must be a list", met)
        case "float_type":
            return Fault(path, "must be a plain number", met)
        case "finite_number":
            return Fault(path, "must be finite", met)
        case "bool_type" | "bool_parsing":
            return Fault(path, "must be true or false", met)
        case "string_type":
            return Fault(path, "must be text in quotes", met)
        case "string_too_short":
            return Fault(path, "must not be empty", met)
        case "string_too_long":
            return Fault(path, f"has {len(value)} characters; at most {context['max_length']} are taken", met)
        case _:
            return Fault(path, detail["msg"], met)


def _walk(model: type[Section], place: Place) -> tuple[Place, type[Section] | None]:
    """Follow a place of pydantic's; gives it as the file has it, and the section that its last step belongs to.

    Pydantic names the distribution that it took a dispersion for as one more step.
    """
    kept: list[int | str] = []
    owner: type[Section] | None = None
    inner: type[Section] | None = model
    for at, step in enumerate(place):
        if isinstance(step, str) and at == 2 and place[0] == "dispersions":
            inner = DISTRIBUTIONS[step]
            continue
        kept.append(step)
        if isinstance(step, str):
            owner, field = inner, inner.model_fields.get(step) if inner else None
            inner = section_of(field.annotation) if field else None
    return tuple(kept), owner


def _needed(owner: type[Section] | None, name: str) -> str:
    field = owner.model_fields.get(name) if owner else None
    if field is None:
        return name
    quantity = quantity_of(field)
    if quantity is None:
        return "a table" if section_of(field.annotation) else (field.description or name)
    return f"{quantity.meaning} [{pretty(quantity.unit)}]" if quantity.unit else quantity.meaning


def _dotted(place: Place) -> str:
    path = ""
    for step in place:
        path += f"[{step}]" if isinstance(step, int) else f".{step}" if path else step
    return path


def _relations(model: type[Section], raw: Any, faulty: set[str], prefix: str = "") -> list[Fault]:
    """Check the relations whose fields are all sound, though others of the file are not."""
    found: list[Fault] = []
    if not isinstance(raw, Mapping):
        return found
    for relation in model.relations:
        if any(_touches(prefix + path, faulty) for path in relation.reads):
            continue
        with contextlib.suppress(Unread):
            text = relation.fault(*[_value(model, raw, path.split(".")) for path in relation.reads])
            found += [Fault(prefix + relation.at, text)] if text else []
    for name, field in model.model_fields.items():
        inner = section_of(field.annotation)
        if inner and get_origin(field.annotation) is not list and name in raw:
            found += _relations(inner, raw[name], faulty, f"{prefix}{name}.")
    return found


def _misfits(raw: Mapping[str, Any], faulty: set[str]) -> list[Fault]:
    """Hold the sound dispersions against the sound fields."""
    from detumble.scenario.dispersions.fitting import faults
    from detumble.scenario.model import Scenario

    def at(path: str) -> Any:
        if _touches(path, faulty):
            raise Unread
        return _value(Scenario, raw, path.split("."))

    def sound(key: str) -> list[tuple[int, Any]]:
        reader: TypeAdapter[Any] = TypeAdapter(get_args(Scenario.model_fields[key].annotation)[0])
        return [
            (number, reader.validate_python(table))
            for number, table in enumerate(raw.get(key, ()) if key not in faulty else ())
            if not any(f"{bad}.".startswith(f"{key}[{number}].") for bad in faulty)
        ]

    dispersions = sound("dispersions")
    # What a dispersion with a fault of its own would have drawn is not known.
    broken = any(bad.startswith("dispersions") for bad in faulty)
    return faults(dispersions, () if broken else sound("correlations"), at)


def _touches(path: str, faulty: set[str]) -> bool:
    return any(path == bad or path.startswith(bad + ".") or bad.startswith((path + ".", path + "[")) for bad in faulty)


def _value(model: type[Section], raw: Mapping[str, Any], path: list[str]) -> Any:
    field = model.model_fields[path[0]]
    if path[0] not in raw:
        default = field.get_default(call_default_factory=True)
        if default is PydanticUndefined:  # missing, or misspelt
            raise Unread
        return default.at(".".join(path[1:])) if len(path) > 1 and isinstance(default, Section) else default
    inner = section_of(field.annotation)
    if len(path) > 1 and inner is not None:
        return _value(inner, raw[path[0]], path[1:])
    quantity = quantity_of(field)
    reader: TypeAdapter[Any] = TypeAdapter(Any if field.annotation is None else field.annotation)
    return quantity.read(raw[path[0]]) if quantity else reader.validate_python(raw[path[0]])
