"""The folder of a campaign: what it flies, and its runs in shards, so that it can be stopped at any time and continued.

    campaign.json                     what is flown, and how many runs were asked for
    shards/shard-000000.parquet ...   shard k holds runs [k n, (k+1) n), n as the recipe says
    .lock                             held by the process that flies

Every file is written whole or not at all, also when power fails. Run i is the same run however many are asked for; so a
campaign that is continued with more runs grows, and one continued with fewer keeps all it has.
"""

from __future__ import annotations

import json
import os
from contextlib import suppress
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from detumble.campaigns.columns import INDEX
from detumble.campaigns.store.manifest import FORMAT, MANIFEST, Manifest, differences, read_manifest
from detumble.campaigns.store.shard import Damage, decode, encode, rows_in
from detumble.errors import RequestError
from detumble.locking import Lock
from detumble.version import __version__
from detumble.writing import leftovers, named_folder, output_folder, read_bytes, reason, whole_file

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from types import TracebackType
    from typing import Self

    from detumble.campaigns.recipe import Recipe


_MOST_BYTES = 2**33
"""Of a shard: the most runs that one may hold take a tenth of it."""


class Store:
    """The folder of a campaign. One that was created or continued is locked until it is closed; use it in `with`.

    Attributes:
        folder: the folder.
        manifest: what is flown, as `campaign.json` has it.
    """

    def __init__(self, folder: Path, manifest: Manifest, lock: Lock | None = None) -> None:
        self.folder = folder
        self.manifest = manifest
        self._lock = lock

    @classmethod
    def create(
        cls,
        folder: str | os.PathLike[str],
        recipe: Recipe,
        runs: int,
        *,
        about: Mapping[str, Any],
        resume: bool = False,
    ) -> Store:
        """Begin a campaign, or continue it, and lock its folder.

        Args:
            folder: created if it is not there; other files in it do not matter.
            recipe: what is flown.
            runs: how many.
            about: back end and machine, as JSON takes them.
            resume: continue the campaign if the folder holds it already; temporary files of killed processes are removed.

        Raises:
            RequestError: the folder is not writable, holds another campaign, holds this one and `resume` is not set, or
                another process is flying it.
        """
        folder = named_folder(folder, "folder")
        with output_folder(folder):
            lock = Lock(folder, "flying this campaign")
            try:
                manifest = _begun(folder, recipe, runs, json.loads(json.dumps(about)), resume)
            except BaseException:
                lock.close(forget=True)
                raise
        return cls(_absolute(folder), manifest, lock)

    @classmethod
    def open(cls, folder: str | os.PathLike[str]) -> Store:
        """Open a campaign to read it.

        Raises:
            RequestError: there is none, or its manifest cannot be used.
        """
        named = named_folder(folder, "folder")
        return cls(_absolute(named), read_manifest(named))

    @property
    def recipe(self) -> Recipe:
        """What is flown."""
        return self.manifest.recipe

    @property
    def runs(self) -> int:
        """The most runs that were ever asked of the campaign."""
        return self.manifest.runs

    def close(self) -> None:
        """Release the lock of the folder."""
        if self._lock:
            self._lock.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def path(self, index: int) -> Path:
        """Give the path of a shard."""
        return self.folder / "shards" / f"shard-{index:06}.parquet"

    def stored_runs(self) -> int:
        """Count the runs that are there, from the first on without a gap; what is damaged counts as missing."""
        runs = 0
        for index in range(self.recipe.shards(self.runs)):
            try:
                rows = rows_in(self.path(index), self.recipe.identity, index)
            except (FileNotFoundError, Damage):
                break
            runs += rows
            if rows < self.recipe.shard:
                break
        return runs

    def write(self, index: int, frame: pl.DataFrame) -> None:
        """Write a shard, whole or not at all; an older one is replaced.

        Args:
            index: of the shard.
            frame: as `frame_of` makes it, the first runs of the shard in order.

        Raises:
            RequestError: it cannot be written.
            ValueError: these are not the runs of this shard.
        """
        first = index * self.recipe.shard
        expected = np.arange(first, first + frame.height, dtype=np.uint64)
        if not 0 < frame.height <= self.recipe.shard or not np.array_equal(frame[INDEX.name], expected):
            raise ValueError(f"shard {index}: its rows must be the runs from {first} on, {self.recipe.shard} at most")
        try:
            _write(self.path(index), encode(frame, self.manifest.identity, index, first))
        except RequestError as error:
            raise RequestError(f"{error}; the shards that are complete are kept, and --resume continues") from None

    def shard(self, index: int, columns: list[str] | None = None) -> pl.DataFrame:
        """Read a shard and check it to the bit.

        Args:
            index: of the shard.
            columns: names; None for all.

        Returns:
            All rows that it holds; they may be more than a campaign of fewer runs needs.

        Raises:
            RequestError: it is missing or damaged.
        """
        try:
            frame = self._decoded(index)
        except FileNotFoundError:
            raise RequestError(f"{self.path(index)}: missing; --resume flies it again") from None
        except Damage as why:
            raise RequestError(f"{self.path(index)}: damaged: {why}; --resume flies it again") from None
        return frame if columns is None else frame.select(columns)

    def find(
        self, index: int, needed: int, remark: Callable[[str], None], *, all_rows: bool = False
    ) -> pl.DataFrame | None:
        """Look for a shard and check it to the bit.

        Args:
            index: of the shard.
            needed: rows that are asked for.
            remark: called with a message about a damaged shard.
            all_rows: give those beyond what is asked for too.

        Returns:
            Its first rows; None where it is missing, damaged, or of a shorter campaign.
        """
        try:
            found = self._decoded(index)
        except FileNotFoundError:
            return None
        except Damage as why:
            remark(f"{self.path(index)}: damaged: {why}; it is flown again")
            return None
        if found.height < needed:
            return None
        return found if all_rows else found.head(needed)

    def _decoded(self, index: int) -> pl.DataFrame:
        try:
            raw = read_bytes(self.path(index), _MOST_BYTES)
        except FileNotFoundError:
            raise
        except ValueError as error:
            raise Damage(str(error)) from None
        except OSError as error:
            raise Damage(f"cannot be read: {reason(error)}") from None
        return decode(raw, self.manifest.identity, index, index * self.recipe.shard)


def _absolute(folder: Path) -> Path:
    """Give a path that holds when the current folder changes.

    Raises:
        RequestError: the current folder is gone.
    """
    try:
        return folder.absolute()
    except OSError as error:
        raise RequestError(f"{folder}: the current folder is gone: {reason(error)}") from None


def _begun(folder: Path, recipe: Recipe, runs: int, about: dict[str, Any], resume: bool) -> Manifest:
    """Write the manifest of a campaign that begins or continues."""
    shards = folder / "shards"
    before = None
    if (folder / MANIFEST).exists():
        before = read_manifest(folder)
        if before.recipe.version != __version__:
            raise RequestError(
                f"{folder}: flown by detumble {before.recipe.version}, this is {__version__}: runs might differ, "
                "so it can be read, but not continued"
            )
        if before.identity != recipe.identity:
            raise RequestError(f"{folder}: holds another campaign ({differences(before.recipe, recipe)})")
        if not resume:
            raise RequestError(f"{folder}: holds this campaign already, of {before.runs} runs; --resume continues it")
    elif shards.is_dir() and any(shards.iterdir()):
        raise RequestError(f"{shards}: not empty, but there is no {MANIFEST} that says what it holds")
    try:
        shards.mkdir(exist_ok=True)
        # this process holds the lock: the writers of these have ended
        for leftover in (*leftovers(folder, MANIFEST), *leftovers(shards, "shard-*.parquet")):
            leftover.unlink()
    except OSError as error:
        raise RequestError(f"{shards}: cannot be used: {reason(error)}") from None
    if before is None:
        created = datetime.now(UTC).isoformat(timespec="seconds")
        manifest = Manifest(FORMAT, recipe.identity, runs, created, [about], recipe)
    else:
        new = [] if about in before.about else [about]
        manifest = replace(before, runs=max(runs, before.runs), about=before.about + new)
    if manifest != before:
        _write(folder / MANIFEST, manifest.text().encode())
    return manifest


def _write(path: Path, content: bytes) -> None:
    """Write a file, whole or not at all, and flush it to the disk."""
    with whole_file(path) as temporary, temporary.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    with suppress(OSError):  # not every system can do this with a folder
        folder = os.open(path.parent, os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)
