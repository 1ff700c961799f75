"""`detumble scenarios`: what comes built in."""

from __future__ import annotations

from detumble.commands.arguments import AsJson
from detumble.commands.printing import print_json


def scenarios(as_json: AsJson = False) -> None:
    """List the built-in scenarios."""
    from detumble.scenario.files import built_in, load

    titles = {name: load(name).title for name in built_in()}
    if as_json:
        print_json({"scenarios": titles})
        return
    width = max(len(name) for name in titles)
    for name, title in titles.items():
        print(f"{name.ljust(width)}  {title}")
