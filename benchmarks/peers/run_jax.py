"""Workload W in JAX: one compiled `lax.scan` over the periods, `vmap` over trajectories, float64 on the CPU.

Tuned for this problem: by components, so that XLA fuses a period into few loops; normals drawn in float32, in half the
time; vectors as wide as the processor's; for more than one thread as many devices, which share the trajectories.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

from serve import serve, threads_asked

THREADS = threads_asked()
# JAX reads these once, when it is loaded.
os.environ["XLA_FLAGS"] = f"--xla_cpu_prefer_vector_width=512 --xla_force_host_platform_device_count={THREADS}"
os.environ["NPROC"] = str(THREADS)

import jax  # noqa: E402  # this and the next only after the devices are chosen above
import jax.numpy as jnp  # noqa: E402
import numpy as np  # noqa: E402
from components import Equations  # noqa: E402
from w import Workload  # noqa: E402

if TYPE_CHECKING:
    from serve import Array, Fly

CHUNK = 1024
"""Trajectories that a device flies together: as many as keep JAX quickest."""


def calls_of(case: dict[str, Any]) -> dict[str, Fly]:
    """Give what this peer flies."""
    jax.config.update("jax_enable_x64", True)
    w = Workload.of(case)
    equations = Equations(w, jnp)

    def judged(k: Any, y: Any, time: Any) -> Any:
        return jnp.where(jnp.isnan(time) & equations.captured(y), k * w.period, time)

    def period(k: Any, y: Any, time: Any, z: Any) -> Any:
        return equations.step(y, *equations.command(y, z)), judged(k, y, time)

    def fly(starts: Any, key: Any, noisy: bool) -> Any:
        count = starts.shape[1]

        def advance(carry: Any, k: Any) -> Any:
            y, time, key = carry
            key, now = jax.random.split(key)
            z = jax.random.normal(now, (9, count), jnp.float32).astype(jnp.float64) if noisy else jnp.zeros((9, count))
            y, time = jax.vmap(period, in_axes=(None, 0, 0, 0))(k, y, time, tuple(z))
            return (y, time, key), None

        carry = (tuple(starts), jnp.full(count, jnp.nan), key)
        (y, time, _), _ = jax.lax.scan(advance, carry, jnp.arange(w.periods))
        return jnp.stack(y), judged(w.periods, y, time)

    compiled = jax.pmap(fly, static_broadcasted_argnums=2)

    def call(starts: Array, noisy: bool, seed: int) -> dict[str, Array]:
        width = CHUNK if len(starts) > 1 else 1  # few shapes: each is compiled anew
        together = width * THREADS
        padded = np.resize(starts, (-(-len(starts) // together) * together, 20))
        blocks = padded.reshape(-1, THREADS, width, 20).swapaxes(2, 3)
        keys = jax.random.split(jax.random.key(seed), (len(blocks), THREADS))
        flown = [compiled(block, key, noisy) for block, key in zip(blocks, keys, strict=True)]
        ends = np.concatenate([np.asarray(y).swapaxes(1, 2).reshape(-1, 20) for y, _ in flown])
        times = np.concatenate([np.asarray(time).reshape(-1) for _, time in flown])
        return {"final_state": ends[: len(starts)], "capture_time": times[: len(starts)]}

    return {"w": call}


if __name__ == "__main__":
    serve(calls_of)
