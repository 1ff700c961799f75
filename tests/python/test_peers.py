"""The benchmark beside its peers: what it is told, what it hands on, what it notices. No peer need be installed."""

from __future__ import annotations

import copy
import json
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from detumble.compiled import core
from detumble.scenario import load
from detumble.workload import random_starts, start_columns, workload

ROOT = Path(__file__).parents[2]
BENCHMARKS = ROOT / "benchmarks"
# The command's package, and the folder that a peer's script sees as its own.
sys.path[:0] = [str(BENCHMARKS), str(BENCHMARKS / "peers")]

from peers import agreement, measure, ways  # noqa: E402
from peers.process import Peer, PeerFailed  # noqa: E402
from w import Workload  # noqa: E402

PYTHON = Path(sys.executable)


def short(periods: int = 60) -> dict[str, Any]:
    """Workload W, cut short, every number of it another one."""
    case = copy.deepcopy(workload())
    case["plan"] |= {"periods": periods, "control_period": 0.04}
    case["orbit"]["mean_motion"] *= 30.0  # so that it shows in seconds
    case["chaser"] |= {"mass": 7.0, "inertia": np.diag([0.2, 0.13, 0.09]).tolist()}
    case["belief"] |= {"chaser_mass": 7.0, "chaser_inertia": case["chaser"]["inertia"]}
    case["debris"]["inertia"] = np.diag([0.03, 0.07, 0.06]).tolist()
    case["goal"] = {"position": [0.1, -0.2, 0.3], "after_capture": [0.1, -0.2, 0.3]}
    case["capture"] |= {"distance": 2.0, "angle": 1.4, "rate": 0.08}
    case["actuators"] |= {"force": [0.3] * 3, "torque": [0.02] * 3}
    case["law"]["before"] = case["law"]["after"] = {
        "translation": {"slope": [0.2] * 3, "gain": [0.09] * 3, "layer": [0.07] * 3, "alpha": 0.8},
        "rotation": {"slope": [0.4] * 3, "gain": [0.15] * 3, "layer": [0.2] * 3, "alpha": 0.6},
    }
    return case


def flown_here(case: dict[str, Any], starts: Any, seed: int = 1) -> dict[str, Any]:
    flown: dict[str, Any] = core().fly_many(case, start_columns(starts), len(starts), seed=seed)
    return flown


def without_noise(case: dict[str, Any]) -> dict[str, Any]:
    return case | {"sensors": dict.fromkeys(case["sensors"], 0.0)}


def test_peers_read_w_as_the_scenario_has_it() -> None:
    w, scenario = Workload.of(workload()), load("workload_w")
    assert (w.mass, w.period, w.periods) == (scenario.chaser.mass, 0.05, 2400)
    assert w.chaser_inertia == (0.1, 0.1, 0.05)
    assert w.debris_inertia == (0.05, 0.05, 0.08)
    assert w.goal == tuple(scenario.goal.position)
    assert (w.translation.slope, w.translation.gain, w.translation.layer, w.translation.alpha) == (
        0.15,
        0.05,
        0.05,
        0.7,
    )
    assert (w.rotation.slope, w.rotation.gain, w.rotation.layer, w.rotation.alpha) == (0.30, 0.20, 0.10, 0.7)
    assert (w.force_limit, w.torque_limit) == (0.1, 0.01)
    assert (w.position_sigma, w.attitude_sigma, w.rate_sigma) == (1e-3, np.radians(0.1), 1e-4)
    assert (w.capture_distance, w.capture_angle, w.capture_rate) == (0.5, np.radians(20.0), 0.05)


@pytest.mark.parametrize(
    ("section", "change"),
    [
        ("plan", {"transition": "approximate"}),
        ("law", {"form": "corrected"}),
        ("law", {"kind": "pd"}),
        ("sensors", {"velocity": 1e-3}),
        ("chaser", {"inertia": [[0.1, 0.01, 0.0], [0.01, 0.1, 0.0], [0.0, 0.0, 0.05]]}),
        ("actuators", {"force": [0.1, 0.1, 0.2]}),
        ("actuators", {"force_gain": [1.0, 1.1, 1.0]}),
        ("belief", {"chaser_mass": 8.0}),
        ("plan", {"end": "capture"}),
    ],
)
def test_peers_refuse_what_they_do_not_fly(section: str, change: dict[str, Any]) -> None:
    case = copy.deepcopy(workload())
    case[section] |= change
    with pytest.raises(ValueError, match="not workload W"):
        Workload.of(case)


@pytest.mark.parametrize("name", ["numpy", "scipy"])
def test_all_numbers_of_a_peer_come_from_the_case(name: str, tmp_path: Path) -> None:
    """With every number changed it still agrees with detumble: through the whole protocol, in a process of its own."""
    case, starts = short(), random_starts(6, seed=3)
    peer = Peer(name, PYTHON, 1, case, tmp_path)
    answer = peer.fly("w", starts, noisy=False, keep=True)
    peer.close()
    ours = flown_here(without_noise(case), starts)
    assert not agreement.quiet(name, answer.arrays, ours).faults
    assert np.isfinite(ours["capture_time"]).any()
    assert answer.seconds > 0.0
    assert answer.peak_bytes is None or 10e6 < answer.peak_bytes < 1e9


def test_noise_of_a_peer_is_that_of_the_case(tmp_path: Path) -> None:
    case, starts = short(400), random_starts(256, seed=4)
    peer = Peer("numpy", PYTHON, 1, case, tmp_path)
    noisy, still = (peer.fly("w", starts, noisy=wanted, keep=True).arrays for wanted in (True, False))
    peer.close()
    theirs = agreement.disturbance(noisy, still)
    still_here = flown_here(without_noise(case), starts)
    ours = agreement.disturbance(flown_here(case, starts), still_here)
    assert not agreement.noisy("numpy", theirs, ours).faults
    for sensor, quantity in {"position": "position", "attitude": "attitude", "rate": "rate"}.items():
        case["sensors"][sensor] *= 2.0
        louder = agreement.noisy("numpy", agreement.disturbance(flown_here(case, starts, 2), still_here), ours)
        case["sensors"][sensor] /= 2.0
        assert any(fault.startswith(quantity) for fault in louder.faults), (sensor, louder)


def test_a_difference_beyond_the_tolerance_is_a_fault() -> None:
    case, starts = without_noise(short()), random_starts(6, seed=3)
    ours = flown_here(case, starts)
    assert np.isfinite(ours["capture_time"]).any()

    def faults(column: int, value: float) -> list[str]:
        theirs = {name: np.array(ours[name]) for name in ("final_state", "capture_time")}
        theirs["final_state"][0, column] += value
        return [fault.partition(":")[0] for fault in agreement.quiet("numba", theirs, ours).faults]

    assert faults(0, 1e-15) == []
    assert faults(1, 1e-9) == ["position m"]
    assert faults(4, 1e-9) == ["velocity m/s"]
    assert faults(8, 1e-8) == ["attitude rad"]
    assert faults(18, 1e-8) == ["rate rad/s"]
    assert faults(2, np.nan) == ["position m"]

    theirs = {"final_state": np.array(ours["final_state"]), "capture_time": ours["capture_time"] + 1e-12}
    theirs["final_state"][:, 6:10] *= -1.0  # the same attitude
    assert not agreement.quiet("numba", theirs, ours).faults
    for other in (ours["capture_time"] + 0.04, np.full(6, np.nan)):
        assert agreement.quiet("numba", theirs | {"capture_time": other}, ours).faults


def test_a_peer_that_is_not_there_is_named_with_the_reason(tmp_path: Path) -> None:
    bare = tmp_path / "bare"
    subprocess.run([PYTHON, "-m", "venv", "--without-pip", str(bare)], check=True)
    peer = Peer("vbar", bare / "bin" / "python", 1, workload(), tmp_path)
    with pytest.raises(PeerFailed, match="No module named"):
        peer.fly("w", random_starts(1))
    peer.close()


def test_a_peer_that_breaks_down_says_why(tmp_path: Path) -> None:
    peer = Peer("numpy", PYTHON, 1, workload(), tmp_path)
    with pytest.raises(PeerFailed, match="KeyError: 'no such way'"):
        peer.fly("no such way", random_starts(1))
    peer.process.kill()
    with pytest.raises(PeerFailed, match="exit code -9"):
        peer.fly("w", random_starts(1))
    peer.close()


def test_growth_flies_nothing_that_is_expected_beyond_the_budget() -> None:
    asked = []

    def fly(runs: int) -> tuple[float, int]:
        asked.append(runs)
        return runs / 100.0, 7  # slower than was measured before: expectations follow

    points = measure.growth(fly, 1e6, 2400, [100, 1000, 3000, 10000], budget=20.0)
    assert asked == [100, 1000]
    assert [point.seconds for point in points] == [1.0, 10.0, None, None]
    assert [point.expected for point in points] == pytest.approx([0.24, 3.16, 30.0, 100.0])


def test_the_command_is_measured_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Time of the whole process, its memory and not that of the process that asks."""
    held = bytearray(300_000_000)
    command = tmp_path / "detumble"

    def becomes(code: str) -> None:
        command.write_text(f'#!/bin/sh\nexec "{PYTHON}" -S -c "{code}" "$@"\n')  # a path may have spaces
        command.chmod(0o755)

    becomes("import sys, time; x = bytearray(60_000_000); time.sleep(0.3); print(sys.argv)")
    monkeypatch.setattr(measure, "DETUMBLE", command)
    seconds, peak = measure.campaign(1000, tmp_path)
    assert 0.3 < seconds < 60.0
    assert peak is not None
    assert 60e6 < peak < 120e6 < len(held)

    becomes("import sys; sys.exit('no such ' + sys.argv[1])")
    with pytest.raises(PeerFailed, match="no such campaign"):
        measure.campaign(1000, tmp_path)


def test_rates_are_of_all_ways_in_turn(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    few = (
        ways.Way("detumble", "detumble", 64),
        ways.Way("numpy", "numpy", 16),
        ways.Way("broken", "numpy", 16, "none"),
    )
    monkeypatch.setattr(measure, "WAYS", few)
    case = short(100)
    peers = {(name, 1): Peer(name, PYTHON, 1, case, tmp_path) for name in ("detumble", "numpy")}
    failed: dict[str, str] = {}
    begin = time.perf_counter()
    rates = measure.rates(peers, 100, 2, failed)
    elapsed = time.perf_counter() - begin
    for peer in peers.values():
        peer.close()
    assert failed == {"broken": "KeyError: 'none'"}
    assert [len(rates[name].steps_per_s) for name in ("detumble", "numpy")] == [2, 2]
    assert rates["detumble"].ratio == 1.0
    assert 0.0 < rates["numpy"].fma_share < rates["detumble"].fma_share < 1.0
    assert all(rate > 2 * 64 * 100 / elapsed for rate in rates["detumble"].steps_per_s)


def test_an_unknown_peer_is_a_wrong_request() -> None:
    done = subprocess.run(
        [PYTHON, BENCHMARKS / "peers.py", "--only", "orekit"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert all(name in done.stderr for name in ("orekit", *ways.PEERS))


def test_every_peer_has_its_script_its_tolerance_and_its_pin() -> None:
    pinned = [line for line in (BENCHMARKS / "peers" / "requirements.txt").read_text().splitlines() if line[0] != "#"]
    assert all("==" in line.partition(";")[0] for line in pinned)
    names = {line.partition("==")[0] for line in pinned}
    for peer in ways.PEERS:
        assert {"basilisk": "bsk"}.get(peer, peer) in names
        assert (BENCHMARKS / "peers" / f"run_{peer}.py").exists()
        assert peer in ways.TOLERANCES
        assert peer in ways.TITLES


def test_the_documentation_has_a_row_for_every_way() -> None:
    lines = (ROOT / "docs" / "benchmarks.md").read_text().splitlines()
    rows = {line.split("|")[1].strip() for line in lines if line.startswith("|")}
    assert {way.label for way in ways.WAYS} <= rows


def test_answers_are_json_whatever_a_library_prints(tmp_path: Path) -> None:
    starts, out = tmp_path / "starts.npy", tmp_path / "out.npz"
    np.save(starts, random_starts(1))
    script = tmp_path / "run_loud.py"
    script.write_text(
        "import os\nfrom serve import serve\n"
        "def calls_of(case):\n    def w(starts, noisy, seed):\n        print('loud')\n        os.system('echo louder')\n"
        "        return {'x': starts}\n    return {'w': w}\nserve(calls_of)\n"
    )
    request = {"call": "w", "starts": str(starts), "noisy": True, "seed": 1, "out": str(out)}
    done = subprocess.run(
        [PYTHON, script, "1"],
        input=f"{{}}\n{json.dumps(request)}\n",
        capture_output=True,
        text=True,
        check=True,
        env={"PYTHONPATH": str(BENCHMARKS / "peers")},
    )
    assert set(json.loads(done.stdout)) == {"seconds", "peak_bytes"}
    assert "louder" in done.stderr
    with np.load(out) as stored:
        assert np.array_equal(stored["x"], random_starts(1))
