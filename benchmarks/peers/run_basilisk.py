"""Workload W in Basilisk: two spacecraft on Keplerian orbits, its own dynamics and RK4, the law compiled by its NumbaModel.

`w` flies one simulation after another, `montecarlo` lets its Controller fly them on THREADS processes, `free` leaves the
law away: torque-free tumble and free drift.
"""

from __future__ import annotations

import json
import os
import tempfile
from typing import TYPE_CHECKING, Any

import numba
import numpy as np
from Basilisk.architecture import messaging, numbaModel
from Basilisk.simulation import extForceTorque, spacecraft
from Basilisk.utilities import SimulationBaseClass, macros, simIncludeGravBody
from Basilisk.utilities.MonteCarlo import Controller, Dispersions
from serve import serve, threads_asked
from w import Workload

if TYPE_CHECKING:
    from serve import Array, Fly

MU = 3.986004418e14
"""Of the Earth [m³/s²]."""


@numba.njit
def quaternion(sigma: Array) -> Array:
    """From modified Rodrigues parameters, scalar first."""
    square = np.dot(sigma, sigma)
    q = np.empty(4)
    q[0] = 1.0 - square
    q[1:] = 2.0 * sigma
    return q / (1.0 + square)


@numba.njit
def product(p: Array, q: Array) -> Array:
    """p ⊗ q."""
    r = np.empty(4)
    r[0] = p[0] * q[0] - np.dot(p[1:], q[1:])
    r[1:] = p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:])
    return r


@numba.njit
def error(q: Array, rate: Array, target: Array, target_rate: Array) -> tuple[Array, Array]:
    """Quaternion relative to the target, and rate relative to it in own axes."""
    e = product(target * np.array([1.0, -1.0, -1.0, -1.0]), q)
    t = np.cross(e[1:], target_rate)
    return e, rate - (target_rate + 2.0 * (np.cross(e[1:], t) - e[0] * t))


@numba.njit
def sliding(e: Array, rate: Array, gains: Array) -> Array:
    """The acceleration that PRRL-SMC asks for, printed form; gains: slope, gain, layer, alpha."""
    s = rate + gains[0] * e
    return -gains[0] * rate - gains[1] * np.abs(s) ** gains[3] * np.minimum(np.maximum(s / gains[2], -1.0), 1.0)


@numba.njit
def relative_motion(chaser: Any, debris: Any) -> tuple[Array, Array, Array]:
    """Axes of H as rows, position and velocity of the chaser in H."""
    axes = np.empty((3, 3))
    momentum = np.cross(debris.r_BN_N, debris.v_BN_N)
    axes[0] = debris.r_BN_N / np.linalg.norm(debris.r_BN_N)
    axes[2] = momentum / np.linalg.norm(momentum)
    axes[1] = np.cross(axes[2], axes[0])
    r = axes @ (chaser.r_BN_N - debris.r_BN_N)
    n = np.linalg.norm(momentum) / np.dot(debris.r_BN_N, debris.r_BN_N)
    v = axes @ (chaser.v_BN_N - debris.v_BN_N) - n * np.array([-r[1], r[0], 0.0])
    return axes, r, v


class Law(numbaModel.NumbaModel):
    """Sensors, PRRL-SMC, limits and the judgement of capture, once a period."""

    def __init__(self, w: Workload, noisy: bool, seed: int) -> None:
        super().__init__()
        self.chaserInMsg, self.debrisInMsg = messaging.SCStatesMsgReader(), messaging.SCStatesMsgReader()
        self.forceOutMsg, self.torqueOutMsg = messaging.CmdForceInertialMsg(), messaging.CmdTorqueBodyMsg()
        self.RNGSeed = seed
        m = self.memory
        m.n, m.mass, m.period, m.capture_time = w.mean_motion, w.mass, w.period, np.nan
        m.force_limit, m.torque_limit = w.force_limit, w.torque_limit
        m.distance, m.half_cosine, m.rate = w.capture_distance, np.cos(w.capture_angle / 2), w.capture_rate
        m.goal, m.inertia = np.array(w.goal), np.array(w.chaser_inertia)
        m.sigmas = noisy * np.array([w.position_sigma, 0.5 * w.attitude_sigma, w.rate_sigma])
        m.translation = np.array([w.translation.slope, w.translation.gain, w.translation.layer, w.translation.alpha])
        m.rotation = np.array([w.rotation.slope, w.rotation.gain, w.rotation.layer, w.rotation.alpha])

    @staticmethod
    def UpdateStateImpl(  # noqa: N802, D102  # the names are Basilisk's
        chaserInMsgPayload: Any,  # noqa: N803  # likewise, as the next
        debrisInMsgPayload: Any,  # noqa: N803
        forceOutMsgPayload: Any,  # noqa: N803
        torqueOutMsgPayload: Any,  # noqa: N803
        CurrentSimNanos: Any,  # noqa: N803
        memory: Any,
        rng: Any,
    ) -> None:
        axes, r, v = relative_motion(chaserInMsgPayload, debrisInMsgPayload)
        q, rate = quaternion(chaserInMsgPayload.sigma_BN), chaserInMsgPayload.omega_BN_B
        target, target_rate = quaternion(debrisInMsgPayload.sigma_BN), debrisInMsgPayload.omega_BN_B
        if np.isnan(memory.capture_time):
            e, spin = error(q, rate, target, target_rate)
            near = np.linalg.norm(r - memory.goal) < memory.distance
            if near and abs(e[0]) > memory.half_cosine and np.linalg.norm(spin) < memory.rate:
                memory.capture_time = CurrentSimNanos * 1e-9

        z = rng.standard_normal(9)
        r = r + memory.sigmas[0] * z[:3]
        tilt = np.ones(4)
        tilt[1:] = memory.sigmas[1] * z[3:6]
        q = product(q, tilt)
        rate = rate + memory.sigmas[2] * z[6:]

        n = memory.n
        natural = np.array([3 * n * n * r[0] + 2 * n * v[1], -2 * n * v[0], -n * n * r[2]])
        force = memory.mass * (sliding(r - memory.goal, v, memory.translation) - natural)
        force = np.minimum(np.maximum(force, -memory.force_limit), memory.force_limit)
        e, spin = error(q / np.linalg.norm(q), rate, target, target_rate)
        short = 1.0 if e[0] >= 0.0 else -1.0
        torque = memory.inertia * sliding(short * e[1:], spin, memory.rotation)
        torque = torque + np.cross(rate, memory.inertia * rate)
        forceOutMsgPayload.forceRequestInertial[:] = axes.T @ force
        torqueOutMsgPayload.torqueRequestBody[:] = np.minimum(
            np.maximum(torque, -memory.torque_limit), memory.torque_limit
        )


class Simulation(SimulationBaseClass.SimBaseClass):
    """Both spacecraft at a start of W.

    Args:
        w: the numbers.
        start: the 20 states.
        seed: of the sensors' noise; None for exact sensors.
        law: whether the chaser is controlled.
    """

    def __init__(self, w: Workload, start: Array, seed: int | None, law: bool) -> None:
        super().__init__()
        self.CreateNewProcess("process").addTask(self.CreateNewTask("task", macros.sec2nano(w.period)))
        gravity = simIncludeGravBody.gravBodyFactory()
        earth = gravity.createEarth()
        earth.isCentralBody, earth.mu = True, MU
        radius = (MU / w.mean_motion**2) ** (1 / 3)
        n = np.array([0.0, 0.0, w.mean_motion])
        for name, mass, inertia, r, v, q, rate in (
            ("chaser", w.mass, w.chaser_inertia, start[0:3], start[3:6], start[6:10], start[10:13]),
            # The debris' mass moves nothing, but must be positive.
            ("debris", 1.0, w.debris_inertia, np.zeros(3), np.zeros(3), start[13:17], start[17:20]),
        ):
            body = spacecraft.Spacecraft()
            body.ModelTag = name
            body.hub.mHub, body.hub.r_BcB_B, body.hub.IHubPntBc_B = mass, [0.0, 0.0, 0.0], np.diag(inertia).tolist()
            place = np.array([radius, 0.0, 0.0]) + r
            body.hub.r_CN_NInit, body.hub.v_CN_NInit = place.tolist(), (v + np.cross(n, place)).tolist()
            body.hub.sigma_BNInit = (np.sign(q[0]) * q[1:] / (1.0 + abs(q[0]))).tolist()
            body.hub.omega_BN_BInit = rate.tolist()
            gravity.addBodiesTo(body)
            setattr(self, name, body)
        self.gravity, self.law = gravity, None
        if law:
            # The effector reads the last tick's command, the body flies up to this tick with it, the law sees the end.
            self.law = Law(w, seed is not None, seed or 0)
            self.law.ModelTag = "law"
            self.effector = extForceTorque.ExtForceTorque()
            self.effector.cmdForceInertialInMsg.subscribeTo(self.law.forceOutMsg)
            self.effector.cmdTorqueInMsg.subscribeTo(self.law.torqueOutMsg)
            self.chaser.addDynamicEffector(self.effector)
            self.law.chaserInMsg.subscribeTo(self.chaser.scStateOutMsg)
            self.law.debrisInMsg.subscribeTo(self.debris.scStateOutMsg)
            self.AddModelToTask("task", self.effector)
        self.AddModelToTask("task", self.chaser)
        self.AddModelToTask("task", self.debris)
        if law:
            self.AddModelToTask("task", self.law)
        self.end = macros.sec2nano(w.period * w.periods)


def execute(simulation: Simulation) -> None:
    """Fly to the end."""
    simulation.InitializeSimulation()
    simulation.ConfigureStopTime(simulation.end)
    simulation.ExecuteSimulation()


def final_state(simulation: Simulation) -> Array:
    """Give the 20 states."""
    chaser, debris = simulation.chaser.scStateOutMsg.read(), simulation.debris.scStateOutMsg.read()
    states = []
    for message in (chaser, debris):
        states += [quaternion(np.array(message.sigma_BN)), np.array(message.omega_BN_B)]
    body, target = (Moving(np.array(m.r_BN_N), np.array(m.v_BN_N)) for m in (chaser, debris))
    _, r, v = relative_motion.py_func(body, target)
    return np.concatenate((r, v, *states))


class Moving:
    """What `relative_motion` asks of a message."""

    def __init__(self, r: Array, v: Array) -> None:
        self.r_BN_N, self.v_BN_N = r, v


def dispersed() -> Simulation:
    """For the Controller: W at its first start; the numbers come by the environment, as workers are started without."""
    given = json.loads(os.environ["PEER_CASE"])
    return Simulation(Workload.of(given["case"]), np.array(given["start"]), given["seed"], law=True)


def calls_of(case: dict[str, Any]) -> dict[str, Fly]:
    """Give what this peer flies."""
    w = Workload.of(case)

    def flown(start: Array, seed: int | None, law: bool) -> tuple[Array, float]:
        simulation = Simulation(w, start, seed, law)
        execute(simulation)
        return final_state(simulation), float(simulation.law.memory.capture_time) if law else np.nan

    def call(starts: Array, noisy: bool, seed: int) -> dict[str, Array]:
        results = [flown(start, seed + i if noisy else None, True) for i, start in enumerate(starts)]
        ends, times = zip(*results, strict=True)
        return {"final_state": np.array(ends), "capture_time": np.array(times)}

    def free(starts: Array, _: bool, __: int) -> dict[str, Array]:
        return {"final_state": np.array([flown(start, None, False)[0] for start in starts])}

    def montecarlo(starts: Array, noisy: bool, seed: int) -> dict[str, Array]:
        """Where the flights start, its own dispersions say; nothing of them is kept."""
        given = {"case": case, "start": starts[0].tolist(), "seed": seed if noisy else None}
        os.environ["PEER_CASE"] = json.dumps(given)
        execute(dispersed())  # compiles the law; the Controller's processes are forks of this one
        controller = Controller.Controller()
        controller.setSimulationFunction(dispersed)
        controller.setExecutionFunction(execute)
        controller.setExecutionCount(len(starts))
        controller.setThreadCount(threads_asked())
        controller.setShouldDisperseSeeds(True)
        controller.setShowProgressBar(False)
        controller.addDispersion(Dispersions.UniformEulerAngleMRPDispersion("debris.hub.sigma_BNInit"))
        controller.addDispersion(Dispersions.UniformVectorCartDispersion("debris.hub.omega_BN_BInit", [-0.05, 0.05]))
        with tempfile.TemporaryDirectory() as folder:
            controller.setArchiveDir(f"{folder}/archive/")
            failed = controller.executeSimulations()
        if failed:
            raise RuntimeError(f"{len(failed)} of {len(starts)} simulations failed")
        return {}

    return {"w": call, "free": free, "montecarlo": montecarlo}


if __name__ == "__main__":
    serve(calls_of)
