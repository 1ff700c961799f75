"""What was probably meant: units in keys, symbols of papers, values that are possible but seldom intended."""

from __future__ import annotations

import math
from typing import Any

import pytest

import detumble
from detumble.scenario import Scenario, from_toml, with_settings
from detumble.scenario.hints import SYMBOLS, UNITS
from detumble.scenario.laws import CHANNELS, REGISTER
from detumble.scenario.laws.base import gains_of_section
from detumble.scenario.reflection import section_at


def fault_of(text: str, path: str) -> str:
    with pytest.raises(detumble.ScenarioError) as caught:
        from_toml(text)
    found = [fault.text for fault in caught.value.faults if fault.path == path]
    assert len(found) == 1, caught.value
    return found[0]


@pytest.mark.parametrize(
    ("table", "line", "hint"),
    [
        ("sensors", "attitude_sigma_deg = 0.5", "attitude_sigma, in rad? 0.5 deg is 0.00872665 rad"),
        ("sensors", "attitude_sigma_arcsec = 60", "attitude_sigma, in rad? 60 arcsec is 2.90888e-4 rad"),
        ("sensors", "position_sigma_mm = 2.0", "position_sigma, in m? 2 mm is 0.002 m"),
        ("capture", "angle_rad = 0.1", "angle_deg, in deg? 0.1 rad is 5.72958 deg"),
        ("capture", "rate_deg_s = 3", "rate, in rad/s? 3 deg/s is 0.0523599 rad/s"),
        ("debris", "tumble_rate_deg = [4, 0, -4]", "tumble_rate, in rad/s? [4, 0, -4] deg/s is [0.0698132, 0, -0.0698132] rad/s"),
        ("debris", "tumble_rate_rpm = [1, 0, 0]", "tumble_rate, in rad/s? [1, 0, 0] rpm is [0.10472, 0, 0] rad/s"),
        ("chaser", "mass_g = 9000", "mass, in kg? 9000 g is 9 kg"),
        ("chaser", "inertia_kg_cm2 = [1000, 1000, 500]", "[1000, 1000, 500] kg cm² is [0.1, 0.1, 0.05] kg m²"),
        ("chaser", "position_km = [1, 0, 0]", "position, in m? [1, 0, 0] km is [1000, 0, 0] m"),
        ("actuators", "force_limit_mN = 100", "force_limit, in N? 100 mN is 0.1 N"),
        ("orbit", "mu_km3_s2 = 398600.0", "3.986e5 km³/s² is 3.986e14 m³/s²"),
        ("orbit", "altitude_km = 700", "altitude, in m? 700 km is 700e3 m"),
        ("time", "duration_min = 10", "duration, in s? 10 min is 600 s"),
    ],
)  # fmt: skip
def test_a_unit_in_a_key_is_named_and_the_value_converted(table: str, line: str, hint: str) -> None:
    said = fault_of(f"[{table}]\n{line}\n", f"{table}.{line.split(' ')[0]}")
    assert said.startswith("unknown key; did you mean ")
    assert hint in said


def test_a_unit_of_another_kind_is_not_converted() -> None:
    assert fault_of("[chaser]\nmass_mm = 9\n", "chaser.mass_mm") == "unknown key; did you mean mass, in kg?"
    assert "is" not in fault_of('[chaser]\nmass_g = "9 kg"\n', "chaser.mass_g").split("?")[1]


def test_mega_is_not_taken_for_milli_and_huge_numbers_for_none_at_all() -> None:
    assert fault_of("[actuators]\nforce_limit_MN = 5\n", "actuators.force_limit_MN").endswith(
        "did you mean force_limit, in N?"
    )
    huge = f"[chaser]\nmass_g = 1{'0' * 400}\n"
    assert fault_of(huge, "chaser.mass_g").endswith("did you mean mass, in kg?")
    for setting in (f"laws.tsmc.translation.p=1{'0' * 400}", f"chaser.mass=1{'0' * 400}"):
        with pytest.raises(detumble.ScenarioError):
            with_settings(detumble.load("paper"), [setting])


def test_every_ending_has_one_meaning() -> None:
    assert all(factor > 0.0 for factor, _ in UNITS.values())
    assert UNITS["deg"][0] == pytest.approx(math.pi / 180.0)
    assert {unit for _, unit in UNITS.values()} == {
        "rad",
        "rad/s",
        "m",
        "m/s",
        "kg",
        "s",
        "N",
        "N m",
        "kg m^2",
        "m^3/s^2",
    }


@pytest.mark.parametrize(
    ("table", "key", "field"),
    [
        ("laws.prrl.translation", "c", "slope"),
        ("laws.prrl.rotation", "Lambda", "slope"),
        ("laws.prrl.rotation", '"φ"', "layer"),
        ("laws.sosmc.rotation", "k", "gain"),
        ("laws.sosmc.rotation", "alpha", "proportional"),
        ("laws.tsmc.translation", "alpha", "slope"),
        ("laws.tsmc.translation", "beta", "gain"),
        ("laws.lqr.translation", "q_r", "q_error"),
        ("laws.lqr.rotation", "q_w", "q_rate"),
        ("laws.lqr.rotation", "R", "r"),
        ("laws.pd.rotation", "K_p", "kp"),
        ("laws.prrl", "phi", "translation.layer and rotation.layer"),
        ("goal", "r_des", "position"),
        ("chaser", "omega", "rate"),
        ("debris", "omega", "tumble_rate"),
        ("debris", "I_d", "inertia"),
        ("actuators", "tau_max", "torque_limit"),
        ("sensors", "sigma_r", "position_sigma"),
    ],
)
def test_a_symbol_of_the_paper_is_led_to_our_name(table: str, key: str, field: str) -> None:
    said = fault_of(f"[{table}]\n{key} = 1\n", f"{table}.{key.strip(chr(34))}")
    assert said == f"unknown key; did you mean {field}?"


def test_a_symbol_at_the_top_is_led_to_its_table() -> None:
    assert fault_of("r_des = [0, 0, 0]\n", "r_des") == "unknown key; did you mean goal.position?"


def test_every_symbol_stands_for_one_field() -> None:
    for table, symbols in SYMBOLS.items():
        section = section_at(Scenario, (table,))
        assert section is not None
        assert set(symbols.values()) <= set(section.model_fields), table
    for law in REGISTER.values():
        for channel in (law, *map(law.channel, CHANNELS)):
            declared = [symbol for gain in gains_of_section(channel).values() for symbol in gain.symbols]
            assert len(declared) == len(set(declared)), channel


def warned(*settings: str) -> list[str]:
    return list(with_settings(detumble.load("paper"), settings).warnings)


@pytest.mark.parametrize(
    ("setting", "said"),
    [
        ("debris.tumble_rate=[4.0, 0, 0]", "debris.tumble_rate: 4 rad/s is 229.2 °/s; if degrees were meant: [0.0698132, 0, 0]"),
        ("chaser.rate=[0, 0, 2.0]", "chaser.rate: 2 rad/s"),
        ("capture.rate=3", "capture.rate: 3 rad/s"),
        ("sensors.attitude_sigma=0.5", "sensors.attitude_sigma: 0.5 rad is 28.65 °; if degrees were meant: 0.00872665 rad"),
        ("chaser.inertia=[9e3, 9e3, 9e3]", "radius of gyration of 31.62 m"),
        ("debris.inertia=[1e6, 1e6, 1e6]", "debris.inertia: of 5 kg"),
        ("chaser.position=[0, 8e4, 0]", "1.1 % of the orbit's radius"),
        ("chaser.inertia=[0.0833, 0.0833, 0.1667]", "0.1666 kg m² is flown"),
        ("chaser.inertia=[[0.1,0.0012346,0],[0.00123,0.1,0],[0,0,0.05]]", "symmetric only to 4.6e-06 kg m²"),
    ],
)  # fmt: skip
def test_a_value_that_is_seldom_meant_is_asked_about(setting: str, said: str) -> None:
    found = warned(setting)
    assert len(found) == 1
    assert said in found[0]
    flight = detumble.simulate(with_settings(detumble.load("paper"), [setting, "time.duration=1"]), "pd")
    assert found[0] in flight.warnings


@pytest.mark.parametrize(
    ("dispersion", "said"),
    [
        (
            'field="debris.tumble_rate", distribution="direction", low=1, high=40',
            "debris.tumble_rate: draws reach 40 rad/s",
        ),
        ('field="chaser.rate", distribution="normal", sigma=0.7', "chaser.rate: draws reach 1.4 rad/s"),
        ('field="sensors.attitude_sigma", distribution="uniform", low=0.01, high=0.9', "draws reach 0.9 rad"),
        ('field="chaser.position", distribution="normal", sigma=5e4', "chaser.position: draws reach 1e+05 m"),
    ],
)
def test_draws_that_are_seldom_meant_are_asked_about(dispersion: str, said: str) -> None:
    found = [each for each in warned(f"dispersions=[{{{dispersion}}}]") if "draws reach" in each]
    assert len(found) == 1
    assert said in found[0]


def test_what_is_usual_is_not_asked_about() -> None:
    for name in detumble.scenarios():
        assert detumble.load(name).warnings == ()
    assert (
        warned("debris.tumble_rate=[0.9, 0, 0]", "chaser.inertia=[8e3, 8e3, 8e3]", "chaser.position=[0, 7e4, 0]") == []
    )


def test_a_gravitational_parameter_in_kilometres_gets_the_hint() -> None:
    with pytest.raises(detumble.ScenarioError, match=r"did you mean 3\.986004418e14\?"):
        warned("orbit.mu=398600.4418")


@pytest.mark.parametrize(
    ("form", "given", "flown"), [("corrected", "p = 7, q = 5", "3/5"), ("printed", "p = 7", "7/3")]
)
def test_an_exponent_that_is_not_given_is_reported(form: str, given: str, flown: str) -> None:
    raw: dict[str, Any] = detumble.load("paper").to_dict()
    del raw["laws"]
    law = f'form = "{form}"\ntranslation = {{ slope = 0.1, gain = 0.1, layer = 0.1, {given} }}\n'
    law += "rotation = { slope = 0.1, gain = 0.1, layer = 0.1, p = 5, q = 3, p_corrected = 3, q_corrected = 5 }\n"
    scenario = from_toml(Scenario.model_validate(raw).to_toml() + f"\n[laws.tsmc]\n{law}")
    (said,) = scenario.warnings
    assert said.startswith("laws.tsmc.translation: ")
    assert f"= {flown}" in said
    scenario.time.duration = 1.0
    assert said in detumble.simulate(scenario, "tsmc").warnings


def test_exponents_of_the_other_form_are_refused_by_name() -> None:
    said = fault_of(
        '[laws.tsmc]\nform = "corrected"\nrotation = { slope = 1, gain = 1, layer = 1, p = 3, q = 5 }\n',
        "laws.tsmc.rotation.p",
    )
    assert "p_corrected/q_corrected" in said
    assert "printed form" in said
