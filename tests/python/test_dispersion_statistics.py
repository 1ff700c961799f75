"""Draws follow the distributions that they are said to: a million of each, against closed forms and scipy."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import special, stats
from scipy.spatial.transform import Rotation

from detumble.campaigns.runs.draws import draw
from detumble.scenario import Scenario, load
from detumble.scenario.faults import validated

Array = NDArray[np.float64]

RUNS = 1_000_000
UNLIKELY = 1e-4
"""A correct sampler is refused once in this many checks; the seeds are fixed, so it is refused always or never."""


def drawn(field: str, distribution: str, nominal: Any = None, runs: int = RUNS, **parameters: Any) -> Array:
    scenario = load("paper")
    if nominal is not None:
        section, _, name = field.rpartition(".")
        setattr(scenario.at(section), name, nominal)
    return of(scenario, [{"field": field, "distribution": distribution, **parameters}], [], runs)[field]


def of(scenario: Scenario, dispersions: list[Any], correlations: list[Any], runs: int = RUNS) -> dict[str, Array]:
    raw = scenario.to_dict() | {"dispersions": dispersions, "correlations": correlations}
    return draw(validated(raw, "case"), 2026, 0, runs)


def assert_follows(sample: Array, cdf: Callable[[Array], Array]) -> None:
    """Kolmogorov and Smirnov's test; for this many draws its statistic has its limiting distribution."""
    shares = cdf(np.sort(sample))
    steps = np.arange(sample.size + 1) / sample.size
    distance = max((steps[1:] - shares).max(), (shares - steps[:-1]).max())
    assert stats.kstwobign.sf(distance * np.sqrt(sample.size)) > UNLIKELY


def assert_independent(*samples: Array) -> None:
    """Chi-squared over cells of equal share, eight a sample."""
    cells = np.zeros(samples[0].size, dtype=np.int64)
    for sample in samples:
        bounds = np.sort(sample)[np.arange(1, 8) * sample.size // 8]
        cells = 8 * cells + sum((sample >= bound for bound in bounds), start=np.int64(0))
    assert stats.chisquare(np.bincount(cells, minlength=8 ** len(samples))).pvalue > UNLIKELY


# Numbers


def test_normal_numbers_are_normal() -> None:
    masses = drawn("chaser.mass", "normal", sigma=0.2)
    assert_follows(masses, stats.norm(9.0, 0.2).cdf)
    assert stats.normaltest(masses).pvalue > UNLIKELY
    assert masses.min() < 9.0 - 4.5 * 0.2
    assert masses.max() > 9.0 + 4.5 * 0.2


def test_a_share_of_the_nominal_is_the_spread_of_each_element() -> None:
    positions = drawn("chaser.position", "normal", relative=[0.1, 0.2, 0.3], mean=1.0)
    for element, sigma in enumerate((0.06, 0.14, 0.09)):
        assert_follows(positions[:, element], stats.norm(1.0, sigma).cdf)
    assert_independent(*positions.T)


@pytest.mark.parametrize(
    ("nominal", "sigma", "low", "high"),
    [
        (9.0, 0.2, 8.9, 9.5),
        (40.0, 2.0, 36.0, None),
        (40.0, 2.0, None, 40.5),
        (9.0, 0.2, 10.6, None),
        (9.0, 0.2, 3.0, 7.4),
        (9.0, 0.2, 11.0, 11.01),
        (9.0, 0.1, None, 5.6),
    ],
)
def test_truncated_normal_numbers_are_those_between_the_bounds(
    nominal: float, sigma: float, low: float | None, high: float | None
) -> None:
    bounds = {name: bound for name, bound in (("low", low), ("high", high)) if bound is not None}
    masses = drawn("chaser.mass", "truncated_normal", nominal, sigma=sigma, **bounds)
    a, b = (-np.inf if low is None else low - nominal) / sigma, (np.inf if high is None else high - nominal) / sigma
    assert low is None or masses.min() >= low
    assert high is None or masses.max() <= high
    z = (masses - nominal) / sigma
    if a > 0.0:  # the complement keeps the upper tail precise
        z, a, b = -z, -b, -a
    assert_follows(z, lambda z: (special.ndtr(z) - special.ndtr(a)) / (special.ndtr(b) - special.ndtr(a)))


def test_draws_far_out_in_a_tail_fall_off_as_the_tail_does() -> None:
    """34 sigma out the tail is an exponential of rate 34 per sigma, nearly: Mills' ratio x (1 - 1/x²) and beyond."""
    masses = drawn("chaser.mass", "truncated_normal", sigma=0.01, low=9.34)
    excess = (masses - 9.34) / 0.01
    log_survival = stats.norm.logsf(34.0 + excess) - stats.norm.logsf(34.0)
    assert_follows(np.exp(log_survival), stats.uniform.cdf)
    assert excess.mean() == pytest.approx(1.0 / 34.0, rel=0.01)


def test_uniform_numbers_are_uniform_in_value_or_in_logarithm() -> None:
    distances = drawn("capture.distance", "uniform", low=0.3, high=0.5)
    assert_follows(distances, stats.uniform(0.3, 0.2).cdf)
    gains = drawn(
        "laws.prrl.translation.gain", "log_uniform", nominal=[0.1, 0.1, 0.1], low=[1e-3, 1e-2, 1e-6], high=1.0
    )
    for element, low in enumerate((1e-3, 1e-2, 1e-6)):
        assert_follows(gains[:, element], stats.loguniform(low, 1.0).cdf)
    assert_independent(*gains.T)


def test_different_fields_and_seeds_are_independent(paper: Scenario) -> None:
    fields = ("chaser.mass", "debris.mass", "belief.stack_mass")
    both = of(paper, [{"field": field, "distribution": "uniform", "low": 1, "high": 2} for field in fields], [])
    assert_independent(*both.values())
    successive = both["chaser.mass"]
    assert_independent(successive[:-2], successive[1:-1], successive[2:])
    raw = paper.to_dict() | {"dispersions": [{"field": "chaser.mass", "distribution": "uniform", "low": 1, "high": 2}]}
    assert_independent(successive, draw(validated(raw, "case"), 2027, 0, RUNS)["chaser.mass"])


# Correlations


def test_normal_numbers_have_exactly_the_correlations_given(paper: Scenario) -> None:
    dispersions = [
        {"field": "chaser.mass", "distribution": "normal", "sigma": 0.2},
        {"field": "debris.mass", "distribution": "normal", "sigma": 0.1},
        {"field": "chaser.position", "distribution": "normal", "sigma": [0.1, 0.2, 0.3]},
    ]
    matrix = np.array([[1.0, 0.6, -0.3], [0.6, 1.0, 0.2], [-0.3, 0.2, 1.0]])
    names = ["chaser.mass", "debris.mass", "chaser.position.z"]
    values = of(paper, dispersions, [{"fields": names, "matrix": matrix}])
    positions = values["chaser.position"]
    together = np.column_stack([values["chaser.mass"], values["debris.mass"], positions[:, 2]])
    # Standard error of a correlation coefficient: (1 - ρ²)/√n.
    error = (1.0 - matrix**2) / np.sqrt(RUNS)
    assert np.all(np.abs(np.corrcoef(together.T) - matrix) <= 4.0 * error + 1e-12)
    # Whitened by the matrix, they are independent: nothing but the correlation ties them.
    standard = (together - [9.0, 5.0, -0.3]) / [0.2, 0.1, 0.3]
    assert_independent(*np.linalg.solve(np.linalg.cholesky(matrix), standard.T))
    for element in range(3):
        assert_follows(standard[:, element], stats.norm.cdf)
    assert_independent(positions[:, 0], positions[:, 1], positions[:, 2])


def test_ranks_of_other_distributions_correlate_as_the_copulas_closed_form(paper: Scenario) -> None:
    dispersions = [
        {"field": "chaser.mass", "distribution": "truncated_normal", "sigma": 2.0, "low": 8.5, "high": 9.0},
        {"field": "capture.distance", "distribution": "uniform", "low": 0.3, "high": 0.5},
        {"field": "laws.prrl.translation.gain", "distribution": "log_uniform", "low": 1e-3, "high": 1.0},
    ]
    group = {
        "fields": [dispersion["field"] for dispersion in dispersions],
        "matrix": [[1, 0.8, -0.5], [0.8, 1, 0], [-0.5, 0, 1]],
    }
    values = of(paper, dispersions, [group])
    ranks = np.corrcoef([np.argsort(np.argsort(sample)) for sample in values.values()])  # there are no ties
    expected = 6.0 / np.pi * np.arcsin(np.array(group["matrix"]) / 2.0)
    assert ranks == pytest.approx(expected, abs=4.0 / np.sqrt(RUNS))
    assert np.abs(expected - np.array(group["matrix"])).max() < 0.02
    assert_follows(
        (values["chaser.mass"] - 9.0) / 2.0,
        lambda z: (special.ndtr(z) - special.ndtr(-0.25)) / (0.5 - special.ndtr(-0.25)),
    )
    assert_follows(values["capture.distance"], stats.uniform(0.3, 0.2).cdf)
    assert_follows(values["laws.prrl.translation.gain"], stats.loguniform(1e-3, 1.0).cdf)


# Directions


def test_directions_are_uniform_on_the_sphere_with_the_nominal_length() -> None:
    rates = drawn("debris.tumble_rate", "direction")
    length = np.linalg.norm(rates, axis=1)
    assert length == pytest.approx(np.linalg.norm([0.03, 0.02, -0.02]), rel=1e-15)
    x, y, z = (rates / length[:, None]).T
    azimuth = np.arctan2(y, x)
    assert_follows(z, stats.uniform(-1.0, 2.0).cdf)
    assert_follows(azimuth, stats.uniform(-np.pi, 2.0 * np.pi).cdf)
    assert_independent(z, azimuth)


@pytest.mark.parametrize(("cone", "magnitude"), [(1e-3, "uniform"), (20.0, "log_uniform"), (180.0, "uniform")])
def test_directions_are_uniform_on_the_cap(cone: float, magnitude: str) -> None:
    nominal = np.array([-0.2, 0.1, -0.4])
    rates = drawn("chaser.rate", "direction", nominal, cone_deg=cone, low=0.01, high=0.05, magnitude=magnitude)
    length = np.linalg.norm(rates, axis=1)
    assert_follows(length, (stats.uniform(0.01, 0.04) if magnitude == "uniform" else stats.loguniform(0.01, 0.05)).cdf)
    axis = nominal / np.linalg.norm(nominal)
    across = np.cross(axis, [0.0, 0.0, 1.0]) / np.linalg.norm(np.cross(axis, [0.0, 0.0, 1.0]))
    x, y = rates @ across / length, rates @ np.cross(axis, across) / length
    # 1 - cos θ = 2 sin²(θ/2) by half angles, which keeps small cones precise.
    half = 0.5 * np.arctan2(np.hypot(x, y), rates @ axis / length)
    share = (np.sin(half) / np.sin(0.5 * np.radians(cone))) ** 2
    azimuth = np.arctan2(y, x)
    assert share.max() <= 1.0 + 1e-9
    assert_follows(share, stats.uniform.cdf)
    assert_follows(azimuth, stats.uniform(-np.pi, 2.0 * np.pi).cdf)
    assert_independent(share, azimuth, length)


# Attitudes


def test_attitudes_are_uniform_on_so3() -> None:
    attitudes = drawn("chaser.attitude", "attitude")
    assert np.linalg.norm(attitudes, axis=1) == pytest.approx(1.0, abs=4e-16)
    assert attitudes[:, 0].min() >= 0.0
    angle = 2.0 * np.arctan2(np.linalg.norm(attitudes[:, 1:], axis=1), attitudes[:, 0])
    assert_follows(angle, lambda theta: (theta - np.sin(theta)) / np.pi)
    rotated = Rotation.from_quat(attitudes, scalar_first=True)
    x, y, z = rotated.apply([1.0, 0.0, 0.0]).T
    assert_follows(z, stats.uniform(-1.0, 2.0).cdf)
    assert_follows(np.arctan2(y, x), stats.uniform(-np.pi, 2.0 * np.pi).cdf)
    assert_independent(z, np.arctan2(y, x))
    # Haar measure is invariant: turned by any fixed attitude they are still the same.
    turned = (Rotation.from_rotvec([0.3, -1.0, 0.5]) * rotated).magnitude()
    assert_follows(turned, lambda theta: (theta - np.sin(theta)) / np.pi)


def test_small_turns_are_normal_in_body_axes() -> None:
    nominal = (0.5, -0.5, 0.5, 0.5)
    attitudes = drawn("debris.attitude", "attitude", nominal, sigma=0.01)
    turns = Rotation.from_quat(nominal, scalar_first=True).inv() * Rotation.from_quat(attitudes, scalar_first=True)
    vectors = turns.as_rotvec()
    for component in vectors.T:
        assert_follows(component, stats.norm(0.0, 0.01).cdf)
    assert_independent(*vectors.T)


# Inertias


def tensors(rows: Array) -> Array:
    return rows[:, [0, 3, 4, 3, 1, 5, 4, 5, 2]].reshape(-1, 3, 3)


def second_moments(inertia: Array) -> Array:
    return 0.5 * np.trace(inertia, axis1=1, axis2=2)[:, None, None] * np.eye(3) - inertia


FULL = np.array([[0.19, 0.012, -0.008], [0.012, 0.31, 0.010], [-0.008, 0.010, 0.29]])


@pytest.mark.parametrize(
    "parameters",
    [{"relative": 0.5}, {"relative": 0.5, "axes": "uniform"}, {"relative": 0.3, "axes_sigma": 1.0}],
    ids=str,
)
def test_every_inertia_is_some_rigid_bodys(parameters: dict[str, Any]) -> None:
    moments = np.linalg.eigvalsh(tensors(drawn("chaser.inertia", "inertia", FULL, **parameters)))
    assert moments[:, 0].min() > 0.0
    assert np.all(moments[:, 2] < moments[:, 0] + moments[:, 1])


def test_principal_second_moments_are_log_normal_about_the_nominal() -> None:
    sigma = second_moments(tensors(drawn("chaser.inertia", "inertia", FULL, relative=0.2)))
    nominal, axes = np.linalg.eigh(second_moments(FULL[None])[0])
    rotated = axes.T @ sigma @ axes
    assert np.abs(rotated[:, [0, 0, 1], [1, 2, 2]]).max() < 1e-15
    ratios = np.log(rotated[:, [0, 1, 2], [0, 1, 2]] / nominal)
    for ratio in ratios.T:
        assert_follows(ratio, stats.norm(0.0, 0.2).cdf)
    assert_independent(*ratios.T)
    assert rotated[:, 0, 0].mean() == pytest.approx(nominal[0] * np.exp(0.5 * 0.2**2), rel=1e-3)


def test_principal_axes_turn_by_the_spread_given() -> None:
    """To first order in small turns φ the off-diagonal of R Σ Rᵀ is the difference of the moments times φ."""
    inertia = tensors(drawn("chaser.inertia", "inertia", (0.1, 0.2, 0.25), axes_sigma=1e-4))
    for (i, j), difference in {(0, 1): 0.1, (0, 2): 0.15, (1, 2): 0.05}.items():
        assert_follows(inertia[:, i, j] / difference, stats.norm(0.0, 1e-4).cdf)


def test_principal_axes_are_uniform_when_asked() -> None:
    inertia = tensors(drawn("chaser.inertia", "inertia", (0.1, 0.2, 0.25), axes="uniform", runs=50_000))
    moments, axes = np.linalg.eigh(inertia)
    assert moments == pytest.approx(np.tile([0.1, 0.2, 0.25], (50_000, 1)), abs=1e-15)
    for k in range(3):
        x, y, z = axes[:, :, k].T
        assert_follows(np.abs(z), stats.uniform.cdf)
        assert_follows(np.arctan2(y, x) % np.pi, stats.uniform(0.0, np.pi).cdf)


def test_a_flat_body_stays_flat() -> None:
    moments = np.linalg.eigvalsh(
        tensors(drawn("chaser.inertia", "inertia", (0.05, 0.08, 0.13), relative=0.3, axes="uniform", runs=50_000))
    )
    assert moments[:, 2] == pytest.approx(moments[:, 0] + moments[:, 1], rel=1e-14)
    assert moments[:, 2].std() > 0.01
