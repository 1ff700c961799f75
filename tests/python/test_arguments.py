"""Help of the commands names what there is."""

from __future__ import annotations

from detumble.commands import arguments
from detumble.scenario.laws import LAWS


def test_help_names_every_law() -> None:
    assert arguments.LAWS.split(", ") == list(LAWS)
