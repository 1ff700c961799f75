"""Simulation of one flight: the core is called, and what it returns becomes events, metrics and warnings."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from detumble.checking import MOST_SEED, whole
from detumble.compiled import checked_backend, core
from detumble.errors import ScenarioError
from detumble.failures import NO_GAINS, cause
from detumble.flight import BROKEN_OFF, Event, Flight
from detumble.metrics import Metrics
from detumble.scenario.accuracy import coarse_step, most_asymmetric
from detumble.scenario.core import case
from detumble.scenario.files import given
from detumble.scenario.hints import far_away, warnings
from detumble.scenario.model import Scenario
from detumble.scenario.step import flown_exactly

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    import numpy as np
    from numpy.typing import NDArray

LARGEST_TURN = 0.5
"""A flight that diverges after a larger turn in an integration step, rad, does so for that reason."""
INSIDE = "the start is already inside every threshold: captured at t = 0"


def simulate(
    scenario: Scenario | str | os.PathLike[str],
    law: str | None = None,
    seed: int = 0,
    *,
    index: int = 0,
    backend: str | None = None,
) -> Flight:
    """Fly a scenario once.

    Args:
        scenario: a scenario, or what `load` takes.
        law: one of `LAWS`, or `none` for open loop; None is the only one with gains here, else `prrl`.
        seed: of the sensor noise, 0 to 2^64 - 1.
        index: of the trajectory under that seed: each has its own noise.
        backend: `portable`, `avx2`, `avx512`; None takes the core's choice. Noise does not depend on it.

    Returns:
        The flight; one that diverged is a flight too.

    Raises:
        ScenarioError: the scenario cannot be flown.
        RequestError: law, seed or back end cannot be used.
    """
    scenario = given(scenario)
    law = scenario.laws.default if law is None else law
    seed, index = whole("seed", seed, 0, MOST_SEED), whole("index", index, 0, MOST_SEED)
    return fly_case(Setup(scenario, law, seed, index, backend), case(scenario, law))


@dataclass(frozen=True)
class Setup:
    """What one flight is flown with.

    Attributes:
        scenario: nominal case, as the flight reports it.
        law: one of `LAWS`, or `none`.
        seed: of the sensor noise.
        index: of the trajectory under that seed.
        backend: of the core; None takes the core's choice.
    """

    scenario: Scenario
    law: str
    seed: int
    index: int
    backend: str | None


def fly_case(setup: Setup, core_case: dict[str, Any], differing: list[str] | None = None) -> Flight:
    """Fly a case of the core once.

    Args:
        setup: of the flight.
        core_case: as `case` gives it.
        differing: paths in which the flights of its campaign differ.

    Raises:
        ScenarioError: the scenario cannot be flown.
        RequestError: there is no such back end.
    """
    scenario, law, backend = setup.scenario, setup.law, checked_backend(setup.backend)
    try:
        record = core().fly(core_case, seed=setup.seed, index=setup.index, backend=backend, differing=differing)
    except ValueError as error:
        raise ScenarioError(scenario.title, problem=str(error)) from None
    metrics = Metrics.from_summary(record["summary"])
    step = core_case["plan"]["control_period"] / core_case["plan"]["steps_per_period"]
    events = _events(metrics, record, step)
    fast_turn = _fast_turn(metrics, record, core_case, scenario)
    return Flight(
        scenario=scenario,
        law=law,
        seed=setup.seed,
        index=setup.index,
        backend=record["backend"],
        history=record["history"],
        metrics=metrics,
        events=events,
        warnings=(
            *_warnings(metrics, events, scenario, law, record["summary"]["end_time"], fast_turn),
            *_far(record, scenario),
            *warnings(scenario, law),
        ),
    )


def _events(metrics: Metrics, record: Mapping[str, Any], step: float) -> tuple[Event, ...]:
    events, history, summary = [], record["history"], record["summary"]
    if metrics.capture_time is not None:
        events.append(Event("captured", metrics.capture_time, _listed(record["merge"] or {})))
    if metrics.settled_tick is not None:
        events.append(Event("settled", float(history["time"][metrics.settled_tick])))
    if summary["failure"] == NO_GAINS:
        events.append(Event("no_gains", summary["end_time"], {"cause": cause(NO_GAINS)}))
    if metrics.diverged_time is not None:
        events.append(Event("diverged", metrics.diverged_time, {"cause": _divergence(history, metrics, step)}))
    return tuple(events)


def _divergence(history: Mapping[str, NDArray[np.float64]], metrics: Metrics, step: float) -> str:
    """Name the cause: a turn too large for the integration, or else the part of the state that grew fastest at the end."""
    if not len(history["time"]):
        return "the start is not finite"
    turn = (metrics.largest_rate or 0.0) * step
    if turn > LARGEST_TURN:
        return f"a body turned {turn:.2g} rad in an integration step of {step:.4g} s, too far for its rotation to be integrated"
    if len(history["time"]) == 1:
        force, torque = (math.hypot(*history[name][0]) for name in ("force", "torque"))
        return f"the state became non-finite within the first control period, under {force:.3g} N and {torque:.3g} N m"
    units = {"position": "m", "velocity": "m/s", "chaser_rate": "rad/s", "debris_rate": "rad/s"}
    last = {name: float(abs(history[name][-1]).max()) for name in units}
    before = {name: float(abs(history[name][-2:][0]).max()) for name in units}
    name = max(units, key=lambda name: (last[name] / before[name] if before[name] else 0.0, last[name]))
    return f"the state became non-finite; last finite {name}: {last[name]:.3g} {units[name]}"


def _listed(value: Any) -> Any:
    """Give lists for tuples all through, as a flight that was read back has them."""
    if isinstance(value, dict):
        return {key: _listed(element) for key, element in value.items()}
    return [_listed(element) for element in value] if isinstance(value, list | tuple) else value


def _far(record: Mapping[str, Any], scenario: Scenario) -> Iterator[str]:
    """Warn that the flight left the range in which its equations hold, unless it began outside."""
    positions = record["history"]["position"]
    if len(positions):
        reached = math.sqrt(float((positions * positions).sum(axis=1).max()))
        if not far_away(math.hypot(*scenario.chaser.position), scenario) and (text := far_away(reached, scenario)):
            yield f"reached a distance of {text}"


def _fast_turn(metrics: Metrics, record: Mapping[str, Any], core_case: Mapping[str, Any], scenario: Scenario) -> str:
    """Warn that a body turned too fast for the integration step; empty where none did."""
    plan, merge = core_case["plan"], record["merge"]
    bodies = [core_case["chaser"]["inertia"]]
    bodies += [merge["stack_inertia"]] if merge else []
    bodies += [] if flown_exactly(scenario) else [core_case["debris"]["inertia"]]
    step = plan["control_period"] / plan["steps_per_period"]
    return coarse_step(most_asymmetric(*bodies), metrics.largest_rate or 0.0, step, record["summary"]["end_time"])


def _warnings(
    metrics: Metrics, events: tuple[Event, ...], scenario: Scenario, law: str, end: float, fast_turn: str
) -> tuple[str, ...]:
    found = []
    broken = next((event for event in events if event.name in BROKEN_OFF), None)
    if metrics.capture_time == 0.0 and law != "none":
        found.append(INSIDE)
    if broken:
        found.append(f"{BROKEN_OFF[broken.name]} at {broken.time:.10g} s: {broken.details['cause']}")
    elif metrics.capture_time is None and law != "none":
        found.append(f"not captured within {end:.10g} s")
    elif metrics.settling_time is None and law != "none" and scenario.capture.merge:
        found.append("captured, but not settled at the end of the flight")
    if fast_turn:
        found.append(fast_turn)
    if law == "none":
        found += [*_clipped(metrics), *cut_off(scenario)]
    return tuple(found)


def _clipped(metrics: Metrics) -> Iterator[str]:
    """Say how much of the open-loop commands was over a limit."""
    for what, share in (("force", metrics.force_saturated_share), ("torque", metrics.torque_saturated_share)):
        if share:
            yield f"the {what} commanded is over actuators.{what}_limit for {100.0 * share:.3g} % of the time, and cut to it"


def cut_off(scenario: Scenario) -> Iterator[str]:
    """Say which open-loop segments end after the flight."""
    duration = scenario.time.duration
    for index, segment in enumerate(scenario.laws.none.segments if scenario.laws.none else ()):
        if segment.end > duration * (1.0 + 1e-9):
            yield (
                f"laws.none.segments[{index}] ends at {segment.end:.10g} s, after the flight ({duration:.10g} s): "
                "the rest is not flown"
            )
