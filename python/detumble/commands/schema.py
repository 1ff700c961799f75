"""`detumble schema`: the JSON Schema of a scenario file."""

from __future__ import annotations

from typing import Annotated

import typer

from detumble.commands.printing import print_json


def schema(
    as_json: Annotated[bool, typer.Option("--json", help="A schema is JSON anyway.")] = True,  # noqa: ARG001
) -> None:
    """Print the JSON Schema of a scenario file: every field with unit, range, meaning and its place in the core."""
    from detumble.scenario.model import Scenario

    print_json(Scenario.schema())
