"""All bounds of one start: the soonest capture, each half of it, the least Δv, and the least time to detumble.

    translation  distance and speed alone, any real time, any control within the limits
    attitude     angle and relative rate alone, likewise
    capture      both at one control tick, as the scenario judges it. Below: the first tick that neither half excludes,
                 there or at any time. Above: the first tick found at which commands held over control periods do both.
    Δv           of a translation that is within its thresholds at some time up to `within`
    detumble     from capture until settled, for any capture

With grasp points the two halves meet: where the chaser must be follows from how it points, so the translation of the upper
bound aims at what the slew found for that tick leaves.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from detumble.analysis.bounds.commanded import reach_at_tick
from detumble.analysis.bounds.detumbling import Detumbling, detumble_bound
from detumble.analysis.bounds.earliest import minimum_times
from detumble.analysis.bounds.fuel import delta_v_bound
from detumble.analysis.bounds.pursuit import Pursuit, check_undisturbed, start_of
from detumble.analysis.bounds.slew import AttitudeBound, Slew, attitude_bound, first_slew
from detumble.analysis.bounds.soonest import translation_bound
from detumble.analysis.bounds.transfer import Bracket, Transfer
from detumble.analysis.bounds.tumble import tumble
from detumble.checking import real
from detumble.errors import Fault, ScenarioError
from detumble.quaternions import Array, conjugate, multiply, rotate
from detumble.scenario.conversions import ticks
from detumble.scenario.core import case as core_case
from detumble.scenario.files import given
from detumble.scenario.model import Scenario
from detumble.states import DEBRIS_ATTITUDE, DEBRIS_RATE

if TYPE_CHECKING:
    import os

ATTEMPTS = 12
"""Ticks tried for the upper bound of the capture time."""


BRACKETED = ("capture_time_s", "translation_s", "attitude_s", "delta_v_m_s")
ENDS = (
    *(f"{quantity}.{end}" for quantity in BRACKETED for end in ("lower", "upper")),
    "detumble_s.lower",
    "detumble_s.matched",
)
"""Names of all that is bounded, with units."""


@dataclass(frozen=True)
class Rendezvous:
    """Bounds of the capture time, and the trajectory of the upper one.

    Attributes:
        lower: no capture is earlier, s; a control tick; inf when the flight is too short.
        upper: tick of the capture found, s; inf when none was found.
        transfer: its translation.
        slew: its rotation; None where no torque limit bounds it.
    """

    lower: float
    upper: float
    transfer: Transfer | None
    slew: Slew | None


@dataclass(frozen=True)
class Bounds:
    """Bounds of one start.

    Attributes:
        capture: s.
        translation: s.
        attitude: s.
        delta_v: m/s, of a translation within `within`.
        within: s.
        detumble: s.
    """

    capture: Rendezvous
    translation: Bracket
    attitude: AttitudeBound
    delta_v: Bracket
    within: float
    detumble: Detumbling

    def ends(self) -> dict[str, float]:
        """Give lower and upper values by name, as `ENDS` lists them."""
        brackets = (self.capture, self.translation, self.attitude, self.delta_v)
        values = [end for bracket in brackets for end in (bracket.lower, bracket.upper)]
        return dict(zip(ENDS, (*values, self.detumble.lower, self.detumble.matched), strict=True))

    def to_json(self) -> dict[str, Any]:
        """Give lower and upper values as JSON takes them."""
        tables: dict[str, dict[str, float]] = {}
        for name, value in self.ends().items():
            quantity, _, end = name.partition(".")
            tables.setdefault(quantity, {})[end] = value
        tables["delta_v_m_s"]["within_s"] = self.within
        return tables


def bound(scenario: Scenario | str | os.PathLike[str], within: float | None = None) -> Bounds:
    """Bound what any controller can do from a scenario's nominal start.

    Args:
        scenario: a scenario, or what `load` takes; law and noise have no effect.
        within: s, by when the Δv is asked for; None is the duration.

    Raises:
        ScenarioError: the scenario contradicts itself, or a disturbance acts: the bounds know of none.
        RequestError: `within` is no time of the flight, or CasADi is not installed.
    """
    scenario = given(scenario)
    if not scenario.capture.model_fields_set:
        raise ScenarioError(scenario.title, [Fault("capture", "missing; a bound needs the thresholds of capture")])
    check_undisturbed(scenario)
    plain = core_case(scenario, "none")
    plain["plan"]["transition"] = scenario.capture.transition  # open loop never merges; what a controller captures does
    return bound_of(plain, within)


def bound_of(case: Mapping[str, Any], within: float | None = None) -> Bounds:
    """Bound what any controller can do in a plain case, as `scenario.core.case` gives it; otherwise as `bound`."""
    pursuit, start = Pursuit.of(case), start_of(case)
    until = time_within(pursuit, within)
    translation, attitude = translation_bound(pursuit, start), attitude_bound(pursuit, start)
    capture = _capture(pursuit, start, translation, attitude)
    return Bounds(
        capture=capture,
        translation=translation,
        attitude=attitude,
        delta_v=delta_v_bound(pursuit, start, until),
        within=until,
        detumble=detumble_bound(case, 0.0 if math.isinf(capture.lower) else capture.lower),
    )


def time_within(pursuit: Pursuit, within: float | None) -> float:
    """Give the time, s, by when a Δv is asked for: the duration, unless another one is given.

    Raises:
        RequestError: it is no time of the flight.
    """
    duration = pursuit.periods * pursuit.period
    if within is None:
        return duration
    return min(real("within", within, above=0.0, most=duration * (1.0 + 1e-12), unit="s"), duration)


def _capture(pursuit: Pursuit, start: Array, translation: Bracket, attitude: AttitudeBound) -> Rendezvous:
    # both halves are judged together at ticks only; each half alone has a tighter bound in continuous time
    halves = max(translation.lower, attitude.lower)
    on_tick = pursuit.time_of(ticks(halves, pursuit.period)) if math.isfinite(halves) else math.inf
    lower = max(minimum_times(pursuit, start).capture, on_tick)
    soonest = max(lower, translation.upper, attitude.upper)
    if math.isinf(soonest):
        return Rendezvous(lower, math.inf, None, None)
    tick = ticks(soonest, pursuit.period)
    for _ in range(ATTEMPTS):
        slew = first_slew(pursuit, start, tick)
        if slew is None:
            break
        tick = ticks(float(slew.times[-1]), pursuit.period)
        place, velocity = _goal(pursuit, start, slew, tick)
        transfer = reach_at_tick(pursuit, start, tick, place, velocity)
        if transfer is not None:
            return Rendezvous(lower, pursuit.time_of(tick), transfer, slew)
        tick += 1
    return Rendezvous(lower, math.inf, None, None)


def _goal(pursuit: Pursuit, start: Array, slew: Slew, tick: int) -> tuple[Array | None, Array | None]:
    """Give r_des and v_des in H, (dwell + 1, 3) each, at a tick and over the dwell before it, for the chaser as it turns.

    r_des = R_HD p_D - R_HC p_C, v_des = Ω_D × R_HD p_D - Ω_C × R_HC p_C, Ω = w - w_H in H. None without grasp points.
    """
    if pursuit.grasp_points is None:
        return None, None
    span = slice(tick - pursuit.dwell_ticks, tick + 1)
    debris = start[DEBRIS_ATTITUDE] / np.linalg.norm(start[DEBRIS_ATTITUDE])
    tumbling = tumble(pursuit.debris_inertia, debris, start[DEBRIS_RATE], pursuit.period, tick)
    orbit_angle = pursuit.mean_motion * pursuit.period * np.arange(tick + 1.0)[span]
    to_lvlh = conjugate(pursuit.lvlh_turned(orbit_angle))  # q_HN†
    place, velocity = np.zeros((2, pursuit.dwell_ticks + 1, 3))
    for sign, point, (attitudes, rates) in zip(
        (-1.0, 1.0), pursuit.grasp_points, ((slew.attitude, slew.rate), tumbling), strict=True
    ):
        in_lvlh = multiply(to_lvlh, attitudes[span])
        arm = rotate(in_lvlh, np.broadcast_to(point, rates[span].shape))
        spin = rotate(in_lvlh, rates[span]) - np.array([0.0, 0.0, pursuit.mean_motion])
        place += sign * arm
        velocity += sign * np.cross(spin, arm)
    return (np.zeros_like(place) if pursuit.from_debris else place), velocity
