"""Workload W in detumble, through the same protocol as its peers; `free` flies without a law."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from serve import serve, threads_asked

from detumble.compiled import core
from detumble.scenario.core import case as case_of
from detumble.scenario.files import load
from detumble.workload import start_columns

if TYPE_CHECKING:
    from serve import Array, Fly


def calls_of(case: dict[str, Any]) -> dict[str, Fly]:
    """Give what is flown here."""
    quiet = case | {"sensors": dict.fromkeys(case["sensors"], 0.0)}
    backend = core().backends()[-1]

    def fly(recipe: dict[str, Any], starts: Array, seed: int) -> dict[str, Array]:
        columns = start_columns(starts)
        flown = core().fly_many(recipe, columns, len(starts), seed=seed, threads=threads_asked(), backend=backend)
        return {name: flown[name] for name in ("final_state", "capture_time")}

    def call(starts: Array, noisy: bool, seed: int) -> dict[str, Array]:
        return fly(case if noisy else quiet, starts, seed)

    def free(starts: Array, _: bool, seed: int) -> dict[str, Array]:
        return fly(case_of(load("workload_w"), "none"), starts, seed)

    return {"w": call, "free": free}


if __name__ == "__main__":
    serve(calls_of)
