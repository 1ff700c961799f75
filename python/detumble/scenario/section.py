"""The base of every part of a scenario: unknown keys are errors, assignment is checked, and leaves nothing half-changed."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, ClassVar

from pydantic import AfterValidator, BaseModel, ConfigDict, ValidationError
from pydantic_core import PydanticCustomError

from detumble.errors import Fault, ScenarioError
from detumble.text import unprintable


@dataclass(frozen=True)
class Relation:
    """What must hold between fields.

    Attributes:
        at: the field that a fault is reported at, dotted from the section.
        reads: the fields compared.
        fault: takes their values in that order, and says what is wrong, or None.
    """

    at: str
    reads: tuple[str, ...]
    fault: Callable[..., str | None]


def _without_controls(keep: str, what: str) -> AfterValidator:
    def check(text: str) -> str:
        met = unprintable(text, keep)
        if met:
            reason = f"holds the character {met}; must be {what}"
            raise PydanticCustomError("quantity", "{text}", {"text": reason, "unit": ""})
        return text

    return AfterValidator(check)


one_line = _without_controls("", "one line of printable text")
"""Text that can stand in a table, a title and a file's attribute."""
lines = _without_controls("\n\r\t", "printable text")
"""Text of several lines."""


class Section(BaseModel):
    """A table of the scenario file.

    A bad value raises ScenarioError on assignment too, and the section stays as it was. Relations between the fields of one
    section hold at any time; those between sections are checked when the scenario is made, saved or flown, so that
    two sections can be changed one after the other.
    """

    model_config = ConfigDict(extra="forbid", validate_assignment=True, validate_default=False)

    relations: ClassVar[tuple[Relation, ...]] = ()
    alternatives: ClassVar[tuple[tuple[str, str], ...]] = ()
    """Pairs of fields of which one is given: assigning one clears the other."""
    checks_relations_on_assignment: ClassVar[bool] = True

    def __setattr__(self, name: str, value: Any) -> None:
        """Assign a checked value.

        Raises:
            ScenarioError: the value is refused; nothing has changed.
        """
        fields, was_set = dict(self.__dict__), set(self.__pydantic_fields_set__)
        try:
            if name in type(self).model_fields:
                for other in self.rivals(name):
                    if value is not None:
                        self.__dict__[other] = None
            super().__setattr__(name, value)
            faults = self.broken() if self.checks_relations_on_assignment else []
        except ValidationError as error:
            from detumble.scenario.faults import explained

            faults = explained(error, type(self))
        if faults:
            object.__setattr__(self, "__dict__", fields)
            object.__setattr__(self, "__pydantic_fields_set__", was_set)
            raise ScenarioError("assignment", [replace(fault, path=self.table() + fault.path) for fault in faults])

    @classmethod
    def table(cls) -> str:
        """Name the section in front of its fields: `chaser.`, `prrl.translation.`."""
        return re.sub(r"(?<=[a-z])(?=[A-Z])", ".", cls.__name__).lower() + "."

    @classmethod
    def rivals(cls, name: str) -> list[str]:
        """Name the fields that stand instead of `name`."""
        return [other for pair in cls.alternatives if name in pair for other in pair if other != name]

    def model_post_init(self, _context: Any, /) -> None:
        """Check the relations of a section that has just been made."""
        faults = self.broken()
        if faults:
            raise PydanticCustomError("relations", "{text}", {"text": faults[0].text, "faults": faults})

    def broken(self) -> list[Fault]:
        """Find the relations of this section (not of those within it) that do not hold."""
        faults = []
        for relation in self.relations:
            text = relation.fault(*(self.at(path) for path in relation.reads))
            if text:
                faults.append(Fault(relation.at, text))
        return faults

    def at(self, path: str) -> Any:
        """Give the value of a field by its dotted path; None where a table on the way is absent."""
        value: Any = self
        for name in path.split("."):
            value = getattr(value, name) if value is not None else None
        return value
