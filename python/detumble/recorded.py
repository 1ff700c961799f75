"""The recorded commands of a flight, flown again tick by tick: same actuators, capture test and merge, no sensors, no law."""

from __future__ import annotations

import os

import numpy as np

from detumble.errors import RequestError
from detumble.flight import Flight, read_netcdf
from detumble.scenario.core import case
from detumble.simulation import Setup, fly_case

SENSORS = ("position", "velocity", "attitude", "rate")


def replay_wrench(flight: Flight | str | os.PathLike[str], *, backend: str | None = None) -> Flight:
    """Fly the commands that a flight recorded.

    Args:
        flight: a flight of any law, or none, or a file that `Flight.to_netcdf` wrote. Runs of a campaign may differ in the
            last bits, as their arithmetic is chosen for the whole campaign.
        backend: as in `simulate`; None takes the flight's own.

    Returns:
        The flight, with law, seed and index of the recorded one: to the bit the same if the scenario is. That of a flight
        which was broken off without gains has its series, and the metrics and events of a flight that ends there.

    Raises:
        ScenarioError: the scenario cannot be flown.
        RequestError: the file cannot be read or is no flight, it holds no tick, or there is no such back end.
    """
    flight = flight if isinstance(flight, Flight) else read_netcdf(flight)
    ticks = len(flight.history["time"])
    if not ticks:
        raise RequestError("the flight holds no tick: there is no command to fly")
    core_case = case(flight.scenario, flight.law)
    wrenches = np.hstack((flight.history["force_command"], flight.history["torque_command"]))
    segments = core_case["law"].get("segments", [])  # open loop has axes of its own
    core_case["law"] = {"kind": "recorded", "wrenches": wrenches.tolist(), "segments": segments}
    core_case["sensors"] = dict.fromkeys(SENSORS, 0.0)
    # the last command of a flight that diverged was flown, that of any other was not
    core_case["plan"]["periods"] = min(core_case["plan"]["periods"], ticks if flight.diverged else ticks - 1)
    setup = Setup(flight.scenario, flight.law, flight.seed, flight.index, backend or flight.backend)
    return fly_case(setup, core_case)
