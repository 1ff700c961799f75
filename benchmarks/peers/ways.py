"""The register of peers: the ways in which each is measured, and how well each must agree with detumble."""

from __future__ import annotations

from dataclasses import dataclass

CORES = 2
"""Threads or processes of the ways that use more than one."""


@dataclass(frozen=True)
class Way:
    """One way of flying workload W.

    Attributes:
        label: in tables.
        peer: whose process flies it.
        flights: in one timed call, about a second's.
        call: what the process is asked for.
        threads: that it may use.
        whole: whether it is all of W; V-BAR has no attitude.
    """

    label: str
    peer: str
    flights: int
    call: str = "w"
    threads: int = 1
    whole: bool = True


WAYS = (
    Way("detumble", "detumble", 8192),
    Way("detumble, 2 threads", "detumble", 16384, threads=CORES),
    Way("JAX", "jax", 2048),
    Way("JAX, 2 threads", "jax", 4096, threads=CORES),
    Way("Numba", "numba", 1024),
    Way("Numba, 2 threads", "numba", 2048, threads=CORES),
    Way("numpy", "numpy", 2048),
    Way("Basilisk", "basilisk", 8),
    Way("Basilisk Monte Carlo, 2 processes", "basilisk", 16, "montecarlo", threads=CORES),
    Way("scipy", "scipy", 1),
    Way("V-BAR, translation only", "vbar", 1, whole=False),
    Way("V-BAR as a batch, translation only", "vbar", 128, "batch", whole=False),
)
PEERS = tuple(dict.fromkeys(way.peer for way in WAYS if way.peer != "detumble"))
TITLES = {
    "detumble": "detumble",
    "jax": "JAX",
    "numba": "Numba",
    "numpy": "numpy",
    "basilisk": "Basilisk",
    "scipy": "scipy",
    "vbar": "V-BAR",
}


@dataclass(frozen=True)
class Tolerance:
    """How far a peer's final state may be from detumble's without noise.

    Attributes:
        position: m.
        attitude: rad.
        why: what the difference is made of.
    """

    position: float
    attitude: float
    why: str


RK4 = Tolerance(1e-12, 1e-10, "RK4 turns a body of ω by (ω·step)⁵/120 wrong a step: 6e-11 rad in all at 0.1 rad/s")
TOLERANCES = {
    "jax": RK4,
    "numba": RK4,
    "numpy": RK4,
    "scipy": Tolerance(1e-10, 1e-10, "adaptive steps with a relative tolerance of 1e-9"),
    "basilisk": Tolerance(5e-6, 1e-10, "Keplerian orbits, not HCW; the force held in N, not in the turning H"),
    "vbar": Tolerance(1e-12, 0.0, "the same exact solution of HCW"),
}
