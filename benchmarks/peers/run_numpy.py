"""Workload W in numpy: a loop over the periods, each operation on a block of trajectories that stays in the cache."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from components import Equations
from serve import serve
from w import Workload

if TYPE_CHECKING:
    from serve import Array, Fly

BLOCK = 2048
"""Trajectories flown together: as many as keep numpy quickest."""


def calls_of(case: dict[str, Any]) -> dict[str, Fly]:
    """Give what this peer flies."""
    w = Workload.of(case)
    equations = Equations(w, np)

    def fly(starts: Array, noisy: bool, generator: np.random.Generator) -> tuple[Array, Array]:
        y = tuple(starts.T.copy())
        time = np.full(len(starts), np.nan)
        z = np.zeros((9, len(starts)))
        for k in range(w.periods):
            time[np.isnan(time) & equations.captured(y)] = k * w.period
            if noisy:
                generator.standard_normal(out=z)
            y = equations.step(y, *equations.command(y, tuple(z)))
        time[np.isnan(time) & equations.captured(y)] = w.periods * w.period
        return np.stack(y, axis=1), time

    def call(starts: Array, noisy: bool, seed: int) -> dict[str, Array]:
        blocks = [starts[i : i + BLOCK] for i in range(0, len(starts), BLOCK)]
        generator = np.random.default_rng(seed).spawn(len(blocks))
        with np.errstate(divide="ignore"):  # log 0 of a trajectory exactly on its surface
            flown = [fly(block, noisy, own) for block, own in zip(blocks, generator, strict=True)]
        ends, times = zip(*flown, strict=True)
        return {"final_state": np.concatenate(ends), "capture_time": np.concatenate(times)}

    return {"w": call}


if __name__ == "__main__":
    serve(calls_of)
