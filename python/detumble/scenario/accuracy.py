"""How accurate the integrated rotation is: an upper estimate, what it judges, and the step it asks for.

A free body's momentum goes through RK4 with the step h, its attitude by a Magnus step of the same order. With ω its largest
rate, t the time, and κ = (I_max - I_min) / I_mid its asymmetry, from 0 of a sphere to 1 of a plate or a thread,

    error ≤ κ ω t (ω h)⁴ (1 + 10 κ⁴ + κ⁵ ω t ω h) / 1000     rad

- 1: Magnus expansion and trapezoidal rule; the factor is measured, for the worst body and spin.
- 10 κ⁴: RK4 turns the rate in the body at the wrong speed, a share (κ ω h)⁴/120 off, where κ ω bounds that speed.
- κ⁵ ω t ω h: RK4 loses momentum, in a step a share (κ ω h)⁶/144 of its part across the axis of a top. So the precession slows
  down, and the attitude errs with the square of time; the worst is a thin rod, with max(sin θ cos⁶ θ)/288 = 1/1210.

It holds up to ω h = 0.3 and until the error is a few tenths of a radian, rounding aside: that adds about 1e-13 ω t, and up
to 1e-16 (ω t)² I_max/I_min to a rod in flat spin. In open loop a torque held in H adds ω t (ω h)⁴/1920, as the quaternion then
goes through RK4.
docs/explanation.md has measured errors, `scripts/rotation_accuracy.py` measures them again.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable, Sequence
from typing import Any

from detumble.scenario.physics import tensor
from detumble.scenario.wording import shown

MOST_TURN = 0.1
"""Largest turn of a body in one integration step, rad, that a flight makes without a warning."""
MOST_ERROR = 1e-3
"""Largest estimated error of an attitude at the end of a flight, rad, likewise."""
AUTOMATIC_ERROR = 1e-8
"""What `integration_step = "auto"` keeps the estimate below, rad."""
MOST_STEPS = 100_000
"""Most integration steps in a control period."""
ANY_BODY = (0.0, 1.0, 1.0)
"""Moments of a thread: no body is more asymmetric."""


def principal_moments(inertia: Sequence[Any]) -> list[float]:
    """Give the principal moments in rising order, kg m².

    Args:
        inertia: principal moments (3,), or the tensor (3, 3).
    """
    flown = tensor(inertia)
    if not any(flown[i][j] for i, j in ((0, 1), (0, 2), (1, 2))):
        return sorted(flown[i][i] for i in range(3))
    import numpy as np  # only a full tensor needs it

    return [float(moment) for moment in np.linalg.eigvalsh(np.array(flown))]


def asymmetry(inertia: Sequence[Any]) -> float:
    """Give κ = (I_max - I_min) / I_mid: 0 for a sphere, 1 for a plate or a thread.

    Args:
        inertia: principal moments (3,), or the tensor (3, 3), kg m².
    """
    least, middle, greatest = principal_moments(inertia)
    return (greatest - least) / middle


def most_asymmetric(*inertias: Sequence[Any]) -> Sequence[Any]:
    """Give that of several inertias for which the estimate is largest."""
    return max(inertias, key=asymmetry)


def attitude_error(inertia: Sequence[Any], rate: float, step: float, time: float) -> float:
    """Estimate from above how far the attitude of a free body is off.

    Args:
        inertia: principal moments (3,), or the tensor (3, 3), kg m².
        rate: largest norm of the angular rate, rad/s.
        step: integration step, s.
        time: from the start, s.

    Returns:
        Angle, rad.
    """
    kappa, turned, turn = asymmetry(inertia), rate * time, rate * step
    return kappa * turned * turn**4 * (1.0 + 10.0 * kappa**4 + kappa**5 * turned * turn) / 1000.0


def steps(length: float, sound: Callable[[float], bool]) -> int:
    """Count the fewest equal steps, at most MOST_STEPS, that a length is cut into for a step to be sound.

    Args:
        length: s.
        sound: tells whether a step will do, as any shorter one then does.
    """
    return 1 + bisect_left(range(1, MOST_STEPS), True, key=lambda count: sound(length / count))


def inaccurate(inertia: Sequence[Any], rate: Any, step: float, time: Any) -> Any:
    """Tell whether a body turns so fast that its attitude may be off by more than flights make without a warning.

    Args:
        inertia: principal moments (3,), or the tensor (3, 3), kg m².
        rate: largest norm of the angular rate, rad/s, of one flight or of several (n,).
        step: integration step, s.
        time: flown, s, likewise.

    Returns:
        One truth value, or (n,).
    """
    return (rate * step > MOST_TURN) | (attitude_error(inertia, rate, step, time) > MOST_ERROR)


def coarse_step(inertia: Sequence[Any], rate: float, step: float, time: float) -> str:
    """Say that an integration step is too long for the rotation to be accurate, and which step would do.

    Args:
        inertia: principal moments (3,), or the tensor (3, 3), kg m².
        rate: largest norm of the angular rate met, rad/s.
        step: integration step, s.
        time: flown, s.

    Returns:
        A sentence; empty if the step will do.
    """

    def sound(step: float) -> bool:
        return not inaccurate(inertia, rate, step, time)

    if sound(step) or not math.isfinite(rate):
        return ""
    off = (
        f"{min(attitude_error(inertia, rate, step, time), math.pi):.1g} rad"
        if rate * step <= MOST_TURN
        else "more than can be estimated"
    )
    enough = step / steps(step, sound)
    if not sound(enough):
        return f"a body turns at up to {rate:.3g} rad/s: no integration step within reach follows that"
    digit = 10.0 ** (math.floor(math.log10(enough)) - 1)
    return (
        f"a body turns at up to {rate:.3g} rad/s, {rate * step:.2g} rad in an integration step of {step:.4g} s: after "
        f"{time:.4g} s its attitude may be off by {off}; with a step of {math.floor(enough / digit) * digit:.2g} s it is "
        f'off by less than {MOST_ERROR:g} rad, and integration_step = "auto" aims at {shown(AUTOMATIC_ERROR)} rad'
    )
