"""Processes that are forked from one that has flown: what works in them does, what cannot says so at once."""

from __future__ import annotations

import multiprocessing
import subprocess
import sys

import pytest

from detumble import surroundings

pytestmark = pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="no forks here")

PROGRAM = """
import multiprocessing, os, sys, warnings
warnings.simplefilter("ignore")
{before}

def campaign():
    import detumble
    return detumble.campaign("paper", runs=2).statistics.runs

def simulate():
    import detumble
    return detumble.simulate("paper").law

def cluster():
    import detumble
    return detumble.campaign("paper", runs=2, local_cluster=1).statistics.runs

def table():
    return result.runs.to_polars().height

def values():
    return result.runs.to_xarray().capture_time_s.values.size

def replay():
    return result.replay(0).law

def tried(work):
    try:
        return work()
    except Exception as error:
        return f"{{type(error).__name__}}: {{error}}"

if __name__ == "__main__":
    with multiprocessing.get_context("fork").Pool(1) as pool:
        for work in ({works},):
            print(pool.apply_async(tried, (work,)).get(30))
"""
REFUSED = "RequestError: this process was forked from one in which polars is at work"


def answers(before: str, works: str) -> list[str]:
    program = PROGRAM.format(before=before, works=works)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=90)
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


@pytest.mark.parametrize(
    "before",
    [
        "import detumble; result = detumble.campaign('paper', runs=2)",
        "import detumble; result = detumble.campaign('paper', runs=2); detumble.read_campaign(result.folder)",
    ],
)
def test_after_a_campaign_what_needs_its_threads_is_refused_at_once_and_the_rest_works(before: str) -> None:
    campaign, table, values, simulate, replay = answers(before, "campaign, table, values, simulate, replay")
    for refused in (campaign, table, values):
        assert refused.startswith(REFUSED)
        assert "spawn" in refused
    assert (simulate, replay) == ("prrl", "prrl")


@pytest.mark.parametrize("imported", ["", "import detumble; "])
def test_polars_used_by_others_is_met_too(imported: str) -> None:
    used = "import io, polars; polars.DataFrame({'a': [1.0]}).write_parquet(io.BytesIO())"
    campaign, simulate = answers(imported + used, "campaign, simulate")
    assert campaign.startswith(REFUSED)
    assert simulate == "prrl"


@pytest.mark.parametrize("before", ["import polars", "import detumble.campaigns.campaign"])
def test_where_polars_has_done_nothing_yet_a_child_may_fly(before: str) -> None:
    assert answers(before, "campaign, simulate") == ["2", "prrl"]


def test_a_worker_that_may_have_no_children_says_so() -> None:
    pytest.importorskip("distributed")
    (cluster,) = answers("", "cluster")
    assert cluster.startswith("RequestError: local_cluster 1: a worker of multiprocessing.Pool can start no processes")


def test_this_process_was_not_forked() -> None:
    assert not surroundings.lost
