"""The bound of every run of a campaign: its own start, bodies, limits and thresholds, as drawn.

The bound depends on nothing that a law does, so one table serves every law that flies these runs. Runs that were drawn
alike share one bound. Many are distributed over further processes of this Python, which exchange lines of JSON: a float
written by Python reads back to the bit, so the result does not depend on the number of processes.
"""

from __future__ import annotations

import json
import math
import subprocess
import sys
from concurrent.futures import CancelledError, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from detumble.analysis.bounds import shooting
from detumble.analysis.bounds.bound import ENDS, bound_of
from detumble.analysis.bounds.detumbling import detumble_lower, largest_moment
from detumble.analysis.bounds.earliest import minimum_capture_times
from detumble.analysis.bounds.fuel import delta_v_lower
from detumble.analysis.bounds.pursuit import Pursuit, check_undisturbed, start_of
from detumble.surroundings import available_threads

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from typing import Self

    from detumble.analysis.trials import Trials
    from detumble.quaternions import Array

CHASE = (
    "start.",
    "orbit.",
    "chaser.",
    "debris.inertia",
    "debris.grasp_point",
    "goal.position",
    "capture.",
    "actuators.",
)
"""Prefixes of the core's paths that matter until capture: not sensors, beliefs, gains, or the target's mass."""
STACK = (*CHASE, "debris.mass", "settled.")
"""Prefixes of the core's paths that matter to the stack."""
CHUNK = {"capture": 64, "delta_v": 4, "all": 1}
"""Runs in one message to a process, some tenths of a second of work."""
FEW = 16
"""Up to so many messages are bounded in this process: starting others would take longer."""
_WORKER = "from detumble.analysis.bounds.runs import serve; serve()"


def capture_bounds(
    trials: Trials, *, processes: int | None = None, progress: Callable[[int], None] | None = None
) -> Array:
    """Bound the capture time of each run from below, whatever controller flies it.

    Args:
        trials: the runs; their horizon and change hold here too.
        processes: to share the work; None for one on each processor. The result is the same.
        progress: called repeatedly with the number of runs done; an exception that it raises ends the work.

    Returns:
        (runs,) s: no capture can come earlier (`analysis.bounds.earliest`); inf where none can come at all.

    Raises:
        ScenarioError: the scenario cannot be flown, or a disturbance acts.
    """
    return _bounds("capture", trials, np.empty((trials.count, 0)), processes, progress)[:, 0]


def delta_v_bounds(
    trials: Trials,
    within: Array,
    *,
    processes: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> Array:
    """Bound the Δv of a capture from below, run by run (`analysis.bounds.fuel`).

    Args:
        trials: the runs.
        within: (k, runs) s: until when each shall have captured; k times for each start.
        processes: as for `capture_bounds`.
        progress: likewise; it counts questions.

    Returns:
        (k, runs) m/s, the time being that of `within`; NaN where that is not finite.

    Raises:
        ScenarioError: the scenario cannot be flown, or a disturbance acts.
    """
    times = within.reshape(-1, 1)
    found = _bounds("delta_v", trials, np.where(np.isfinite(times), times, np.nan), processes, progress)
    of_runs: Array = found.reshape(within.shape)
    return of_runs


def all_bounds(
    trials: Trials,
    within: float,
    *,
    processes: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> dict[str, Array]:
    """Bound everything that `analysis.bounds.bound` bounds, from both sides, run by run: about a second each.

    Args:
        trials: the runs.
        within: s, by when the Δv is asked for.
        processes: as for `capture_bounds`.
        progress: likewise.

    Returns:
        (runs,) by name: `capture_time_s.lower`, `capture_time_s.upper`, …; inf where there is none within the flight.

    Raises:
        ScenarioError: the scenario cannot be flown, or a disturbance acts.
        RequestError: CasADi is not installed.
    """
    shooting.casadi()  # raises here, not in a worker
    found = _bounds("all", trials, np.full((trials.count, 1), within), processes, progress, STACK)
    return dict(zip(ENDS, found.T, strict=True))


def settling_bounds(trials: Trials, momentum: Array) -> Array:
    """Bound the time from capture to settled from below, run by run (`analysis.bounds.detumbling`).

    Args:
        trials: the runs.
        momentum: (k, runs) N m s, of the stack at capture: k times for each run.

    Returns:
        (k, runs) s; NaN where the momentum is.

    Raises:
        ScenarioError: the scenario cannot be flown, or a disturbance acts.
    """
    check_undisturbed(trials.scenario)
    nominal, columns = trials.nominal("none"), _columns(trials, STACK)
    table = np.hstack([*columns.values(), np.empty((trials.count, 0))])
    _, firsts, members = np.unique(table, axis=0, return_index=True, return_inverse=True)
    cases = [_case(nominal, columns, int(index)) for index in firsts]
    torque = np.array([Pursuit.of(case).torque for case in cases])
    moment = np.array([largest_moment(case) for case in cases])
    rate = np.array([float(case["orbit"]["mean_motion"]) + float(case["settled"]["rate"]) for case in cases])
    own = members.reshape(-1)
    return detumble_lower(momentum, torque[own], moment[own], rate[own])


def _bounds(
    question: str,
    trials: Trials,
    further: Array,
    processes: int | None,
    progress: Callable[[int], None] | None,
    matters: tuple[str, ...] = CHASE,
) -> Array:
    """Bound each run, with further numbers (k runs, m): k times for run 0, 1, …; a row of results for each."""
    check_undisturbed(trials.scenario)
    nominal, columns = trials.nominal("none"), _columns(trials, matters)
    widths = {path: values.shape[1] for path, values in columns.items()}
    fields = np.hstack([*columns.values(), np.empty((trials.count, 0))])
    table = np.hstack([np.tile(fields, (len(further) // trials.count, 1)), further])
    rows, members, sizes = np.unique(table, axis=0, return_inverse=True, return_counts=True)
    size = CHUNK[question]
    chunks = [slice(first, min(first + size, len(rows))) for first in range(0, len(rows), size)]
    workers = 1 if len(chunks) <= FEW else min(processes or available_threads(), len(chunks))
    answers: list[Array] = []
    done = 0
    with _Pool(_Job(question, nominal, widths), workers) as pool:
        for chunk, found in zip(chunks, pool.map([rows[chunk] for chunk in chunks]), strict=True):
            answers.append(found)
            done += int(sizes[chunk].sum())
            if progress:
                progress(done)
    of_runs: Array = np.concatenate(answers)[members.reshape(-1)]
    return of_runs


def _columns(trials: Trials, matters: tuple[str, ...]) -> dict[str, Array]:
    """The inputs that differ from run to run and matter to a bound."""
    return {path: values for path, values in trials.columns("none").items() if path.startswith(matters)}


def _case(nominal: Mapping[str, Any], columns: Mapping[str, Array], index: int) -> dict[str, Any]:
    """The nominal case with the numbers of one run."""
    own = {name: dict(table) for name, table in nominal.items()}
    for path, values in columns.items():
        table, _, name = path.partition(".")
        own[table][name] = values[index].reshape(np.shape(own[table][name]))
    return own


@dataclass(frozen=True)
class _Job:
    """A question, and the case of which each row changes some numbers.

    Attributes:
        question: `capture`; or `delta_v` or `all`, whose rows end with the time by which.
        nominal: the core's case.
        widths: numbers in a row for each path, in order.
    """

    question: str
    nominal: Mapping[str, Any]
    widths: Mapping[str, int]

    def answers(self, rows: Array) -> Array:
        """Answer for rows (n, numbers)."""
        parts = np.split(rows, np.cumsum(list(self.widths.values()), dtype=np.intp), axis=1)
        columns = dict(zip(self.widths, parts, strict=False))
        return np.array([self._answer(_case(self.nominal, columns, index), rows[index]) for index in range(len(rows))])

    def _answer(self, plain: Mapping[str, Any], row: Array) -> list[float]:
        pursuit, start = Pursuit.of(plain), start_of(plain)
        match self.question:
            case "capture":
                return [float(minimum_capture_times(pursuit, start[None])[0])]
            case "delta_v":
                return [math.nan if math.isnan(row[-1]) else delta_v_lower(pursuit, start, float(row[-1]))]
            case _:
                return list(bound_of(plain, float(row[-1])).ends().values())


class _Pool:
    """Bounds chunks of runs, in this process or in several others; in `with`, at whose end they are killed.

    A pool of multiprocessing would import the user's main module anew in each worker, and with it do all that an unguarded
    script does.
    """

    def __init__(self, job: _Job, workers: int) -> None:
        self._answers = job.answers
        self._closed = False
        self._threads = ThreadPoolExecutor(workers)
        self._workers: list[subprocess.Popen[str]] = []
        if workers > 1:
            command = [sys.executable, "-P", "-c", _WORKER]  # -P: no module of that name in the current folder
            for _ in range(workers):
                self._workers.append(
                    subprocess.Popen(
                        command,
                        stdin=subprocess.PIPE,
                        stdout=subprocess.PIPE,
                        text=True,
                        start_new_session=True,  # Ctrl-C reaches this process only, also while a worker starts
                    )
                )
                with suppress(OSError):  # a worker that failed to start is found out at its first request
                    _send(self._workers[-1], json.dumps(asdict(job)))
        self._idle = list(self._workers)

    def map(self, chunks: Sequence[Array]) -> Iterator[Array]:
        """Give the bounds of each chunk, in order."""
        return self._threads.map(self._request, chunks) if self._workers else map(self._answers, chunks)

    def _request(self, rows: Array) -> Array:
        worker = self._idle.pop()  # there is one for each thread
        answer = ""
        with suppress(OSError):
            answer = _send(worker, json.dumps(rows.tolist()), answered=True)
        self._idle.append(worker)
        if self._closed:
            raise CancelledError
        # without an answer the worker has ended: killed, or this Python cannot be started again
        return np.array(json.loads(answer)) if answer.endswith("\n") else self._answers(rows)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._closed = True
        for worker in self._workers:
            worker.kill()
        self._threads.shutdown(cancel_futures=True)
        for worker in self._workers:
            with suppress(OSError), worker:  # closes the pipes
                pass


def _send(worker: subprocess.Popen[str], line: str, *, answered: bool = False) -> str:
    assert worker.stdin is not None
    assert worker.stdout is not None
    worker.stdin.write(line + "\n")
    worker.stdin.flush()
    return worker.stdout.readline() if answered else ""


def serve() -> None:
    """Bound runs from standard input, a line of JSON at a time, until its end."""
    line = sys.stdin.readline()
    if not line.endswith("\n"):  # the parent has ended
        return
    job = _Job(**json.loads(line))
    for line in sys.stdin:
        print(json.dumps(job.answers(np.array(json.loads(line))).tolist()), flush=True)
