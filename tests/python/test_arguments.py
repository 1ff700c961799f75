"""Help of the commands names what there is."""

from __future__ import annotations

import pytest
from typer.testing import CliRunner

from detumble.commands.app import app
from detumble.scenario.laws import LAWS


@pytest.mark.parametrize("command", ["run", "campaign", "tune"])
def test_help_names_every_law(command: str) -> None:
    said = " ".join(CliRunner().invoke(app, [command, "--help"], env={"COLUMNS": "200"}).output.split())
    assert ", ".join(LAWS) in said
    assert "{laws}" not in said
