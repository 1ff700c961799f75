"""Whatever is wrong with a scenario: one message that names field, value and what is allowed, and nothing changed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from detumble.errors import RequestError, ScenarioError
from detumble.scenario import Scenario, from_toml, load, with_settings

ASYMMETRIC = "[[0.1, 0.2, 0], [0, 0.1, 0], [0, 0, 0.1]]"
INDEFINITE = "[[0.1, 0.2, 0], [0.2, 0.1, 0], [0, 0, 0.1]]"
FLAT = "[[0.1, 0, 0.02], [0, 0.3, 0], [0.02, 0, 0.1]]"

REFUSED = [
    # setting, field at fault, words of the message
    ("chaser.mass=0", "chaser.mass", "0 kg: must be at least 0.001 and at most 100e3"),
    ("chaser.mass=1e-300", "chaser.mass", "1e-300 kg: must be at least 0.001"),
    ("chaser.mass=-9", "chaser.mass", "-9 kg: must be at least 0.001"),
    ("chaser.mass=9e6", "chaser.mass", "at most 100e3"),
    ("chaser.mass=nan", "chaser.mass", "nan kg: NaN"),
    ("chaser.mass=inf", "chaser.mass", "must be finite"),
    ("chaser.mass=1e999", "chaser.mass", "must be finite"),
    (f"chaser.mass={'9' * 400}", "chaser.mass", "too large"),
    ("chaser.mass='9 kg'", "chaser.mass", '"9 kg": must be a plain number in kg'),
    ("chaser.mass=true", "chaser.mass", "must be a plain number in kg"),
    ("chaser.mass=[9]", "chaser.mass", "must be a plain number in kg"),
    ("debris.mass=0", "debris.mass", "must be at least 0.001"),
    ("chaser.inertia=[0.1, 0.1, 0.3]", "chaser.inertia", "the largest principal moment exceeds the sum of the others (0.2)"),
    (f"chaser.inertia={FLAT}", "chaser.inertia", "exceeds the sum of the others (0.2)"),
    (f"chaser.inertia={ASYMMETRIC}", "chaser.inertia", "must be symmetric"),
    (f"debris.inertia={INDEFINITE}", "debris.inertia", "must be positive definite"),
    ("chaser.inertia=[0.1, 0.1, 0]", "chaser.inertia", "must be positive on every axis"),
    ("chaser.inertia=[1e-320, 1e-320, 1e-320]", "chaser.inertia", "must be at least 1e-9"),
    ("debris.inertia=[[5e-10, 0, 0], [0, 6e-10, 0], [0, 0, 6e-10]]", "debris.inertia", "a principal moment of 5e-10; must"),
    ("belief.stack_inertia=[1e-10, 1, 1]", "belief.stack_inertia", "a principal moment of 1e-10; must be at least 1e-9"),
    ("chaser.inertia=[0.1, 0.1, nan]", "chaser.inertia", "NaN"),
    ("chaser.inertia=[0.1, 0.1]", "chaser.inertia", "has 2 elements"),
    ("chaser.inertia=[[1, 0], [0, 1], [0, 0]]", "chaser.inertia", "3 principal moments or a 3x3 list"),
    ("chaser.inertia=2e6", "chaser.inertia", "3 principal moments or a 3x3 list"),
    ("debris.inertia=[5e7, 5e7, 8e7]", "debris.inertia", "at most 1e6"),
    ("chaser.attitude=[0, 0, 0, 0]", "chaser.attitude", "zero is no attitude"),
    ("chaser.attitude=[1, 1, 0, 0]", "chaser.attitude", "has norm 1.41421; must be 1"),
    ("debris.attitude=[1, 0, 0]", "debris.attitude", "has 3 elements"),
    ("orbit.lvlh_attitude=[nan, 0, 0, 0]", "orbit.lvlh_attitude", "NaN"),
    ("chaser.position=[1, 2]", "chaser.position", "has 2 elements; must be a list of 3 numbers in m"),
    ("chaser.position=[1, 2, '3 m']", "chaser.position", "must be a list of 3 numbers in m"),
    ("chaser.position=[1e7, 0, 0]", "chaser.position", "at most 1e6"),
    ("chaser.velocity=[1e5, 0, 0]", "chaser.velocity", "m/s: must be"),
    ("chaser.rate=[0, 0, 200]", "chaser.rate", "rad/s: must be"),
    ("debris.tumble_rate=[0, 0, nan]", "debris.tumble_rate", "NaN"),
    ("debris.tumble_rate=[0, 0, 360]", "debris.tumble_rate", "at most 100"),
    ("orbit.altitude=700", "orbit.altitude", "did you mean 700e3?"),
    ("orbit.altitude=7e8", "orbit.altitude", "700e6 m: must be"),
    ("orbit.altitude='700 km'", "orbit.altitude", "write the bare number in m"),
    ("orbit.radius=7071", "orbit.radius", "did you mean 7.071e6?"),
    ("orbit.earth_radius=6371", "orbit.earth_radius", "did you mean 6.371e6?"),
    ("orbit.mu=398600.4", "orbit.mu", "m³/s²: must be"),
    ("time.duration=0", "time.duration", "must be greater than 0"),
    ("time.duration=600.05", "time.duration", "whole number of control periods (0.1 s)"),
    ("time.duration=1e7", "time.duration", "at most 2000000 can be flown"),
    ("time.control_period=0", "time.control_period", "must be greater than 0"),
    ("time.integration_step=0.2", "time.integration_step", "must not be longer than control_period (0.1 s)"),
    ("time.integration_step=0", "time.integration_step", "must be greater than 0"),
    ("time.integration_step=1e-9", "time.integration_step", "a 100000th of control_period"),
    ("goal.position=[nan, 0, 0]", "goal.position", "NaN"),
    ("goal.acceleration_feedforward=true", "goal.acceleration_feedforward", "needs grasp points"),
    ("chaser.grasp_point=[0, 0, 0.2]", "chaser.grasp_point", "both bodies carry a grasp point, or neither"),
    ("capture.distance=0", "capture.distance", "must be greater than 0"),
    ("capture.angle_deg=0", "capture.angle_deg", "must be greater than 0"),
    ("capture.angle_deg=200", "capture.angle_deg", "at most 180"),
    ("capture.rate=-1", "capture.rate", "must be greater than 0"),
    ("capture.speed=0", "capture.speed", "must be greater than 0"),
    ("capture.dwell=-1", "capture.dwell", "must be at least 0"),
    ("capture.transition=momentum", "capture.transition", "did you mean momentum_conserving?"),
    ("capture.distance_from=gaol", "capture.distance_from", "did you mean goal?"),
    ("capture.merge=1", "capture.merge", "must be true or false"),
    ("settled.rate=0", "settled.rate", "must be greater than 0"),
    ("settled.angle_deg=181", "settled.angle_deg", "at most 180"),
    ("actuators.force_limit=0", "actuators.force_limit", "must be greater than 0"),
    ("actuators.force_limit=[0.1, -0.1, 0.1]", "actuators.force_limit", "must be greater than 0"),
    ("actuators.force_limit=-inf", "actuators.force_limit", "must be finite"),
    ("actuators.torque_limit=nan", "actuators.torque_limit", "NaN"),
    ("actuators.torque_limit='10 mN m'", "actuators.torque_limit", "write the bare number in N m"),
    ("actuators.forcelimit=1", "actuators.forcelimit", "unknown key; did you mean force_limit?"),
    ("sensors.position_sigma=-1", "sensors.position_sigma", "must be at least 0"),
    ("sensors.velocity_sigma=nan", "sensors.velocity_sigma", "NaN"),
    ("sensors.attitude_sigma=10", "sensors.attitude_sigma", "at most 1"),
    ("sensors.rate_sigma=-1e-4", "sensors.rate_sigma", "-1e-4 rad/s: must be at least 0"),
    ("belief={stack = 'true', stack_mass = 3}", "belief.stack_mass", 'needs stack = "design"'),
    ("belief.chaser_mass=0", "belief.chaser_mass", "must be at least 0.001"),
    (f"belief.stack_inertia={INDEFINITE}", "belief.stack_inertia", "must be positive definite"),
    ("laws.attitude_error=eps", "laws.attitude_error", "must be epsilon or two_epsilon"),
    ("laws.pd.form=corect", "laws.pd.form", "did you mean corrected?"),
    ("laws.pd.translation.kp=-1", "laws.pd.translation.kp", "N/m: must be at least 0"),
    ("laws.lqr.rotation.r=0", "laws.lqr.rotation.r", "must be greater than 0"),
    ("laws.lqr.translation.q_error=0", "laws.lqr.translation.q_error", "must be greater than 0"),
    ("laws.sosmc.rotation.layer=0", "laws.sosmc.rotation.layer", "must be greater than 0"),
    ("laws.tsmc.translation.p=4", "laws.tsmc.translation.p", "must be odd"),
    ("laws.tsmc.translation.p=5.5", "laws.tsmc.translation.p", "must be a whole odd number"),
    ("laws.tsmc.translation.p=1", "laws.tsmc.translation.p", "p/q = 1/3 must be greater than 1"),
    ("laws.tsmc.rotation.q_corrected=3", "laws.tsmc.rotation.p_corrected", "must be less than 1"),
    ("laws.prrl.alpha=1", "laws.prrl.alpha", "less than 1"),
    ("laws.prrl.alpha=0", "laws.prrl.alpha", "greater than 0"),
    ("laws.prl.alpha=0.5", "laws.prl", "unknown key; did you mean prrl?"),
    ("laws.prrl.translation.kp=1", "laws.prrl.translation.kp", "unknown key"),
    ("laws.prrl.translation={slope = 1, gain = 1}", "laws.prrl.translation.layer", "phi, thickness of the boundary layer [m/s]"),
    ("laws.prrl.stack={rotation = {slope = 1, layer = 1}}", "laws.prrl.stack.rotation.gain", "missing"),
    ("laws.none.segments=[{start = 1, end = 1}]", "laws.none.segments[0].end", "later than start"),
    ("laws.none.segments=[{start = 0, end = 0.25}]", "laws.none.segments", "[0]: 0.25 s is not a whole number"),
    ("laws.none.segments=[{start = 0, end = 2}, {start = 1, end = 3}]", "laws.none.segments", "[1]: starts at 1 s"),
    ("laws.none.segments=[{start = 0, end = 1, forc = 1}]", "laws.none.segments[0].forc", "did you mean force?"),
    ("laws.none.segments=3", "laws.none.segments", "must be an array of tables"),
    ("chaser=3", "chaser", "must be a table"),
    ("chaser.mass.x=3", "chaser.mass", "is not a table"),
    ("title=''", "title", "must not be empty"),
    ("titel='x'", "titel", "did you mean title?"),
]  # fmt: skip


@pytest.mark.parametrize(("setting", "field", "words"), REFUSED, ids=[setting[:50] for setting, *_ in REFUSED])
def test_each_bad_value_is_refused_with_field_value_and_reason(
    paper: Scenario, setting: str, field: str, words: str
) -> None:
    with pytest.raises(ScenarioError) as refusal:
        with_settings(paper, [setting], "my6u.toml")
    assert [fault.path for fault in refusal.value.faults] == [field]
    assert words in str(refusal.value)
    assert str(refusal.value).startswith("my6u.toml: 1 problem\n  ")


def test_every_fault_of_a_file_is_in_one_message(paper: Scenario) -> None:
    settings = [
        "chaser.inertia=[0.1, 0.1, 0.3]",
        "actuators.forcelimit=1",
        "time.duration=-5",
        "time.integration_step=1",
    ]
    with pytest.raises(ScenarioError) as refusal:
        with_settings(paper, [*settings, "chaser.grasp_point=[0, 0, 1]"], "my6u.toml")
    lines = str(refusal.value).splitlines()
    assert lines[0] == "my6u.toml: 5 problems"
    assert lines[2] == (
        "  chaser.inertia         [0.1, 0.1, 0.3] kg m²: "
        "the largest principal moment exceeds the sum of the others (0.2); no rigid body has that"
    )
    assert "  actuators.forcelimit   unknown key; did you mean force_limit?" in lines


def test_a_missing_table_or_value_is_named_with_its_unit(paper: Scenario) -> None:
    text = paper.to_toml().replace("mass = 9.0", "").replace("[time]", "[when]").replace("[orbit]", "[orbitt]")
    with pytest.raises(ScenarioError) as refusal:
        from_toml(text, "x.toml")
    assert "chaser.mass" in str(refusal.value)
    assert "missing; needed: mass [kg]" in str(refusal.value)
    assert "time         missing; needed: a table" in str(refusal.value)
    assert "orbitt       unknown key; did you mean orbit?" in str(refusal.value)
    assert "orbit " not in str(refusal.value)


def test_exactly_one_of_altitude_and_radius(paper: Scenario) -> None:
    for replacement in ("", "altitude = 700e3\nradius = 7071e3"):
        text = "\n".join(replacement if line.startswith("altitude") else line for line in paper.to_toml().splitlines())
        with pytest.raises(ScenarioError, match="exactly one of altitude and radius"):
            from_toml(text)


def test_the_goal_is_a_position_or_two_grasp_points(paper: Scenario) -> None:
    with pytest.raises(ScenarioError, match="they are the goal"):
        with_settings(paper, ["chaser.grasp_point=[0,0,1]", "debris.grasp_point=[0,0,1]"])
    with pytest.raises(ScenarioError, match="without grasp points the goal needs a position"):
        with_settings(paper, ["goal={}"])
    points = ["goal={acceleration_feedforward = true}", "chaser.grasp_point=[0,0,1]", "debris.grasp_point=[0,0,1]"]
    assert with_settings(paper, points).has_grasp_points


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"title = ", "not valid TOML"),
        (b"a = 1\nb = = 3\n", "not valid TOML: line 2, column 5"),
        (b"title = 'x'\ntitle = 'y'\n", "not valid TOML: line 2"),
        (b"title = \xff\n", "not UTF-8 text (byte 0xff at position 8)"),
        (b"", "5 problems"),
    ],
)
def test_a_file_that_is_no_scenario_says_where(tmp_path: Path, content: bytes, words: str) -> None:
    file = tmp_path / "x.toml"
    file.write_bytes(content)
    with pytest.raises(ScenarioError) as refusal:
        load(file)
    assert str(refusal.value).startswith(f"{file}: ")
    assert words in str(refusal.value)


def test_a_file_that_cannot_be_read_says_why(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r"no such file, and no built-in scenario .*did you mean paper\?"):
        load("papr")
    with pytest.raises(ScenarioError, match="is a folder"):
        load(tmp_path)
    with pytest.raises(ScenarioError, match="not a directory"):
        load(Path(__file__) / "x.toml")


def test_a_setting_needs_field_and_value(paper: Scenario) -> None:
    with pytest.raises(RequestError, match="must be field=value"):
        with_settings(paper, ["chaser.mass"])


ASSIGNED = [
    ("chaser.mass", -1, "chaser.mass  -1 kg: must be at least 0.001"),
    ("chaser.masss", 1, "chaser.masss  unknown key; did you mean mass?"),
    ("chaser.inertia", [0.1, 0.1, 0.3], "no rigid body has that"),
    ("debris.attitude", [0, 0, 0, 0], "zero is no attitude"),
    ("chaser.position", np.array([0.0, np.nan, 0.0]), "NaN"),
    ("time.integration_step", 5.0, "must not be longer than control_period"),
    ("orbit.altitude", 700, "did you mean 700e3?"),
    ("capture.transition", "x", "must be approximate or momentum_conserving"),
    ("laws.tsmc.rotation.p", 1, "must be greater than 1"),
    ("laws.prrl.translation.gain", [1, 2], "has 2 elements"),
    ("chaser", 3, "must be a table"),
]


@pytest.mark.parametrize(("path", "value", "words"), ASSIGNED, ids=[path for path, *_ in ASSIGNED])
def test_a_bad_assignment_is_refused_and_changes_nothing(paper: Scenario, path: str, value: object, words: str) -> None:
    before = paper.model_copy(deep=True)
    *sections, name = path.split(".")
    owner = paper.at(".".join(sections)) if sections else paper
    with pytest.raises(ScenarioError) as refusal:
        setattr(owner, name, value)
    assert words in str(refusal.value)
    assert paper == before


def test_a_good_assignment_is_taken(paper: Scenario) -> None:
    paper.chaser.mass = 12
    paper.chaser.position = np.array([1, 2, 3])
    paper.orbit.radius = 7000e3
    assert (paper.chaser.mass, paper.chaser.position) == (12.0, (1.0, 2.0, 3.0))
    assert paper.orbit.altitude is None
    paper.orbit.altitude = 500e3
    assert paper.orbit.radius is None
    assert paper.orbit.mean_motion == pytest.approx((3.986004418e14 / 6871e3**3) ** 0.5, rel=1e-15)


def test_sections_that_contradict_each_other_are_found_when_used(paper: Scenario, tmp_path: Path) -> None:
    paper.chaser.grasp_point = (0.0, 0.0, 0.2)
    with pytest.raises(ScenarioError, match="both bodies carry a grasp point"):
        paper.save(tmp_path / "x.toml")
    assert not list(tmp_path.iterdir())
    paper.debris.grasp_point = (0.0, 0.0, 0.2)
    paper.goal.position = None
    paper.check()
