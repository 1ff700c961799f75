"""What can be tuned: shipped gains lie in their ranges, ranges grow with the spacecraft, a file says what is flown."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

import detumble
from detumble.analysis.trials import Trials
from detumble.analysis.tuning.gains import gains_of
from detumble.analysis.tuning.space import space_of
from detumble.scenario import LAWS, Scenario
from detumble.scenario.faults import validated
from detumble.scenario.laws import Form
from detumble.scenario.laws.tsmc import EXPONENT
from variants import VARIANTS

SHIPPED = [
    (name, law) for name in detumble.scenarios() for law in LAWS if getattr(detumble.load(name).laws, law) is not None
]


@pytest.mark.parametrize(("name", "law"), SHIPPED)
def test_every_shipped_gain_lies_within_its_range(name: str, law: str) -> None:
    space = space_of(detumble.load(name), law)
    for tunable in space.tunables:
        low, high = tunable.range(space.natural(tunable, space.own))
        assert low < space.own[tunable.path] < high, tunable.path


def test_number_of_gains() -> None:
    both = ("translation", "rotation")
    counts = {law: (len(gains_of(law)), len(gains_of(law, stack=both))) for law in LAWS}
    assert counts == {"pd": (4, 8), "lqr": (4, 8), "sosmc": (8, 16), "tsmc": (8, 16), "prrl": (7, 13), "stsmc": (6, 12)}
    twelve_u = space_of(detumble.load("twelve_u"), "pd")
    assert [one.path for one in twelve_u.tunables if one.path.startswith("stack.")] == [
        "stack.rotation.kp",
        "stack.rotation.kd",
    ]


@pytest.mark.parametrize("stack", [False, True])
@pytest.mark.parametrize("law", LAWS)
def test_point_and_gains_are_each_others_inverse(law: str, stack: bool) -> None:
    space = space_of(detumble.load("far_tumble"), law, stack=stack)
    values = space.values(np.random.default_rng(1).random(len(space.tunables)).tolist())
    again = space.values(space.point(values).tolist())
    assert again == pytest.approx(values, rel=1e-12)


@pytest.mark.parametrize(("law", "form"), VARIANTS)
def test_what_is_flown_is_what_the_file_says(law: str, form: Form | None) -> None:
    """Candidates as columns of one batch, and each as a scenario of its own: the same bits."""
    scenario = detumble.load("paper_dispersed")
    for stack in (False, True):
        space = space_of(scenario, law, form=form, stack=stack)
        points = 0.4 + 0.25 * np.random.default_rng(2).random((3, len(space.tunables)))
        together = Trials(space.base, 7, 0, 4, 60.0).fly(law, space.columns(points))
        for candidate, point in enumerate(points):
            own = space.scenario(space.values(point.tolist()))
            alone = Trials(own, 7, 0, 4, 60.0).fly(law)
            assert np.array_equal(alone["torque_impulse"][0], together["torque_impulse"][candidate])
            assert np.array_equal(alone["impulse"][0], together["impulse"][candidate])


def similar(scenario: Scenario, length: float, mass: float, inertia: float) -> Scenario:
    """Give a case of other lengths and bodies in which, forces and torques grown alike, everything takes as long."""
    raw = scenario.to_dict()
    raw["orbit"] |= {"mu": raw["orbit"].get("mu", 3.986004418e14)}
    for body in ("chaser", "debris"):
        raw[body]["mass"] *= mass
        raw[body]["inertia"] = tuple(inertia * moment for moment in raw[body]["inertia"])
    raw["chaser"]["position"] = tuple(length * x for x in raw["chaser"]["position"])
    raw["goal"]["position"] = tuple(length * x for x in raw["goal"]["position"])
    raw["capture"]["distance"] *= length
    raw["actuators"]["force_limit"] *= mass * length
    raw["actuators"]["torque_limit"] *= inertia
    raw["sensors"] = {}
    return validated(raw, "similar")


@pytest.mark.parametrize(("law", "form"), VARIANTS)
def test_a_point_of_the_cube_means_the_same_to_a_spacecraft_of_another_size(law: str, form: Form | None) -> None:
    paper = detumble.load("paper")
    flown = []
    for case in (similar(paper, 1.0, 1.0, 1.0), similar(paper, 10.0, 3.0, 7.0)):
        space = space_of(case, law, form=form, stack=True)
        points = np.full((1, len(space.tunables)), 0.55)
        flown.append(Trials(space.base, 0, 0, 1, 100.0).fly(law, space.columns(points)))
    one, other = flown
    assert one["capture_time"][0, 0] == other["capture_time"][0, 0]
    assert other["impulse"][0, 0] == pytest.approx(30.0 * one["impulse"][0, 0], rel=1e-9)
    assert other["torque_impulse"][0, 0] == pytest.approx(7.0 * one["torque_impulse"][0, 0], rel=1e-9)


@pytest.mark.parametrize(("form", "low", "high"), [("printed", 1.0, 3.0), ("corrected", 1.0 / 3.0, 1.0)])
def test_exponents_are_snapped_to_the_nearest_fraction_of_odd_numbers(form: str, low: float, high: float) -> None:
    odd = range(1, 22, 2)
    allowed = {Fraction(p, q) for p in odd for q in odd if Fraction(1, 3) <= Fraction(p, q) <= 3 and p != q}
    allowed = {one for one in allowed if (one > 1) == (form == "printed")}
    for wanted in np.linspace(low, high, 301):
        p, q = EXPONENT.fractions[form].nearest(float(wanted))
        assert p % 2 == q % 2 == 1
        assert max(p, q) <= 21
        assert Fraction(p, q) in allowed
        assert abs(p / q - wanted) == pytest.approx(min(abs(float(one) - wanted) for one in allowed), abs=1e-15)
    assert EXPONENT.fractions["printed"].nearest(5 / 3) == (5, 3)
    assert EXPONENT.fractions["corrected"].nearest(7 / 9) == (7, 9)


def test_lengths_with_grasp_points_are_those_between_the_points() -> None:
    raw = detumble.load("paper").to_dict()
    del raw["goal"]["position"]
    raw["chaser"] |= {"position": (2.0, 0.0, 0.0), "attitude": (1.0, 0.0, 0.0, 0.0), "grasp_point": (-0.3, 0.0, 0.0)}
    raw["debris"] |= {
        "attitude": (0.5**0.5, 0.0, 0.0, 0.5**0.5),
        "grasp_point": (0.0, -0.2, 0.0),
    }  # a quarter turn about z
    space = space_of(validated(raw, "grasp"), "pd", stack=True)
    assert space.naturals["translation"].length == pytest.approx(2.0 - 0.3 - 0.2)
    assert space.naturals["stack.translation"].length == 0.5
