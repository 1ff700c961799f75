"""What a campaign flies: enough to fly any of its runs again, anywhere, to the bit."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field

from detumble.checking import MOST_SEED
from detumble.compiled import core
from detumble.scenario.laws import LAWS
from detumble.version import __version__

if TYPE_CHECKING:
    from detumble.scenario.model import Scenario

SHARD = 16_384
"""Runs in a shard: about a second of work, and a few megabytes."""
WIDE = "avx2"
"""The least that a processor needs for wide arithmetic."""


def arithmetic(backend: str | None) -> str:
    """Name the kind of arithmetic of a back end, `wide` or `portable`; None is the best back end of this machine."""
    portable = backend == "portable" or (backend is None and WIDE not in core().backends())
    return "portable" if portable else "wide"


@dataclass(frozen=True)
class Recipe:
    """A campaign, but for its length: run i is the same run however many there are.

    Attributes:
        scenario: the text of the scenario file, dispersions included.
        law: name of the law.
        seed: of dispersions and sensor noise.
        version: of detumble.
        shard: runs in a shard.
        arithmetic: `wide`, of the back ends avx2 and avx512, which give the same bits, or `portable`, whose rows agree to
            1e-12 but not in the last bits.
    """

    scenario: str
    law: Annotated[str, Field(pattern=f"^({'|'.join(LAWS)}|none)$")]
    seed: Annotated[int, Field(ge=0, le=MOST_SEED)]
    version: str = __version__
    shard: Annotated[int, Field(ge=1, le=10**6)] = SHARD
    arithmetic: Annotated[str, Field(pattern="^(wide|portable)$")] = "wide"

    @cached_property
    def parsed(self) -> Scenario:
        """The scenario."""
        from detumble.scenario.files import from_toml

        return from_toml(self.scenario, "scenario.toml")

    @cached_property
    def identity(self) -> str:
        """Hash of everything above: campaigns of one identity have the same runs."""
        return hashlib.sha256(json.dumps(asdict(self), sort_keys=True).encode()).hexdigest()

    def to_dict(self) -> dict[str, Any]:
        """Give the recipe as JSON takes it."""
        return asdict(self)

    def runs_of(self, index: int, runs: int) -> range:
        """Give the indices of the runs in a shard, in a campaign of `runs` runs."""
        return range(index * self.shard, min((index + 1) * self.shard, runs))

    def shards(self, runs: int) -> int:
        """Count the shards that hold `runs` runs."""
        return -(-runs // self.shard)
