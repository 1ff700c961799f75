"""Every law in every form that it has."""

from __future__ import annotations

from detumble.analysis.comparing.entries import entries_of
from detumble.scenario.laws import Form

VARIANTS: list[tuple[str, Form | None]] = [(entry.law, entry.form) for entry in entries_of()]
