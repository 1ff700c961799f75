"""The commands gathered under one name."""

from __future__ import annotations

from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperOption

from detumble.commands.bench import bench
from detumble.commands.bound import bound
from detumble.commands.campaign import campaign
from detumble.commands.compare import compare
from detumble.commands.paper import paper
from detumble.commands.run import run
from detumble.commands.scenarios import scenarios
from detumble.commands.schema import schema
from detumble.commands.tune import tune
from detumble.version import __version__


class Command(TyperCommand):
    """A command in whose help `{laws}` stands for the names of the laws; their register takes long to import."""

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """Write the help, with the names of the laws."""
        from detumble.scenario.laws import LAWS

        for parameter in self.params:
            if isinstance(parameter, TyperOption) and parameter.help:
                parameter.help = parameter.help.replace("{laws}", ", ".join(LAWS))
        super().format_help(ctx, formatter)


app = typer.Typer(
    name="detumble",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
for command in (paper, run, campaign, bound, tune, compare, scenarios, schema, bench):
    app.command(cls=Command)(command)


def _version(asked: bool) -> None:
    if asked:
        print(f"detumble {__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and leave.")
    ] = False,
) -> None:
    """Which control law captures this tumbling target with this chaser: how fast, at what delta-v, and how sure."""
