"""The same recipe gives the same numbers: on every back end, any number of threads, one flight or many."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import detumble
from detumble import _core
from detumble.flight import Flight
from detumble.scenario import LAWS, with_settings
from detumble.scenario.core import case
from detumble.scenario.laws import Form
from detumble.workload import random_starts, start_columns
from variants import VARIANTS

Array = NDArray[np.float64]
FLOWN = [
    (name, law)
    for name in detumble.scenarios()
    for law in (*LAWS, "none")
    if law == "none" or getattr(detumble.load(name).laws, law) is not None
]
QUIET = ["sensors={}"]
needs_both = pytest.mark.skipif(
    not {"avx2", "avx512"} <= set(_core.backends()), reason="this CPU lacks AVX2 or AVX-512"
)


def assert_same_bits(one: Flight, other: Flight) -> None:
    for name, series in one.history.items():
        assert series.tobytes() == other.history[name].tobytes(), name
    assert repr(one.metrics) == repr(other.metrics)
    assert repr(one.events) == repr(other.events)


def fly_starts(
    recipe: dict[str, Any], starts: Array, seed: int, first: int, threads: int, backend: str
) -> dict[str, Array]:
    """Fly one case from many starts; gives what is known of each flight, array by array."""
    flown = _core.fly_many(
        recipe, start_columns(starts), len(starts), seed=seed, first_index=first, threads=threads, backend=backend
    )
    return {name: values for name, values in flown.items() if isinstance(values, np.ndarray)}


def state(motion: Any) -> list[float]:
    parts = ("position", "velocity", "chaser_attitude", "chaser_rate", "debris_attitude", "debris_rate")
    return [float(x) for part in parts for x in motion[part]]


@needs_both
@pytest.mark.parametrize(("name", "law"), FLOWN)
def test_noisy_flights_have_the_same_bits_on_avx2_and_avx512(name: str, law: str) -> None:
    scenario = detumble.load(name)
    narrow, wide = (detumble.simulate(scenario, law, seed=11, backend=backend) for backend in ("avx2", "avx512"))
    assert (narrow.backend, wide.backend) == ("avx2", "avx512")
    assert_same_bits(narrow, wide)


@needs_both
@pytest.mark.parametrize("law", LAWS)
def test_many_flights_have_the_same_bits_on_avx2_and_avx512(law: str) -> None:
    recipe = case(with_settings(detumble.load("twelve_u"), ["time.duration=120.0"]), law)
    starts = random_starts(37, seed=2)
    narrow, wide = (fly_starts(recipe, starts, 5, 0, 1, backend) for backend in ("avx2", "avx512"))
    for column, values in narrow.items():
        assert values.tobytes() == wide[column].tobytes(), column


@pytest.mark.parametrize("backend", _core.backends())
@pytest.mark.parametrize("law", LAWS)
def test_threads_chunks_and_lanes_do_not_show(law: str, backend: str) -> None:
    """37 flights, no multiple of any lane count: as one, on two threads, in chunks of 1, 5 and 16."""
    recipe = case(with_settings(detumble.load("paper"), ["time.duration=40.0"]), law)
    starts = random_starts(37, seed=3)
    whole = fly_starts(recipe, starts, 9, 100, 1, backend)
    assert len(np.unique(whole["final_state"][:, 0])) == 37
    threaded = fly_starts(recipe, starts, 9, 100, 2, backend)
    chunked = {
        size: [
            fly_starts(recipe, starts[first : first + size], 9, 100 + first, 2, backend) for first in range(0, 37, size)
        ]
        for size in (1, 5, 16)
    }
    for column, values in whole.items():
        assert threaded[column].tobytes() == values.tobytes(), column
        for size, chunks in chunked.items():
            together = np.concatenate([chunk[column] for chunk in chunks])
            assert together.tobytes() == values.tobytes(), (column, size)


@pytest.mark.parametrize("backend", _core.backends())
@pytest.mark.parametrize("law", LAWS)
def test_flight_i_of_many_is_the_single_flight_with_that_index(law: str, backend: str) -> None:
    scenario = with_settings(detumble.load("far_tumble"), ["time.duration=250.0"])
    recipe = case(scenario, law)
    first, seed = 40, 2**63 + 12345
    starts = np.repeat(np.array([state(recipe["start"])]), 11, axis=0)
    many = fly_starts(recipe, starts, seed, first, 2, backend)
    assert len(np.unique(many["final_state"][:, 0])) == 11
    for i in (0, 1, 7, 8, 10):
        flight = detumble.simulate(scenario, law, seed, index=first + i, backend=backend)
        last = {name: series[-1] for name, series in flight.history.items()}
        assert state(last) == many["final_state"][i].tolist()
        for name in ("capture_time", "settling_time", "delta_v", "final_rate", "torque_saturated_share"):
            single = getattr(flight.metrics, name)
            if single is None:
                assert np.isnan(many[name][i])
            else:
                assert many[name][i] == pytest.approx(single, rel=1e-15)


@pytest.mark.skipif(len(_core.backends()) < 2, reason="this CPU has no wide back end")
@pytest.mark.parametrize(("law", "form"), [*VARIANTS, ("none", None)])
@pytest.mark.parametrize("name", [name for name in detumble.scenarios() if name != "workload_w"])
def test_the_portable_path_agrees_to_1e_12_over_600_s_without_noise(name: str, law: str, form: Form | None) -> None:
    """m, m/s, rad/s, quaternion components. No law shipped amplifies round-off that far.

    Measured: mostly 1e-14 or less; 8e-13 rad/s for corrected TSMC on `twelve_u`, whose terminal surface has an infinite slope
    at zero error; 2e-7 rad/s for STSMC there, whose reaching law has one at s = 0, and a sign that round-off may turn a tick
    sooner.
    """
    scenario = with_settings(detumble.load(name), QUIET)
    assert scenario.time.duration == 600.0
    if form is not None:
        getattr(scenario.laws, law).form = form
    narrow, wide = (detumble.simulate(scenario, law, backend=backend) for backend in ("portable", _core.backends()[-1]))
    assert narrow.metrics.capture_time == wide.metrics.capture_time
    tolerance = {("tsmc", "corrected"): 5e-12, ("stsmc", None): 1e-6}.get((law, form), 1e-12)
    for series in ("position", "velocity", "chaser_attitude", "chaser_rate", "debris_attitude", "debris_rate"):
        assert np.abs(narrow.history[series] - wide.history[series]).max() < tolerance, series


def test_seeds_and_indices_are_all_different() -> None:
    scenario = with_settings(detumble.load("paper"), ["time.duration=1.0"])
    flights = [
        detumble.simulate(scenario, "pd", seed, index=index)
        for seed in (0, 1, 2, 2**32, 2**64 - 1)
        for index in (0, 1, 2**32, 2**64 - 1)
    ]
    commands = {flight.history["torque_command"].tobytes() for flight in flights}
    assert len(commands) == len(flights)


# --- noise: a law that returns what it measures


def measured(sigmas: str, index: int = 0, seed: int = 4) -> dict[str, Array]:
    """Errors of measurement over 60 000 ticks, read from the commands of PD with gains so small that they move nothing.

    U = -kp e_r - kd e_v and tau = -kp ε - kd w: with one gain a channel, one noise at a time.
    """
    gain = 1e-9
    found = {}
    for name, translation, rotation in (
        ("proportional", f"{{kp = {gain}, kd = 0.0}}", f"{{kp = {gain}, kd = 0.0}}"),
        ("rate", f"{{kp = 0.0, kd = {gain}}}", f"{{kp = 0.0, kd = {gain}}}"),
    ):
        scenario = with_settings(
            detumble.load("paper"),
            [
                "orbit={radius = 1e9, mu = 1e10}",  # as good as no orbit
                "chaser.position=[10.0, 0.0, 0.0]",
                "chaser.attitude=[1, 0, 0, 0]",
                "debris.tumble_rate=[0.0, 0.0, 0.0]",
                "goal.position=[10.0, 0.0, 0.0]",
                "capture={distance = 1e-9, angle_deg = 1e-9, rate = 1e-9, merge = false}",
                f"sensors={sigmas}",
                f"laws.pd={{translation = {translation}, rotation = {rotation}}}",
                "time={duration = 6000.0, control_period = 0.1, integration_step = 0.1}",
            ],
        )
        flown = detumble.simulate(scenario, "pd", seed, index=index).history
        truth = {"proportional": flown["position"] - [10.0, 0.0, 0.0], "rate": flown["velocity"]}[name]
        found[f"{name} of translation"] = -flown["force_command"] / gain - truth
        turn = {"proportional": flown["chaser_attitude"][:, 1:], "rate": flown["chaser_rate"]}[name]
        found[f"{name} of rotation"] = -flown["torque_command"] / gain - turn
    return found


def test_noise_is_white_gaussian_of_the_sigma_asked_for() -> None:
    """60 001 draws an axis: mean to 5 σ/√N, standard deviation to 1.5 %, kurtosis 3 ± 0.15, neither axis nor tick correlated."""
    sigmas = {
        "proportional of translation": 0.01,
        "rate of translation": 2e-3,
        "proportional of rotation": 5e-3,  # ε is half the small angle
        "rate of rotation": 3e-4,
    }
    noise = measured("{position_sigma = 0.01, velocity_sigma = 2e-3, attitude_sigma = 1e-2, rate_sigma = 3e-4}")
    draws = []
    for name, sigma in sigmas.items():
        values = noise[name] / sigma
        count = len(values)
        assert count == 60_001
        assert np.abs(values.mean(axis=0)).max() < 5.0 / np.sqrt(count), name
        assert np.abs(values.std(axis=0) - 1.0).max() < 0.015, name
        assert np.abs((values**4).mean(axis=0) - 3.0).max() < 0.15, name
        assert 3.8 < np.abs(values).max() < 6.0, name
        draws.append(values)
    together = np.column_stack(draws)
    columns = np.column_stack([together[:-1], together[1:]])
    correlation = np.corrcoef(columns.T) - np.eye(24)
    assert np.abs(correlation).max() < 5.0 / np.sqrt(len(columns))


def test_a_sigma_of_zero_leaves_its_measurement_exact_and_the_others_draws_unchanged() -> None:
    everything = measured("{position_sigma = 0.01, velocity_sigma = 2e-3, attitude_sigma = 1e-2, rate_sigma = 3e-4}")
    position = measured("{position_sigma = 0.01}")
    name = "proportional of translation"
    assert np.abs(position[name] - everything[name]).max() < 1e-7  # the commands move the chaser a little
    for other in ("rate of translation", "proportional of rotation", "rate of rotation"):
        assert np.abs(position[other]).max() < 1e-12


def test_trajectories_have_noise_of_their_own() -> None:
    sigmas = "{position_sigma = 0.01}"
    name = "proportional of translation"
    first = measured(sigmas)[name]
    for other in (measured(sigmas, index=1)[name], measured(sigmas, seed=5)[name]):
        assert np.abs(np.corrcoef(first.T, other.T)[:3, 3:]).max() < 5.0 / np.sqrt(len(first))
