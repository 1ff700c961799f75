"""Arguments and options that several commands take, and how they are read."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from detumble.commands.printing import remark
from detumble.errors import RequestError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from detumble.scenario.model import Scenario

SCENARIO = typer.Argument(help="Name of a built-in scenario, or path of a TOML file.")
ScenarioName = Annotated[str, SCENARIO]
More = Annotated[list[str] | None, typer.Argument(hidden=True, metavar="[FIELD=VALUE]...")]
"""Settings that follow the first one of --set without an option of their own."""
Settings = Annotated[
    list[str] | None, typer.Option("--set", metavar="FIELD=VALUE ...", help="Change fields: chaser.mass=12")
]
Law = Annotated[str | None, typer.Option(help="{laws}, or none for open loop.  [prrl, or the only one given]")]
Threads = Annotated[int | None, typer.Option(help="Threads to use; all processors by default.")]
Backend = Annotated[str | None, typer.Option(help="portable, avx2 or avx512; else the core chooses.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object.")]


def out_option(what: str) -> Any:
    """Make the option --out, a folder.

    Args:
        what: the help: what is written there.
    """
    return typer.Option(parser=folder, metavar="DIR", help=what)


def folder(text: str) -> Path:
    """Read the folder given with --out.

    Raises:
        RequestError: it has no name; as a path that would be the current folder.
    """
    if not text.strip():
        raise RequestError('--out "": names no folder; the current one is "."')
    return Path(text)


def scenario_of(
    name: str, settings: Sequence[str] | None, more: Sequence[str] | None, *, quiet: bool = False
) -> Scenario:
    """Read the scenario that a command was given, with its settings.

    Args:
        name: of a built-in scenario, or the path of a file.
        settings: of --set, `field=value` each.
        more: further ones, see `More`.
        quiet: print no warnings of the scenario; the command prints those of the flight, which include them.

    Raises:
        RequestError: a field is set twice.
        ScenarioError: the scenario cannot be read, or contradicts itself.
    """
    from detumble.scenario.files import load, with_settings

    settings = [*(settings or ()), *(more or ())]
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
