"""An independent simulator of the capture flight, to check the product against.

Written from the paper and our reading of it alone (SPEC.md with its section "How we read what is open",
and the scenario format); it shares no code with the core, and its author has seen none of it.

It differs in method wherever it can. Attitudes are rotation matrices relative to the turning frame H; quaternions
are scipy's conversion of them, with q0 >= 0: compare up to the sign. Each control period is integrated by the Taylor
series of the whole right-hand side, summed until its terms no longer count in double precision, so that
`time.integration_step` plays no part. The Riccati equation is solved by scipy.

Noise-free flights only. Units are SI; quaternions are scalar first and turn body axes into N.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass, fields, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_continuous_are
from scipy.spatial.transform import Rotation

Array = NDArray[Any]
Table = dict[str, Any]

MAX_ORDER = 30  # of the Taylor series; a period that needs more is halved
NEGLIGIBLE = 1e-18  # against the largest term: a later one adds nothing in double precision


@dataclass(frozen=True)
class Body:
    """A rigid body; position and velocity of its centre of mass relative to H's origin, in H."""

    mass: float
    inertia: Array  # body axes
    position: Array
    velocity: Array  # seen in H
    attitude: Array  # matrix, body axes -> H
    rate: Array  # relative to N, body axes


@dataclass(frozen=True)
class ChaserState:
    """The chaser at the capture tick, before the merge."""

    position: Array
    velocity: Array
    attitude: Array
    rate: Array


@dataclass(frozen=True)
class Flight:
    """Row k is the state at tick k after judging and merging, and the command of that tick.

    From the capture on `position`, `velocity` and `chaser_*` are the stack's (its axes are the chaser's), and
    `debris_*` ride along rigidly. Closed loop: forces in H axes, torques in body axes; open loop: both in the
    axes of the segment. The last row's commands are computed, not flown.
    """

    t: Array
    position: Array
    velocity: Array
    chaser_attitude: Array
    chaser_rate: Array
    debris_attitude: Array
    debris_rate: Array
    force_command: Array
    force: Array
    torque_command: Array
    torque: Array
    capture_time: float | None
    capture_tick: int | None
    stack_inertia: Array | None  # None unless the bodies merged
    before_merge: ChaserState | None  # None unless captured


def skew(a: Array) -> Array:
    """The matrix of a x ."""
    x, y, z = a
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def vector3(value: Any) -> Array:
    """Number or 3-list."""
    return np.array(np.broadcast_to(np.asarray(value, dtype=float), 3))


def inertia_matrix(value: Any) -> Array:
    """Principal moments or the whole matrix."""
    array = np.asarray(value, dtype=float)
    return np.diag(array) if array.ndim == 1 else array


def matrix_of(quaternion: Any) -> Array:
    return Rotation.from_quat(quaternion, scalar_first=True).as_matrix()


def quaternion_of(matrix: Array) -> Array:
    """Scalar first, q0 >= 0: the short way round. Also of a whole history of matrices."""
    return Rotation.from_matrix(matrix).as_quat(canonical=True, scalar_first=True)


def hcw_matrix(n: float) -> Array:
    """[r; v]' = A [r; v] + [0; force / m]."""
    a = np.zeros((6, 6))
    a[:3, 3:] = np.eye(3)
    a[3, 0], a[3, 4], a[4, 3], a[5, 2] = 3 * n * n, 2 * n, -2 * n, -n * n
    return a


class Wrench(NamedTuple):
    """A force and a torque, each the sum of a part held in H axes and a part held in body axes."""

    force_h: Array
    force_b: Array
    torque_h: Array
    torque_b: Array


def advance(body: Body, wrench: Wrench, n: float, dt: float) -> Body:
    """The body `dt` later, by the Taylor series of

    Q' = Q [w x] - [n z x] Q,   I w' = t_b + Q^T t_h - w x (I w),   x' = A x + [0; f_h + Q f_b] / m.
    """
    hcw, turn = hcw_matrix(n), skew(np.array([0.0, 0.0, n]))
    inverse = np.linalg.inv(body.inertia)
    q, s = np.zeros((2, MAX_ORDER + 1, 3, 3))  # coefficients times dt^k: attitude, [w x]
    w, h = np.zeros((2, MAX_ORDER + 1, 3))  # rate, body angular momentum
    x = np.zeros((MAX_ORDER + 1, 6))
    q[0], w[0], x[0] = body.attitude, body.rate, np.concatenate([body.position, body.velocity])
    small = 0
    for k in range(MAX_ORDER):
        s[k], h[k] = skew(w[k]), body.inertia @ w[k]
        torque = q[k].T @ wrench.torque_h - np.einsum("aij,aj->i", s[: k + 1], h[k::-1])
        force = q[k] @ wrench.force_b
        if k == 0:
            torque, force = torque + wrench.torque_b, force + wrench.force_h
        step = dt / (k + 1)
        q[k + 1] = step * (np.einsum("aij,ajk->ik", q[: k + 1], s[k::-1]) - turn @ q[k])
        w[k + 1] = step * (inverse @ torque)
        x[k + 1] = step * (hcw @ x[k] + np.concatenate([np.zeros(3), force / body.mass]))
        negligible = all(
            np.abs(series[k + 1]).max() <= NEGLIGIBLE * np.abs(series[: k + 1]).max()
            for series in (q, w, x[:, :3], x[:, 3:])
        )
        small = small + 1 if negligible else 0
        if small == 2:
            break
    else:
        return advance(advance(body, wrench, n, dt / 2), wrench, n, dt / 2)
    attitude = q[k + 1 :: -1].sum(axis=0)  # smallest terms first
    attitude = attitude @ (1.5 * np.eye(3) - 0.5 * attitude.T @ attitude)  # rounding only: keep it orthonormal
    end = x[k + 1 :: -1].sum(axis=0)
    return replace(body, position=end[:3], velocity=end[3:], attitude=attitude, rate=w[k + 1 :: -1].sum(axis=0))


@dataclass(frozen=True)
class Goal:
    """Where the centre of mass shall be, in H."""

    position: Array
    velocity: Array
    acceleration: Array


def fixed_goal(position: Any) -> Goal:
    return Goal(vector3(position), np.zeros(3), np.zeros(3))


def offset(body: Body, point: Array, angular_acceleration: Array, n: float) -> Goal:
    """A point of the body from its centre of mass: its place, velocity and acceleration as seen in H."""
    w_h = np.array([0.0, 0.0, n])
    w, alpha = body.attitude @ body.rate, body.attitude @ angular_acceleration
    p = body.attitude @ point
    v = np.cross(w - w_h, p)
    inertial = np.cross(alpha, p) + np.cross(w, np.cross(w, p))
    return Goal(p, v, inertial - 2 * np.cross(w_h, v) - np.cross(w_h, np.cross(w_h, p)))


def goal_before(scenario: Table, chaser: Body, debris: Body, n: float) -> Goal:
    """r_des in H with its derivatives: given, or what brings the two grasp points together."""
    if "grasp_point" not in scenario["chaser"]:
        return fixed_goal(scenario["goal"]["position"])
    tumbling = np.linalg.solve(debris.inertia, -np.cross(debris.rate, debris.inertia @ debris.rate))
    d = offset(debris, vector3(scenario["debris"]["grasp_point"]), tumbling, n)
    c = offset(chaser, vector3(scenario["chaser"]["grasp_point"]), np.zeros(3), n)
    return Goal(d.position - c.position, d.velocity - c.velocity, d.acceleration - c.acceleration)


def within_thresholds(capture: Table, chaser: Body, debris: Body, goal: Goal) -> bool:
    relative = debris.attitude.T @ chaser.attitude
    q_e = quaternion_of(relative)
    centre = {"goal": goal.position, "debris": np.zeros(3)}[capture.get("distance_from", "goal")]
    return bool(
        np.linalg.norm(chaser.position - centre) < capture["distance"]
        and 2 * math.atan2(np.linalg.norm(q_e[1:]), q_e[0]) < math.radians(capture["angle_deg"])
        and np.linalg.norm(chaser.rate - relative.T @ debris.rate) < capture["rate"]
        and np.linalg.norm(chaser.velocity - goal.velocity) < capture.get("speed", math.inf)
    )


def merged(transition: str, chaser: Body, debris: Body, n: float) -> Body:
    """The stack, in the chaser's axes."""
    mass = chaser.mass + debris.mass
    if transition == "approximate":
        return replace(chaser, mass=mass, inertia=chaser.inertia + debris.inertia)
    if transition != "momentum_conserving":
        raise ValueError(f"transition {transition!r}")
    to_c = chaser.attitude.T @ debris.attitude
    reduced = chaser.mass * debris.mass / mass
    d = chaser.attitude.T @ chaser.position
    d_rate = chaser.attitude.T @ (chaser.velocity + np.cross([0.0, 0.0, n], chaser.position))
    inertia = chaser.inertia + to_c @ debris.inertia @ to_c.T + reduced * (d @ d * np.eye(3) - np.outer(d, d))
    momentum = chaser.inertia @ chaser.rate + to_c @ debris.inertia @ debris.rate + reduced * np.cross(d, d_rate)
    share = chaser.mass / mass
    return Body(mass, inertia, share * chaser.position, share * chaser.velocity, chaser.attitude,
                np.linalg.solve(inertia, momentum))  # fmt: skip


def belief(scenario: Table, chaser: Body, debris: Body, stack: Body | None) -> tuple[float, Array]:
    """What the law takes mass and inertia for: of the chaser, or of the stack once there is one."""
    given = scenario.get("belief", {})
    if stack is None:
        mass, inertia, which = chaser.mass, chaser.inertia, "chaser"
    elif given.get("stack", "design") == "true":
        return stack.mass, stack.inertia
    else:
        mass, inertia, which = chaser.mass + debris.mass, chaser.inertia + debris.inertia, "stack"
    return given.get(which + "_mass", mass), inertia_matrix(given.get(which + "_inertia", inertia))


def lqr_gain(a: Array, b: Array, gains: dict[str, Array]) -> Array:
    q, r = np.diag(np.concatenate([gains["q_error"], gains["q_rate"]])), np.diag(gains["r"])
    return np.linalg.solve(r, b.T @ solve_continuous_are(a, b, q, r))


class Law:
    """One law in one phase (`after` the capture or before), with its gains and its belief."""

    def __init__(self, scenario: Table, name: str, form: str | None, after: bool, known: tuple[float, Array], n: float):
        laws = scenario["laws"]
        table = laws[name]
        own = table.get("stack", {}) if after else {}
        self.name, self.after, self.hcw = name, after, hcw_matrix(n)
        self.mass, self.inertia = known
        self.corrected = {"printed": False, "corrected": True}[form or table.get("form", "printed")]
        self.exact = {"printed": False, "exact": True}[laws.get("surface_rate", "printed")]
        self.scale = {"epsilon": 1.0, "two_epsilon": 2.0}[laws.get("attitude_error", "epsilon")]
        self.exponent = table.get("alpha", 0.7)  # PRRL's
        self.translation, self.rotation = (
            {key: vector3(gain) for key, gain in own.get(channel, table[channel]).items()}
            for channel in ("translation", "rotation")
        )
        if name == "lqr":
            zero, one = np.zeros((3, 3)), np.eye(3)
            kinematics = np.block([[zero, 0.5 * self.scale * one], [zero, zero]])
            self.k_translation = lqr_gain(self.hcw, np.vstack([zero, one]), self.translation)
            self.k_rotation = lqr_gain(kinematics, np.vstack([zero, np.linalg.inv(self.inertia)]), self.rotation)

    def command(self, body: Body, goal: Goal, reference: Array, reference_rate: Array) -> tuple[Array, Array]:
        """Force in H, torque in body axes. The reference: its attitude (axes -> H) and rate in its own axes."""
        m, inertia, w = self.mass, self.inertia, body.rate
        e_r, e_v = body.position - goal.position, body.velocity - goal.velocity
        relative = reference.T @ body.attitude
        e_w = w - relative.T @ reference_rate
        q_e = quaternion_of(relative)
        epsilon = self.scale * q_e[1:]
        epsilon_rate = self.scale * 0.5 * (q_e[0] * e_w + np.cross(q_e[1:], e_w))
        if self.name == "pd":
            force = -self.translation["kp"] * e_r - self.translation["kd"] * e_v
            torque = -self.rotation["kp"] * epsilon - self.rotation["kd"] * (e_w if self.corrected else w)
        elif self.name == "lqr":
            damped = e_w if self.corrected or self.after else w
            force = -m * self.k_translation @ np.concatenate([e_r, e_v])
            torque = -self.k_rotation @ np.concatenate([epsilon, damped])
        else:
            natural = self.hcw[3:] @ np.concatenate([body.position, body.velocity])
            gyroscopic = np.cross(w, inertia @ w)
            if self.name == "sosmc":
                natural, gyroscopic = np.zeros(3), gyroscopic if self.corrected else -gyroscopic
            force = m * (self.sliding(self.translation, e_r, e_v, e_v) - natural)
            torque = inertia @ self.sliding(self.rotation, epsilon, e_w, epsilon_rate) + gyroscopic
        return force + m * goal.acceleration, torque

    def sliding(self, g: dict[str, Array], e: Array, rate: Array, e_rate: Array) -> Array:
        """The acceleration a sliding law asks for. `rate` is what stands in s, `e_rate` the true de/dt."""
        slope, layer, gain = g["slope"], g["layer"], g["gain"]
        if self.name == "sosmc":
            s = rate + slope * e
            return -gain * np.clip(s / layer, -1, 1) - g["proportional"] * s
        if self.name == "prrl":
            s = rate + slope * e
            size = np.maximum(np.abs(s), layer) if self.corrected else np.abs(s)
            return -slope * (e_rate if self.exact else rate) - gain * size**self.exponent * np.clip(s / layer, -1, 1)
        if self.name != "tsmc":
            raise ValueError(f"no law {self.name!r}")
        exponent = g["p_corrected"] / g["q_corrected"] if self.corrected else g["p"] / g["q"]
        s = rate + slope * np.sign(e) * np.abs(e) ** exponent
        reaching = -gain * np.clip(s / layer, -1, 1)
        steepness = np.abs(np.where(e == 0.0, 1.0, e)) ** (exponent - 1)
        exact = slope * exponent * steepness * e_rate
        return reaching - np.where(e == 0.0, 0.0, exact) * self.exact  # at e = 0 it is nought, or infinite: left out


def limited(command: Array, limit: Any, scaled: bool) -> Array:
    bound = vector3(limit)
    if not scaled:
        return np.clip(command, -bound, bound)
    return command / max([1.0] + [abs(c) / b for c, b in zip(command, bound, strict=True) if c != 0.0])


def fly(scenario: Table, law: str, form: str | None = None) -> Flight:
    """Fly the scenario under `law` ("pd", "lqr", "sosmc", "tsmc", "prrl" or "none"); `form` overrides the law's own."""
    if any(np.any(np.asarray(sigma) > 0) for sigma in scenario.get("sensors", {}).values()):
        raise ValueError("this simulator flies without noise only")
    period = scenario["time"]["control_period"]
    ticks = round(scenario["time"]["duration"] / period)
    orbit, capture, actuators = scenario["orbit"], scenario["capture"], scenario["actuators"]
    radius = orbit["radius"] if "radius" in orbit else orbit["altitude"] + orbit.get("earth_radius", 6371e3)
    n = math.sqrt(orbit.get("mu", 3.986004418e14) / radius**3)
    h_start = matrix_of(orbit.get("lvlh_attitude", [1, 0, 0, 0]))
    still, upright = np.zeros(3), [1, 0, 0, 0]

    c, d = scenario["chaser"], scenario["debris"]
    chaser = Body(c["mass"], inertia_matrix(c["inertia"]), vector3(c["position"]), vector3(c.get("velocity", 0)),
                  h_start.T @ matrix_of(c.get("attitude", upright)), vector3(c.get("rate", 0)))  # fmt: skip
    debris = Body(d["mass"], inertia_matrix(d["inertia"]), still, still,
                  h_start.T @ matrix_of(d.get("attitude", upright)), vector3(d["tumble_rate"]))  # fmt: skip

    segments = scenario.get("laws", {}).get("none", {}).get("segments", [])
    merges = capture.get("merge", True) and law != "none"
    dwell = math.ceil(capture.get("dwell", 0.0) / period - 1e-9)  # in ticks; 1.1 / 0.1 is meant to be 11
    scaled = {"per_axis": False, "scaled": True}[actuators.get("saturation", "per_axis")]
    goals = scenario.get("goal", {})
    controller = None if law == "none" else Law(scenario, law, form, False, belief(scenario, chaser, debris, None), n)

    body = chaser  # the one that is flown: the stack once the bodies are one
    held = 0  # ticks in a row, up to now, at which the thresholds hold
    tick: int | None = None
    before: ChaserState | None = None
    stack: Body | None = None
    riding = np.eye(3)  # debris axes -> stack axes
    after = fixed_goal(0)
    rows: list[tuple[Array, ...]] = []  # ten columns, in the order of Flight

    for k in range(ticks + 1):
        to_n = h_start @ Rotation.from_rotvec([0.0, 0.0, n * k * period]).as_matrix()
        goal = after if stack else goal_before(scenario, body, debris, n)
        if tick is None:
            held = held + 1 if within_thresholds(capture, body, debris, goal) else 0
            if held > dwell:
                tick = k
                before = ChaserState(body.position, body.velocity, quaternion_of(to_n @ body.attitude), body.rate)
                if k == 0:
                    warnings.warn("the start is already inside the capture thresholds", stacklevel=2)
                if merges:
                    stack = merged(capture.get("transition", "approximate"), body, debris, n)
                    riding = body.attitude.T @ debris.attitude
                    goal = after = fixed_goal(goals.get("position_after_capture", goal.position))
                    controller = Law(scenario, law, form, True, belief(scenario, body, debris, stack), n)
                    body = stack
        if stack:
            debris = replace(debris, attitude=body.attitude @ riding, rate=riding.T @ body.rate)

        frame, force_command, torque_command = "lvlh", still, still
        if controller is None:
            for s in segments:
                if round(s["start"] / period) <= k < round(s["end"] / period):
                    frame, force_command, torque_command = s["frame"], vector3(s["force"]), vector3(s["torque"])
        else:
            if not goals.get("acceleration_feedforward", False):
                goal = replace(goal, acceleration=still)
            reference = (np.eye(3), np.array([0.0, 0.0, n])) if stack else (debris.attitude, debris.rate)
            force_command, torque_command = controller.command(body, goal, *reference)
        force = limited(force_command, actuators["force_limit"], scaled)
        torque = limited(torque_command, actuators["torque_limit"], scaled)

        rows.append((body.position, body.velocity, to_n @ body.attitude, body.rate, to_n @ debris.attitude, debris.rate,
                     force_command, force, torque_command, torque))  # fmt: skip
        if k < ticks:
            if controller is not None:
                wrench = Wrench(force, still, still, torque)
            elif frame == "lvlh":
                wrench = Wrench(force, still, torque, still)
            else:
                wrench = Wrench(still, force, still, torque)
            body = advance(body, wrench, n, period)
            if not stack:
                debris = advance(debris, Wrench(still, still, still, still), n, period)

    columns = zip((f.name for f in fields(Flight)[1:11]), zip(*rows, strict=True), strict=True)
    history: Table = {name: np.array(column) for name, column in columns}
    history |= {name: quaternion_of(history[name]) for name in ("chaser_attitude", "debris_attitude")}
    return Flight(period * np.arange(ticks + 1), **history, capture_time=None if tick is None else tick * period,
                  capture_tick=tick, stack_inertia=stack.inertia if stack else None, before_merge=before)  # fmt: skip
