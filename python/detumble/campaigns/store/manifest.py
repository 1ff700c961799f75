"""The manifest of a campaign: what it flies, how far it was asked to go, and what flew it."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field, TypeAdapter, ValidationError

from detumble.campaigns.recipe import Recipe
from detumble.errors import RequestError, ScenarioError
from detumble.scenario.wording import shown
from detumble.writing import read_bytes, reason

if TYPE_CHECKING:
    from collections.abc import Mapping

MANIFEST = "campaign.json"
_MOST_BYTES = 2**26
"""Of the manifest."""
FORMAT = 2
"""Of the folder; raised when what older versions wrote can no longer be read in the same way, or they not read the new."""


@dataclass(frozen=True)
class Manifest:
    """What `campaign.json` holds.

    Attributes:
        format: of the folder.
        identity: of the recipe.
        runs: the most that were ever asked for.
        created: when the campaign was begun, UTC.
        about: what flew it: back end and machine; one entry more each time that one of them is another.
        recipe: what is flown.
    """

    format: Annotated[int, Field(ge=1, strict=True)]
    identity: str
    runs: Annotated[int, Field(ge=1)]
    created: str
    about: list[dict[str, Any]]
    recipe: Recipe

    def text(self) -> str:
        """Give the content of the file."""
        return json.dumps(asdict(self), indent=2, ensure_ascii=False) + "\n"


def read_manifest(folder: Path) -> Manifest:
    """Read the manifest of the campaign in a folder.

    Raises:
        RequestError: there is none, or it cannot be used.
    """
    path = folder / MANIFEST
    try:
        raw = json.loads(read_bytes(path, _MOST_BYTES))
    except (FileNotFoundError, NotADirectoryError):
        raise RequestError(f"{folder}: holds no campaign (no {MANIFEST})") from None
    except OSError as error:
        raise RequestError(f"{path}: cannot be read: {reason(error)}") from None
    except (ValueError, RecursionError) as error:
        raise RequestError(f"{path}: broken: {error}") from None
    found = raw.get("format") if isinstance(raw, dict) else None
    if isinstance(found, int) and found != FORMAT:
        age = "a newer" if found > FORMAT else "an older"
        raise RequestError(f"{path}: format {found}; this detumble reads format {FORMAT}: {age} one wrote it")
    try:
        manifest = TypeAdapter(Manifest).validate_python(raw)
    except ValidationError as error:
        fault = error.errors()[0]
        place = ".".join(map(str, fault["loc"]))
        raise RequestError(f"{path}: broken: {place}: {fault['msg'].lower()}") from None
    if manifest.recipe.identity != manifest.identity:
        raise RequestError(f"{path}: its recipe is not the one that was flown: changed after it was written")
    return manifest


def differences(there: Recipe, asked: Recipe) -> str:
    """Say in what two recipes differ, the three first fields of their scenarios included."""
    both = {
        name: (getattr(there, name), getattr(asked, name)) for name in ("law", "seed", "version", "shard", "arithmetic")
    }
    found = [f"{name} {old} there, {new} asked for" for name, (old, new) in both.items() if old != new]
    if there.scenario != asked.scenario:
        try:
            first, second = _flat(there.parsed.to_dict()), _flat(asked.parsed.to_dict())
        except ScenarioError:
            return "; ".join([*found, "scenario"])
        differing = [path for path in {**first, **second} if first.get(path) != second.get(path)]
        for path in differing[:3]:
            values = [shown(values[path]) if path in values else "nothing" for values in (first, second)]
            found.append(f"{path} {values[0]} there, {values[1]} asked for")
        found += [f"and {len(differing) - 3} fields more"] if len(differing) > 3 else []
        found += [] if differing else ["text of the scenario"]
    return "; ".join(found)


def _flat(table: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    found: dict[str, Any] = {}
    for name, value in table.items():
        found |= _flat(value, f"{prefix}{name}.") if isinstance(value, dict) else {prefix + name: value}
    return found
