"""The rooms of the core import one way: each file of `crates/core/src` uses only its own room and those listed before it."""

from __future__ import annotations

import re
from pathlib import Path

CORE = Path(__file__).parents[2] / "crates" / "core" / "src"
ORDER = (
    "number",
    "batch",
    "part",
    "clock",
    "plant",
    "hardware",
    "gnc",
    "plan",
    "case",
    "flight",
    "scene",
    "observer",
    "closed_loop",
    "metrics",
    "history",
)
"""From the ground up."""
BESIDE = {("metrics", "history"), ("history", "metrics")}
"""Rooms of one level, which do not use each other."""
MACROS = {"batch_struct", "batch_enum", "batch_uniform", "case_struct", "fields"}
"""Exported by `batch` at the root of the crate."""
EXCEPTIONS: set[tuple[str, str]] = set()
"""Uses upward that are still there: file, room. Each that is mended is removed here."""


def rooms_used(source: str) -> set[str]:
    """First names of all paths that begin with `crate::`, those in braces included."""
    code = re.sub(r"//[^\n]*", "", source)
    found = set(re.findall(r"(?<!\$)\bcrate::(\w+)", code))
    for group in re.findall(r"(?<!\$)\bcrate::\{([^;]*)\}", code):
        while (inner := re.sub(r"\{[^{}]*\}", "", group)) != group:
            group = inner
        found |= {name.strip().partition("::")[0] for name in group.split(",") if name.strip()}
    return {"batch" if name in MACROS else name for name in found}


def uses() -> set[tuple[str, str]]:
    """Every file without tests, and each room that it uses beside its own."""
    found = set()
    for path in CORE.rglob("*.rs"):
        file = path.relative_to(CORE)
        room = file.parts[0].removesuffix(".rs")
        if path.stem != "tests" and file.name != "lib.rs":
            source = path.read_text().partition("#[cfg(test)]\nmod tests {")[0]
            found |= {(file.as_posix(), used) for used in rooms_used(source) if used != room}
    return found


def test_every_room_of_the_core_has_its_place() -> None:
    there = {path.relative_to(CORE).parts[0].removesuffix(".rs") for path in CORE.rglob("*.rs")} - {"lib", "tests"}
    assert there == set(ORDER)
    assert {used for _, used in uses()} <= set(ORDER)


def test_rooms_of_the_core_use_only_rooms_below() -> None:
    upward = set()
    for file, used in uses():
        room = file.partition("/")[0].removesuffix(".rs")
        if ORDER.index(used) > ORDER.index(room) or (room, used) in BESIDE:
            upward.add((file, used))
    assert upward == EXCEPTIONS


def test_paths_of_the_crate_are_found_wherever_they_stand() -> None:
    source = """
use crate::{batch_struct, plant::{motion::Motion, orbit}, number};
let x = crate::gnc::f(); // crate::scene
$crate::case
"""
    assert rooms_used(source) == {"batch", "plant", "number", "gnc"}
