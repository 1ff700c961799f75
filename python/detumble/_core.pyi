"""The compiled core: plain numbers in, plain numbers out."""

from collections.abc import Callable
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]

def fly(
    case: dict[str, Any],
    *,
    seed: int = 0,
    index: int = 0,
    backend: str | None = None,
    differing: list[str] | None = None,
) -> dict[str, Any]:
    """Fly one case; gives `backend`, `history`, `summary` and `merge`.

    `differing` are the paths of the numbers in which flights of its campaign differ: such a flight may have drawn weights
    without gains, and ends where they would command.
    """

def fly_many(
    case: dict[str, Any],
    columns: dict[str, Array],
    flights: int,
    *,
    seed: int = 0,
    first_index: int = 0,
    threads: int = 1,
    backend: str | None = None,
    progress: Callable[[int], None] | None = None,
    cycle: int | None = None,
) -> dict[str, Any]:
    """Fly one case many times, with the numbers of `columns` in place of its own: by path, a row for each flight.

    After `cycle` flights the random numbers begin again.

    Gives `final_state` (n, 20), the metrics but those by axis, `failure` (codes of `register`) and `end_time` column by column,
    and how many `ticks` the flights took of the `lane_ticks` that the lanes went through.
    """

def draw(spec: dict[str, Any], seed: int, first: int, count: int) -> dict[str, Array]:
    """Draw the dispersed fields of runs `first` to `first + count - 1`; by path (count,), or (count, width)."""

def tick_times(period: float, ticks: NDArray[np.uint64]) -> Array:
    """Give the times of control ticks, s, as histories and metrics have them."""

def backends() -> list[str]:
    """Name the back ends that this machine can run, the narrowest first."""

def fma_peak(backend: str, iterations: int) -> float:
    """Run a loop of nothing but fused multiply-adds; gives the number of flops done."""

def lqr_translation(q_error: list[float], q_rate: list[float], r: float, mean_motion: float) -> tuple[Any, Any]:
    """Gain of the HCW model, input acceleration: 3x3 of the position error, 3x3 of the velocity error."""

def lqr_rotation(
    q_error: list[float], q_rate: list[float], r: float, inertia: list[list[float]], two_epsilon: bool = False
) -> tuple[Any, Any]:
    """Gain of the linearised attitude, input torque: 3x3 of the attitude error, 3x3 of the rate error."""

def echo(case: dict[str, Any]) -> dict[str, Any]:
    """Give the case back as the core understood it."""

def register() -> dict[str, Any]:
    """Give what the core calls its results.

    `metrics`: name, label, unit, definition, and `number`, `whole` or `axes`, in the order of tables and files. `causes`: code of
    each failure and its words. `codes` and `thresholds`: by name. `state`: name and width of the parts of a state, in its order.
    `series`: name, width, unit and meaning of the time series of a flight.
    """
