"""CMA-ES in the unit cube: the covariance matrix adaptation evolution strategy (Hansen 2016, arXiv:1604.00772), by `cma`.

What gains are worth has several valleys, and a descent finds the bottom of one. The first begins at a given point with a step of
0.2 of the cube. One that has converged, or that has gained no more than a thousandth in 20 generations, makes room for
another: in turn from the best point so far with a small step, to refine it, and from the best of some random points, to find
another valley. Every evaluation counts, and all of the budget is used.

All randomness comes from a generator of its own: nothing depends on, or touches, numpy's global one.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from detumble.matplotlib_setup import load_matplotlib

Array = NDArray[np.float64]
Evaluate = Callable[[Array], Array]
"""Gives the costs (k,) of candidates (k, n): finite, the less the better."""

STEP, REFINING, EXPLORING = 0.2, 0.05, 0.3
"""Standard deviations, in widths of the cube, with which descents begin: the first, from the best, from anywhere."""
LEAST = 8
"""Candidates in a generation: so many fill the lanes of the core."""
SCATTERED = 8
"""Random points for each coordinate, the best of which begins a descent elsewhere."""
PATIENCE, GAIN = 20, 1e-3
"""A descent ends when so many generations lessen its best cost by no more than this share."""


@dataclass(frozen=True)
class Best:
    """The best of all candidates.

    Attributes:
        point: (n,) in the unit cube.
        cost: its cost; infinite if there was no candidate.
    """

    point: Array
    cost: float


def minimise(evaluate: Evaluate, start: Array, budget: int, seed: int, *, step: float = STEP) -> Best:
    """Search the unit cube for the point of the least cost.

    Args:
        evaluate: is given one generation at a time.
        start: (n,) where the first descent begins.
        budget: number of evaluations, all of which are used; the last generation may be a part of one.
        seed: of the search, 0 or more.
        step: standard deviation that the first descent begins with, in widths of the cube.

    Returns:
        The best candidate, the first of those that are equal. A search of a larger budget begins with the same candidates.
    """
    dimensions = len(start)
    generator = np.random.default_rng([seed, dimensions])
    best, left = Best(start, math.inf), budget

    def flown(points: Array) -> Array:
        nonlocal best, left
        points = points[:left]
        costs = evaluate(points)
        first = int(np.argmin(costs))
        if costs[first] < best.cost:
            best = Best(points[first].copy(), float(costs[first]))
        left -= len(points)
        return costs

    descents = 0
    while left > 0:
        origin, width = start, step
        if descents % 2:
            origin, width = best.point, REFINING
        elif descents:
            scattered = generator.random((SCATTERED * dimensions, dimensions))
            origin, width = scattered[int(np.argmin(flown(scattered)))], EXPLORING
        strategy = _strategy(origin, width, max(LEAST, 4 + int(3.0 * math.log(dimensions))), generator)
        least: list[float] = []
        while left > 0 and not strategy.stop() and not _stagnant(least):
            asked = strategy.ask()
            costs = flown(np.clip(np.array(asked)[:, :dimensions], 0.0, 1.0))
            if len(costs) == len(asked):
                strategy.tell(asked, costs.tolist())
            least.append(min([float(costs.min()), *least[-1:]]))
        descents += 1
    return best


def _stagnant(least: list[float]) -> bool:
    """Whether a descent gains too little, by its least cost after each generation."""
    return len(least) > PATIENCE and least[-1 - PATIENCE] - least[-1] <= GAIN * abs(least[-1])


def _strategy(origin: Array, step: float, population: int, generator: np.random.Generator) -> Any:
    """Begin a descent."""
    load_matplotlib()  # which cma imports
    import cma  # type: ignore[import-untyped]  # it tells no types

    options = {
        "popsize": population,
        "bounds": [0.0, 1.0],
        "randn": lambda *shape: generator.standard_normal(shape),
        "seed": math.nan,  # leaves numpy's global generator alone
        "tolx": 1e-4,
        "tolfun": 1e-9,
        "tolfunhist": 1e-9,
        "tolflatfitness": 5,
        "maxiter": math.inf,
        "verbose": -10,
        "verb_log": 0,
        "verb_filenameprefix": os.devnull,  # of the files that are not written; by default in the current folder, if any
        "verb_disp": 0,
        "signals_filename": "",  # no file steers the search
    }
    # The library needs two coordinates; a second one that nothing depends on does no harm.
    inside = np.resize(np.clip(origin, 0.0, 1.0), max(len(origin), 2))
    return cma.CMAEvolutionStrategy(inside, step, options)
