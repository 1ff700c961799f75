"""How each surface converges: translation from 0.5 m off the goal without noise, until the error is a tenth, a hundredth.

The claim is that TSMC converges in finite time. On s = 0 the printed exponent p/q > 1 decays only polynomially.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

import detumble
from detumble.analysis.trials import Array
from detumble.scenario import Scenario
from detumble.scenario.faults import validated
from detumble.show.style import new_figure, save, styled

LEVELS = (1e-1, 1e-2, 1e-3, 1e-4)
"""Errors whose time is reported, m."""
_DURATION = 600.0


def case(law: str, form: str) -> Scenario:
    """Approach along y without noise; capture only records, nothing merges."""
    raw = detumble.load("paper").to_dict()
    raw["time"] |= {"duration": _DURATION, "control_period": 0.05, "integration_step": 0.05}
    raw["chaser"] |= {"position": [0.0, 0.8, 0.0], "attitude": [1.0, 0.0, 0.0, 0.0]}
    raw["debris"]["tumble_rate"] = [0.0, 0.0, 0.0]
    raw["capture"]["merge"] = False
    raw["sensors"] = {}
    raw["laws"] = {law: raw["laws"][law] | {"form": form}}
    return validated(raw, f"{law}, {form}")


def fly() -> dict[str, Any]:
    """Time, s, after which the error stays below each level, by entry; None if not within 600 s."""
    found: dict[str, Any] = {}
    for law, form in (("tsmc", "printed"), ("tsmc", "corrected"), ("prrl", "printed"), ("sosmc", "corrected")):
        time, error = _history(law, form)
        found[f"{law}, {form}"] = {
            "reached_s": [_after(time, error, level) for level in LEVELS],
            "line": [time[::40].tolist(), error[::40].tolist()],
        }
    return found


def _history(law: str, form: str) -> tuple[Array, Array]:
    flight = detumble.simulate(case(law, form), law)
    error = np.linalg.norm(np.array(flight.history["position"]) - np.array([0.0, 0.3, 0.0]), axis=1)
    return np.array(flight.history["time"]), error


def _after(time: Array, error: Array, level: float) -> float | None:
    above = np.flatnonzero(error > level)
    after = 0 if not len(above) else int(above[-1]) + 1
    return float(time[after]) if after < len(time) else None


def draw(found: dict[str, Any], path: Path) -> list[Path]:
    """Plot the error over time, logarithmic."""
    from detumble.show.style import look

    with styled():
        figure = new_figure(6.5, 3.4)
        axes = figure.subplots()
        for name, entry in found.items():
            law, _, form = name.partition(", ")
            style = look(law)
            axes.plot(
                *entry["line"],
                color=style.colour,
                linestyle="-" if form == "printed" else (0, (4, 1.5)),
                label=f"{style.label}, {form}",
            )
        axes.set(yscale="log", xlabel="time [s]", ylabel="distance from the goal [m]", ylim=(1e-6, 1.0))
        axes.legend()
        figure.suptitle("Convergence without noise, gains of the paper's case")
        return save(figure, [path])
