"""A scenario for a plant check alone: no goal, no capture, no actuators."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

import detumble
from commands import call
from detumble.scenario import from_toml

PLANT = """
title = "plant check"
[time]
duration = 10.0
control_period = 0.1
[orbit]
altitude = 700e3
[chaser]
mass = 9.0
inertia = [0.1, 0.1, 0.05]
position = [1.0, 2.0, 3.0]
[debris]
mass = 5.0
inertia = [0.05, 0.05, 0.08]
tumble_rate = [0.1, 0.0, 0.0]
"""
PUSH = """
[[laws.none.segments]]
start = 0.0
end = 5.0
force = [1000.0, 0.0, 0.0]
"""


def test_it_flies_without_limit_and_is_never_captured() -> None:
    flight = detumble.simulate(from_toml(PLANT + PUSH))
    assert flight.law == "none"
    assert flight.metrics.capture_time is None
    assert flight.metrics.peak_force == 1000.0
    assert flight.warnings == ()


def test_it_comes_back_from_a_file_as_it_was(tmp_path: Path) -> None:
    scenario = from_toml(PLANT + PUSH)
    text = scenario.to_toml()
    assert "[capture]" not in text
    assert "[actuators]" not in text
    assert from_toml(text) == scenario
    detumble.simulate(scenario).to_netcdf(tmp_path / "flight.nc")
    assert detumble.read_netcdf(tmp_path / "flight.nc").scenario == scenario


def test_what_needs_them_asks_for_them() -> None:
    scenario = from_toml(PLANT)
    with pytest.raises(detumble.ScenarioError, match="capture  missing"):
        detumble.bound(scenario)
    with pytest.raises(detumble.ScenarioError, match=r"laws\.prrl  missing; this scenario has gains for no law"):
        detumble.simulate(scenario, "prrl")
    gains = "[laws.pd]\ntranslation = { kp = 1, kd = 1 }\nrotation = { kp = 1, kd = 1 }\n"
    with pytest.raises(detumble.ScenarioError) as caught:
        from_toml(PLANT + gains)
    assert {fault.path for fault in caught.value.faults} == {"goal.position", "capture", "actuators"}
    given = "[goal]\nposition = [0, 0, 0]\n[capture]\ndistance = 0.5\nangle_deg = 20\nrate = 0.05\n"
    given += "[actuators]\nforce_limit = 0.1\ntorque_limit = 0.01\n"
    assert detumble.simulate(from_toml(PLANT + given + gains)).law == "pd"


def test_a_law_with_the_only_gains_flies_unless_another_is_named(tmp_path: Path) -> None:
    raw = detumble.load("paper").to_dict()
    raw["time"]["duration"] = 2.0
    lqr = raw["laws"]["lqr"]
    raw["laws"] = {"lqr": lqr}
    scenario = detumble.Scenario.model_validate(raw)
    scenario.save(tmp_path / "only.toml")
    assert detumble.simulate(scenario).law == "lqr"
    assert detumble.campaign(scenario, runs=2).recipe.law == "lqr"
    for command in (("run",), ("campaign", "--runs", "2", "--out", "c"), ("tune", "--budget", "1", "--starts", "1")):
        done = call(command[0], "only.toml", *command[1:], cwd=tmp_path)
        assert done.code == 0, done.err
        assert "LQR" in done.out
    assert detumble.simulate(detumble.load("paper")).law == "prrl"
    assert call("run", "only.toml", "--law", "", cwd=tmp_path).code == 2


def test_no_limit_is_infinite_not_zero() -> None:
    scenario = from_toml(PLANT)
    assert scenario.actuators.force_limit == math.inf
    assert scenario.actuators.torque_limit == math.inf
