"""The study's page: what lies between `<!-- table: name -->` and `<!-- end -->` follows from the numbers, the rest is written."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from detumble.scenario.laws import TITLES
from study.cases import CASES
from study.claims import Numbers, claims

_BLOCK = re.compile(r"(<!-- table: (\w+) -->\n).*?(<!-- end -->)", re.DOTALL)


def filled(page: str, numbers: Numbers) -> str:
    """Put the tables into the page.

    Args:
        page: text with its blocks.
        numbers: of `numbers.json`.

    Raises:
        KeyError: the page asks for a table that there is none of.
    """
    return _BLOCK.sub(lambda block: f"{block[1]}\n{TABLES[block[2]](numbers)}\n\n{block[3]}", page)


def _markdown(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines: list[Sequence[str]] = [head, ["---" for _ in head], *rows]
    return "\n".join(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in row)} |" for row in lines)


def _claims(numbers: Numbers) -> str:
    rows = [(claim.text, f"**{claim.verdict}**", claim.number, f"`{claim.command}`") for claim in claims(numbers)]
    return _markdown(("the paper says", "verdict", "numbers", "command"), rows)


def _comparison(key: str, numbers: Numbers) -> str:
    comparison = numbers["compare"][key]
    entries = {entry["name"]: entry for entry in comparison["entries"]}
    head = (
        "entry",
        "rank",
        "ties",
        "success %",
        "median s",
        "95 % s",
        "objective s",
        "× bound",
        "Δv m/s",
        "Δv × bound",
        "settled s",
    )
    rows = [_standing(placed, entries[placed["name"]]) for placed in comparison["ranking"]]
    return _markdown(head, rows)


def _standing(placed: Numbers, entry: Numbers) -> tuple[str, ...]:
    low, high = entry["success_ci"]
    return (
        entry["name"],
        str(placed["rank"]),
        placed["ties"],
        f"{100 * entry['success']:.2f} ({100 * low:.2f}–{100 * high:.2f})",
        _cell(entry["capture_time_s"], "p50"),
        _cell(entry["capture_time_s"], "p95"),
        "–" if entry["short_of_required"] else f"{entry['objective']:.2f}",
        _cell(entry["ratios"].get("time"), "p50"),
        _cell(entry["delta_v_to_capture_m_s"], "p50", 3),
        _cell(entry["ratios"].get("delta_v"), "p50"),
        _cell(entry["settled_time_s"], "p50", 1),
    )


def _cell(figures: Numbers | None, name: str, decimals: int = 2) -> str:
    value: Any = figures.get(name) if figures else None
    return "–" if value is None else f"{value:.{decimals}f}"


def _handover(gains: str, numbers: Numbers) -> str:
    under = numbers["handover"][gains]
    laws = list(next(iter(under.values())))
    rows = [(TITLES[law], *(_settled(under[condition][law]) for condition in under)) for law in laws]
    return _markdown(("law", *under), rows)


def _settled(found: Numbers) -> str:
    share, median, late = (found[name] for name in ("settled_of_captured", "settling_median_s", "settling_p95_s"))
    if share is None:
        return "none captured"
    times = " / ".join("–" if time is None else f"{time:.1f}" for time in (median, late))
    return f"{100 * share:.1f} %, {times} s"


def _longer(numbers: Numbers) -> str:
    rows = [
        (TITLES[law], *(f"{one['mean_s']:.2f} s, {100 * one['success']:.2f} %" for one in searches))
        for law, searches in numbers["longer"].items()
    ]
    return _markdown(("law as printed", *(f"search {number + 1}" for number in range(len(rows[0]) - 1))), rows)


def _effort(numbers: Numbers) -> str:
    about = numbers["about"]
    parts = ", ".join(f"{name} {seconds:.0f} s" for name, seconds in about["seconds"].items())
    minutes = sum(about["seconds"].values()) / 60.0
    return f"detumble {about['version']}, {about['processors']} processors: {minutes:.0f} minutes ({parts})."


TABLES: dict[str, Callable[[Numbers], str]] = {
    "claims": _claims,
    **{case.key: partial(_comparison, case.key) for case in CASES},
    "handover_given": partial(_handover, "given"),
    "handover_tuned": partial(_handover, "tuned"),
    "longer": _longer,
    "effort": _effort,
}
"""Tables of the page by name, each made from the numbers."""
