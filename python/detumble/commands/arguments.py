"""Arguments that several commands take."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from detumble.commands.printing import remark
from detumble.errors import RequestError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from detumble.scenario.model import Scenario


def folder(text: str) -> Path:
    """Read the folder given with --out.

    Raises:
        RequestError: it has no name; as a path that would be the current folder.
    """
    if not text.strip():
        raise RequestError('--out "": names no folder; the current one is "."')
    return Path(text)


def scenario_of(name: str, settings: Sequence[str], *, quiet: bool = False) -> Scenario:
    """Read the scenario that a command was given, with the fields changed that were set there.

    Args:
        name: of a built-in scenario, or the path of a file.
        settings: `field=value` each.
        quiet: leave what ought to be looked at again to the command, which says it of the flight.

    Raises:
        ScenarioError: it cannot be read, or contradicts itself.
    """
    from detumble.scenario.files import load, with_settings

    fields = [setting.partition("=")[0].strip() for setting in settings]
    twice = next((field for field in fields if fields.count(field) > 1), None)
    if twice is not None:
        raise RequestError(f"--set {twice}: is set twice; set it once")
    scenario = load(name)
    if settings:
        scenario = with_settings(scenario, settings, name)
    for warning in () if quiet else scenario.warnings:
        remark(f"warning: {warning}")
    return scenario


def percentile(statistic: str) -> float | None:
    """Read --statistic: `mean`, which is None, or a percentile such as `p95`.

    Raises:
        RequestError: it is neither.
    """
    if statistic == "mean":
        return None
    try:
        return float(statistic.removeprefix("p"))
    except ValueError:
        raise RequestError(f"--statistic {statistic}: must be mean, or a percentile such as p95") from None
