"""The control laws: one file each, which declares title, colour and gains. A new law is its file and its field in `Laws`."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from detumble.checking import choice, met
from detumble.errors import RequestError
from detumble.scenario.laws.base import CHANNELS, FORMS, Appearance, Form, Gain, Law, Natural, Provenance, form_of
from detumble.scenario.laws.lqr import Lqr
from detumble.scenario.laws.open_loop import OpenLoop, Segment
from detumble.scenario.laws.pd import Pd
from detumble.scenario.laws.prrl import Prrl
from detumble.scenario.laws.sosmc import Sosmc
from detumble.scenario.laws.stsmc import Stsmc
from detumble.scenario.laws.tsmc import Tsmc
from detumble.scenario.reflection import section_of
from detumble.scenario.section import Section

__all__ = [
    "APPEARANCES",
    "CHANNELS",
    "FORMS",
    "LAWS",
    "REGISTER",
    "TITLES",
    "Form",
    "Gain",
    "Law",
    "Laws",
    "Natural",
    "OpenLoop",
    "Provenance",
    "Segment",
    "checked_form",
    "form_of",
]


class Laws(Section):
    """What every law shares, and the gains of each law that this scenario can fly."""

    attitude_error: Literal["epsilon", "two_epsilon"] = Field(
        "epsilon", description="the laws use the vector part of the error quaternion, or twice it"
    )
    surface_rate: Literal["printed", "exact"] = Field(
        "printed",
        description="rate of the surface in the compensation of tsmc and prrl; sosmc has none, stsmc always the exact one",
    )
    pd: Pd | None = None
    lqr: Lqr | None = None
    sosmc: Sosmc | None = None
    tsmc: Tsmc | None = None
    prrl: Prrl | None = None
    stsmc: Stsmc | None = None
    none: OpenLoop | None = None

    @property
    def closed_loop(self) -> list[str]:
        """The laws that this scenario has gains for."""
        return [law for law in LAWS if getattr(self, law) is not None]

    @property
    def default(self) -> str:
        """The law that flies where none is named: the only one that has gains, open loop where none has, else PRRL-SMC."""
        laws = self.closed_loop or ["none"]
        return laws[0] if len(laws) == 1 else "prrl"


_SECTIONS = {name: section_of(field.annotation) for name, field in Laws.model_fields.items()}
REGISTER: dict[str, type[Law[Any, Any]]] = {
    name: section for name, section in _SECTIONS.items() if section is not None and issubclass(section, Law)
}
"""The class of each closed-loop law by its name."""

LAWS = tuple(REGISTER)
"""The closed-loop laws, in the order of `Laws`; `none` flies open loop."""

APPEARANCES: dict[str, type[Appearance]] = {**REGISTER, "none": OpenLoop}
"""How each law looks in tables and figures, open loop among them."""

TITLES = {name: law.title for name, law in APPEARANCES.items()}
"""What tables and figures call each law."""


def checked_form(law: str, form: str | None) -> Form | None:
    """Check the form that is asked for.

    Args:
        law: one of `LAWS`.
        form: None where none is asked for.

    Raises:
        RequestError: the law has no such form, or none to choose from.
    """
    forms = REGISTER[law].forms()
    if form is None:
        return None
    if not forms:
        raise RequestError(f"form {met(form)}: {law} has only one form; leave it out")
    return choice("form", form, forms)
