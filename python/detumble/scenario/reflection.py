"""What stands where in the scenario model: the section or the quantity that a field holds."""

from __future__ import annotations

from types import UnionType
from typing import TYPE_CHECKING, Any, Literal, Union, get_args, get_origin

from detumble.scenario.quantity import Quantity
from detumble.scenario.section import Section

if TYPE_CHECKING:
    from collections.abc import Sequence

    from pydantic.fields import FieldInfo


def section_at(model: type[Section], place: Sequence[int | str]) -> type[Section] | None:
    """Find the section that stands at a place of the model, or None where there is none."""
    current: type[Section] | None = model
    for step in place:
        if isinstance(step, int):
            continue
        field = current.model_fields.get(step) if current else None
        current = section_of(field.annotation) if field else None
    return current


def section_of(annotation: Any) -> type[Section] | None:
    """Find the section that a field holds, perhaps optional or in a list; None where it holds a value."""
    if isinstance(annotation, type) and get_origin(annotation) is None and issubclass(annotation, Section):
        return annotation
    if get_origin(annotation) in (Union, UnionType, list):
        return next((found for inner in get_args(annotation) if (found := section_of(inner))), None)
    return None


def quantity_of(field: FieldInfo) -> Quantity | None:
    """Find the quantity that describes a field, also where the field is optional."""
    inner = [meta for part in get_args(field.annotation) for meta in getattr(part, "__metadata__", ())]
    return next((meta for meta in (*field.metadata, *inner) if isinstance(meta, Quantity)), None)


def is_text(field: FieldInfo | None) -> bool:
    """Tell whether a field holds text: a title, or one of several words."""
    return field is not None and (field.annotation is str or get_origin(field.annotation) is Literal)
