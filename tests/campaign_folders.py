"""Folders of campaigns full of made-up rows, in this process and in others: what the tests of storage share."""

from __future__ import annotations

import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import detumble
from detumble.campaigns.recipe import Recipe
from detumble.campaigns.store.campaign_folder import Store
from detumble.campaigns.store.shard import frame_of
from detumble.failures import CAUSES

ROWS = 100
"""In a shard."""
RUNS = 450
ABOUT = {"backend": "avx2", "machine": {"cpu": "a processor", "cores": 2}}
ODD = "a folder=1 [*] Δv"
"""Has what shells, globs and Hive partitions read something into."""


@cache
def recipe() -> Recipe:
    """What all these campaigns say that they fly."""
    return Recipe(detumble.load("paper").to_toml(), "prrl", 2**64 - 1, shard=ROWS)


def begin(folder: Path | str, runs: int = RUNS, *, resume: bool = False) -> Store:
    """Begin or continue such a campaign."""
    return Store.create(folder, recipe(), runs, about=ABOUT, resume=resume)


def rows(first: int, count: int = ROWS) -> dict[str, Any]:
    """Rows that depend on the run alone."""
    index = np.arange(first, first + count, dtype=np.uint64)
    noise = np.modf(np.sin(index.astype(float) + 1.0) * 43758.5453)[0]
    success = noise > -0.5
    return {
        "index": index,
        "chaser.mass": 8.0 + 0.1 * noise,
        "chaser.position.x": noise - 3.0,
        "success": success,
        "failure": [None if fine else CAUSES[number % len(CAUSES)] for number, fine in enumerate(success)],
        "capture_time_s": np.where(success, 40.0 + noise, np.nan),
        "force_saturated_share": np.abs(noise),
    }


def fly(store: Store, runs: int, but: tuple[int, ...] = ()) -> None:
    """Write the shards of so many runs, the last first."""
    for number in reversed(range(store.recipe.shards(runs))):
        if number not in but:
            span = store.recipe.runs_of(number, runs)
            store.write(number, frame_of(rows(span.start, len(span))))


def there(store: Store, runs: int) -> tuple[list[int], list[str]]:
    """Give the shards of so many runs that are whole and sound, and what is remarked of the others."""
    remarks: list[str] = []
    needed = {number: len(store.recipe.runs_of(number, runs)) for number in range(store.recipe.shards(runs))}
    return [number for number in needed if store.find(number, needed[number], remarks.append) is not None], remarks


def flip(path: Path, place: int, bit: int = 0) -> None:
    """Change one bit of a file."""
    content = bytearray(path.read_bytes())
    content[place] ^= 1 << bit
    path.write_bytes(content)


def child(script: str, folder: Path, *wrapper: str) -> subprocess.Popen[str]:
    """Start a process that runs a script; there `folder` is the folder, and all of this module is at hand."""
    prelude = (
        f"import sys\nsys.path.insert(0, {str(Path(__file__).parent)!r})\nfrom campaign_folders import *\n"
        "from detumble.errors import RequestError\nfolder = Path(sys.argv[1])\n"
    )
    command = [*wrapper, sys.executable, "-c", prelude + script, str(folder)]
    streams = dict.fromkeys(("stdin", "stdout", "stderr"), subprocess.PIPE)
    return subprocess.Popen(command, text=True, **streams)


def on_a_disk_of_its_own(folder: Path, options: str, *command: str) -> list[str]:
    """Give a command that sees another file system at `folder`."""
    mount = f'mount -t tmpfs -o {options} none "$0" && exec "$@"'
    return ["unshare", "-rm", "sh", "-c", mount, str(folder), *command]


def _can_mount() -> bool:
    command = on_a_disk_of_its_own(Path("/mnt"), "ro", "true")
    return shutil.which("unshare") is not None and subprocess.run(command, capture_output=True).returncode == 0


needs_a_disk_of_its_own = pytest.mark.skipif(not _can_mount(), reason="needs a file system of its own")
