"""The two bodies, their orbit, where one shall stand relative to the other, and what the laws believe of them."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from detumble.scenario.quantity import Inertia, Quantity, Quaternion, Switch, Vector
from detumble.scenario.rules import Place, Rule
from detumble.scenario.section import Relation, Section

_ZERO: Vector = (0.0, 0.0, 0.0)
_IDENTITY: Quaternion = (1.0, 0.0, 0.0, 0.0)


def _mass(place: str | Place) -> Quantity:
    return Quantity("kg", "mass", place=place, least=1e-3, most=1e5)


def _inertia(meaning: str, place: str | Place, *, rigid: bool = True) -> Quantity:
    return Quantity("kg m^2", meaning, shape="inertia", place=place, rigid=rigid, least=-1e6, most=1e6)


def _attitude(meaning: str, place: str) -> Quantity:
    return Quantity("", meaning, shape="quaternion", place=place)


def _rate(meaning: str, place: str) -> Quantity:
    return Quantity("rad/s", meaning, shape="vector", place=place, least=-100.0, most=100.0)


def _position(meaning: str, place: str | Place) -> Quantity:
    return Quantity("m", meaning, shape="vector", place=place, least=-1e6, most=1e6)


def _grasp_point(body: str, axes: str) -> Quantity:
    return _position(f"grasp point in {axes} axes", Place(f"{body}.grasp_point", Rule("zeros")))


def _orbit_fault(altitude: float | None, radius: float | None) -> str | None:
    if (altitude is None) == (radius is None):
        return "exactly one of altitude and radius must be given"
    return None


_MEAN_MOTION = Place(
    "orbit.mean_motion",
    Rule("mean_motion", ("orbit.mu", "orbit.radius")),
    Rule("mean_motion", ("orbit.mu", "orbit.earth_radius", "orbit.altitude")),
    own=False,
)


class Orbit(Section):
    """The target's circular orbit."""

    altitude: (
        Annotated[float, Quantity("m", "height above earth_radius", kilo=True, place=_MEAN_MOTION, least=8e4, most=1e8)]
        | None
    ) = None
    radius: (
        Annotated[float, Quantity("m", "distance from the centre", kilo=True, place=_MEAN_MOTION, least=1e6, most=1e9)]
        | None
    ) = None
    earth_radius: Annotated[
        float, Quantity("m", "radius of the planet", kilo=True, place=_MEAN_MOTION, least=1e5, most=1e8)
    ] = 6371e3
    mu: Annotated[
        float,
        Quantity(
            "m^3/s^2",
            "gravitational parameter of the planet",
            kilo=1e9,
            place=_MEAN_MOTION,
            least=1e10,
            most=1e18,
        ),
    ] = 3.986004418e14
    lvlh_attitude: Annotated[Quaternion, _attitude("q_HN, H -> N at t = 0", "orbit.lvlh_attitude")] = _IDENTITY

    alternatives: ClassVar[tuple[tuple[str, str], ...]] = (("altitude", "radius"),)
    relations: ClassVar[tuple[Relation, ...]] = (Relation("altitude", ("altitude", "radius"), _orbit_fault),)

    @property
    def mean_motion(self) -> float:
        """Angular rate of H about its z axis, rad/s."""
        radius = self.distance
        return math.sqrt(self.mu / (radius * radius * radius))

    @property
    def distance(self) -> float:
        """Radius of the orbit, m."""
        return self.radius if self.radius is not None else self.earth_radius + (self.altitude or 0.0)


class Chaser(Section):
    """The spacecraft that captures."""

    mass: Annotated[float, _mass("chaser.mass")]
    inertia: Annotated[Inertia, _inertia("inertia about the centre of mass, body axes", "chaser.inertia")]
    position: Annotated[Vector, _position("r_CD_H at t = 0: relative to the debris, in H", "start.position")]
    velocity: Annotated[
        Vector,
        Quantity(
            "m/s",
            "relative velocity at t = 0, seen in the turning H",
            shape="vector",
            place="start.velocity",
            least=-1e3,
            most=1e3,
        ),
    ] = _ZERO
    attitude: Annotated[Quaternion, _attitude("C -> N at t = 0", "start.chaser_attitude")] = _IDENTITY
    rate: Annotated[Vector, _rate("omega_CN_C at t = 0", "start.chaser_rate")] = _ZERO
    grasp_point: Annotated[Vector, _grasp_point("chaser", "C")] | None = None


class Debris(Section):
    """The tumbling target, at the origin of H."""

    mass: Annotated[float, _mass("debris.mass")]
    inertia: Annotated[Inertia, _inertia("inertia about the centre of mass, body axes", "debris.inertia")]
    attitude: Annotated[Quaternion, _attitude("D -> N at t = 0", "start.debris_attitude")] = _IDENTITY
    tumble_rate: Annotated[Vector, _rate("omega_DN_D at t = 0", "start.debris_rate")]
    grasp_point: Annotated[Vector, _grasp_point("debris", "D")] | None = None


class Goal(Section):
    """Where the chaser shall stand relative to the debris; with grasp points that follows from them."""

    position: (
        Annotated[Vector, _position("r_des in H, before capture", Place("goal.position", Rule("zeros")))] | None
    ) = None
    position_after_capture: (
        Annotated[
            Vector,
            _position(
                "r_des in H of the stack; default: it stays",
                Place("goal.after_capture", Rule("number", ("goal.position",)), Rule("zeros")),
            ),
        ]
        | None
    ) = None
    acceleration_feedforward: Switch = Field(False, description="with grasp points: the law adds m a_des")


def _belief_relation(field: str) -> Relation:
    def fault(stack: str, override: object) -> str | None:
        return (
            None
            if override is None or stack == "design"
            else 'needs stack = "design"; a law that is told the truth has no belief'
        )

    return Relation(field, ("stack", field), fault)


def _believed(body: str, what: str) -> Place:
    """Give the place of a belief; its default is the design: what the nominal bodies have, for the stack their sum."""
    bodies = ("chaser", "debris") if body == "stack" else ("chaser",)
    design = Rule("total" if what == "mass" else "tensor", tuple(f"{one}.{what}" for one in bodies), design=True)
    when = (("belief.stack", "design"),) if body == "stack" else ()
    return Place(f"belief.{body}_{what}", design, when=when)


class Belief(Section):
    """What the laws believe about the bodies; the default is their design."""

    stack: Literal["design", "true"] = Field(
        "design", description="the stack is m_c + m_d and I_c + I_d as matrices, or what it truly is"
    )
    chaser_mass: Annotated[float, _mass(_believed("chaser", "mass"))] | None = None
    chaser_inertia: (
        Annotated[Inertia, _inertia("believed inertia of the chaser", _believed("chaser", "inertia"), rigid=False)]
        | None
    ) = None
    stack_mass: Annotated[float, _mass(_believed("stack", "mass"))] | None = None
    stack_inertia: (
        Annotated[Inertia, _inertia("believed inertia of the stack", _believed("stack", "inertia"), rigid=False)] | None
    ) = None

    relations: ClassVar[tuple[Relation, ...]] = (_belief_relation("stack_mass"), _belief_relation("stack_inertia"))
