"""PRRL-SMC with an alpha for each channel and phase: the short form is the long one with equal numbers."""

from __future__ import annotations

import numpy as np
import pytest

import detumble
from detumble.analysis.tuning.space import space_of
from detumble.scenario import Scenario, from_toml, with_settings
from detumble.scenario.core import case

CHANNELS = ("translation", "rotation", "stack.translation", "stack.rotation")


@pytest.fixture
def short() -> Scenario:
    """The paper's case with a set of gains for the stack, and one alpha for all."""
    scenario = with_settings(detumble.load("paper"), ["time.duration=40.0"])
    gains = scenario.to_dict()["laws"]["prrl"]
    stack = ", ".join(
        f"{channel} = {{ {', '.join(f'{name} = {0.9 * value}' for name, value in gains[channel].items())} }}"
        for channel in ("translation", "rotation")
    )
    return with_settings(scenario, [f"laws.prrl.stack={{ {stack} }}"])


def with_powers(scenario: Scenario, *powers: float) -> Scenario:
    return with_settings(
        scenario, [f"laws.prrl.{channel}.alpha={power}" for channel, power in zip(CHANNELS, powers, strict=True)]
    )


def test_the_long_form_with_equal_numbers_gives_the_bits_of_the_short_one(short: Scenario) -> None:
    long = with_powers(short, 0.7, 0.7, 0.7, 0.7)
    long.laws.prrl.alpha = None  # type: ignore[union-attr]
    one, other = (detumble.simulate(scenario, "prrl", 3) for scenario in (short, long))
    assert one.metrics == other.metrics
    assert all(one.history[name].tobytes() == other.history[name].tobytes() for name in one.history)


def test_every_channel_and_phase_flies_its_own(short: Scenario) -> None:
    law = case(with_powers(short, 0.61, 0.62, 0.63, 0.64), "prrl")["law"]
    assert (law["before"]["translation"]["alpha"], law["before"]["rotation"]["alpha"]) == (0.61, 0.62)
    assert (law["after"]["translation"]["alpha"], law["after"]["rotation"]["alpha"]) == (0.63, 0.64)
    flights = [detumble.simulate(short, "prrl")]
    flights += [
        detumble.simulate(with_settings(short, [f"laws.prrl.{channel}.alpha=0.4"]), "prrl") for channel in CHANNELS
    ]
    assert len({flight.history["chaser_rate"].tobytes() + flight.history["force"].tobytes() for flight in flights}) == 5


def test_a_channel_without_one_takes_the_laws_and_a_stack_without_gains_those_of_before() -> None:
    scenario = with_settings(detumble.load("paper"), ["laws.prrl.rotation.alpha=0.5"])
    law = case(scenario, "prrl")["law"]
    assert [law[phase]["translation"]["alpha"] for phase in ("before", "after")] == [0.7, 0.7]
    assert [law[phase]["rotation"]["alpha"] for phase in ("before", "after")] == [0.5, 0.5]


def test_one_that_is_missing_is_asked_for(short: Scenario) -> None:
    text = short.to_toml().replace("alpha = 0.7\n", "alpha = 0.7\n", 1)
    raw = "\n".join(line for line in text.splitlines() if not line.startswith("alpha = "))
    with pytest.raises(detumble.ScenarioError, match=r"laws\.prrl\.alpha  missing; needed: power of the reaching law"):
        from_toml(raw)
    with pytest.raises(detumble.ScenarioError, match=r"alpha"):
        short.laws.prrl.alpha = None  # type: ignore[union-attr]


def test_a_file_keeps_both_forms(short: Scenario) -> None:
    for scenario in (short, with_powers(short, 0.61, 0.62, 0.63, 0.64)):
        assert from_toml(scenario.to_toml()) == scenario


def test_each_is_a_gain_of_its_own_and_is_measured_by(short: Scenario) -> None:
    shared = space_of(short, "prrl")
    assert [path for path in shared.own if path.endswith("alpha")] == ["alpha"]
    mixed = space_of(with_settings(short, ["laws.prrl.rotation.alpha=0.5"]), "prrl")
    assert [path for path in mixed.own if path.endswith("alpha")] == ["alpha", "rotation.alpha"]
    own = space_of(with_powers(short, 0.61, 0.62, 0.63, 0.64), "prrl")
    assert [path for path in own.own if path.endswith("alpha")] == [f"{channel}.alpha" for channel in CHANNELS]
    point = own.point(own.own)
    for path, value in own.values(point).items():
        assert value == pytest.approx(own.own[path], rel=1e-9), path
    for space in (shared, mixed, own):
        columns = space.columns(np.stack([space.point(space.own)] * 2))
        assert {path for path in columns if path.endswith("alpha")} == {
            f"law.{phase}.{channel}.alpha" for phase in ("before", "after") for channel in ("translation", "rotation")
        }


def test_they_are_tuned_and_dispersed_one_by_one(short: Scenario) -> None:
    scenario = with_powers(short, 0.61, 0.62, 0.63, 0.64)
    tuned = detumble.tune(scenario, "prrl", budget=8, starts=2)
    assert {path for path in tuned.gains if path.endswith("alpha")} == {f"{channel}.alpha" for channel in CHANNELS}
    assert tuned.scenario.laws.prrl is not None
    assert tuned.scenario.laws.prrl.rotation.alpha == pytest.approx(tuned.gains["rotation.alpha"], abs=1e-12)
    scenario.dispersions.append(
        {"field": "laws.prrl.rotation.alpha", "distribution": "uniform", "low": 0.4, "high": 0.9}  # type: ignore[arg-type]
    )
    result = detumble.campaign(scenario, "prrl", 4)
    drawn = result.runs.to_polars()["laws.prrl.rotation.alpha"]
    replayed = result.replay(2).scenario.laws.prrl
    assert replayed is not None
    assert replayed.rotation.alpha == drawn[2]
    assert replayed.translation.alpha == 0.61
