"""Slews by direct multiple shooting: rigid-body rotation as a nonlinear programme, solved by IPOPT through CasADi.

Torque is constant on each interval, attitude and rate at its ends are unknowns, and classical Runge-Kutta steps tie them
together (Bock & Plitt, IFAC 1984). Two programmes, each built once:

    soonest     min T                        intervals of T/N, thresholds at T; the debris' attitude and rate at T are
                                             cubic splines through its tumble
    on time     min slack + small effort     intervals as given, thresholds widened by the slack at chosen nodes

Angle: (q_C · q_D)² ≥ cos²(θ/2), independent of the signs of quaternions. Rate: |w_C - R w_D|² ≤ rate². Solutions are not verified
here: the callers integrate the torques again. IPOPT stops after a number of iterations, not of seconds, so that its answer is the
same everywhere.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from detumble.analysis.bounds.chase import Motion
from detumble.errors import RequestError
from detumble.quaternions import Array

SOONEST_INTERVALS = 30
TIMED_INTERVALS = 48
SUBSTEPS = 3
KNOTS = 96  # of the spline through the tumble
ITERATIONS = 100


def casadi() -> Any:
    """Give CasADi.

    Raises:
        RequestError: it is not installed.
    """
    try:
        import casadi  # slow to import, and optional
    except ImportError:
        raise RequestError(
            "upper bounds of the attitude need CasADi, which is not installed: pip install 'detumble[bounds]'"
        ) from None
    return casadi


@dataclass(frozen=True)
class SlewTask:
    """What a slew must do, and with what.

    Attributes:
        inertia: (3, 3) kg m².
        limit: (3,) N m, finite.
        angle: threshold, rad.
        rate: threshold, rad/s.
    """

    inertia: Array
    limit: Array
    angle: float
    rate: float

    @property
    def body(self) -> tuple[Any, Any, Any]:
        """Values of the parameters that `_body` declares."""
        return self.inertia.ravel(), np.linalg.inv(self.inertia).ravel(), self.limit

    @property
    def thresholds(self) -> Array:
        """cos²(θ/2) and the rate, (2,)."""
        return np.array([np.cos(0.5 * min(self.angle, np.pi)) ** 2, self.rate])


def soonest(task: SlewTask, horizon: float, tumbling: tuple[Array, Array], guess: Motion) -> Motion:
    """Look for the shortest slew near a guess.

    Args:
        task: body, limits and thresholds.
        horizon: s, the longest time allowed.
        tumbling: the debris' attitudes (KNOTS, 4), of one continuous sign, and rates (KNOTS, 3), evenly from 0 to horizon.
        guess: SOONEST_INTERVALS intervals; its first node is the start.

    Returns:
        What IPOPT ended with, not necessarily feasible.
    """
    ca = casadi()
    solver = _soonest_solver()
    scale = min(guess.time, horizon)
    parameters = np.concatenate((*task.body, [scale, horizon], task.thresholds, _spline(np.hstack(tumbling)).ravel()))
    nodes = np.hstack((guess.attitude, guess.rate))
    first = np.concatenate(([guess.time / scale], (guess.torque / _divisor(task.limit)).ravel(), nodes.ravel()))
    lower, upper = _box(SOONEST_INTERVALS, nodes[0], 1e-3, horizon / scale)
    size = 7 * SOONEST_INTERVALS
    found = solver(
        x0=first, p=parameters, lbx=lower, ubx=upper, lbg=np.zeros(size + 2), ubg=np.r_[np.zeros(size), np.inf, np.inf]
    )
    head, torque, nodes = _parts(np.array(ca.DM(found["x"])).ravel(), SOONEST_INTERVALS, task.limit)
    return Motion(head * scale, torque, nodes[:, :4], nodes[:, 4:])


def on_time(
    task: SlewTask, durations: Array, tumbling: tuple[Array, Array], judged: Array, guess: Motion
) -> tuple[Motion, float]:
    """Look for a slew that meets the thresholds at given nodes.

    Args:
        task: body, limits and thresholds.
        durations: (TIMED_INTERVALS,) s, zero for those not wanted.
        tumbling: the debris' attitude (TIMED_INTERVALS + 1, 4) and rate (TIMED_INTERVALS + 1, 3) at each node.
        judged: (TIMED_INTERVALS + 1,) bool, at which nodes the thresholds count.
        guess: TIMED_INTERVALS intervals; its first node is the start.

    Returns:
        What IPOPT ended with, and how far it widened the thresholds (their squares, relative); 0 if not at all.
    """
    ca = casadi()
    solver = _timed_solver()
    parameters = np.concatenate((*task.body, task.thresholds, durations, np.hstack(tumbling).ravel()))
    nodes = np.hstack((guess.attitude, guess.rate))
    first = np.concatenate(([1.0], (guess.torque / _divisor(task.limit)).ravel(), nodes.ravel()))
    lower, upper = _box(TIMED_INTERVALS, nodes[0], 0.0, 1e3)
    size = 7 * TIMED_INTERVALS
    least = np.where(np.repeat(judged, 2), 0.0, -np.inf)
    found = solver(
        x0=first, p=parameters, lbx=lower, ubx=upper,
        lbg=np.r_[np.zeros(size), least], ubg=np.r_[np.zeros(size), np.full(len(least), np.inf)],
    )  # fmt: skip
    widened, torque, nodes = _parts(np.array(ca.DM(found["x"])).ravel(), TIMED_INTERVALS, task.limit)
    return Motion(float(durations.sum()), torque, nodes[:, :4], nodes[:, 4:]), widened


def _divisor(limit: Array) -> Array:
    return np.where(limit > 0.0, limit, 1.0)


def _spline(values: Array) -> Array:
    """Coefficients (KNOTS, m) of cubic splines through values (KNOTS, m) at evenly spaced points of [0, 1]."""
    from scipy.interpolate import make_interp_spline  # type: ignore[import-untyped]  # slow to import

    coefficients: Array = make_interp_spline(np.linspace(0.0, 1.0, KNOTS), values, k=3).c
    return coefficients


def _box(intervals: int, start: Array, least: float, most: float) -> tuple[Array, Array]:
    """Bounds of (head, torques in parts of the limit, nodes); the first node is fixed."""
    free = np.full(7 * intervals, np.inf)
    lower = np.concatenate(([least], -np.ones(3 * intervals), start, -free))
    upper = np.concatenate(([most], np.ones(3 * intervals), start, free))
    return lower, upper


def _parts(solution: Array, intervals: int, limit: Array) -> tuple[float, Array, Array]:
    """Split a solution into its head, torques (n, 3), N m, clipped, and nodes (n + 1, 7)."""
    torque = np.clip(solution[1 : 1 + 3 * intervals].reshape(intervals, 3), -1.0, 1.0) * limit
    return float(solution[0]), torque, solution[1 + 3 * intervals :].reshape(intervals + 1, 7)


def _quaternion_product(ca: Any, p: Any, q: Any) -> Any:
    return ca.vertcat(
        p[0] * q[0] - ca.dot(p[1:], q[1:]),
        p[0] * q[1:] + q[0] * p[1:] + ca.cross(p[1:], q[1:]),
    )


def _body(ca: Any) -> tuple[Any, Any, Any]:
    """Parameters that every programme has: inertia, its inverse, torque limit."""
    return ca.MX.sym("inertia", 9), ca.MX.sym("inverse", 9), ca.MX.sym("limit", 3)


@lru_cache(1)
def _interval() -> Any:
    """CasADi function: node (7), torque (3), duration, inertia (9) and its inverse (9) → node at the end."""
    ca = casadi()
    node, torque, duration = ca.SX.sym("node", 7), ca.SX.sym("torque", 3), ca.SX.sym("duration")
    inertia, inverse = ca.SX.sym("inertia", 9), ca.SX.sym("inverse", 9)

    def slope(state: Any) -> Any:
        q, w = state[:4], state[4:]
        turning = 0.5 * _quaternion_product(ca, q, ca.vertcat(0, w))
        spun = torque - ca.cross(w, ca.reshape(inertia, 3, 3) @ w)
        return ca.vertcat(turning, ca.reshape(inverse, 3, 3) @ spun)

    state, h = node, duration / SUBSTEPS
    for _ in range(SUBSTEPS):
        k1 = slope(state)
        k2 = slope(state + 0.5 * h * k1)
        k3 = slope(state + 0.5 * h * k2)
        k4 = slope(state + h * k3)
        state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return ca.Function("interval", [node, torque, duration, inertia, inverse], [state])


@lru_cache(1)
def _judge() -> Any:
    """CasADi function: chaser's and debris' node (7 each) → (q_C · q_D)², |w_C - R w_D|²."""
    ca = casadi()
    chaser, debris = ca.SX.sym("chaser", 7), ca.SX.sym("debris", 7)
    turn = _quaternion_product(ca, ca.vertcat(chaser[0], -chaser[1:4]), debris[:4])
    twice = 2 * ca.cross(turn[1:], debris[4:])
    relative = chaser[4:] - (debris[4:] + turn[0] * twice + ca.cross(turn[1:], twice))
    return ca.Function("judge", [chaser, debris], [turn[0] ** 2, ca.dot(relative, relative)])


def _unknowns(ca: Any, intervals: int) -> tuple[Any, Any, Any, Any]:
    """All unknowns as one vector, and its parts: head, torques (3, n) in parts of the limit, nodes (7, n + 1)."""
    unknowns = ca.MX.sym("unknowns", 1 + 3 * intervals + 7 * (intervals + 1))
    torque = ca.reshape(unknowns[1 : 1 + 3 * intervals], 3, intervals)
    return unknowns, unknowns[0], torque, ca.reshape(unknowns[1 + 3 * intervals :], 7, intervals + 1)


def _chained(ca: Any, intervals: int, nodes: Any, torque: Any, durations: Any, body: tuple[Any, Any, Any]) -> Any:
    """Residuals of the motion over each interval, as one vector."""
    inertia, inverse, limit = body
    spread = [ca.repmat(part, 1, intervals) for part in (inertia, inverse)]
    ends = _interval().map(intervals)(nodes[:, :-1], torque * ca.repmat(limit, 1, intervals), durations, *spread)
    return ca.vec(nodes[:, 1:] - ends)


def _solver(ca: Any, unknowns: Any, parameters: list[Any], cost: Any, constraints: Any) -> Any:
    programme = {"x": unknowns, "p": ca.vertcat(*parameters), "f": cost, "g": constraints}
    quiet = {
        "print_level": 0,
        "sb": "yes",
        "max_iter": ITERATIONS,
        "tol": 1e-7,
        "acceptable_tol": 1e-5,
        "acceptable_iter": 8,
    }
    quiet |= {"mu_strategy": "adaptive", "bound_relax_factor": 0.0}
    return ca.nlpsol("slew", "ipopt", programme, {"ipopt": quiet, "print_time": False, "show_eval_warnings": False})


@lru_cache(1)
def _soonest_solver() -> Any:
    ca = casadi()
    unknowns, head, torque, nodes = _unknowns(ca, SOONEST_INTERVALS)
    body = _body(ca)
    scale, horizon, limits = ca.MX.sym("scale"), ca.MX.sym("horizon"), ca.MX.sym("limits", 2)
    coefficients = ca.MX.sym("coefficients", 7 * KNOTS)
    time = head * scale
    durations = ca.repmat(time / SOONEST_INTERVALS, 1, SOONEST_INTERVALS)
    inner = np.linspace(0.0, 1.0, KNOTS)[2:-2]  # scipy's not-a-knot
    debris = ca.bspline(time / horizon, coefficients, [[0.0] * 4 + list(inner) + [1.0] * 4], [3], 7)
    aligned, relative = _judge()(nodes[:, -1], debris)
    constraints = ca.vertcat(
        _chained(ca, SOONEST_INTERVALS, nodes, torque, durations, body),
        aligned / ca.sumsqr(nodes[:4, -1]) / ca.sumsqr(debris[:4]) - limits[0],
        1 - relative / limits[1] ** 2,
    )
    cost = head + 1e-7 * ca.sumsqr(torque)
    return _solver(ca, unknowns, [*body, scale, horizon, limits, coefficients], cost, constraints)


@lru_cache(1)
def _timed_solver() -> Any:
    ca = casadi()
    unknowns, head, torque, nodes = _unknowns(ca, TIMED_INTERVALS)
    body = _body(ca)
    durations, limits = ca.MX.sym("durations", TIMED_INTERVALS), ca.MX.sym("limits", 2)
    tumbling = ca.MX.sym("tumbling", 7 * (TIMED_INTERVALS + 1))
    debris = ca.reshape(tumbling, 7, TIMED_INTERVALS + 1)
    aligned, relative = _judge().map(TIMED_INTERVALS + 1)(nodes, debris)
    slack = ca.repmat(head, 1, TIMED_INTERVALS + 1)
    norms = ca.sum1(nodes[:4, :] ** 2)
    judged = ca.vertcat(aligned / norms - limits[0] + slack, 1 + slack - relative / limits[1] ** 2)
    constraints = ca.vertcat(_chained(ca, TIMED_INTERVALS, nodes, torque, durations.T, body), ca.vec(judged))
    cost = 10.0 * head + 1e-3 * ca.sumsqr(torque) / TIMED_INTERVALS
    return _solver(ca, unknowns, [*body, limits, durations, tumbling], cost, constraints)
