"""The output of `detumble schema` alone makes the core's case, and the columns of a campaign, from a scenario's dict.

`Interpreter` is what a program without Python would do: it has conversions of its own, and nothing of `detumble.scenario`.
"""

from __future__ import annotations

import json
import math
from functools import cache, reduce
from operator import add
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from typer.testing import CliRunner

import detumble
from detumble.campaigns.runs.draws import draw
from detumble.campaigns.runs.overlay import overlay
from detumble.commands.app import app
from detumble.scenario import LAWS, Scenario, built_in, from_toml, with_settings
from detumble.scenario.core import case
from detumble.scenario.faults import validated
from detumble.scenario.laws import REGISTER
from detumble.scenario.step import integration_step

if TYPE_CHECKING:
    from collections.abc import Container, Iterator

Tree = dict[str, Any]
RUNS = 5
GRASP = [
    "chaser.grasp_point=[-0.1, 0.02, 0.01]", "debris.grasp_point=[0.1, 0.2, -0.04]", "capture.dwell=1.25",
    "goal={acceleration_feedforward=true}", "belief={stack='true'}", "orbit.radius=7071e3", "dispersions=[]",
    "chaser.attitude=[0.9598, 0.24, -0.12, 0.08]", "campaign.hold=1e6",
]  # fmt: skip
OPEN_LOOP = """
title = "pushed"
[time]
duration = 10.0
control_period = 0.1
[orbit]
radius = 7071e3
[chaser]
mass = 9.0
inertia = [[0.1, 0.01, 0.0], [0.01, 0.1, 0.0], [0.0, 0.0, 0.05]]
position = [0.0, 0.0, 0.0]
[debris]
mass = 5.0
inertia = [0.05, 0.05, 0.08]
tumble_rate = [0.1, 0.0, 0.0]
[[laws.none.segments]]
start = 0.3
end = 5.0
force = [1.0, 0.0, 0.0]
[[laws.none.segments]]
start = 6.0
end = 99.0
frame = "body"
"""

TENSOR = (0, 3, 4, 3, 1, 5, 4, 5, 2)
PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


def ticks(time: float, period: float) -> int:
    return max(0, math.ceil(time / period - 1e-9 * max(1.0, time / period)))


def total(*terms: list[float]) -> list[float]:
    return [reduce(add, column) for column in zip(*terms, strict=True)]


CONVERSIONS: dict[str, Any] = {
    "number": lambda x: x,
    "degrees": lambda x: [element * (math.pi / 180.0) for element in x],
    "per_axis": lambda x: x * 3 if len(x) == 1 else x,
    "tensor": lambda *inertias: [total(*inertias)[place] for place in TENSOR],
    "total": total,
    "ratio": lambda p, q: [p[0] / q[0]],
    "mean_motion": lambda mu, *radius: [math.sqrt(mu[0] / math.prod(total(*radius) * 3))],
    "zeros": lambda: [0.0] * 3,
    "infinite": lambda: [math.inf],
    "unlimited": lambda: [math.inf] * 3,
    "word": lambda x: x,
    "steps": lambda step, period: max(1, ticks(period, step)),
    "nearest_tick": lambda time, period: round(time / period),
    "tick_within": lambda time, end, period: min(round(time / period), round(end / period) + 1),
    "wait": lambda time, end, period: ticks(min(time, (round(end / period) + 1) * period), period),
}


class Interpreter:
    """Makes the core's case of a scenario's dict, to which `flight` and a resolved integration step have been added."""

    def __init__(self, declared: Tree, scenario: Tree) -> None:
        self.declared, self.scenario = declared, scenario
        law = declared["laws"][scenario["flight"]["law"]]
        self.number_rules, self.plan_rules = declared["numbers"] | law["numbers"], declared["plan"] | law["plan"]

    def at(self, path: str) -> Any:
        *tables, name = path.split(".")
        table: Any = self.scenario
        for step in tables:
            table = (table or {}).get(step)
        if table is None and len(tables) > 1:
            return None
        return (table or {}).get(name, self.declared["fields"].get(path, {}).get("default"))

    def numbers(self, path: str) -> list[float]:
        value, shape = self.at(path), self.declared["fields"][path]["shape"]
        if shape == "inertia" and isinstance(value[0], list | tuple):
            return [(value[i][j] + value[j][i]) / 2 for i, j in PAIRS]
        numbers = list(value) if isinstance(value, list | tuple) else [value]
        norm = math.hypot(*numbers) if shape == "quaternion" else 1.0
        numbers = [number / norm for number in numbers] if abs(norm - 1.0) > 1e-15 else numbers
        return numbers + [0.0] * 3 if shape == "inertia" else numbers

    def rule(self, rules: list[Tree], drawn: Container[str] = ()) -> Tree:
        for rule in rules:
            met = all(self.at(path) == value for path, value in rule.get("when", {}).items())
            if met and all(path in drawn or self.at(path) is not None for path in rule.get("of", ())):
                return rule
        raise LookupError(rules)

    def word(self, rules: list[Tree]) -> Any:
        rule = self.rule(rules)
        return rule["value"] if "value" in rule else CONVERSIONS[rule["conversion"]](*map(self.at, rule["of"]))

    def case(self) -> Tree:
        found = {path: self.word(rules) for path, rules in self.plan_rules.items()}
        for path, rules in self.number_rules.items():
            rule = self.rule(rules)
            found[path] = CONVERSIONS[rule["conversion"]](*map(self.numbers, rule.get("of", ())))
        if self.at("flight.law") == "none":
            segments = (self.at("laws.none.segments") or []) if self.at("laws.none") else []
            inner = [Interpreter(self.declared, self.scenario | {"segment": segment}) for segment in segments]
            found["law.segments"] = [
                {key: one.word(rules) for key, rules in self.declared["segment"].items()} for one in inner
            ]
        return found

    def columns(self, drawn: dict[str, list[list[float]]]) -> dict[str, list[list[float]]]:
        found = {}
        for path, rules in self.number_rules.items():
            rule = self.rule(rules, drawn)
            read = [drawn.get(field) or [self.numbers(field)] * RUNS for field in rule.get("of", ())]
            if not rule.get("design") and not drawn.keys().isdisjoint(rule.get("of", ())):
                found[path] = [CONVERSIONS[rule["conversion"]](*row) for row in zip(*read, strict=True)]
        return found


@cache
def declared() -> Tree:
    printed = CliRunner().invoke(app, ["schema"])
    return dict(json.loads(printed.output)["x-core"])


def interpreter(scenario: Scenario, law: str) -> Interpreter:
    raw = scenario.to_dict()
    raw["time"]["integration_step"] = integration_step(scenario)
    raw = json.loads(json.dumps(raw))
    return Interpreter(declared(), raw | {"flight": {"law": law, "whole": True}})


def flat(tree: Tree, path: str = "") -> Tree:
    """Give a case of the core by path, every number as a list, a matrix row by row."""
    found: Tree = {}
    for name, value in tree.items():
        if isinstance(value, dict):
            found |= flat(value, f"{path}{name}.")
        else:
            found[path + name] = value
    return found


def as_lists(case_by_path: Tree) -> Tree:
    """Give floats as lists of one, and matrices row by row, but in the plan."""

    def plain(path: str, value: Any) -> Any:
        if path.startswith("plan.") or isinstance(value, str) or path == "law.segments":
            return value
        return np.array(value).reshape(-1).tolist()

    return {path: plain(path, value) for path, value in case_by_path.items()}


def spread() -> Scenario:
    """Disperse an inertia, an angle in degrees, the altitude, a gain of one axis each, and the power of every channel."""
    raw = detumble.load("paper").to_dict()
    raw["laws"]["prrl"]["rotation"]["alpha"] = 0.5
    raw["laws"]["prrl"]["translation"]["slope"] = [0.1, 0.12, 0.14]
    raw["laws"]["prrl"]["stack"] = {"rotation": raw["laws"]["prrl"]["rotation"] | {"alpha": 0.6}}
    raw["dispersions"] = [
        {"field": "debris.inertia", "distribution": "inertia", "relative": 0.1},
        {"field": "capture.angle_deg", "distribution": "uniform", "low": 10.0, "high": 30.0},
        {"field": "orbit.altitude", "distribution": "uniform", "low": 5e5, "high": 9e5},
        {"field": "actuators.force_limit", "distribution": "normal", "relative": 0.02},
        {"field": "belief.stack_mass", "distribution": "normal", "relative": 0.02},
        {"field": "laws.prrl.translation.slope", "distribution": "normal", "relative": 0.05},
        {"field": "laws.prrl.alpha", "distribution": "uniform", "low": 0.3, "high": 0.8},
        {"field": "laws.prrl.stack.rotation.alpha", "distribution": "uniform", "low": 0.3, "high": 0.8},
    ]
    return validated(raw, "spread")


def cases() -> Iterator[tuple[str, Scenario, str]]:
    for name in built_in():
        scenario = detumble.load(name)
        for law in (*scenario.laws.closed_loop, "none"):
            yield f"{name}, {law}", scenario, law
            if law != "none" and REGISTER[law].forms():
                yield f"{name}, {law} corrected", with_settings(scenario, [f"laws.{law}.form=corrected"]), law
    yield "grasp points, own stack", with_settings(spread(), GRASP), "prrl"
    yield "open loop alone", from_toml(OPEN_LOOP), "none"


CASES = {name: (scenario, law) for name, scenario, law in cases()}


@pytest.mark.parametrize("name", CASES)
def test_the_schema_alone_makes_the_cores_case(name: str) -> None:
    scenario, law = CASES[name]
    assert as_lists(interpreter(scenario, law).case()) == as_lists(flat(case(scenario, law)))


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("scenario", [detumble.load("paper_dispersed"), spread()], ids=["paper_dispersed", "spread"])
def test_the_schema_alone_makes_the_columns_of_a_campaign(scenario: Scenario, law: str) -> None:
    drawn = draw(scenario, 3, 0, RUNS)
    expected = {path: values.tolist() for path, values in overlay(scenario, law, drawn).items()}
    rows = {path: values.reshape(RUNS, -1).tolist() for path, values in drawn.items()}
    assert interpreter(scenario, law).columns(rows) == expected
    assert expected


def test_every_place_and_conversion_is_declared() -> None:
    known = declared()
    paths = set(known["plan"]) | set(known["numbers"]) | {f"law.segments.{key}" for key in known["segment"]}
    for law in known["laws"].values():
        paths |= set(law["plan"]) | set(law["numbers"])
        for rules in (known["numbers"] | known["plan"] | law["numbers"] | law["plan"]).values():
            for rule in rules:
                assert "value" in rule or rule["conversion"] in known["conversions"]
                assert set(rule.get("of", ())) <= known["fields"].keys() | {"flight.law"}
    for field in known["fields"].values():
        assert field["core"]
        assert set(field["core"]) <= paths
