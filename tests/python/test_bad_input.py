"""Bad input of every kind, through every command and every public function.

One rule: a command answers with one message on standard error, nothing on standard output, exit code 2, and leaves no file;
a function raises a documented exception; nothing succeeds that should not.
"""

from __future__ import annotations

import datetime
import json
from collections.abc import Callable, Iterator
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import detumble
from commands import call
from detumble.analysis.comparing.entries import entries_of
from detumble.analysis.comparing.plan import Plan
from detumble.analysis.tuning import Objective
from detumble.checking import met
from detumble.errors import RequestError
from detumble.intervals import Proportion
from detumble.scenario import Scenario, from_toml, with_settings
from detumble.scenario.dispersions.fitting import fields

SHORT = "time.duration=2.0"
NO_NUMBER = ("x", "", " ", "1,5", "1e", "0x10", "[1]", "true", "ٳ", "1 m")
NO_WHOLE = (*NO_NUMBER, "1.5", "nan", "inf", "-1", "1e3", str(2**64), "9" * 400)
NO_REAL = (*NO_NUMBER, "nan", "inf", "-inf", "-1", "1e400")

BASES: dict[str, tuple[str, ...]] = {
    "run": ("run", "paper", "--set", SHORT),
    "campaign": ("campaign", "paper", "--out", "out", "--runs", "2", "--set", SHORT),
    "bound": ("bound", "paper", "--runs", "1", "--quick", "--set", SHORT),
    "tune": ("tune", "paper", "--budget", "1", "--starts", "1", "--held-out", "0", "--out", "out", "--set", SHORT),
    "compare": ("compare", "paper", "--as-given", "--runs", "2", "--robust", "0", "--out", "out", "--set", SHORT),
}  # fmt: skip
OPTIONS: dict[str, dict[str, tuple[str, ...]]] = {
    "run": {
        "--seed": NO_WHOLE,
        "--index": NO_WHOLE,
        "--law": ("", " ", "PRRL", "prl", "none ", "../x", "prrl,pd", "\x1b[31m"),
        "--backend": ("", "sse", "AVX2", "gpu"),
    },
    "campaign": {
        "--runs": (*NO_WHOLE, "0"),
        "--seed": NO_WHOLE,
        "--threads": (*NO_WHOLE, "0", "4097"),
        "--until-ci": (*NO_REAL, "0", "0.6"),
        "--law": ("", "PRRL", "x"),
        "--backend": ("", "x"),
        "--map": ("chaser.mass", "", "x"),
        "--local-cluster": ("0", "-1", "x", "1.5"),
        "--out": ("", " "),
    },
    "bound": {"--runs": (*NO_WHOLE, "0"), "--seed": NO_WHOLE, "--out": ("", " ")},
    "tune": {
        "--budget": (*NO_WHOLE, "0"),
        "--starts": (*NO_WHOLE, "0"),
        "--seed": NO_WHOLE,
        "--optimiser-seed": NO_WHOLE,
        "--threads": (*NO_WHOLE, "0"),
        "--held-out": NO_WHOLE,
        "--horizon": (*NO_REAL, "0"),
        "--required": ("x", "nan", "-0.1", "1.1", ""),
        "--objective": ("", "speed", "capture "),
        "--statistic": ("", "median", "p", "p0", "p101", "pnan", "mean "),
        "--until": ("", "captured ", "never"),
        "--form": ("", "Printed", "other"),
        "--law": ("", "none", "PD"),
        "--fix": ("", "x", "alpha=", "alpha=x", "alpha=nan", "alpha=2", "alpha=-1", "=0.5", "translation.gain=inf"),
    },
    "compare": {
        "--runs": (*NO_WHOLE, "0"),
        "--seed": NO_WHOLE,
        "--held-out-seed": (*NO_WHOLE, "0"),
        "--threads": (*NO_WHOLE, "0"),
        "--budget": (*NO_WHOLE, "0"),
        "--tunings": (*NO_WHOLE, "0", "101"),
        "--robust": NO_WHOLE,
        "--horizon": (*NO_REAL, "0"),
        "--laws": ("", "pd,x", "pd,pd", ",", "none,pd"),
        "--entry": ("", "x", "x=", "=pd", "x=pd:other", "x=pd", "x=pd:", "\x1b=pd", "x" * 300 + "=pd", "$=pd"),
        "--statistic": ("", "p101", "x"),
        "--out": ("", " "),
    },
}  # fmt: skip
SETTINGS = (
    "", "=", "x", "chaser", "chaser.mass", "chaser.mass=", "=3", "chaser.mass=nan", "chaser.mass=inf", "chaser.mass=-1",
    "chaser.mass=1e-9", "chaser.mass='9'", "chaser.mass=[9]", "chaser.mass=9 kg", "chaser.mass=true", "chaser.mass={}",
    "chaser.position=[1,2]", "chaser.position=[1,2,nan]", "chaser.position=1", "chaser.position=[[1],[2],[3]]",
    "chaser.attitude=[0,0,0,0]", "chaser.attitude=[2,0,0,0]", "chaser.attitude=[1,0,0]", "chaser.inertia=[1,1,3]",
    "chaser.inertia=[-1,1,1]", "chaser.inertia=[[1,2],[3,4]]", "chaser.inertia=[[1,0,0],[0.5,1,0],[0,0,1]]", "chaser.x=1",
    "x.y.z=1", "orbit.radius=7071", "orbit.mu=398600", "orbit.altitude=1e400", "capture.angle_deg=200", "capture.angle=0.1",
    "capture.merge=1", "capture.transition=other", "time.duration=0", "time.duration=2.03", "time.control_period=0",
    "time.control_period=1e-9", "time.integration_step=-1", "time.integration_step=fast", "time.integration_step=1e-12",
    "laws.prrl.alpha=1", "laws.prrl.alpha=0", "laws.prrl.form=x", "laws.prrl.translation.c=1", "laws.tsmc.translation.p=2",
    "laws.tsmc.translation.p=1", "laws.x=1", "laws.prrl=1", "laws=1", "dispersions=1", "dispersions=[1]", "title=",
    "title=a\x1bb", "title=a\nb", "title=\x00", "sensors.attitude_sigma_deg=0.5", "actuators.force_limit=0",
    "actuators.force_limit=[1,2]", "goal.position=", "belief.stack=x", "chaser.grasp_point=[0,0,0]", "a." * 3000 + "b=1",
    "chaser.mass=" + "[" * 3000, "chaser.mass=" + "9" * 5000, "campaign.end=never", "campaign.hold=-1",
)  # fmt: skip
WORDS = (
    ("run", "paper", "--set", "chaser.mass=9", "chaser.mass=10"), ("tune", "paper", "--list", "--fix", "kp=1"),
    (), ("x",), ("run",), ("run", ""), ("run", "nope"), ("run", "nope.toml"), ("run", "/dev/zero"), ("run", "/dev/null"),
    ("run", "."), ("run", "paper", "x"), ("run", "paper", "--nope"), ("run", "paper", "--replay", "x:0"), ("run", "--replay", ""),
    ("run", "--replay", "x"), ("run", "--replay", "x:y"), ("run", "--replay", ":0"), ("run", "--replay", "x:-1"),
    ("run", "--replay", "x:0", "--seed", "1"), ("run", "--replay", "x:0", "--law", "pd"), ("run", "a\0b"), ("run", "\x1b[31m"),
    ("run", "paper", "--out", ""), ("run", "paper", "--out", "/dev/null/x"), ("run", "paper", "--out", "/proc/x"),
    ("campaign", "paper"), ("campaign", "paper", "--out", "o", "--map", "a"), ("campaign", "nope", "--out", "o"),
    ("campaign", "paper", "--out", "o", "--threads", "1", "--local-cluster", "1"),
    ("campaign", "paper", "--out", "o", "--scheduler", "x y"), ("campaign", "paper", "--out", "o", "--scheduler", ""),
    ("bound", "nope"), ("bound", "paper", "--quick"), ("bound", "paper", "--seed", "1"), ("bound", "paper", "--within", "0"),
    ("bound", "paper", "--within", "nan"), ("bound", "paper", "--within", "1e9"), ("tune", "nope"), ("tune", "paper", "--resume"),
    ("tune", "paper", "--stack", "--one-set"), ("tune", "paper", "--fix", "alpha", "--fix", "alpha=0.3"),
    ("tune", "paper", "--fix", "alpha=0.3", "--fix", "alpha=0.4"), ("tune", "paper", "--law", "x", "--list"),
    ("compare", "nope"), ("compare", "paper", "--resume"), ("compare", "paper", "--laws", "pd,lqr", "--entry", "a=pd"),
    ("compare", "paper", "--held-out", "3", "--held-out-seed", "3"), ("compare", "paper", "--seed", "3", "--held-out", "3"),
    ("scenarios", "x"), ("schema", "x"), ("bench", "x"), ("paper", "x"), ("paper", "--out", ""),
)  # fmt: skip


def command_lines() -> Iterator[tuple[str, ...]]:
    for name, options in OPTIONS.items():
        for option, values in options.items():
            for value in values:
                yield (*BASES[name], option, value)
    for setting in SETTINGS:
        yield ("run", "paper", "--set", setting)
    for name in ("campaign", "bound", "tune", "compare"):
        yield (*BASES[name], "--set", "chaser.mass=nan")
        yield (name, "x.toml", *BASES[name][2:])
    yield from WORDS


LINES = list(command_lines())


def fault(done: Any, folder: Path) -> str:
    """Say what is wrong with how a bad request was answered; empty if nothing is."""
    if done.code != 2:
        return f"exit code {done.code}: {done.out[:200]}{done.err[:200]}"
    if done.out and "Usage" not in done.out:
        return f"standard output: {done.out[:200]}"
    if not done.err.strip() and not done.out:
        return "no message"
    if "Traceback" in done.err or "\x1b[31m" in done.err or "\0" in done.err:
        return f"standard error: {done.err[-300:]!r}"
    left = [path for path in folder.rglob("*") if path.is_file() and path.name not in (".lock",)]
    return f"files: {left}" if left else ""


def test_there_are_hundreds_of_bad_command_lines() -> None:
    assert len(set(LINES)) >= 400


@pytest.mark.parametrize("part", range(8))
def test_a_bad_command_line_is_answered_in_words(part: int, tmp_path: Path) -> None:
    wrong = {}
    for number, arguments in enumerate(LINES[part::8]):
        folder = tmp_path / str(number)
        folder.mkdir()
        try:
            found = fault(call(*arguments, cwd=folder), folder)
        except BaseException as error:  # whatever reaches the top would have been a traceback
            found = f"{type(error).__name__}: {error}"
        if found:
            wrong[" ".join(arguments)[:160]] = found
    assert not wrong, "\n".join(f"{line!r}: {found}" for line, found in wrong.items())


NUMBERS: tuple[Any, ...] = (
    "1", b"1", bytearray(b"1"), 1.5, -1, float("nan"), float("inf"), True, np.True_, [1], (), {}, 2**70, 1j, None,
    np.array([1, 2]), np.array("1"), np.float64(0.5), np.datetime64("2020"), np.timedelta64(3, "s"), np.timedelta64(3),
    datetime.date(2020, 1, 1), object(), "٣",
)  # fmt: skip
TEXTS: tuple[Any, ...] = (None, 3, b"prrl", ["prrl"], "", "PRRL", "\x1b", "none ", object())
PATHS: tuple[Any, ...] = (None, 3, b"x", "", [], {}, "\0", "/dev/zero", "/dev/null", Path("/dev/zero"), object())


@pytest.fixture(scope="module")
def short() -> Scenario:
    return with_settings(detumble.load("paper"), [SHORT])


@pytest.fixture(scope="module")
def result(short: Scenario) -> detumble.CampaignResult:
    return detumble.campaign(short, "prrl", 20, seed=1)


def tried(calls: dict[str, Callable[[], Any]]) -> None:
    """Make every call; each must raise a documented exception."""
    wrong = []
    for name, function in calls.items():
        try:
            wrong.append(f"{name}: gave {met(function())}")
        except RequestError as error:
            if not str(error).strip():
                wrong.append(f"{name}: no message")
        except Exception as error:  # that is what is looked for
            wrong.append(f"{name}: {type(error).__name__}: {error}")
    assert not wrong, "\n".join(wrong)


def test_what_is_no_whole_number_is_refused_everywhere(short: Scenario, result: detumble.CampaignResult) -> None:
    quick = {"budget": 1, "starts": 1}
    calls: dict[str, Callable[[], Any]] = {}
    for bad in NUMBERS:
        optional: dict[str, Callable[[], Any]] = {
            "campaign threads": lambda bad=bad: detumble.campaign(short, "prrl", 2, threads=bad),
            "local_cluster": lambda bad=bad: detumble.campaign(short, "prrl", 2, local_cluster=bad),
            "optimiser_seed": lambda bad=bad: detumble.tune(short, "prrl", **quick, optimiser_seed=bad),
            "held_out": lambda bad=bad: Plan(held_out=bad),
        }
        always: dict[str, Callable[[], Any]] = {
            "simulate seed": lambda bad=bad: detumble.simulate(short, "prrl", bad),
            "simulate index": lambda bad=bad: detumble.simulate(short, "prrl", index=bad),
            "campaign runs": lambda bad=bad: detumble.campaign(short, "prrl", bad),
            "campaign seed": lambda bad=bad: detumble.campaign(short, "prrl", 2, bad),
            "campaign shard": lambda bad=bad: detumble.campaign(short, "prrl", 2, shard=bad),
            "replay": lambda bad=bad: result.replay(bad),
            "tune budget": lambda bad=bad: detumble.tune(short, "prrl", budget=bad, starts=1),
            "tune starts": lambda bad=bad: detumble.tune(short, "prrl", budget=1, starts=bad),
            "tune seed": lambda bad=bad: detumble.tune(short, "prrl", **quick, seed=bad),
            "plan runs": lambda bad=bad: Plan(runs=bad),
            "plan seed": lambda bad=bad: Plan(seed=bad),
            "proportion": lambda bad=bad: Proportion.of(bad, 3),
        }
        for name, function in (always if bad is None else always | optional).items():
            calls[f"{name} {met(bad)}"] = function
    tried(calls)


def test_what_is_no_number_is_refused_everywhere(short: Scenario) -> None:
    calls: dict[str, Callable[[], Any]] = {}
    for bad in NUMBERS:
        if isinstance(bad, float) and 0.0 < bad < 10.0:
            continue
        some: dict[str, Callable[[], Any]] = {
            "required": lambda bad=bad: Objective(required=bad),
            "mass": lambda bad=bad: setattr(short.model_copy(deep=True).chaser, "mass", bad),
            "position": lambda bad=bad: setattr(short.model_copy(deep=True).chaser, "position", bad),
            "inertia": lambda bad=bad: setattr(short.model_copy(deep=True).chaser, "inertia", bad),
            "attitude": lambda bad=bad: setattr(short.model_copy(deep=True).chaser, "attitude", bad),
            "gain": lambda bad=bad: setattr(short.model_copy(deep=True).laws.prrl.rotation, "gain", bad),
            "within elements": lambda bad=bad: setattr(short.model_copy(deep=True).chaser, "position", [bad, 0.0, 0.0]),
        }
        if isinstance(bad, int) and not isinstance(bad, bool):  # a position may be -1, and a force gain large
            del some["within elements"]
        if bad is not None:
            some["until_ci"] = lambda bad=bad: detumble.campaign(short, "prrl", 2, until_ci=bad)
            some["percentile"] = lambda bad=bad: Objective(percentile=bad)
            some["fixed"] = lambda bad=bad: detumble.tune(short, "prrl", budget=1, starts=1, fixed={"alpha": bad})
            if not isinstance(bad, int) or bad < 0:
                some["horizon"] = lambda bad=bad: detumble.tune(short, "prrl", budget=1, starts=1, horizon=bad)
                some["within"] = lambda bad=bad: detumble.bound(short, within=bad)
        for name, function in some.items():
            calls[f"{name} {met(bad)}"] = function
    tried(calls)


def test_what_is_no_name_is_refused_everywhere(short: Scenario, result: detumble.CampaignResult) -> None:
    calls: dict[str, Callable[[], Any]] = {}
    for bad in TEXTS:
        some: dict[str, Callable[[], Any]] = {
            "tune law": lambda bad=bad: detumble.tune(short, bad, budget=1, starts=1),
            "objective": lambda bad=bad: Objective(what=bad),
            "summary": lambda bad=bad: result.statistics.summary(bad),
            "ecdf": lambda bad=bad: result.statistics.ecdf(bad),
            "entries": lambda bad=bad: detumble.compare(short, [bad, bad]),
            "plan": lambda bad=bad: detumble.compare(short, plan=bad if bad is not None else 3),
        }
        if bad != ["prrl"]:
            some["entries_of"] = lambda bad=bad: entries_of(bad)
        if bad is not None:
            some |= {
                "simulate law": lambda bad=bad: detumble.simulate(short, bad),
                "campaign law": lambda bad=bad: detumble.campaign(short, bad, 2),
                "backend": lambda bad=bad: detumble.simulate(short, "prrl", backend=bad),
                "form": lambda bad=bad: detumble.tune(short, "prrl", budget=1, starts=1, form=bad),
                "until": lambda bad=bad: Objective(until=bad),
            }
        for name, function in some.items():
            calls[f"{name} {met(bad)}"] = function
    calls["summary of a share"] = lambda: result.statistics.summary("success")
    calls["gain without a name"] = lambda: detumble.tune(short, "pd", budget=1, starts=1, fixed={1: 1.0})  # type: ignore[dict-item]
    for bad in (float("nan"), "5", [3], None, 1):
        calls[f"resume {bad!r}"] = lambda bad=bad: detumble.campaign(short, "pd", 2, resume=bad)
        if bad is not None:
            calls[f"stack {bad!r}"] = lambda bad=bad: detumble.tune(short, "pd", budget=1, starts=1, stack=bad)
    calls["more than a float holds"] = lambda: Objective(required=10**400)
    calls["more than a float holds, in time"] = lambda: detumble.bound(short, within=10**400)
    calls["more than all"] = lambda: Proportion.of(5, 3)
    tried(calls)


def test_what_is_no_path_is_refused_everywhere(
    short: Scenario, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    flight = detumble.simulate(short, "prrl")
    calls: dict[str, Callable[[], Any]] = {}
    for bad in PATHS:
        some: dict[str, Callable[[], Any]] = {
            "load": lambda bad=bad: detumble.load(bad),
            "simulate": lambda bad=bad: detumble.simulate(bad),
            "campaign": lambda bad=bad: detumble.campaign(bad),
            "bound": lambda bad=bad: detumble.bound(bad),
            "tune": lambda bad=bad: detumble.tune(bad, "prrl", budget=1),
            "compare": lambda bad=bad: detumble.compare(bad),
            "read_netcdf": lambda bad=bad: detumble.read_netcdf(bad),
            "read_campaign": lambda bad=bad: detumble.read_campaign(bad),
            "save": lambda bad=bad: short.save(bad),
            "to_netcdf": lambda bad=bad: flight.to_netcdf(bad),
            "from_toml": lambda bad=bad: from_toml(bad),
        }
        if bad is not None:
            some["out"] = lambda bad=bad: detumble.campaign(short, "prrl", 2, out=bad)
            some["compare out"] = lambda bad=bad: detumble.compare(short, out=bad)
            some["record"] = lambda bad=bad: detumble.tune(short, "prrl", budget=1, starts=1, record=bad)
        for name, function in some.items():
            calls[f"{name} {met(bad)}"] = function
    tried(calls)
    assert not list(tmp_path.iterdir())


WRONG_VALUES = ('"text"', "true", "nan", "-1e300", "1e300", "[]", "[1, 2]", "{}", "2020-01-01", "[[1]]")


def test_every_number_of_a_scenario_refuses_what_it_cannot_be(short: Scenario) -> None:
    """Field by field, the fault names the field."""
    wrong = []
    for path in fields():
        for value in WRONG_VALUES:
            try:
                with_settings(short, [f"{path}={value}"])
            except detumble.ScenarioError as error:
                named = {found.path for found in error.faults}
                if not any(found.startswith(path) or path.startswith(found) for found in named):
                    wrong.append(f"{path} = {value}: {named}")
            else:
                wrong.append(f"{path} = {value}: taken")
    assert not wrong, "\n".join(wrong)


def test_a_list_that_was_appended_to_is_checked(short: Scenario) -> None:
    bad: tuple[Any, ...] = ({"field": "nope"}, 5, None, "x", {}, {"field": "chaser.mass", "distribution": "normal"})
    for item in bad:
        for name in ("dispersions", "correlations"):
            scenario = short.model_copy(deep=True)
            getattr(scenario, name).append(item)
            for use in (detumble.simulate, detumble.campaign, Scenario.to_toml, Scenario.check):
                with pytest.raises(RequestError):
                    use(scenario)
    scenario = short.model_copy(deep=True)
    scenario.dispersions.append({"field": "chaser.mass", "distribution": "normal", "sigma": 0.1})  # type: ignore[arg-type]
    drawn = detumble.campaign(scenario, "prrl", 5).runs.to_polars()["chaser.mass"]
    assert drawn.std() > 0.0
    assert from_toml(scenario.to_toml()).dispersions[0].field == "chaser.mass"


def test_numbers_of_numpy_and_xarray_are_numbers(short: Scenario) -> None:
    flight = detumble.simulate(short, "prrl", np.uint64(2**64 - 1), index=np.int8(3))
    assert (flight.seed, flight.index) == (2**64 - 1, 3)
    assert json.dumps(flight.seed)
    campaign = detumble.campaign(short, "prrl", np.int32(4), np.int64(1), threads=np.int16(1), shard=np.int64(2))
    assert campaign.replay(np.int64(3)).index == 3
    scenario = short.model_copy(deep=True)
    scenario.chaser.position = flight.data.position[-1]
    assert scenario.chaser.position == tuple(flight.history["position"][-1])
    scenario.chaser.attitude = flight.data.chaser_attitude[0].to_pandas()
    scenario.chaser.position = (np.float32(0.5), np.int64(2), np.array(3.0))
    assert scenario.chaser.position == (0.5, 2.0, 3.0)
    scenario.chaser.inertia = [np.array([0.1, 0.0, 0.0]), (0.0, np.float64(0.1), 0), np.array([0, 0, 0.05])]
    scenario.chaser.mass = np.float32(12.0)
    scenario.actuators.force_limit = np.array([0.1, 0.2, 0.3])
    scenario.laws.tsmc.translation.p = np.int64(7)
    assert from_toml(scenario.to_toml()) == scenario
    with pytest.raises(detumble.ScenarioError, match=r"is in m/s; must be a list of 3 numbers in m"):
        scenario.chaser.position = flight.data.velocity[-1]
    with pytest.raises(detumble.ScenarioError, match=r"is in m/s; must be a list of 3 numbers in m"):
        scenario.chaser.position = [1.0, flight.data.velocity[-1, 0], 2.0]
    for nine in (Decimal(9), np.longdouble(9), np.array(9, dtype=object), np.float16(9)):
        scenario.chaser.mass = nine
        assert scenario.chaser.mass == 9.0
    scenario.capture.merge = np.bool_(False)
    assert scenario.capture.merge is False
