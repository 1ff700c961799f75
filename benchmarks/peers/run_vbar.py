"""The translation of workload W in V-BAR, which has no attitude: 6 of the 20 states, PRRL-SMC in one channel.

Its own environment, one episode after another (`w`) and as a batch (`batch`); the law is an agent of ours.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from serve import serve
from vbar import ApproachConfig, run_episode
from vbar.dynamics.bodies import EARTH
from vbar.scenarios import ApproachEnv
from vbar.scenarios.vector import ApproachVectorEnv
from vbar.spacecraft import GaussianNav, PerfectNav
from w import Workload

if TYPE_CHECKING:
    from serve import Array, Fly


class Prrl:
    """PRRL-SMC, printed form, as an acceleration; V-BAR clips it."""

    name = "prrl"

    def __init__(self, w: Workload) -> None:
        self.w = w

    def reset(self, view: Any, rng: Any = None) -> None:
        """Nothing to remember."""

    def act(self, seen: Array, _: Any) -> Array:
        """Give the acceleration in H for states seen, shape (..., 6)."""
        n, gains = self.w.mean_motion, self.w.translation
        r, v = seen[..., :3], seen[..., 3:]
        zero = np.zeros_like(r[..., 0])
        natural = np.stack((3 * n * n * r[..., 0], zero, -n * n * r[..., 2]), axis=-1)
        natural += 2 * n * np.stack((v[..., 1], -v[..., 0], zero), axis=-1)
        s = v + gains.slope * (r - self.w.goal)
        return -gains.slope * v - gains.gain * np.abs(s) ** gains.alpha * np.clip(s / gains.layer, -1, 1) - natural


def calls_of(case: dict[str, Any]) -> dict[str, Fly]:
    """Give what this peer flies."""
    w = Workload.of(case)
    agent = Prrl(w)

    def settings(noisy: bool, **more: Any) -> ApproachConfig:
        return ApproachConfig(
            dt=w.period,
            max_steps=w.periods,
            altitude_m=(EARTH.mu / w.mean_motion**2) ** (1 / 3) - EARTH.radius,
            action_mode="accel",
            max_accel=w.force_limit / w.mass,
            mass_kg=w.mass,
            sensor=GaussianNav(w.position_sigma, 0.0) if noisy else PerfectNav(),
            hold_point=w.goal,
            capture_radius=0.0,  # never: the flight goes on to its end
            keep_out_radius=1e-9,
            violation_samples=2,
            **more,
        )

    def one_by_one(starts: Array, noisy: bool, seed: int) -> dict[str, Array]:
        flown = [
            run_episode(ApproachEnv(settings(noisy, start_state=tuple(start[:6]))), agent, seed + i, seed + len(starts))
            for i, start in enumerate(starts)
        ]
        return {"translation": np.array([flight["states"][-1] for flight in flown])}

    def batch(starts: Array, noisy: bool, seed: int) -> dict[str, Array]:
        fleet = ApproachVectorEnv(settings(noisy), len(starts))
        fleet.reset(seed=seed)
        fleet.state[:] = seen = starts[:, :6]
        for _ in range(w.periods - 1):
            seen = fleet.step(agent.act(seen, None))[0]
        last = fleet.step(agent.act(seen, None))[4]  # it resets whatever has ended
        return {"translation": last["final_info"]["true_state"]}

    return {"w": one_by_one, "batch": batch}


if __name__ == "__main__":
    serve(calls_of)
