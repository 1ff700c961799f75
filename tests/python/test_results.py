"""Folders of results: what was not written there by detumble, or was changed since, is never replaced."""

from __future__ import annotations

import hashlib
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import detumble
from commands import call
from detumble.analysis.comparing.plan import Plan
from detumble.errors import RequestError
from detumble.results import WRITTEN, results_folder
from detumble.writing import write_text

SHORT = ("--set", "time.duration=5.0")
COMMANDS = {
    "run": ("run", "paper", *SHORT),
    "bound": ("bound", "paper", "--runs", "2", "--quick", *SHORT),
    "tune": ("tune", "paper", "--budget", "1", "--starts", "1", "--held-out", "0", *SHORT),
    "compare": ("compare", "paper", "--as-given", "--runs", "2", "--robust", "0", "--laws", "pd,prrl", *SHORT),
}


def state(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("command", COMMANDS)
def test_the_users_scenario_in_the_folder_stays(command: str, tmp_path: Path) -> None:
    own = tmp_path / "scenario.toml"
    own.write_text("# my own words\n" + detumble.load("paper").to_toml())
    before = state(tmp_path)
    name, _, *rest = COMMANDS[command]
    for arguments in ((name, "scenario.toml", *rest), (name, "paper", *rest)):
        done = call(*arguments, "--out", ".", cwd=tmp_path)
        assert done.code == 2, done.err
        assert "scenario.toml" in done.err
        assert done.err.count("\n") == 1
        assert state(tmp_path) == before


def test_a_result_is_replaced_by_the_next_one_but_not_after_an_edit(tmp_path: Path) -> None:
    run = ("run", "paper", *SHORT, "--out", "results")
    assert call(*run, "--law", "pd", cwd=tmp_path).code == 0
    first = state(tmp_path)
    assert call(*run, "--law", "lqr", cwd=tmp_path).code == 0
    second = state(tmp_path)
    assert first["results/metrics.json"] != second["results/metrics.json"]
    scenario = tmp_path / "results" / "scenario.toml"
    assert call("run", "results/scenario.toml", "--out", "results", cwd=tmp_path).code == 2
    scenario.write_text(scenario.read_text() + "# a note\n")
    edited = state(tmp_path)
    done = call(*run, "--law", "pd", cwd=tmp_path)
    assert done.code == 2
    assert "scenario.toml" in done.err
    assert state(tmp_path) == edited


def test_a_campaign_leaves_a_foreign_summary_and_foreign_figures(tmp_path: Path) -> None:
    fly = ("campaign", "paper", "--runs", "3", *SHORT, "--out", ".", "--resume", "--figures")
    (tmp_path / "figures").mkdir()
    (tmp_path / "figures" / "mine.png").write_text("not in the way")
    for name in ("summary.json", "figures/failures.png"):
        mine = tmp_path / name
        mine.parent.mkdir(exist_ok=True)
        mine.write_text("mine")
        done = call(*fly, cwd=tmp_path)
        assert done.code == 2, done.err
        assert name in done.err
        assert state(tmp_path) == {name: b"mine", "figures/mine.png": b"not in the way"}
        mine.unlink()
    for _ in range(2):  # its own are replaced
        assert call(*fly, cwd=tmp_path).code == 0


def test_a_killed_process_leaves_nothing_that_the_next_one_does_not_know(tmp_path: Path) -> None:
    """Written ahead: both the file that stood there and the one that was to come are known."""

    class Killed(BaseException):
        pass

    with results_folder(tmp_path, ["file"]):
        write_text(tmp_path / "file", "first")
    replace = Path.replace

    def die(self: Path, target: Path) -> Path:
        if Path(target).name == "file":
            raise Killed
        return replace(self, target)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Path, "replace", die)
        with pytest.raises(Killed), results_folder(tmp_path, ["file"]):
            write_text(tmp_path / "file", "second")
    for text in ("first", "second"):
        (tmp_path / "file").write_text(text)
        with results_folder(tmp_path, ["file"]):
            pass
    (tmp_path / "file").write_text("third")
    with pytest.raises(RequestError, match="file: not written by detumble"), results_folder(tmp_path, ["file"]):
        pass


def test_a_file_that_was_not_foreseen_is_not_replaced_either(tmp_path: Path) -> None:
    (tmp_path / "other").write_text("mine")
    with pytest.raises(RequestError, match="other"), results_folder(tmp_path, ["file"]):
        write_text(tmp_path / "other", "ours")
    assert (tmp_path / "other").read_text() == "mine"


@pytest.mark.parametrize("content", ["", "{", "[]", '{"files": 3}', '{"files": {"file": 3}}', '{"my": "notes"}', "\0"])
def test_another_file_of_the_ledgers_name_stays(content: str, tmp_path: Path) -> None:
    (tmp_path / WRITTEN).write_text(content)
    with pytest.raises(RequestError, match=WRITTEN), results_folder(tmp_path, ["file"]):
        write_text(tmp_path / "file", "ours")
    assert state(tmp_path) == {WRITTEN: content.encode()}


def test_a_link_of_the_ledgers_name_stays(tmp_path: Path) -> None:
    (tmp_path / "mine").write_text("mine")
    for target in ("mine", "nowhere"):
        (tmp_path / WRITTEN).symlink_to(target)
        with pytest.raises(RequestError, match=WRITTEN), results_folder(tmp_path, ["file"]):
            pass
        (tmp_path / WRITTEN).unlink()
    assert state(tmp_path) == {"mine": b"mine"}


def test_another_lock_file_or_record_stays(tmp_path: Path) -> None:
    fly = ("campaign", "paper", "--runs", "2", *SHORT, "--out", ".")
    tune = ("tune", "paper", "--budget", "1", "--starts", "1", "--held-out", "0", *SHORT, "--out", ".")
    (tmp_path / "mine").write_text("12")
    for command in (fly, tune):
        (tmp_path / ".lock").symlink_to("mine")
        assert call(*command, cwd=tmp_path).code == 2
        (tmp_path / ".lock").unlink()
        (tmp_path / ".lock").write_text("my own lock")
        assert call(*command, cwd=tmp_path).code == 2
        assert state(tmp_path) == {"mine": b"12", ".lock": b"my own lock"}
        (tmp_path / ".lock").unlink()
    for content in ("my only notes", "my notes\n", '{"formal": 1'):
        (tmp_path / "record.jsonl").write_text(content)
        assert call(*tune, cwd=tmp_path).code == 2, content
        assert state(tmp_path) == {"mine": b"12", "record.jsonl": content.encode()}


def test_only_temporary_files_of_killed_writers_are_removed(tmp_path: Path) -> None:
    mine = (".campaign.mine.json", ".campaign.json", "shards/.shard-mine.parquet", ".fig1.png")
    theirs = (".campaign.12.json", ".campaign.12-34.json", "shards/.shard-000000.12.parquet", ".summary.99.json")
    (tmp_path / "shards").mkdir()
    for name in (*mine, *theirs):
        (tmp_path / name).write_text("x")
    (tmp_path / "shards" / "shard-000000.parquet").write_text("x")
    fly = ("campaign", "paper", "--runs", "2", *SHORT, "--out", ".")
    assert call(*fly, cwd=tmp_path).code == 2
    (tmp_path / "shards" / "shard-000000.parquet").unlink()
    for name in ("shards/.shard-mine.parquet", "shards/.shard-000000.12.parquet"):
        (tmp_path / name).unlink()
    assert call(*fly, cwd=tmp_path).code == 0
    # of a campaign's own files; beside them nobody knows whose they are
    assert {name for name in (*mine, *theirs) if (tmp_path / name).exists()} == {mine[0], mine[1], mine[3], theirs[3]}


def test_results_of_another_request_do_not_stay_beside_the_new_ones(tmp_path: Path) -> None:
    bound = ("bound", "paper", "--out", "b")
    assert call(*bound, *SHORT, "--runs", "2", "--quick", cwd=tmp_path).code == 0
    (tmp_path / "b" / "notes.csv").write_text("mine")
    assert call(*bound, "--set", "time.duration=1.0", cwd=tmp_path).code == 0
    assert set(state(tmp_path / "b")) == {"bound.json", "scenario.toml", "notes.csv", WRITTEN}


def test_a_campaign_is_read_from_nothing_that_has_no_end(tmp_path: Path) -> None:
    fly = ("campaign", "paper", "--runs", "3", *SHORT, "--out", "c")
    assert call(*fly, cwd=tmp_path).code == 0
    shard, manifest = tmp_path / "c" / "shards" / "shard-000000.parquet", tmp_path / "c" / "campaign.json"
    shard.unlink()
    os.mkfifo(shard)
    assert call("run", "--replay", "c:0", cwd=tmp_path).code == 0
    with pytest.raises(RequestError):
        detumble.read_campaign(tmp_path / "c")
    assert call(*fly, "--resume", cwd=tmp_path).code == 2
    manifest.unlink()
    for make in (os.mkfifo, lambda path: path.symlink_to("/dev/zero"), Path.mkdir):
        make(manifest)
        for command in (("run", "--replay", "c:0"), fly):
            assert call(*command, cwd=tmp_path).code == 2
        Path.rmdir(manifest) if manifest.is_dir() else manifest.unlink()


@pytest.mark.parametrize(
    ("name", "value"), [("shard", 0), ("seed", -1), ("law", "x"), ("arithmetic", "foo"), ("format", "2")]
)
def test_a_manifest_with_a_wrong_value_is_refused(name: str, value: object, tmp_path: Path) -> None:
    folder = tmp_path / "c"
    paper = detumble.load("paper")
    paper.time.duration = 2.0
    detumble.campaign(paper, "pd", 3, out=folder)
    raw = json.loads((folder / "campaign.json").read_text())
    if name == "format":
        raw["format"] = value
    else:
        raw["recipe"][name] = value
        raw["identity"] = hashlib.sha256(json.dumps(raw["recipe"], sort_keys=True).encode()).hexdigest()
    (folder / "campaign.json").write_text(json.dumps(raw))
    with pytest.raises(RequestError, match=rf"campaign\.json: broken: .*{name}"):
        detumble.read_campaign(folder)


def test_two_processes_do_not_write_into_one_folder(tmp_path: Path) -> None:
    with results_folder(tmp_path, ["*"]):
        command = [sys.executable, "-m", "detumble.cli", "run", "paper", *SHORT, "--out", str(tmp_path)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "another process" in done.stderr


def test_a_comparison_does_not_replace_another(tmp_path: Path) -> None:
    compare = ("compare", "paper", "--as-given", "--runs", "2", "--robust", "0", *SHORT, "--out", "c")
    assert call(*compare, "--laws", "pd,prrl", cwd=tmp_path).code == 0
    before = state(tmp_path)
    assert {"c/tuned/pd.toml", "c/tuned/prrl-smc.toml"} <= set(before)
    for changed in (("--laws", "pd,lqr"), ("--laws", "pd,prrl", "--seed", "3"), ("--laws", "pd,prrl")):
        done = call(*compare, *changed, cwd=tmp_path)
        assert done.code == 2
        assert "holds" in done.err
        assert state(tmp_path) == before
    more = [*compare[: compare.index("--runs")], "--runs", "3", *compare[compare.index("--runs") + 2 :]]
    for again in (compare, more):
        assert call(*again, "--laws", "pd,prrl", "--resume", cwd=tmp_path).code == 0
        assert set(state(tmp_path)) == set(before)


LOST = ("--set", "laws.lqr.translation.q_error=1e-300")
"""Weights of which the Riccati equation has no solution."""


@pytest.mark.parametrize(
    "command",
    [
        ("campaign", "paper", "--law", "lqr", "--runs", "4", *LOST),
        ("tune", "paper", "--law", "lqr", "--budget", "4", *LOST),
        ("tune", "paper", "--law", "lqr", "--objective", "pareto", "--budget", "4", *LOST),
        ("compare", "paper", "--laws", "pd,lqr", "--runs", "10", "--budget", "4", *LOST),
        ("compare", "paper", "--as-given", "--laws", "pd,lqr", "--runs", "10", *LOST),
    ],
)
def test_a_refused_request_leaves_no_folder(command: tuple[str, ...], tmp_path: Path) -> None:
    done = call(*command, "--out", "o", cwd=tmp_path)
    assert done.code == 2
    assert "Riccati" in done.err
    assert not list(tmp_path.iterdir())


def test_an_empty_name_is_no_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    paper = detumble.load("paper")
    for out in ("", "  ", "a\0b", 5, b"x"):
        with pytest.raises(RequestError, match="out"):
            detumble.campaign(paper, runs=2, out=out)  # type: ignore[arg-type]
        with pytest.raises(RequestError, match="out"):
            detumble.compare(paper, plan=Plan(as_given=True, runs=2, robust=0), out=out)  # type: ignore[arg-type]
        with pytest.raises(RequestError):
            detumble.read_campaign(out)  # type: ignore[arg-type]
    assert not list(tmp_path.iterdir())


def test_a_result_is_read_also_from_another_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    paper = detumble.load("paper")
    paper.time.duration = 5.0
    result = detumble.campaign(paper, "prrl", 3, out="here")
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert len(result.runs.to_polars()) == 3
    assert result.replay(2).index == 2
    assert result.folder == tmp_path / "here"


def test_a_continued_campaign_tells_of_all_runs_that_it_has(tmp_path: Path) -> None:
    fly = ("campaign", "paper", *SHORT, "--out", "c")
    assert call(*fly, "--runs", "40", cwd=tmp_path).code == 0
    summary = state(tmp_path)["c/summary.json"]
    for more in (("--runs", "10"), ()):
        done = call(*fly, *more, "--resume", "--json", cwd=tmp_path)
        assert done.code == 0, done.err
        assert '"runs": 40' in done.out
    again = state(tmp_path)["c/summary.json"]
    assert b'"runs": 40' in again
    assert again.split(b'"rate_runs')[0] == summary.split(b'"rate_runs')[0]


def test_a_smaller_budget_does_not_replace_better_gains(tmp_path: Path) -> None:
    tune = ("tune", "paper", "--starts", "2", "--held-out", "0", *SHORT, "--out", "t")
    assert call(*tune, "--budget", "20", cwd=tmp_path).code == 0
    before = state(tmp_path)
    done = call(*tune, "--budget", "3", "--resume", cwd=tmp_path)
    assert done.code == 2
    assert "20 candidates" in done.err
    for name in ("scenario.toml", "tuning.json", "record.jsonl"):
        assert state(tmp_path)[f"t/{name}"] == before[f"t/{name}"]
    assert call(*tune, "--budget", "20", "--resume", cwd=tmp_path).code == 0
