"""Which fields of a scenario become which numbers of the core: rules, as data.

A number of the core has a path in the core's case (`start.chaser_attitude`, `law.before.rotation.gain`) and a few rules. The
first rule that applies gives its value: a named conversion (`detumble.scenario.conversions`) of the values of a few fields. The
same rules make a single case (`detumble.scenario.core`), the columns of a campaign, and the export of `detumble schema`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

At = Callable[[str], Any]
"""Gives the value of a field by its dotted path; None where it is absent."""


@dataclass(frozen=True)
class Rule:
    """One way to a number of the core; it applies where all fields that it reads are given and its conditions hold.

    Attributes:
        conversion: by name.
        of: the fields read, dotted paths of the scenario.
        when: fields with the values that they must have; None for absent.
        design: the value is believed of the nominal bodies, and stays when those fields are drawn at random.
        constant: the value itself, for the conversion `constant`.
    """

    conversion: str
    of: tuple[str, ...] = ()
    when: tuple[tuple[str, Any], ...] = ()
    design: bool = False
    constant: str | None = None

    def permitted(self, at: At) -> bool:
        """Tell whether the conditions hold, be the fields given or not."""
        return all(at(path) == value for path, value in self.when)

    def applies(self, at: At) -> bool:
        """Tell whether the rule gives the number in a scenario."""
        return self.permitted(at) and all(at(path) is not None for path in self.of)

    def json(self) -> dict[str, Any]:
        """Give the rule as plain data; what it does not use is left out."""
        return {
            **({"conversion": self.conversion} if self.constant is None else {"value": self.constant}),
            **({"of": list(self.of)} if self.of else {}),
            **({"when": dict(self.when)} if self.when else {}),
            **({"design": True} if self.design else {}),
        }


Table = dict[str, tuple[Rule, ...]]
"""Rules by path of the core, in the order in which they are tried."""


def constant(value: str, *when: tuple[str, Any]) -> Rule:
    """Give the rule for a word that is the same in every scenario in which its conditions hold."""
    return Rule("constant", when=when, constant=value)


def active(rules: tuple[Rule, ...], at: At) -> Rule:
    """Give the rule that makes a number in a scenario.

    Raises:
        LookupError: none applies.
    """
    for rule in rules:
        if rule.applies(at):
            return rule
    raise LookupError(f"no rule applies: {rules}")


class Place:
    """Where a field goes in the core, for use in `Quantity`.

    Args:
        path: of the core.
        otherwise: rules tried where the field itself does not give the number.
        own: whether the field alone gives the number, by the conversion that its quantity declares.
        when: conditions for that, as in `Rule`.
    """

    def __init__(
        self,
        path: str,
        *otherwise: Rule,
        own: bool = True,
        when: tuple[tuple[str, Any], ...] = (),
    ) -> None:
        self.path = path
        self.otherwise = otherwise
        self.own = own
        self.when = when

    def rules(self, field: str, conversion: str) -> tuple[Rule, ...]:
        """Give the rules of the number.

        Args:
            field: path of the field that is declared to go here.
            conversion: of its quantity.
        """
        return ((Rule(conversion, (field,), self.when),) if self.own else ()) + self.otherwise
