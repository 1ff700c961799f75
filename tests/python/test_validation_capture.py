"""Validation: the merge against momentum and energy as sums over two bodies in an inertial frame, written here.

Before: both bodies' states from the `captured` event; after: the stack's, with its mass and inertia from there. The
inertial frame moves with the debris' orbit and does not turn; in it the debris is at rest, the chaser at R r with
R (v + n z × r).
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import detumble
from detumble.flight import Flight
from detumble.scenario import LAWS, Scenario, with_settings
from detumble.scenario.laws import Form
from detumble.scenario.physics import tensor
from variants import VARIANTS

SCENARIOS = Path(__file__).parents[1] / "data" / "scenarios"
Array = NDArray[np.float64]
ANYTHING = ["capture.distance=1.5", "capture.angle_deg=170", "capture.rate=1.0"]


def matrix(q: Any) -> Array:
    """Body → reference, from a quaternion with the scalar first."""
    w, v = float(q[0]), np.asarray(q[1:])
    cross = np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])
    return np.asarray(np.eye(3) + 2.0 * w * cross + 2.0 * cross @ cross)


def unit(q: Any) -> Array:
    return np.asarray(np.asarray(q) / np.linalg.norm(q))


def lvlh(scenario: Scenario, time: float) -> Array:
    half = 0.5 * scenario.orbit.mean_motion * time
    turned = np.array([[np.cos(2 * half), -np.sin(2 * half), 0], [np.sin(2 * half), np.cos(2 * half), 0], [0, 0, 1.0]])
    return np.asarray(matrix(unit(scenario.orbit.lvlh_attitude)) @ turned)


class Balance:
    """Momenta and energies before and after a merge, inertial axes."""

    def __init__(self, flight: Flight) -> None:
        event = flight.event("captured")
        assert event is not None
        scenario, details = flight.scenario, event.details
        self.before, self.after = details["before"], details["after"]
        frame = lvlh(scenario, event.time)
        spin = np.array([0.0, 0.0, scenario.orbit.mean_motion])

        def still(position: Any, velocity: Any) -> tuple[Array, Array]:
            r, v = np.asarray(position), np.asarray(velocity)
            return frame @ r, frame @ (v + np.cross(spin, r))

        zero = np.zeros(3)
        chaser, debris, b = scenario.chaser, scenario.debris, self.before
        bodies = [
            (chaser.mass, chaser.inertia, b["chaser_attitude"], b["chaser_rate"], *still(b["position"], b["velocity"])),
            (debris.mass, debris.inertia, b["debris_attitude"], b["debris_rate"], zero, zero),
        ]
        a = self.after
        stack = (details["stack_mass"], details["stack_inertia"], a["attitude"], a["rate"])
        self.sums = [self.sum(bodies), self.sum([(*stack, *still(a["position"], a["velocity"]))])]
        self.inertia_before = self.inertia(bodies, matrix(a["attitude"]))
        self.inertia_after = np.array(details["stack_inertia"])

    @staticmethod
    def sum(bodies: list[Any]) -> dict[str, Any]:
        mass = sum(body[0] for body in bodies)
        centre = sum(body[0] * body[4] for body in bodies) / mass
        drift = sum(body[0] * body[5] for body in bodies) / mass
        momentum, angular, energy, scale = mass * drift, np.zeros(3), 0.0, 0.0
        for m, inertia, attitude, rate, r, v in bodies:
            w, turn = np.asarray(rate), matrix(attitude)
            own = turn @ (np.array(tensor(inertia)) @ w)
            orbital = m * np.cross(r - centre, v - drift)
            angular = angular + own + orbital
            energy += 0.5 * m * float(v @ v) + 0.5 * float(w @ np.array(tensor(inertia)) @ w)
            scale += float(np.linalg.norm(own) + np.linalg.norm(orbital))
        return {"p": momentum, "H": angular, "E": energy, "scale": scale, "m": mass, "centre": centre}

    @staticmethod
    def inertia(bodies: list[Any], axes: Array) -> Array:
        """About the common centre of mass, by the parallel-axis theorem, in the stack's axes."""
        centre = sum(body[0] * body[4] for body in bodies) / sum(body[0] for body in bodies)
        total = np.zeros((3, 3))
        for m, inertia, attitude, _, r, _ in bodies:
            turn, arm = matrix(attitude), r - centre
            total += turn @ np.array(tensor(inertia)) @ turn.T + m * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        return np.asarray(axes.T @ total @ axes)


def assert_conserved(flight: Flight) -> None:
    balance = Balance(flight)
    before, after = balance.sums
    assert after["m"] == pytest.approx(before["m"], rel=1e-15)
    for name in ("p", "centre"):
        assert np.abs(after[name] - before[name]).max() < 4e-15 * float(np.linalg.norm(before[name]))
    assert np.abs(after["H"] - before["H"]).max() < 2e-14 * before["scale"]
    assert after["E"] <= before["E"] * (1.0 + 1e-14)
    assert np.abs(balance.inertia_after - balance.inertia_before).max() < 1e-14 * np.abs(balance.inertia_before).max()
    assert np.array_equal(balance.after["attitude"], balance.before["chaser_attitude"])


@pytest.mark.parametrize(("law", "form"), VARIANTS)
@pytest.mark.parametrize("name", ["products_of_inertia", "grasp_points", "far_tumble", "twelve_u"])
def test_validation_capture_conserves_momenta_and_gains_no_energy(name: str, law: str, form: Form | None) -> None:
    path = SCENARIOS / f"{name}.toml"
    scenario = detumble.load(path if path.exists() else name)
    if law not in scenario.laws.closed_loop:
        pytest.skip("no gains")
    if form is not None:
        getattr(scenario.laws, law).form = form
    flight = detumble.simulate(scenario, law=law)
    assert_conserved(flight)
    row = int(np.argmax(flight.history["captured"]))
    after = flight.event("captured").details["after"]  # type: ignore[union-attr]  # it has been read above
    assert np.array_equal(flight.history["position"][row], after["position"])
    assert np.array_equal(flight.history["chaser_rate"][row], after["rate"])


def random_body(rng: np.random.Generator) -> tuple[float, list[list[float]]]:
    moments = np.sort(rng.uniform(0.2, 1.0, 3))
    moments[2] = min(moments[2], 0.99 * (moments[0] + moments[1]))
    axes, _ = np.linalg.qr(rng.standard_normal((3, 3)))
    mass = float(10.0 ** rng.uniform(-0.5, 2.0))
    inertia = 0.02 * mass * axes @ np.diag(moments) @ axes.T
    return mass, (0.5 * (inertia + inertia.T)).tolist()


def varied(rng: np.random.Generator, transition: str) -> Scenario:
    """Random bodies, attitudes, rates, closing speed and frame; captured at once or within seconds."""
    numbers = {
        "chaser.position": rng.uniform(-0.6, 0.6, 3),
        "chaser.velocity": rng.uniform(-0.2, 0.2, 3),
        "chaser.attitude": unit(rng.standard_normal(4)),
        "chaser.rate": rng.uniform(-0.4, 0.4, 3),
        "debris.attitude": unit(rng.standard_normal(4)),
        "debris.tumble_rate": rng.uniform(-0.4, 0.4, 3),
        "orbit.lvlh_attitude": unit(rng.standard_normal(4)),
    }
    chaser, debris = random_body(rng), random_body(rng)
    return with_settings(
        detumble.load(SCENARIOS / "products_of_inertia.toml"),
        [
            *(f"{field}={value.tolist()}" for field, value in numbers.items()),
            *(f"chaser.{name}={value}" for name, value in zip(("mass", "inertia"), chaser, strict=True)),
            *(f"debris.{name}={value}" for name, value in zip(("mass", "inertia"), debris, strict=True)),
            *ANYTHING,
            f"capture.dwell={rng.integers(0, 20) * 0.1:.1f}",
            "capture.speed=10.0",
            f"capture.transition={transition}",
            "time.duration=20.0",
        ],
    )


def test_validation_any_capture_conserves_momenta_and_gains_no_energy() -> None:
    rng = np.random.default_rng(6)
    captured = 0
    for number in range(150):
        flight = detumble.simulate(varied(rng, "momentum_conserving"), law=LAWS[number % 5])
        if flight.event("captured") is None:
            continue
        captured += 1
        assert_conserved(flight)
    assert captured > 120


def test_the_plain_transition_conserves_neither_so_the_check_above_can_fail() -> None:
    flight = detumble.simulate(varied(np.random.default_rng(6), "approximate"), law="pd")
    with pytest.raises(AssertionError):
        assert_conserved(flight)


def test_the_approximate_transition_leaves_the_chasers_motion_as_it_was() -> None:
    rng = np.random.default_rng(7)
    captured = 0
    for number in range(60):
        scenario = varied(rng, "approximate")
        flight = detumble.simulate(scenario, law=LAWS[number % 5])
        event = flight.event("captured")
        if event is None:
            continue
        captured += 1
        before, after = event.details["before"], event.details["after"]
        for name, same in (
            ("position", "position"),
            ("velocity", "velocity"),
            ("attitude", "chaser_attitude"),
            ("rate", "chaser_rate"),
        ):
            assert np.array_equal(after[name], before[same])
        assert event.details["stack_mass"] == scenario.chaser.mass + scenario.debris.mass
        plain = np.array(tensor(scenario.chaser.inertia)) + np.array(tensor(scenario.debris.inertia))
        assert np.abs(event.details["stack_inertia"] - plain).max() <= 1e-16 * np.abs(plain).max()
    assert captured > 40


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("name", ["grasp_points", "twelve_u"])
def test_validation_grasp_points_are_within_reach_at_capture_and_not_a_tick_earlier(name: str, law: str) -> None:
    """The gap |r + R_HC p_C - R_HD p_D|, and the other thresholds, anew at every tick before capture."""
    path = SCENARIOS / f"{name}.toml"
    scenario = detumble.load(path if path.exists() else name)
    if law not in scenario.laws.closed_loop:
        pytest.skip(f"{name} has no gains for {law}")
    flight = detumble.simulate(scenario, law=law)
    event, flown, limits = flight.event("captured"), flight.history, scenario.capture
    assert event is not None
    row = int(event.details["tick"])
    grasp = [np.asarray(body.grasp_point) for body in (scenario.chaser, scenario.debris)]

    def inside(time: float, state: dict[str, Any]) -> bool:
        frame = lvlh(scenario, time)
        chaser, debris = matrix(state["chaser_attitude"]), matrix(state["debris_attitude"])
        arm = frame.T @ debris @ grasp[1]
        gap = np.asarray(state["position"]) + frame.T @ chaser @ grasp[0] - arm
        relative = np.asarray(state["chaser_rate"]) - chaser.T @ debris @ np.asarray(state["debris_rate"])
        turn = np.arccos(np.clip(0.5 * (np.trace(chaser.T @ debris) - 1.0), -1.0, 1.0))
        # v_des: how the goal R_HD p_D - R_HC p_C moves in H as both bodies turn
        spin = np.array([0.0, 0.0, scenario.orbit.mean_motion])
        tip = frame.T @ (
            debris @ np.cross(state["debris_rate"], grasp[1]) - chaser @ np.cross(state["chaser_rate"], grasp[0])
        )
        carried = np.cross(spin, arm - frame.T @ chaser @ grasp[0])
        speed = np.linalg.norm(np.asarray(state["velocity"]) - (tip - carried))
        return bool(
            np.linalg.norm(gap) < limits.distance
            and np.degrees(turn) < limits.angle_deg
            and np.linalg.norm(relative) < limits.rate
            and (limits.speed is None or speed < limits.speed)
        )

    held = 0
    for k in range(row):
        held = held + 1 if inside(flown["time"][k], {key: series[k] for key, series in flown.items()}) else 0
        assert held <= round(limits.dwell / scenario.time.control_period), f"tick {k} was a capture already"
    assert inside(event.time, event.details["before"])
    assert held == round(limits.dwell / scenario.time.control_period)
