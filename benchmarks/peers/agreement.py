"""Whether the peers solve the same problem: checked before anything is measured.

Without noise, final states from the same starts are compared, and the ticks of capture. With noise the generators
differ, so only distributions can agree: what the noise did to each final state, and to each capture time, is compared
over the flights.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import mannwhitneyu, norm

from peers.ways import TOLERANCES

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from peers.process import Peer

    Array = NDArray[np.float64]

FLIGHTS = 16
NOISY = {"jax": 256, "numba": 256, "numpy": 256, "basilisk": 32}
"""Flights with noise of the peers that have all of W's; scipy's would take minutes."""
SIGMAS = 4.5
"""Standard errors that a rank sum may be off: by chance in one of 10^5 comparisons."""
SAME_TICK = 1e-6
"""Capture times of one tick differ by round-off only [s]."""


@dataclass
class Check:
    """What was found of one peer.

    Attributes:
        peer: its name.
        what: which comparison.
        figures: what was compared, by name.
        faults: in words; empty when all agree.
    """

    peer: str
    what: str
    figures: dict[str, float] = field(default_factory=dict)
    faults: list[str] = field(default_factory=list)

    def hold(self, name: str, value: float, allowed: float) -> None:
        """Record a figure; one beyond the tolerance, or not finite, is a fault."""
        self.figures[name] = value
        if not value <= allowed:
            self.faults.append(f"{name}: {value:.2g}, allowed {allowed:.2g}")


def angles(p: Array, q: Array) -> Array:
    """Angle between attitudes, rows of quaternions, exact for small angles [rad]."""
    chord = np.minimum(np.linalg.norm(p - q, axis=1), np.linalg.norm(p + q, axis=1))
    return np.asarray(4.0 * np.arcsin(np.minimum(chord / 2.0, 1.0)))


def quiet(name: str, flown: Mapping[str, Array], reference: Mapping[str, Array], what: str = "no noise") -> Check:
    """Compare flights without noise.

    Args:
        name: of the peer.
        flown: its `final_state` and `capture_time`, or `translation` (n, 6) alone.
        reference: detumble's from the same starts.
        what: was compared.
    """
    check, allowed = Check(name, what), TOLERANCES[name]
    ours = reference["final_state"]
    theirs = flown["translation"] if "translation" in flown else flown["final_state"]
    check.hold("position m", float(np.abs(theirs[:, :3] - ours[:, :3]).max()), allowed.position)
    check.hold("velocity m/s", float(np.abs(theirs[:, 3:6] - ours[:, 3:6]).max()), allowed.position)
    if theirs.shape[1] < 20:
        return check
    turned = max(float(angles(theirs[:, i : i + 4], ours[:, i : i + 4]).max()) for i in (6, 13))
    rates = max(float(np.abs(theirs[:, i : i + 3] - ours[:, i : i + 3]).max()) for i in (10, 17))
    check.hold("attitude rad", turned, allowed.attitude)
    check.hold("rate rad/s", rates, allowed.attitude)
    if what == "no noise":
        late = np.abs(flown["capture_time"] - reference["capture_time"])
        never = np.isnan(flown["capture_time"]) & np.isnan(reference["capture_time"])
        check.hold("captures at another tick", float((~never & ~(late < SAME_TICK)).sum()), 0)
    return check


def disturbance(noisy: Mapping[str, Array], still: Mapping[str, Array]) -> dict[str, Array]:
    """Give what the noise did to each flight: mean squares over the axes, and the delay of capture; shape (n,)."""
    with_noise, without = noisy["final_state"], still["final_state"]
    return {
        "position": ((with_noise[:, :3] - without[:, :3]) ** 2).mean(axis=1),
        "velocity": ((with_noise[:, 3:6] - without[:, 3:6]) ** 2).mean(axis=1),
        "attitude": angles(with_noise[:, 6:10], without[:, 6:10]) ** 2,
        "rate": ((with_noise[:, 10:13] - without[:, 10:13]) ** 2).mean(axis=1),
        "capture": np.round(noisy["capture_time"] - still["capture_time"], 6),  # whole ticks
    }


def noisy(name: str, theirs: Mapping[str, Array], ours: Mapping[str, Array]) -> Check:
    """Compare what the noise did, as `disturbance` gives it: the rank sums of Mann and Whitney within `SIGMAS`.

    Ranks, since noise that tips a flight over to the other way round outweighs all the others in a mean.
    """
    check = Check(name, "noise, standard errors off")
    for quantity in ours:
        a, b = theirs[quantity], ours[quantity]
        if quantity == "capture":  # nothing else may be missing
            a, b = a[np.isfinite(a)], b[np.isfinite(b)]
        alike = np.ptp(np.concatenate((a, b))) == 0.0
        check.hold(quantity, 0.0 if alike else float(norm.isf(mannwhitneyu(a, b).pvalue / 2.0)), SIGMAS)
    lost = abs(np.isnan(theirs["capture"]).mean() - np.isnan(ours["capture"]).mean())
    check.hold("share not captured", float(lost), 0.05)
    return check


def check_peer(peer: Peer, ours: Peer, starts: Array) -> list[Check]:
    """Compare one peer with detumble.

    Args:
        peer: it.
        ours: detumble.
        starts: shape (n, 20), at least as many as `NOISY` says.

    Raises:
        PeerFailed: one of them cannot fly.
    """
    first = starts[:FLIGHTS]

    def both(call: str, chosen: Array, with_noise: bool) -> tuple[dict[str, Array], dict[str, Array]]:
        return tuple(one.fly(call, chosen, noisy=with_noise, keep=True).arrays for one in (peer, ours))  # type: ignore[return-value]  # two of them

    checks = [quiet(peer.name, *both("w", first, False))]
    if peer.name == "basilisk":
        checks.append(quiet(peer.name, *both("free", first, False), what="no law"))
    if count := NOISY.get(peer.name):
        chosen = starts[:count]
        with_noise, without = both("w", chosen, True), both("w", chosen, False)
        checks.append(noisy(peer.name, *(disturbance(a, b) for a, b in zip(with_noise, without, strict=True))))
    return checks
