"""What was probably meant: units in the names of keys, symbols of papers, and values that are possible but seldom intended."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Any

from detumble.checking import plain
from detumble.scenario import physics
from detumble.scenario.laws import CHANNELS, REGISTER, form_of
from detumble.scenario.laws.base import gains_of_section
from detumble.scenario.wording import pretty, shown
from detumble.text import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Iterator

    from detumble.scenario.model import Scenario
    from detumble.scenario.section import Section

_TURN, _RPM = math.pi / 180.0, math.pi / 30.0
UNITS = {
    "rad": (1.0, "rad"), "mrad": (1e-3, "rad"), "deg": (_TURN, "rad"), "arcmin": (_TURN / 60, "rad"),
    "arcsec": (_TURN / 3600, "rad"), "rad_s": (1.0, "rad/s"), "mrad_s": (1e-3, "rad/s"), "deg_s": (_TURN, "rad/s"),
    "deg_per_s": (_TURN, "rad/s"), "dps": (_TURN, "rad/s"), "rpm": (_RPM, "rad/s"), "hz": (2 * math.pi, "rad/s"),
    "km": (1e3, "m"), "m": (1.0, "m"), "cm": (1e-2, "m"), "mm": (1e-3, "m"), "um": (1e-6, "m"),
    "km_s": (1e3, "m/s"), "m_s": (1.0, "m/s"), "cm_s": (1e-2, "m/s"), "mm_s": (1e-3, "m/s"),
    "t": (1e3, "kg"), "kg": (1.0, "kg"), "g": (1e-3, "kg"), "lb": (0.45359237, "kg"),
    "s": (1.0, "s"), "ms": (1e-3, "s"), "min": (60.0, "s"), "h": (3600.0, "s"), "days": (86400.0, "s"),
    "kn": (1e3, "N"), "n": (1.0, "N"), "mn": (1e-3, "N"), "un": (1e-6, "N"),
    "nm": (1.0, "N m"), "n_m": (1.0, "N m"), "mnm": (1e-3, "N m"), "mn_m": (1e-3, "N m"), "unm": (1e-6, "N m"),
    "kg_m2": (1.0, "kg m^2"), "kgm2": (1.0, "kg m^2"), "kg_cm2": (1e-4, "kg m^2"), "kg_mm2": (1e-6, "kg m^2"),
    "g_cm2": (1e-7, "kg m^2"), "m3_s2": (1.0, "m^3/s^2"), "km3_s2": (1e9, "m^3/s^2"),
}  # fmt: skip
"""Endings of keys, what they are in SI, and that unit."""

_FIELD_UNITS = {"deg": (_TURN, "rad")}
"""Units of fields that are not SI."""


_BODY = {"m": "mass", "I": "inertia", "J": "inertia", "q": "attitude"}
_OMEGA = ("omega", "ω", "w", "angular_velocity")
SYMBOLS: dict[str, dict[str, str]] = {
    "orbit": {"a": "radius", "R": "radius", "h": "altitude", "GM": "mu", "μ": "mu", "R_E": "earth_radius"},
    "chaser": {
        **_BODY, **dict.fromkeys(("r", "r_0", "r_CD", "rho", "ρ"), "position"), **dict.fromkeys(("v", "v_0"), "velocity"),
        **dict.fromkeys((*_OMEGA, "omega_c", "ω_c", "w_c", "omega_CN"), "rate"),
        "q_c": "attitude", "m_c": "mass", "I_c": "inertia", "J_c": "inertia", "p_C": "grasp_point",
    },
    "debris": {
        **_BODY, **dict.fromkeys((*_OMEGA, "omega_d", "omega_t", "ω_d", "w_d", "omega_DN", "rate"), "tumble_rate"),
        "q_d": "attitude", "m_d": "mass", "I_d": "inertia", "J_d": "inertia", "p_D": "grasp_point",
    },
    "goal": {"r_des": "position", "r_d": "position", "r_ref": "position", "a_des": "acceleration_feedforward"},
    "capture": {
        **dict.fromkeys(("d", "r"), "distance"), **dict.fromkeys(("theta", "θ"), "angle_deg"), **dict.fromkeys(_OMEGA, "rate"),
        "v": "speed",
    },
    "actuators": {
        **dict.fromkeys(("F_max", "U_max", "u_max"), "force_limit"),
        **dict.fromkeys(("tau_max", "τ_max", "T_max", "M_max"), "torque_limit"),
    },
    "sensors": {
        f"{sigma}_{of}": f"{what}_sigma"
        for sigma in ("sigma", "σ")
        for what, symbols in {
            "position": ("r", "pos"), "velocity": ("v", "vel"), "attitude": ("q", "theta", "θ"), "rate": ("w", "omega", "ω")
        }.items()
        for of in symbols
    },
}  # fmt: skip
"""What papers call our fields, by table; gains declare their own symbols (`Gain.symbols`)."""


def unknown_key(owner: type[Section] | None, name: str, value: Any) -> str:
    """Say what an unknown key was probably meant to be.

    Args:
        owner: the section that has no such field; None where that is not known.
        name: of the key.
        value: that was given.
    """
    if owner is None:
        return "unknown key"
    return (
        f"unknown key{_converted(owner, name, value) or _symbol(owner, name) or did_you_mean(name, owner.model_fields)}"
    )


def _converted(owner: type[Section], name: str, value: Any) -> str:
    """Where the key names a unit: the field, its unit, and the value converted."""
    from detumble.scenario.dispersions.base import Parameter
    from detumble.scenario.reflection import quantity_of

    folded = name.lower()
    for ending in sorted(UNITS, key=len, reverse=True):
        if not folded.endswith(f"_{ending}"):
            continue
        factor, unit = UNITS[ending]
        stem = folded.removesuffix(f"_{ending}")
        for field, info in owner.model_fields.items():
            quantity = quantity_of(info)
            if quantity is None or stem not in (field, re.sub(r"_(deg)$", "", field)):
                continue
            if isinstance(quantity, Parameter):  # of a distribution
                return f"; did you mean {field}, in the unit of the field that is dispersed?"
            scale, base = _FIELD_UNITS.get(quantity.unit, (1.0, quantity.unit))
            said = f"; did you mean {field}, in {pretty(quantity.unit) or 'pure numbers'}"
            per_second = base == f"{unit}/s"  # a rate typed under the unit of an angle or a length
            if ending[0] == "m" and factor < 1.0 and name[len(name) - len(ending)] == "M":  # mega, or a slip
                return f"{said}?"
            number = _times(plain(value), factor / scale) if base == unit or per_second else None
            if number is None:
                return f"{said}?"
            ending = name[len(name) - len(ending) :]  # as it was typed: mN, not mn
            given = pretty(ending.replace("_per_", "/").replace("_s2", "/s^2").replace("_s", "/s").replace("_", " "))
            given = re.sub(r"(?<=m)([23])", r"^\1", given) + ("/s" if per_second else "")
            return f"{said}? {shown(value)} {pretty(given)} is {shown(number)} {pretty(quantity.unit)}"
    return ""


def _times(value: Any, factor: float) -> Any:
    """Multiply a number, or a list of them; None for anything else."""
    if isinstance(value, list):
        values = [_times(element, factor) for element in value]
        return None if None in values else values
    if isinstance(value, bool) or not isinstance(value, int | float) or abs(value) > 10**300:
        return None
    exact = float(f"{math.log10(factor):.9g}").is_integer()  # of such factors no digit is lost
    return float(f"{value * factor:.{15 if exact else 6}g}")


def _symbol(owner: type[Section], name: str) -> str:
    """Where the key is what papers call a field: its name here, also in one or two of the tables beneath."""
    from detumble.scenario.reflection import section_of

    beneath = {table: section_of(info.annotation) for table, info in owner.model_fields.items() if table != "stack"}
    found = [_named(owner, name)] if _named(owner, name) else [
        f"{table}.{field}" for table, inner in beneath.items() if inner is not None and (field := _named(inner, name))
    ]  # fmt: skip
    return f"; did you mean {' and '.join(found)}?" if 0 < len(found) <= 2 else ""


def _named(owner: type[Section], name: str) -> str:
    """Give the field of a section that a symbol stands for; empty for none."""
    symbols = SYMBOLS.get(owner.table().rstrip("."), {})
    symbols |= {symbol: gain for gain, declared in gains_of_section(owner).items() for symbol in declared.symbols}
    folded = {symbol.lower().replace("_", ""): field for symbol, field in symbols.items()}
    field = symbols.get(name) or folded.get(name.lower().replace("_", ""), "")
    return field if field in owner.model_fields else ""


FAST = 1.0
"""Rates above this, rad/s (57 °/s), are asked about: they may have been meant in degrees."""
LOOSE = 0.1
"""Attitude noise above this, rad (5.7 degrees), likewise."""
GYRATION, OF_MASS = 30.0, 9.0
"""Radius of gyration, m, that no spacecraft of 9 kg has; of other masses in proportion to the cube root."""
FAR = 0.01
"""Share of the orbit's radius up to which the Hill–Clohessy–Wiltshire equations are used here without a word."""


def warnings(scenario: Scenario, law: str | None = None) -> tuple[str, ...]:
    """Name values of a scenario that are possible, but seldom what was meant.

    Args:
        scenario: any.
        law: that flies; None looks at the gains of all laws.
    """
    return (*_rates(scenario), *_bodies(scenario), *_distances(scenario), *_exponents(scenario, law))


_RATES = ("chaser.rate", "debris.tumble_rate", "capture.rate", "settled.rate", "sensors.rate_sigma")


def _rates(scenario: Scenario) -> Iterator[str]:
    for path in (*_RATES, "sensors.attitude_sigma"):
        value, most = scenario.at(path), LOOSE if path.endswith("attitude_sigma") else FAST
        unit = "rad" if path.endswith("attitude_sigma") else "rad/s"
        size = math.hypot(*value) if isinstance(value, tuple) else value
        drawn = _drawn(scenario, path)
        if size > most:
            meant = shown(_times(plain(value), _TURN))
            yield f"{path}: {_in_degrees(size, unit)}; if degrees were meant: {meant} {unit}"
        elif drawn > most:
            yield f"{path}: draws reach {_in_degrees(drawn, unit)}; bounds and deviations are in {unit}, not in degrees"


def _in_degrees(size: float, unit: str) -> str:
    return f"{size:.4g} {unit} is {math.degrees(size):.4g} {unit.replace('rad', '°')}"


def _drawn(scenario: Scenario, path: str) -> float:
    """Give a size that draws of a field easily reach: the upper bound, or two sigma; 0 where it is not dispersed."""
    from detumble.scenario.dispersions.fitting import resolved

    for dispersion in scenario.dispersions:
        if dispersion.field == path:
            distribution = resolved(dispersion, scenario.at)[1]["distribution"]
            if distribution["kind"] == "direction":
                return float(distribution["magnitude"]["high"])
            reached = [_easily(element) for element in distribution["elements"]]
            return max(reached)
    return 0.0


def _easily(element: dict[str, Any]) -> float:
    if element["kind"] == "normal":
        return float(abs(element["mean"]) + 2.0 * element["sigma"])
    return float(max(abs(element["low"]), abs(element["high"])))


def _bodies(scenario: Scenario) -> Iterator[str]:
    for name in ("chaser", "debris"):
        body = getattr(scenario, name)
        changed = physics.made_exact(body.inertia)
        if changed:
            yield f"{name}.inertia {changed}"
        moments = physics.tensor(body.inertia)
        radius = math.sqrt(max(moments[axis][axis] for axis in range(3)) / body.mass)
        most = GYRATION * math.cbrt(body.mass / OF_MASS)
        if radius > most:
            yield (
                f"{name}.inertia: of {body.mass:.4g} kg this is a radius of gyration of {radius:.4g} m; no spacecraft of that "
                "mass has more than some metres: kg m² are needed"
            )
    for name in ("chaser_inertia", "stack_inertia"):
        inertia = getattr(scenario.belief, name)
        changed = physics.made_exact(inertia, rigid=False) if inertia is not None else None
        if changed:
            yield f"belief.{name} {changed}"


def _distances(scenario: Scenario) -> Iterator[str]:
    distance = math.hypot(*scenario.chaser.position)
    if text := far_away(distance, scenario):
        yield f"chaser.position: {text}"
    elif text := far_away(_drawn(scenario, "chaser.position"), scenario):
        yield f"chaser.position: draws reach {text}"


def far_away(distance: float, scenario: Scenario) -> str:
    """Say that a distance, m, is too far for the equations of relative motion; empty where it is not."""
    radius = scenario.orbit.distance
    if distance <= FAR * radius:
        return ""
    return (
        f"{distance:.4g} m is {100 * distance / radius:.2g} % of the orbit's radius; the Hill–Clohessy–Wiltshire equations are "
        "of first order in that"
    )


def _exponents(scenario: Scenario, law: str | None) -> Iterator[str]:
    for name in REGISTER if law is None else REGISTER.keys() & {law}:
        gains = getattr(scenario.laws, name)
        for channel in (*CHANNELS, *(f"stack.{channel}" for channel in CHANNELS)) if gains else ():
            own, form = gains.at(channel), form_of(gains)
            for gain in own.by_form if own and form else ():
                fraction = gain.fractions[form]
                if not set(fraction.fields) <= own.model_fields_set:
                    flown = " = ".join("/".join(map(str, pair)) for pair in (fraction.fields, fraction.of(own)))
                    yield (
                        f"laws.{name}.{channel}: the {form} form flies {flown}, not given here in full: "
                        "the rest is the default, ours"
                    )
