"""A run is the same run, bit by bit, whoever flies it and however many are flown beside it."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

import detumble
from detumble.campaigns.recipe import Recipe
from detumble.campaigns.result import CampaignResult
from detumble.campaigns.runs.cluster import fly_shard
from detumble.campaigns.runs.flying import fly_runs
from detumble.campaigns.statistics.running import Statistics
from detumble.campaigns.store.shard import digest, frame_of
from detumble.compiled import core
from detumble.errors import RequestError
from detumble.progress import Watcher
from detumble.scenario import LAWS
from uncertain import flown, rows_digest, uncertain

QUIET: dict[str, Any] = {"scheduler_kwargs": {"dashboard": False, "dashboard_address": "127.0.0.1:0"}}
WIDE = {"avx2", "avx512"} & set(core().backends())


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> CampaignResult:
    return flown(tmp_path_factory.mktemp("reference") / "one", threads=1)


def test_the_campaign_ends_in_every_way(reference: CampaignResult) -> None:
    causes = set(reference.statistics.failures)
    assert {"diverged", "captured, not settled", "never captured: dwell", "never captured: angle"} <= causes
    ends = reference.runs.to_polars()["end_time_s"]
    assert reference.statistics.success.count > 10
    assert (ends < 60.0).sum() > 40
    assert (ends == 60.0).sum() > 50


def test_run_i_is_the_same_however_many_are_flown(reference: CampaignResult, tmp_path: Path) -> None:
    fewer = flown(tmp_path / "fewer", runs=130).runs.to_polars()
    assert fewer["index"].to_list() == list(range(130))
    assert digest(fewer) == digest(reference.runs.to_polars().head(130))


@pytest.mark.parametrize("how", [{"threads": 2}, {"shard": 17}, {"shard": 1000, "threads": 2}], ids=str)
def test_results_depend_neither_on_threads_nor_on_shards(
    reference: CampaignResult, tmp_path: Path, how: dict[str, int]
) -> None:
    assert rows_digest(flown(tmp_path, **how)) == rows_digest(reference)


@pytest.mark.skipif(len(WIDE) < 2, reason="this CPU lacks AVX2 or AVX-512")
@pytest.mark.parametrize("law", [*LAWS, "none"])
def test_avx2_and_avx512_give_the_same_rows(law: str) -> None:
    recipe = Recipe(uncertain().to_toml(), law, 3)
    narrow, wide = (fly_runs(recipe, 2**40, 100, backend=backend).columns for backend in ("avx2", "avx512"))
    assert digest(frame_of(narrow)) == digest(frame_of(wide))


@pytest.mark.parametrize("law", [*LAWS, "none"])
def test_any_part_of_a_campaign_can_be_flown_alone(law: str) -> None:
    recipe = Recipe(uncertain().to_toml(), law, 2**64 - 1)
    whole = frame_of(fly_runs(recipe, 0, 61, threads=2).columns)
    for first, count in ((0, 1), (5, 9), (60, 1)):
        part = frame_of(fly_runs(recipe, first, count).columns)
        assert digest(part) == digest(whole.slice(first, count))


def test_seeds_and_laws_have_rows_of_their_own(reference: CampaignResult, tmp_path: Path) -> None:
    other = flown(tmp_path / "seed", seed=4, runs=20).runs.to_polars()
    law = flown(tmp_path / "law", law="lqr", runs=20).runs.to_polars()
    same = reference.runs.to_polars().head(20)
    assert not set(other["chaser.mass"]) & set(same["chaser.mass"])
    assert law["chaser.mass"].equals(same["chaser.mass"])
    assert not set(law["delta_v_m_s"]) & set(same["delta_v_m_s"])


def test_a_campaign_without_dispersions_still_has_noise_of_its_own_in_each_run(tmp_path: Path) -> None:
    scenario = uncertain()
    scenario.dispersions = []
    rows = detumble.campaign(scenario, "prrl", 50, out=tmp_path).runs.to_polars()
    assert rows["delta_v_m_s"].n_unique() == 50
    assert not any(name.startswith("chaser") for name in rows.columns)


# --- Dask --------------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    distributed = pytest.importorskip("distributed")
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, host="127.0.0.1", silence_logs=50, **QUIET
    ) as cluster:
        yield cluster


class Killer(Watcher):
    """Kills the workers one after the other, each as soon as so many runs more are done."""

    def __init__(self, workers: list[int], pause: int) -> None:
        self.workers, self.pause, self.killed = workers, pause, 0

    def now(self, done: int, flown: int, statistics: Statistics) -> None:
        if self.killed < len(self.workers) and done >= (self.killed + 1) * self.pause:
            os.kill(self.workers[self.killed], signal.SIGKILL)
            self.killed += 1


def test_workers_of_a_cluster_give_the_same_rows_whatever_their_number_and_though_some_are_killed(
    reference: CampaignResult, cluster: Any, tmp_path: Path
) -> None:
    alone = flown(tmp_path / "one", local_cluster=1)
    assert alone.store.manifest.about[0]["workers"] == 1
    assert rows_digest(alone) == rows_digest(reference)

    with cluster.get_client() as client:
        workers = list(client.run(os.getpid).values())
        killer = Killer(workers, pause=100)
        robbed = flown(tmp_path / "robbed", scheduler=cluster.scheduler_address, shard=10, watcher=killer)
        assert killer.killed == 2
        assert rows_digest(robbed) == rows_digest(reference)
        assert robbed.store.manifest.about[0]["workers"] == 2

        cluster.scale(3)
        client.wait_for_workers(3, timeout=60)
        for law in ("none", "prrl"):
            three = flown(tmp_path / "three" / law, law, scheduler=cluster.scheduler_address)
            here = flown(tmp_path / "here" / law, law)
            assert three.store.manifest.about[0]["workers"] == 3
            assert rows_digest(three) == rows_digest(here)
            assert three.statistics.to_json() == here.statistics.to_json()


def test_a_cluster_stops_where_this_process_would(cluster: Any, tmp_path: Path) -> None:
    here, there = (
        flown(tmp_path / name, runs=2000, shard=50, until_ci=0.06, **how)
        for name, how in {"here": {}, "there": {"scheduler": cluster.scheduler_address}}.items()
    )
    assert 100 < here.statistics.runs == there.statistics.runs < 1000
    assert rows_digest(here) == rows_digest(there)
    assert len(list((tmp_path / "there" / "shards").iterdir())) == there.statistics.runs // 50


def test_a_scheduler_that_is_not_there_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("distributed")
    monkeypatch.setattr("detumble.campaigns.runs.cluster._CONNECT_SECONDS", 0.5)
    for address in ("tcp://127.0.0.1:9", "nowhere"):
        with pytest.raises(RequestError, match=f"scheduler {address}: cannot be reached"):
            flown(tmp_path / "out", scheduler=address)
    assert not (tmp_path / "out").exists()


class Call(Watcher):
    """Does something once, after three shards."""

    def __init__(self, something: Callable[[], object]) -> None:
        self.something: Callable[[], object] | None = something

    def now(self, done: int, flown: int, statistics: Statistics) -> None:
        if self.something and statistics.runs >= 300:
            self.something()
            self.something = None


def test_a_cluster_that_breaks_down_is_told_and_the_campaign_can_be_continued(
    reference: CampaignResult, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    dask, distributed = (pytest.importorskip(name) for name in ("dask", "distributed"))
    monkeypatch.setattr("detumble.campaigns.runs.cluster._CONNECT_SECONDS", 1)
    kept = "the shards that are complete are kept, and --resume continues"
    with (
        distributed.LocalCluster(n_workers=1, processes=False, silence_logs=50, **QUIET) as cluster,
        pytest.raises(RequestError, match=f"^the scheduler is lost; {kept}$"),
    ):
        flown(tmp_path, runs=10**5, scheduler=cluster.scheduler_address, watcher=Call(cluster.close))
    assert len(list((tmp_path / "shards").iterdir())) >= 3

    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 0}),
        distributed.LocalCluster(n_workers=1, threads_per_worker=1, silence_logs=50, **QUIET) as cluster,
        cluster.get_client() as client,
    ):
        (worker,) = client.run(os.getpid).values()
        killed = Call(lambda: os.kill(worker, signal.SIGKILL))
        address = cluster.scheduler_address
        with pytest.raises(RequestError, match=f"^workers died over the same runs again and again; {kept}$"):
            flown(tmp_path, runs=10**5, scheduler=address, resume=True, watcher=killed)
        client.wait_for_workers(1, timeout=60)
        ended = flown(tmp_path, scheduler=address, resume=True)
    assert rows_digest(ended) == rows_digest(reference)


def test_a_worker_that_would_give_other_rows_refuses(monkeypatch: pytest.MonkeyPatch) -> None:
    recipe = Recipe(uncertain().to_toml(), "pd", 0)
    with pytest.raises(RequestError, match=r"a worker has detumble .*, the campaign 0\.0: runs might differ"):
        fly_shard(recipe.to_dict() | {"version": "0.0"}, 0, 1, None)
    with pytest.raises(RequestError, match="backend portable: its rows would differ in the last bits from those"):
        fly_shard(recipe.to_dict(), 0, 1, "portable")
    monkeypatch.setattr("detumble._core.backends", lambda: ["portable"])
    with pytest.raises(RequestError, match="no AVX2: its rows would differ"):
        fly_shard(recipe.to_dict(), 0, 1, None)


def test_without_dask_the_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(RequestError, match=r"Dask is not installed; install detumble\[cluster\]"):
        flown(tmp_path, local_cluster=1)
