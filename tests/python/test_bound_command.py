"""`detumble bound`: both sides of every bound together, for the nominal start and for the runs of a campaign."""

import json
import math
import subprocess
import sys

import numpy as np
import polars as pl
import pytest
from scipy.spatial.transform import Rotation

import detumble
from detumble.analysis.bounds.bound import BRACKETED, ENDS, bound
from detumble.analysis.bounds.earliest import minimum_capture_times
from detumble.analysis.bounds.fuel import delta_v_lower
from detumble.analysis.bounds.pursuit import Pursuit
from detumble.analysis.bounds.runs import all_bounds, capture_bounds
from detumble.analysis.trials import Trials
from detumble.campaigns.runs.draws import drawn_scenario
from detumble.scenario.core import case
from detumble.scenario.files import with_settings
from detumble.workload import start_columns


@pytest.fixture
def cli():
    def run(*arguments, check=True):
        command = [sys.executable, "-m", "detumble.cli", *map(str, arguments)]
        return subprocess.run(command, check=check, capture_output=True, text=True)

    return run


IN_LINE = ("chaser.attitude=[1,0,0,0]", "debris.tumble_rate=[0,0,0]", "goal.position=[0,0,0]")
NO_ORBIT = ("orbit.radius=1e9",)


def test_json_has_every_bound_and_lower_is_below_upper(cli):
    found = json.loads(cli("bound", "far_tumble", "--json").stdout)
    for quantity in BRACKETED:
        assert 0.0 < found[quantity]["lower"] <= found[quantity]["upper"]
        assert found[quantity]["upper"] <= 1.5 * found[quantity]["lower"]
    assert found["translation_s"]["upper"] <= 1.001 * found["translation_s"]["lower"]
    assert found["delta_v_m_s"]["upper"] <= 1.005 * found["delta_v_m_s"]["lower"]
    assert found["detumble_s"]["lower"] >= 0.0


def test_a_capture_is_no_sooner_than_either_half_alone():
    # close by with a weak torque and a small angle: the turn decides, and alone it is bounded better than tick by tick
    near = ["chaser.position=[0,0.3,0]", "actuators.torque_limit=0.002", "capture.angle_deg=2.0", "time.duration=60.0"]
    found = bound(with_settings(detumble.load("paper"), near))
    assert max(found.attitude.lower, found.translation.lower) <= found.capture.lower <= found.capture.upper


@pytest.mark.parametrize("gap", [1.0, 9.0])
def test_one_axis_with_tight_thresholds_is_rest_to_rest(gap):
    settings = [*IN_LINE, *NO_ORBIT, f"chaser.position=[0,0,{gap}]", "capture.distance=1e-4", "capture.speed=1e-4"]
    found = bound(with_settings(detumble.load("paper"), settings))
    closed_form = 2.0 * math.sqrt(gap / (0.1 / 9.0))
    assert found.translation.lower <= closed_form
    assert found.translation.lower == pytest.approx(closed_form, rel=2e-3)
    # commanded at ticks: at most one and a bit later
    assert closed_form - 0.1 <= found.capture.lower <= found.capture.upper <= closed_form + 0.3


def test_upper_bound_of_capture_is_flown_by_the_simulator():
    settings = ["capture.merge=false", "sensors.position_sigma=0", "time.duration=60"]
    for name in ("paper", "twelve_u"):
        chosen = with_settings(detumble.load(name), settings)
        found = bound(chosen)
        tick = round(found.capture.upper / chosen.time.control_period)
        force = chosen.chaser.mass * found.capture.transfer.acceleration
        times = found.capture.transfer.times
        raw = chosen.to_dict()
        raw["laws"]["none"] = {
            "segments": [
                {"start": float(begin), "end": float(end), "force": one.tolist()}
                for begin, end, one in zip(times, times[1:], force, strict=False)
            ]
        }
        flight = detumble.simulate(detumble.Scenario.model_validate(raw), "none")
        place = flight.history["position"][tick]
        assert place == pytest.approx(found.capture.transfer.states[-1, :3], abs=1e-9)
        if name == "paper":  # its goal does not depend on how the chaser turns
            assert flight.history["distance"][tick] < chosen.capture.distance
            assert (flight.history["distance"][:tick] >= chosen.capture.distance).all()


def test_grasp_points_meet_in_the_capture_behind_the_upper_bound():
    # geometry written apart: the debris and H as the simulator flies them, rotations by scipy, velocities by differences
    # a tilted H, a faster tumble and tight thresholds, so that no sign and no frame goes unnoticed
    settings = ["orbit.lvlh_attitude=[0.5,0.5,-0.5,0.5]", "debris.tumble_rate=[0.08,-0.05,0.06]"]
    settings += ["capture.distance=0.005", "capture.speed=0.004", "time.duration=60"]
    scenario = with_settings(detumble.load("twelve_u"), settings)
    found = bound(scenario).capture
    tick = round(found.upper / scenario.time.control_period)
    flight = detumble.simulate(scenario, "none")
    spans = range(tick - 1, tick + 1)

    def turned(quaternion, point):
        return Rotation.from_quat(np.roll(quaternion, -1)).apply(point)

    apart = []
    for at in spans:
        turn = [0.0, 0.0, scenario.orbit.mean_motion * at * scenario.time.control_period]
        to_lvlh = (Rotation.from_quat(np.roll(scenario.orbit.lvlh_attitude, -1)) * Rotation.from_rotvec(turn)).inv()
        debris = to_lvlh.apply(turned(flight.history["debris_attitude"][at], scenario.debris.grasp_point))
        chaser = to_lvlh.apply(turned(found.slew.attitude[at], scenario.chaser.grasp_point))
        apart.append(
            found.transfer.states[np.searchsorted(found.transfer.times, at * 0.1 - 1e-6), :3] + chaser - debris
        )
    assert np.linalg.norm(apart[1]) < scenario.capture.distance
    # the speed half a period before differs by less than the forces give in that time
    speed = np.linalg.norm((apart[1] - apart[0]) / scenario.time.control_period)
    assert speed < scenario.capture.speed + 0.002
    between = turned(found.slew.attitude[tick] * [1, -1, -1, -1], np.eye(3))
    debris_axes = turned(flight.history["debris_attitude"][tick] * [1, -1, -1, -1], np.eye(3))
    angle = np.arccos((np.trace(between.T @ debris_axes) - 1.0) / 2.0)
    assert angle < math.radians(scenario.capture.angle_deg)


def test_no_gains_whatever_beat_the_bounds_in_200_random_starts():
    rng = np.random.default_rng(17)
    count = 200
    starts = np.zeros((count, 20))
    starts[:, :3] = rng.uniform(-2.0, 2.0, (count, 3))
    starts[:, 3:6] = 0.02 * rng.standard_normal((count, 3))
    for first in (6, 13):
        attitude = rng.standard_normal((count, 4))
        starts[:, first : first + 4] = attitude / np.linalg.norm(attitude, axis=1, keepdims=True)
    starts[:, 17:] = 0.05 * rng.standard_normal((count, 3))
    scenario = detumble.load("paper")
    plain = case(scenario, "none")
    pursuit = Pursuit.of(plain)
    bounds = minimum_capture_times(pursuit, starts)
    from detumble import _core

    captures = 0
    for law, names in {"pd": ("kp", "kd"), "sosmc": ("slope", "gain"), "prrl": ("slope", "gain")}.items():
        columns = dict(start_columns(starts))
        for channel in ("translation", "rotation"):
            for name in names:
                columns[f"law.before.{channel}.{name}"] = np.repeat(10.0 ** rng.uniform(-2, 1, (count, 1)), 3, axis=1)
        flown = _core.fly_many(case(scenario, law), columns, count, seed=3, threads=2)
        times, fuel = flown["capture_time"], flown["delta_v_to_capture"]
        captured = np.isfinite(times)
        captures += int(captured.sum())
        assert not (times[captured] < bounds[captured] - 1e-9).any()
        for run in np.flatnonzero(captured)[:15]:
            least = delta_v_lower(pursuit, starts[run], max(times[run], plain["plan"]["control_period"]))
            assert fuel[run] >= least * (1.0 - 1e-9)
    assert captures > 200


def test_runs_of_a_campaign_are_bounded_as_they_were_drawn(cli, tmp_path):
    scenario = detumble.load("paper_dispersed")
    table = all_bounds(Trials(scenario, 4, 0, 2), 50.0)
    assert tuple(table) == ENDS
    alone = bound(drawn_scenario(scenario, 4, 1), 50.0).ends()
    for name, values in table.items():
        # a drawn scenario goes through its file, whose quaternions are normalised anew
        assert values[1] == pytest.approx(alone[name], rel=1e-6, abs=1e-9), name
    assert np.array_equal(capture_bounds(Trials(scenario, 4, 0, 2)), table["capture_time_s.lower"])

    done = cli("bound", "paper_dispersed", "--runs", "30", "--seed", "4", "--quick", "--json", "--out", tmp_path / "b")
    rows = pl.read_parquet(tmp_path / "b" / "bounds.parquet")
    assert rows["index"].to_list() == list(range(30))
    assert rows["capture_time_s.lower"].to_list()[:2] == table["capture_time_s.lower"].tolist()
    assert json.loads(done.stdout)["capture_time_s"]["lower"]["max"] == rows["capture_time_s.lower"].max()


def test_what_is_written_and_what_is_refused(cli, tmp_path):
    folder = tmp_path / "with space"
    done = cli("bound", "paper", "--within", "30", "--out", folder)
    assert "capture" in done.stdout
    names = {file.name for file in folder.iterdir()}
    assert names == {
        "bound.json", "scenario.toml", "translation.csv", "least_delta_v.csv", "attitude.csv", "bound.png",
        "written.json",
    }  # fmt: skip
    rows = pl.read_csv(folder / "translation.csv")
    assert rows["time_s"][-1] == pytest.approx(
        json.loads((folder / "bound.json").read_text())["capture_time_s"]["upper"]
    )
    assert "acceleration_m_s2.x" in rows.columns
    for arguments, word in (
        (("paper", "--within", "1e9"), "600 s"),
        (("paper", "--within", "nan"), "greater than 0"),
        (("paper", "--quick"), "--runs"),
        (("paper", "--runs", "-2"), "runs -2"),
    ):
        refused = cli("bound", *arguments, check=False)
        assert refused.returncode == 2
        assert word in refused.stderr
        assert not refused.stdout


def test_what_the_flight_is_too_short_for_is_null(cli):
    found = json.loads(cli("bound", "far_tumble", "--set", "time.duration=20", "--json").stdout)
    assert found["translation_s"] == {"lower": None, "upper": None}
    assert found["capture_time_s"]["lower"] is None
