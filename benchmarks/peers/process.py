"""Exchange with a peer that runs in a process of its own, so that the failure of one stops no other."""

from __future__ import annotations

import json
import os
import subprocess
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

FOLDER = Path(__file__).parent


class PeerFailed(Exception):
    """A peer that cannot be run here, or not so; the message is its last line of output."""


@dataclass(frozen=True)
class Answer:
    """What a call took.

    Attributes:
        seconds: of the call alone.
        peak_bytes: the most memory that the process has held so far; None where the system does not say.
        arrays: what was flown, if asked for.
    """

    seconds: float
    peak_bytes: int | None
    arrays: dict[str, NDArray[np.float64]]


class Peer:
    """One running peer.

    Args:
        name: of its `run_*.py`.
        python: the interpreter that has what it needs.
        threads: that it may use.
        case: detumble's case of workload W.
        folder: for what is exchanged.
    """

    def __init__(self, name: str, python: Path, threads: int, case: dict[str, Any], folder: Path) -> None:
        self.name, self.threads, self.folder = name, threads, folder
        self.errors = tempfile.TemporaryFile("w+")  # noqa: SIM115  # open as long as the peer runs
        self.begin = time.perf_counter()
        self.process = subprocess.Popen(
            [python, FOLDER / f"run_{name}.py", str(threads)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self.errors,
            text=True,
            env={name: value for name, value in os.environ.items() if not name.startswith("PYTHON")},
        )
        self._send(case)

    def fly(
        self, call: str, starts: NDArray[np.float64], *, noisy: bool = True, seed: int = 1, keep: bool = False
    ) -> Answer:
        """Have it fly.

        Args:
            call: which of its ways.
            starts: shape (n, 20), as `detumble.workload.random_starts` gives them.
            noisy: with the sensors' noise.
            seed: of the noise.
            keep: whether what was flown is wanted.

        Raises:
            PeerFailed: it cannot, or has ended.
        """
        given, flown = self.folder / "starts.npy", self.folder / "flown.npz"
        np.save(given, starts)
        request = {
            "call": call,
            "starts": str(given),
            "noisy": noisy,
            "seed": seed,
            "out": str(flown) if keep else None,
        }
        self._send(request)
        assert self.process.stdout is not None
        line = self.process.stdout.readline()
        if not line:
            raise PeerFailed(self._last_words())
        answer = json.loads(line)
        if "error" in answer:
            raise PeerFailed(answer["error"])
        arrays = {}
        if keep:
            with np.load(flown) as stored:
                arrays = {key: stored[key] for key in stored}
        return Answer(answer["seconds"], answer["peak_bytes"], arrays)

    def close(self) -> None:
        """End it."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        try:
            self.process.stdin.close()
            self.process.wait(timeout=10.0)
        except (OSError, subprocess.TimeoutExpired):
            self.process.kill()
            self.process.wait()
        self.process.stdout.close()
        self.errors.close()

    def _send(self, value: dict[str, Any]) -> None:
        assert self.process.stdin is not None
        try:
            self.process.stdin.write(json.dumps(value) + "\n")
            self.process.stdin.flush()
        except BrokenPipeError:
            raise PeerFailed(self._last_words()) from None

    def _last_words(self) -> str:
        self.process.wait()
        self.errors.seek(0)
        lines = self.errors.read().strip().splitlines()
        return lines[-1] if lines else f"ended with exit code {self.process.returncode} before it answered"
