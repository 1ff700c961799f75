"""What a control law declares of itself: name in tables, colour in figures, and the gains of its channels.

Units: translation has m, m/s and N; rotation has the vector part of the error quaternion (no unit), rad/s and N m.

Each gain declares its natural scale: what it would be if the error were of the channel's length, and the law asked there for
all that the actuators give. Ranges of gains in a search are multiples of it, and so fit spacecraft of any size; see `Natural`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import ClassVar, Generic, Literal, TypeVar, get_args

from pydantic import Field

from detumble.scenario.quantity import Quantity, Shape
from detumble.scenario.reflection import quantity_of, section_of
from detumble.scenario.section import Relation, Section

Form = Literal["printed", "corrected"]
FORMS: tuple[Form, ...] = get_args(Form)
CHANNELS = ("translation", "rotation")

Span = tuple[float, float]
"""Least and most."""
Dashes = tuple[int, tuple[float, ...]] | Literal["-"]
"""A line style as matplotlib takes it."""


@dataclass(frozen=True)
class Natural:
    """What the gains of one channel are measured by.

    Attributes:
        mass: kg, or the largest moment of inertia in kg m².
        acceleration: the most that the weakest axis gives, m/s² or rad/s².
        length: m; 1 in rotation, where the vector part of the error quaternion has no unit.
        gains: the channel's gains without a scale, by name: a scale may depend on these; `natural["alpha"]`.
    """

    mass: float
    acceleration: float
    length: float
    gains: Mapping[str, float] = field(default_factory=dict)

    def __getitem__(self, gain: str) -> float:
        """Give a gain of the channel that has no scale of its own."""
        return self.gains[gain]

    @property
    def time(self) -> float:
        """s: sqrt(length / acceleration)."""
        return math.sqrt(self.length / self.acceleration)

    @property
    def speed(self) -> float:
        """m/s or rad/s: sqrt(length acceleration)."""
        return math.sqrt(self.length * self.acceleration)


Scale = Callable[[Natural], float]
"""Gives a gain's natural scale."""


class Gain(Quantity):
    """A gain of a law, and where a search looks for it.

    Args:
        unit, meaning, note: as of any quantity.
        scale: its natural scale; a search is uniform in the logarithm. None searches uniformly in the number itself.
        symbol: of the paper.
        aliases: what else papers call it.
        shape: `axes`, one number for every axis or one for each; or `number`.
        above, below, most: bounds; without `above` it may be 0.
        span: least and most to search, in natural scales (in plain numbers without a scale); None holds it fixed in a search.
    """

    def __init__(
        self,
        unit: str,
        meaning: str,
        scale: Scale | None = None,
        *,
        symbol: str = "",
        aliases: tuple[str, ...] = (),
        note: str = "",
        shape: Shape = "axes",
        above: float | None = None,
        below: float | None = None,
        most: float = 1e9,
        span: Span | None = (1e-3, 1e2),
    ) -> None:
        super().__init__(
            unit,
            f"{symbol}, {meaning}" if symbol else meaning,
            note=note,
            shape=shape,
            above=above,
            least=0.0 if above is None else None,
            below=below,
            most=None if below is not None else most,
        )
        self.scale = scale
        self.symbols = ((symbol,) if symbol else ()) + aliases
        self.span = span


SQUARES: Span = (1e-6, 1e4)
"""Span of weights, whose square roots are gains."""
SLOPE = ("c", "Lambda", "Λ", "λ")
GAIN = ("K", "k")
LAYER = ("phi", "φ", "ϕ", "Φ", "delta", "δ")


def layer(unit: str) -> Gain:
    """Give the boundary layer of a sliding law, in the unit of its surface."""
    meaning = "thickness of the boundary layer"
    return Gain(unit, meaning, lambda c: c.speed, symbol="phi", aliases=LAYER[1:], above=0.0)


MOST_ODD = 21
"""Of numerator and denominator of a fraction that a search gives."""
_ODD = range(1, MOST_ODD + 1, 2)


@dataclass(frozen=True)
class OddFraction:
    """A gain that a file writes as a fraction of odd numbers.

    Attributes:
        fields: numerator and denominator.
        span: least and most to search; 1 itself is excluded.
    """

    fields: tuple[str, str]
    span: Span

    def of(self, gains: Section) -> tuple[int, int]:
        """Give numerator and denominator that a channel flies."""
        p, q = (getattr(gains, name) for name in self.fields)
        return p, q

    def nearest(self, value: float) -> tuple[int, int]:
        """Give the fraction of odd numbers up to 21, within the span, that is nearest to a number."""
        low, high = self.span
        pairs = [(p, q) for q in _ODD for p in _ODD if p != q and math.gcd(p, q) == 1]
        allowed = [(p, q) for p, q in pairs if low * q - 1e-9 <= p <= high * q + 1e-9]
        return min(allowed, key=lambda pair: (abs(pair[0] / pair[1] - value), pair[1]))

    def takes(self, value: float) -> bool:
        """Tell whether a number lies within the span."""
        return self.span[0] <= value <= self.span[1] and value != 1.0


@dataclass(frozen=True)
class GainByForm:
    """A gain that each form of a law writes as a fraction of its own.

    Attributes:
        name: in the core, and in a search.
        meaning: one phrase.
        fractions: by form.
    """

    name: str
    meaning: str
    fractions: Mapping[Form, OddFraction]


class Channel(Section):
    """The gains of one channel of a law. Their names are the core's."""

    by_form: ClassVar[tuple[GainByForm, ...]] = ()

    @classmethod
    def gains(cls) -> dict[str, Gain]:
        """Give the declared gains by name."""
        return gains_of_section(cls)


def gains_of_section(section: type[Section]) -> dict[str, Gain]:
    """Give the gains that a section's own fields are, by name."""
    quantities = {name: quantity_of(info) for name, info in section.model_fields.items()}
    return {name: quantity for name, quantity in quantities.items() if isinstance(quantity, Gain)}


Translation = TypeVar("Translation", bound=Channel)
Rotation = TypeVar("Rotation", bound=Channel)


class StackGains(Section, Generic[Translation, Rotation]):
    """A second set of gains, flown after capture; a channel without one keeps the first."""

    translation: Translation | None = None
    rotation: Rotation | None = None


class Provenance(Section):
    """How the gains of a law were found by a search; nothing of it is flown."""

    objective: Literal["capture", "settling", "delta_v", "delta_v_total", "pareto"] = Field(
        description="what was made small"
    )
    statistic: str = Field(description="over the starts: `mean`, or a percentile such as `p95`")
    time_s: float | None = Field(None, ge=0.0, allow_inf_nan=False, description="that statistic of the time reached, s")
    delta_v_m_s: float | None = Field(None, ge=0.0, allow_inf_nan=False, description="that of the Δv reached, m/s")
    success: float = Field(ge=0.0, le=1.0, description="share of the starts that succeeded")
    required: float = Field(ge=0.0, le=1.0, description="share that had to")
    until: Literal["settled", "captured", "duration"] = Field(description="how the flights ended")
    horizon_s: float = Field(gt=0.0, allow_inf_nan=False, description="later than this was a failure, s")
    starts: int = Field(ge=1, strict=True, description="runs of the campaign that each candidate flew")
    seed: int = Field(ge=0, strict=True, description="of these runs")
    optimiser_seed: int = Field(ge=0, strict=True, description="of the search")
    evaluations: int = Field(ge=1, strict=True, description="candidates tried")
    version: str = Field(description="of detumble")


class TwoForms(Section):
    """The option of a law that the paper prints with slips."""

    form: Form = Field("printed", description="as the paper prints the law, or with its slips corrected")


class Appearance(Section):
    """What tables and figures call a law, and how figures draw it."""

    title: ClassVar[str]
    colour: ClassVar[str]
    """Hexadecimal; apart from that of any other law, also to the colour-blind."""
    dashes: ClassVar[Dashes]
    marker: ClassVar[str]
    width: ClassVar[float] = 1.5
    """Of lines, points."""


class Law(Appearance, Generic[Translation, Rotation]):
    """One law: its gains, and perhaps other gains for the stack.

    A gain that stands in the law itself is shared by all channels that have none of that name of their own. Forms are an option:
    a law that has them derives from `TwoForms` too.
    """

    translation: Translation
    rotation: Rotation
    stack: StackGains[Translation, Rotation] | None = None
    tuned: Provenance | None = None

    @classmethod
    def channel(cls, name: str) -> type[Channel]:
        """Give the class of a channel's gains: `translation` or `stack.translation`."""
        found = section_of(cls.model_fields[name.removeprefix("stack.")].annotation)
        assert found is not None
        assert issubclass(found, Channel)
        return found

    @classmethod
    def forms(cls) -> tuple[Form, ...]:
        """Give the forms that the law can be flown in; empty for a law that has no such option."""
        return FORMS if issubclass(cls, TwoForms) else ()


def form_of(law: Section) -> Form | None:
    """Give the form of a law; None where it has no such option."""
    return law.form if isinstance(law, TwoForms) else None


def shared_gain(name: str, meaning: str) -> tuple[Relation, ...]:
    """Give the relations of a law that hold its channels to have a gain of their own wherever the law shares none."""
    text = f"missing; needed: {meaning}, for all channels here or in each channel"

    def fault(shared: object, *channels: Section | None) -> str | None:
        return text if shared is None and any(own and getattr(own, name) is None for own in channels) else None

    sets = (CHANNELS, tuple(f"stack.{channel}" for channel in CHANNELS))
    return tuple(Relation(name, (name, *channels), fault) for channels in sets)
