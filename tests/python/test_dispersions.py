"""Dispersions: what a file may say, what it is told otherwise, and which numbers belong to which run."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import pytest

import detumble
from detumble.campaigns.runs.draws import draw, drawn_scenario, spec
from detumble.compiled import core
from detumble.errors import ScenarioError
from detumble.scenario import Scenario, from_toml, load, with_settings
from detumble.scenario.core import case
from detumble.scenario.dispersions import Normal, Uniform
from detumble.scenario.dispersions.fitting import fields
from detumble.scenario.faults import validated

MASS = {"field": "chaser.mass", "distribution": "normal", "sigma": 0.2}
DEBRIS = {"field": "debris.mass", "distribution": "truncated_normal", "relative": 0.2, "low": 3.0}
ALL = [
    MASS,
    DEBRIS,
    {"field": "capture.distance", "distribution": "uniform", "low": 0.3, "high": 0.5},
    {"field": "laws.prrl.translation.gain", "distribution": "log_uniform", "low": 0.01, "high": 0.5},
    {"field": "chaser.position", "distribution": "normal", "sigma": [0.1, 0.2, 0.0], "mean": [0.5, 0.6, -0.2]},
    {"field": "debris.tumble_rate", "distribution": "direction", "cone_deg": 20.0, "low": 0.01, "high": 0.05},
    {"field": "chaser.attitude", "distribution": "attitude", "sigma": 0.1},
    {"field": "debris.attitude", "distribution": "attitude"},
    {"field": "chaser.inertia", "distribution": "inertia", "relative": 0.1, "axes_sigma": 0.05},
    {"field": "debris.inertia", "distribution": "inertia", "relative": 0.1, "axes": "uniform"},
]
GROUP = {"fields": ["chaser.mass", "chaser.position.y"], "matrix": [[1.0, 0.6], [0.6, 1.0]]}


@pytest.fixture
def dispersed(paper: Scenario) -> Scenario:
    return given(paper, ALL, [GROUP])


def given(scenario: Scenario, dispersions: Any, correlations: Any = ()) -> Scenario:
    raw = scenario.to_dict() | {"dispersions": dispersions, "correlations": list(correlations)}
    return validated(raw, "my6u.toml")


def only(field: str, distribution: str, **parameters: Any) -> list[dict[str, Any]]:
    return [{"field": field, "distribution": distribution, **parameters}]


# Files


def test_a_file_keeps_every_dispersion_and_correlation(dispersed: Scenario) -> None:
    again = from_toml(dispersed.to_toml())
    assert again == dispersed
    assert again.to_toml() == dispersed.to_toml()
    assert isinstance(again.dispersions[0], Normal)


def test_a_saved_file_tells_the_units_of_the_dispersed_fields(dispersed: Scenario) -> None:
    tables = dispersed.to_toml().split("[[dispersions]]")
    assert (
        'field = "chaser.mass"\ndistribution = "normal"\nsigma = 0.2                                 # kg' in tables[1]
    )
    assert "high = 0.05                                 # rad/s" in tables[6]
    assert "sigma = 0.1                                 # rad" in tables[7]


def test_dispersions_are_set_in_python_and_checked(paper: Scenario) -> None:
    paper.dispersions = [
        Normal(field="chaser.mass", sigma=0.2),
        {"field": "debris.attitude", "distribution": "attitude"},
    ]
    paper.dispersions.append(Uniform(field="capture.distance", low=0.3, high=0.5))
    paper.correlations = [{"fields": ["chaser.mass", "capture.distance"], "matrix": np.eye(2)}]
    assert list(draw(paper, 0, 0, 1)) == ["chaser.mass", "debris.attitude", "capture.distance"]
    with pytest.raises(ScenarioError, match=r"normal\.sigma  -1: must be at least 0"):
        paper.dispersions[0].sigma = -1.0
    paper.dispersions[0].relative = 0.01
    assert paper.dispersions[0].sigma is None
    paper.dispersions.append(Uniform(field="chaser.mass", low=1.0, high=2.0))
    with pytest.raises(ScenarioError, match=r"dispersions\[3\]\.field"):
        paper.check()


def test_dispersions_are_set_on_the_command_line(paper: Scenario) -> None:
    text = "dispersions=[{field='chaser.mass', distribution='uniform', low=8, high=10}]"
    assert with_settings(paper, [text]).dispersions == [Uniform(field="chaser.mass", low=8.0, high=10.0)]
    assert with_settings(with_settings(paper, [text]), ["dispersions=[]"]) == paper


def test_a_single_flight_is_that_of_the_nominal_values(paper: Scenario) -> None:
    assert case(given(paper, ALL, [GROUP]), "prrl") == case(paper, "prrl")


def test_the_schema_requires_the_distribution_and_has_units() -> None:
    schema = Scenario.schema()
    choices = schema["properties"]["dispersions"]["items"]["discriminator"]["mapping"]
    assert set(choices) == {"normal", "truncated_normal", "uniform", "log_uniform", "direction", "attitude", "inertia"}
    for reference in choices.values():
        definition = schema["$defs"][reference.rsplit("/", 1)[1]]
        assert {"field", "distribution"} <= set(definition["required"])
    assert schema["$defs"]["Normal"]["properties"]["sigma"]["unit"] == "field's unit"
    json.dumps(schema)


# Faults: dispersions, correlations, field at fault, value met, words

TURNED = [[0.1, 0.02, 0.0], [0.02, 0.1, 0.0], [0.0, 0.0, 0.05]]
NORMALS = "use normal, truncated_normal, uniform or log_uniform"
D0 = "dispersions[0]"
C0 = "correlations[0]"

REFUSED: list[tuple[list[Any], list[Any], str, str, str]] = [
    # a table that is wrong by itself
    (only("chaser.mass", "normall", sigma=1.0), [], f"{D0}.distribution", '"normall"', "did you mean normal?"),
    ([{"field": "chaser.mass", "sigma": 1.0}], [], f"{D0}.distribution", "", "missing; needed: normal or truncated_normal"),
    ([{"distribution": "normal", "sigma": 1.0}], [], f"{D0}.field", "", "missing; needed: path of a number"),
    ([3], [], D0, "3", "must be a table"),
    (3, [], "dispersions", "3", "must be an array of tables"),  # type: ignore[list-item]
    (only("chaser.mass", "normal", sigm=1.0), [], f"{D0}.sigm", "", "unknown key; did you mean sigma?"),
    (only("chaser.mass", "normal"), [], f"{D0}.sigma", "", "exactly one of sigma and relative"),
    (only("chaser.mass", "normal", sigma=1, relative=1), [], f"{D0}.sigma", "", "exactly one of sigma and relative"),
    (only("chaser.mass", "normal", sigma="1 kg"), [], f"{D0}.sigma", '"1 kg"', "must be a number or a list of 3"),
    (only("chaser.mass", "normal", sigma=-1.0), [], f"{D0}.sigma", "-1", "must be at least 0"),
    (only("chaser.mass", "normal", sigma=math.nan), [], f"{D0}.sigma", "nan", "NaN"),
    (only("chaser.mass", "uniform", low=1.0), [], f"{D0}.high", "", "missing; needed: greatest value"),
    (only("chaser.mass", "uniform", low=2.0, high=2.0), [], f"{D0}.high", "", "must be greater than low (2)"),
    (only("chaser.position", "uniform", low=0.0, high=[1, 1, -1]), [], f"{D0}.high", "", "equal stays fixed"),
    (only("chaser.mass", "uniform", low=2.0, high=math.inf), [], f"{D0}.high", "inf", "must be finite"),
    (only("chaser.mass", "log_uniform", low=0.0, high=1.0), [], f"{D0}.low", "0", "must be greater than 0"),
    (only("chaser.mass", "truncated_normal", sigma=1.0), [], f"{D0}.low", "", "low or high must be given"),
    (only("chaser.mass", "truncated_normal", sigma=1, low=9, high=9), [], f"{D0}.high", "", "must be greater than low (9)"),
    (only("chaser.rate", "direction", low=0.1), [], f"{D0}.low", "", "given together, or neither"),
    (only("chaser.rate", "direction", low=0.1, high=0.1), [], f"{D0}.high", "", "must be greater than low"),
    (only("chaser.rate", "direction", cone_deg=181.0), [], f"{D0}.cone_deg", "181 deg", "at most 180"),
    (only("debris.tumble_rate", "direction", magnitude="log_uniform"), [], f"{D0}.magnitude", "", "needs low and high"),
    (only("chaser.rate", "direction", magnitude="log_uniform", low=0, high=1), [], f"{D0}.magnitude", "", "low greater than 0"),
    (only("chaser.rate", "direction", magnitude="flat"), [], f"{D0}.magnitude", '"flat"', "must be uniform or log_uniform"),
    (only("chaser.inertia", "inertia"), [], f"{D0}.relative", "", "relative, axes_sigma or axes must be given"),
    (only("chaser.inertia", "inertia", axes="uniform", axes_sigma=0.1), [], f"{D0}.axes", "", "give one of them"),
    (only("chaser.inertia", "inertia", axes="any"), [], f"{D0}.axes", '"any"', "must be uniform"),
    (only("chaser.inertia", "inertia", relative=2.0), [], f"{D0}.relative", "2", "at most 1"),
    # its field
    (only("chaser.mas", "normal", sigma=0.1), [], f"{D0}.field", '"chaser.mas"', "did you mean chaser.mass?"),
    (only("laws.prl.alpha", "normal", sigma=0.1), [], f"{D0}.field", '"laws.prl.alpha"', "did you mean laws.prrl.alpha?"),
    (only("chaser", "normal", sigma=0.1), [], f"{D0}.field", '"chaser"', "is a table; name one of its numbers"),
    (only("title", "normal", sigma=0.1), [], f"{D0}.field", '"title"', "nothing that varies from run to run"),
    (only("capture.merge", "normal", sigma=0.1), [], f"{D0}.field", '"capture.merge"', "nothing that varies"),
    (only("laws.tsmc.rotation.p", "normal", sigma=0.1), [], f"{D0}.field", '"laws.tsmc.rotation.p"', "nothing that varies"),
    (only("time.duration", "normal", sigma=0.1), [], f"{D0}.field", '"time.duration"', "is the same in every run"),
    (only("capture.dwell", "uniform", low=1, high=2), [], f"{D0}.field", '"capture.dwell"', "is the same in every run"),
    (only("laws.none.segments", "normal", sigma=0.1), [], f"{D0}.field", '"laws.none.segments"', "open-loop segments"),
    (only("capture.speed", "normal", sigma=0.1), [], f"{D0}.field", '"capture.speed"', "is not given here; give it a value"),
    (only("orbit.radius", "normal", sigma=0.1), [], f"{D0}.field", '"orbit.radius"', "value or disperse orbit.altitude"),
    (only("laws.prrl.stack.rotation.gain", "normal", sigma=0.1), [], f"{D0}.field", '"laws.prrl.stack.rotation.gain"', "is not"),
    ([MASS, MASS], [], "dispersions[1].field", '"chaser.mass"', "dispersed by dispersions[0] already"),
    (only("chaser.attitude", "normal", sigma=0.1), [], f"{D0}.distribution", '"normal"', "does not fit chaser.attitude; use att"),
    (only("chaser.inertia", "uniform", low=1, high=2), [], f"{D0}.distribution", '"uniform"', "use inertia"),
    (only("chaser.mass", "direction"), [], f"{D0}.distribution", '"direction"', NORMALS),
    (only("chaser.rate", "attitude"), [], f"{D0}.distribution", '"attitude"', f"{NORMALS[:-15]}, log_uniform or direction"),
    (only("actuators.force_limit", "inertia", relative=0.1), [], f"{D0}.distribution", '"inertia"', NORMALS),
    # ranges
    (only("chaser.mass", "normal", sigma=2.0), [], f"{D0}.sigma", "2 kg",
     "draws reach -5 kg, but chaser.mass must be at least 0.001 and at most 100e3; at 7 sigma; use truncated_normal"),
    (only("laws.prrl.alpha", "normal", relative=0.1), [], f"{D0}.relative", "0.1", "draws reach 1.19, but laws.prrl.alpha must"),
    (only("chaser.mass", "normal", sigma=0.1, mean=-9), [], f"{D0}.sigma", "0.1 kg", "draws reach -9.7 kg"),
    (only("chaser.mass", "normal", sigma=[1, 2, 3]), [], f"{D0}.sigma", "[1, 2, 3] kg", "3 elements, but chaser.mass is one"),
    (only("actuators.force_limit", "uniform", low=[1, 2, 3], high=4), [], f"{D0}.low", "[1, 2, 3] N", "for all axes alike"),
    (only("chaser.mass", "normal", sigma=0.0), [], f"{D0}.sigma", "0 kg", "must be greater than 0"),
    (only("chaser.velocity", "normal", relative=0.1), [], f"{D0}.relative", "0.1", "a share of chaser.velocity = [0, 0, 0] is"),
    (only("chaser.mass", "truncated_normal", sigma=0.0, low=8), [], f"{D0}.sigma", "0 kg", "must be greater than 0"),
    (only("chaser.rate", "truncated_normal", sigma=[1, 1, 0], low=-1), [], f"{D0}.sigma", "[1, 1, 0] rad/s", "on every axis"),
    (only("chaser.mass", "truncated_normal", sigma=1, low=-1), [], f"{D0}.low", "-1 kg", "chaser.mass must be at least"),
    (only("chaser.mass", "truncated_normal", sigma=2, high=10), [], f"{D0}.sigma", "2 kg", "draws reach -5 kg, but"),
    (only("laws.prrl.alpha", "truncated_normal", sigma=0.1, low=0.5), [], f"{D0}.sigma", "0.1", "at 7 sigma; give high"),
    (only("chaser.mass", "truncated_normal", sigma=0.1, low=13.0), [], f"{D0}.low", "13 kg", "40 sigma beyond the mean; at most"),
    (only("chaser.mass", "truncated_normal", sigma=0.1, high=5.0), [], f"{D0}.high", "5 kg", "40 sigma beyond the mean"),
    (only("chaser.mass", "uniform", low=-1, high=2), [], f"{D0}.low", "-1 kg", "chaser.mass must be at least 0.001"),
    (only("orbit.altitude", "uniform", low=600, high=700), [], f"{D0}.low", "600 m", "did you mean 600e3?"),
    (only("capture.angle_deg", "log_uniform", low=1, high=200), [], f"{D0}.high", "200 deg", "at most 180"),
    (only("debris.tumble_rate", "direction", low=1, high=101), [], f"{D0}.high", "101 rad/s", "at most 100"),
    (only("chaser.rate", "direction"), [], f"{D0}.low", "", "missing; chaser.rate is zero"),
    (only("chaser.rate", "direction", cone_deg=5, low=1, high=2), [], f"{D0}.cone_deg", "5 deg", "has no direction"),
    # correlations
    ([MASS, DEBRIS], [{"fields": ["chaser.mass"], "matrix": [[1.0]]}], f"{C0}.fields", "", "two fields or more"),
    ([MASS, DEBRIS], [GROUP | {"fields": ["chaser.mass"] * 2}], f"{C0}.fields", "", "names chaser.mass twice"),
    ([MASS], [{"fields": ["chaser.mass", "debris.mass"]}], f"{C0}.matrix", "", "missing; needed: correlations, symmetric"),
    ([MASS], [{"fields": 3, "matrix": [[1.0]]}], f"{C0}.fields", "3", "must be a list"),
    ([MASS], [{"fields": ["chaser.mass", 3], "matrix": [[1.0]]}], f"{C0}.fields[1]", "3", "must be text in quotes"),
    ([MASS], [GROUP | {"matrix": [[1, "a"], [0, 1]]}], f"{C0}.matrix[0][1]", '"a"', "must be a plain number"),
    ([MASS], [GROUP | {"matrix": [[1, math.nan], [0, 1]]}], f"{C0}.matrix[0][1]", "nan", "must be finite"),
    ([MASS], [GROUP | {"matrix": [[1, 0], [0]]}], f"{C0}.matrix", "", "must be 2x2"),
    ([MASS], [GROUP | {"matrix": [[2, 0], [0, 1]]}], f"{C0}.matrix", "", "ones on its diagonal"),
    ([MASS], [GROUP | {"matrix": [[1, 0.1], [0.2, 1]]}], f"{C0}.matrix", "", "must be symmetric"),
    ([MASS], [GROUP | {"matrix": [[1, 1], [1, 1]]}], f"{C0}.matrix", "", "must be positive definite"),
    ([MASS], [GROUP | {"fields": ["chaser.mass", "debris.mass"]}], f"{C0}.fields", '"debris.mass"', "is not dispersed"),
    ([MASS, DEBRIS], [GROUP | {"fields": ["debris.mass", "chaser.mas"]}], f"{C0}.fields", '"chaser.mas"',
     "did you mean chaser.mass?"),
    (ALL, [GROUP | {"fields": ["chaser.mass", "chaser.position"]}], f"{C0}.fields", '"chaser.position"',
     "such as chaser.position.x"),
    (ALL, [GROUP | {"fields": ["chaser.mass", "debris.attitude"]}], f"{C0}.fields", '"debris.attitude"', "drawn as a whole"),
    (ALL, [GROUP, GROUP | {"fields": ["chaser.mass", "debris.mass"]}], "correlations[1].fields", '"chaser.mass"',
     "in correlations[0] already"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("dispersions", "correlations", "field", "value", "words"),
    REFUSED,
    ids=[f"{row[2]}: {row[4][:30]}" for row in REFUSED],
)
def test_each_bad_dispersion_is_refused_with_key_value_and_reason(
    paper: Scenario, dispersions: Any, correlations: Any, field: str, value: str, words: str
) -> None:
    with pytest.raises(ScenarioError) as refusal:
        given(paper, dispersions, correlations)
    assert [(fault.path, fault.value) for fault in refusal.value.faults] == [(field, value)]
    assert words in str(refusal.value)
    assert str(refusal.value).startswith("my6u.toml: 1 problem\n  ")


def test_limits_without_bound_have_no_spread_about_them(paper: Scenario) -> None:
    paper.actuators.force_limit = math.inf
    with pytest.raises(ScenarioError, match="nothing lies about that"):
        given(paper, only("actuators.force_limit", "normal", relative=0.1))
    given(paper, only("actuators.force_limit", "uniform", low=0.05, high=0.1))


def test_an_inertia_must_be_a_rigid_bodys_and_its_draws_within_range(paper: Scenario) -> None:
    paper.belief.stack_inertia = (0.1, 0.1, 0.5)
    with pytest.raises(ScenarioError, match="no rigid body has that"):
        given(paper, only("belief.stack_inertia", "inertia", relative=0.1))
    paper.debris.inertia = (6e5, 6e5, 8e5)
    with pytest.raises(
        ScenarioError, match=r"relative  0\.1: draws reach 1\.611e6 kg m², but debris.inertia must be at least"
    ):
        given(paper, only("debris.inertia", "inertia", relative=0.1))
    paper.debris.inertia = (5e-9, 5e-9, 5e-9)
    with pytest.raises(ScenarioError, match=r"principal moment of 6\.12282e-10; must be at least 1e-9"):
        given(paper, only("debris.inertia", "inertia", relative=0.3))


def test_a_stack_that_is_known_truly_has_no_belief_to_disperse(paper: Scenario) -> None:
    paper.belief.stack = "true"
    with pytest.raises(ScenarioError, match=r'needs belief\.stack = "design"'):
        given(paper, only("belief.stack_mass", "normal", sigma=0.1))


def test_faults_of_dispersions_stand_beside_all_others_of_the_file(paper: Scenario) -> None:
    raw = paper.to_dict()
    raw["chaser"]["mass"] = -9.0
    raw["capture"]["distanc"] = raw["capture"].pop("distance")
    raw["dispersions"] = [
        MASS,
        *only("capture.distance", "uniform", low=0.1, high=0.2),
        *only("debris.mass", "normal", sigma=5.0),
        *only("belief.stack_mass", "normal", sigma=0.1),
        *only("debris.tumble", "direction"),
    ]
    raw["correlations"] = [
        GROUP | {"fields": ["chaser.mass", "debris.mass"]},
        GROUP | {"fields": ["capture.distance", "goal"]},
    ]
    with pytest.raises(ScenarioError) as refusal:
        validated(raw, "my6u.toml")
    found = [fault.path for fault in refusal.value.faults]
    expected = [
        "chaser.mass",
        "capture.distanc",
        "dispersions[2].sigma",
        "dispersions[4].field",
        "correlations[1].fields",
    ]
    assert found == expected
    assert "did you mean debris.tumble_rate?" in str(refusal.value)


def test_faults_of_dispersions_are_found_beside_a_broken_one(paper: Scenario) -> None:
    bad = [*only("chaser.mass", "normal", sigma=-1.0), *only("debris.mass", "normal", sigma=5.0)]
    with pytest.raises(ScenarioError) as refusal:
        given(paper, bad, [GROUP | {"fields": ["chaser.mass", "debris.mass"]}])
    assert [fault.path for fault in refusal.value.faults] == ["dispersions[0].sigma", "dispersions[1].sigma"]


@pytest.mark.parametrize("key", ["duration", "control_period", "mass", "distance"])
def test_a_misspelt_key_that_others_depend_on_is_one_fault(paper: Scenario, key: str) -> None:
    text = paper.to_toml().replace(f"\n{key} = ", f"\n{key}x = ", 1)
    with pytest.raises(ScenarioError) as refusal:
        from_toml(text, "my6u.toml")
    assert [fault.path.rpartition(".")[2] for fault in refusal.value.faults] == [f"{key}x"]


# Draws


def test_runs_are_the_same_however_many_are_drawn(dispersed: Scenario) -> None:
    long = draw(dispersed, 1, 0, 5000)
    for first, count in ((0, 1000), (500, 1000), (4999, 1), (17, 0)):
        for path, values in draw(dispersed, 1, first, count).items():
            assert np.array_equal(values, long[path][first : first + count]), path
    assert {path: values.shape for path, values in long.items()} == {
        "chaser.mass": (5000,),
        "debris.mass": (5000,),
        "capture.distance": (5000,),
        "laws.prrl.translation.gain": (5000,),
        "chaser.position": (5000, 3),
        "debris.tumble_rate": (5000, 3),
        "chaser.attitude": (5000, 4),
        "debris.attitude": (5000, 4),
        "chaser.inertia": (5000, 6),
        "debris.inertia": (5000, 6),
    }


def test_seeds_fields_and_runs_have_numbers_of_their_own(paper: Scenario) -> None:
    scenario = given(
        paper,
        [{"field": path, "distribution": "uniform", "low": 1, "high": 2} for path in ("chaser.mass", "debris.mass")],
    )
    drawn = [values for seed in (0, 1, 2**32, 2**64 - 1) for values in draw(scenario, seed, 2**40, 1000).values()]
    assert np.unique(np.concatenate(drawn)).size == 8000


def test_draws_do_not_change_when_other_dispersions_come_go_or_move(dispersed: Scenario, paper: Scenario) -> None:
    together = draw(dispersed, 3, 0, 200)
    for path, values in draw(given(paper, [*ALL[5:], *ALL[:5]], [GROUP]), 3, 0, 200).items():
        assert np.array_equal(values, together[path]), path
    for dispersion in ALL:
        if dispersion["field"] != "chaser.position":
            alone = draw(given(paper, [dispersion]), 3, 0, 200)
            assert np.array_equal(alone[dispersion["field"]], together[dispersion["field"]]), dispersion


def fnv_1a(path: str) -> int:
    number = 0xCBF29CE484222325
    for byte in path.encode():
        number = (number ^ byte) * 0x100000001B3 % 2**64
    return number


def philox(counter: list[int], key: list[int]) -> list[int]:
    """Philox4x32-10 as published: Salmon et al., SC'11."""
    for _ in range(10):
        even, odd = counter[0] * 0xD2511F53, counter[2] * 0xCD9E8D57
        counter = [odd >> 32 ^ counter[1] ^ key[0], odd % 2**32, even >> 32 ^ counter[3] ^ key[1], even % 2**32]
        key = [(key[0] + 0x9E3779B9) % 2**32, (key[1] + 0xBB67AE85) % 2**32]
    return counter


def test_numbers_are_named_by_seed_run_and_path_as_documented(paper: Scenario) -> None:
    seed, first = 0x0123_4567_89AB_CDEF, 2**32 - 2
    scenario = given(paper, only("chaser.position", "uniform", low=0.0, high=1.0))
    named = fnv_1a("chaser.position")
    step, block = named % 2**32, 2**31 | (named >> 32 << 4) % 2**31
    for offset, row in enumerate(draw(scenario, seed, first, 4)["chaser.position"]):
        run = first + offset
        words: list[int] = []
        for k in (0, 1):
            counter = [step, block | k, run >> 32, seed >> 32]
            words += philox(counter, [seed % 2**32, run % 2**32])
        pairs = zip(words[0:6:2], words[1:6:2], strict=True)
        assert row.tolist() == [(2 * (high << 20 | low >> 12) + 1) * 2.0**-53 for high, low in pairs]


def test_no_two_fields_share_random_numbers() -> None:
    places = {(fnv_1a(path) % 2**32, (fnv_1a(path) >> 32 << 4) % 2**31) for path in fields()}
    assert len(places) == len(fields()) > 80


def test_every_field_named_can_be_dispersed_and_reaches_the_case(paper: Scenario) -> None:
    scenario = with_settings(load("twelve_u"), ["goal={}", "laws=" + json_as_toml(paper.to_dict()["laws"])])
    for path, quantity in fields().items():
        nominal = scenario.at(path)
        if nominal is None:
            continue
        if quantity.shape == "quaternion":
            dispersion = only(path, "attitude")
        elif quantity.shape == "inertia":
            dispersion = only(path, "inertia", relative=0.1, axes="uniform")
        else:
            dispersion = only(
                path, "uniform", low=quantity.range.least or 0.2, high=(quantity.range.least or 0.2) + 0.1
            )
        run = drawn_scenario(given(scenario, dispersion), 0, 0)
        laws = [law for law in detumble.LAWS if case(run, law) != case(scenario, law)]
        assert laws, path


def json_as_toml(tables: dict[str, Any]) -> str:
    from detumble.scenario.toml import literal

    return literal(tables)


# Runs as scenarios


def test_a_run_is_a_scenario_with_the_drawn_values_and_no_dispersions(dispersed: Scenario) -> None:
    drawn, run = draw(dispersed, 9, 0, 8), drawn_scenario(dispersed, 9, 7)
    assert run.dispersions == run.correlations == []
    assert from_toml(run.to_toml()) == run
    assert run.chaser.mass == drawn["chaser.mass"][7]
    assert run.chaser.position == tuple(drawn["chaser.position"][7])
    assert run.chaser.attitude == tuple(drawn["chaser.attitude"][7])
    assert run.at("laws.prrl.translation.gain") == drawn["laws.prrl.translation.gain"][7]
    tensor = np.array(run.chaser.inertia)
    assert tensor[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]].tolist() == drawn["chaser.inertia"][7].tolist()
    assert np.array_equal(tensor, tensor.T)


def test_a_run_flown_as_a_scenario_has_every_bit_of_its_draws(dispersed: Scenario) -> None:
    drawn = draw(dispersed, 4, 0, 50)
    for index in range(50):
        run = case(drawn_scenario(dispersed, 4, index), "prrl")
        assert run["chaser"]["mass"] == drawn["chaser.mass"][index]
        assert run["start"]["chaser_attitude"] == drawn["chaser.attitude"][index].tolist()
        assert run["start"]["debris_attitude"] == drawn["debris.attitude"][index].tolist()
        assert run["start"]["debris_rate"] == drawn["debris.tumble_rate"][index].tolist()
        xx, yy, zz, xy, xz, yz = drawn["debris.inertia"][index].tolist()
        assert run["debris"]["inertia"] == [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]


def test_one_number_for_all_axes_stays_one(paper: Scenario) -> None:
    paper.actuators.torque_limit = (0.01, 0.02, 0.03)
    both = [
        *only("actuators.force_limit", "normal", relative=0.05),
        *only("actuators.torque_limit", "normal", relative=0.05),
    ]
    scenario = given(paper, both)
    assert draw(scenario, 0, 0, 5)["actuators.force_limit"].shape == (5,)
    assert draw(scenario, 0, 0, 5)["actuators.torque_limit"].shape == (5, 3)
    run = drawn_scenario(scenario, 0, 0)
    assert isinstance(run.actuators.force_limit, float)
    assert len(set(np.divide(run.actuators.torque_limit, paper.actuators.torque_limit))) == 3


def test_the_laws_go_on_believing_the_design(dispersed: Scenario, paper: Scenario) -> None:
    believed = case(paper, "prrl")["belief"]
    for index in range(3):
        run = case(drawn_scenario(dispersed, 0, index), "prrl")
        assert run["belief"] == believed
        assert run["chaser"]["mass"] != believed["chaser_mass"]
        assert run["chaser"]["inertia"] != believed["chaser_inertia"]


def test_only_beliefs_about_dispersed_bodies_are_written_out(paper: Scenario) -> None:
    run = drawn_scenario(given(paper, only("debris.mass", "normal", sigma=0.1)), 0, 0)
    assert run.belief.stack_mass == 14.0
    assert run.belief.chaser_mass is run.belief.chaser_inertia is run.belief.stack_inertia is None
    paper.belief.stack_mass = 13.0
    assert drawn_scenario(given(paper, only("debris.mass", "normal", sigma=0.1)), 0, 0).belief.stack_mass == 13.0
    paper.belief.stack_mass = None
    paper.belief.stack = "true"
    told = drawn_scenario(given(paper, only("chaser.mass", "normal", sigma=0.1)), 0, 0)
    assert told.belief.stack_mass is None
    assert told.belief.chaser_mass == 9.0


def test_beliefs_left_to_default_are_dispersed_about_the_design(paper: Scenario) -> None:
    both = [*only("belief.stack_mass", "normal", sigma=0.1), *only("belief.stack_inertia", "inertia", relative=0.05)]
    scenario = given(paper, both)
    masses = draw(scenario, 0, 0, 10_000)["belief.stack_mass"]
    assert masses.mean() == pytest.approx(14.0, abs=0.005)
    inertia = draw(scenario, 0, 0, 10_001)["belief.stack_inertia"]
    assert np.median(inertia, axis=0) == pytest.approx([0.15, 0.15, 0.13, 0, 0, 0], abs=5e-4)
    run = drawn_scenario(scenario, 0, 4)
    assert (run.chaser, run.debris) == (scenario.chaser, scenario.debris)
    assert run.belief.stack_mass == masses[4]
    assert run.belief.chaser_mass is None


def test_a_run_flies(short: Scenario) -> None:
    scenario = given(short, ALL, [GROUP])
    flights = [detumble.simulate(drawn_scenario(scenario, 0, index)) for index in range(2)]
    starts = [flight.data.position[0].to_numpy() for flight in flights]
    assert np.array_equal(starts, draw(scenario, 0, 0, 2)["chaser.position"])


def test_a_diagonal_inertia_stays_exactly_diagonal(paper: Scenario) -> None:
    drawn = draw(given(paper, only("chaser.inertia", "inertia", relative=0.3)), 0, 0, 1000)["chaser.inertia"]
    off = drawn[:, 3:]
    assert not off.any()
    assert not np.signbit(off).any()


def test_the_core_refuses_names_that_it_does_not_know(dispersed: Scenario) -> None:
    recipe = spec(dispersed)
    recipe["dispersions"][0]["distribution"]["elements"][0]["sigmaa"] = 1.0
    with pytest.raises(Exception, match="unknown field `sigmaa`"):
        core().draw(recipe, 0, 0, 1)
