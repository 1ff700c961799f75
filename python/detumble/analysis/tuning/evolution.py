"""CMA-ES in the unit cube: the covariance matrix adaptation evolution strategy (Hansen 2016, arXiv:1604.00772), by `cma`.

The cost of gains has several local minima, and a descent finds one of them. The first descent begins at a given point with a
step of 0.2 of the cube. When a descent has converged, or has gained no more than a thousandth in 20 generations, the next one
begins: in turn from the best point so far with a small step, to refine it, and from the best of some random points, to find
another minimum. Every evaluation counts, and all of the budget is used.

All random numbers come from the search's own generator; numpy's global one is neither read nor changed.
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
"""Gives the costs (k,) of candidates (k, n): finite, less is better."""

STEP, REFINING, EXPLORING = 0.2, 0.05, 0.3
"""Standard deviations, in widths of the cube, with which descents begin: the first, from the best, from anywhere."""
LEAST = 8
"""Fewest candidates in a generation: as many as the core has lanes."""
SCATTERED = 8
"""Number of random points for each coordinate; the best of them begins an exploring descent."""
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
        evaluate: gives the costs of a generation.
        start: (n,) where the first descent begins.
        budget: number of evaluations, all of which are used; the last generation may be incomplete.
        seed: of the search, 0 or more.
        step: initial standard deviation of the first descent, in widths of the cube.

    Returns:
        The best candidate, the first of those that are equal. A search of a larger budget begins with the same candidates.
    """
    dimensions = len(start)
    generator = np.random.default_rng([seed, dimensions])
    best, left = Best(start, math.inf), budget

    def evaluated(points: Array) -> Array:
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
            origin, width = scattered[int(np.argmin(evaluated(scattered)))], EXPLORING
        strategy = _strategy(origin, width, max(LEAST, 4 + int(3.0 * math.log(dimensions))), generator)
        least: list[float] = []
        while left > 0 and not strategy.stop() and not _stagnant(least):
            asked = strategy.ask()
            costs = evaluated(np.clip(np.array(asked)[:, :dimensions], 0.0, 1.0))
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
    import cma  # type: ignore[import-untyped]  # it has no type hints

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
        "verb_filenameprefix": os.devnull,  # of files that are not written; the default would be the current folder
        "verb_disp": 0,
        "signals_filename": "",  # no file controls the search
    }
    # The library needs two coordinates; a second one that nothing depends on does no harm.
    inside = np.resize(np.clip(origin, 0.0, 1.0), max(len(origin), 2))
    return cma.CMAEvolutionStrategy(inside, step, options)
