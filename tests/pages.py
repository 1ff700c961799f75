"""Someone who tries everything that a page of the documentation says, block by block.

- a ```python block is executed, the blocks of a page sharing their names; a ```text block straight after it is what it
  prints. One that begins with a comment `# name.py` is a program for elsewhere: it is compiled only
- in a ```console block, `$ detumble ...` is run and prints what follows; it leaves with 0 unless `$ echo $?` says otherwise
- in what is printed a line of `...` stands for any lines
- a ```sh block is for elsewhere too: the shell can read it, and what it asks of `detumble` can be asked
- a ```toml block that begins with a comment `# name.toml` is a whole scenario, there as that file; any other is a part of one
- a ```yaml block can be read
- in a block without a language, a line that begins with `.venv/bin/detumble` is run
"""

from __future__ import annotations

import contextlib
import copy
import io
import itertools
import re
import shlex
import subprocess
import sys
import tomllib
import traceback
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
import typer
import yaml

import detumble
from detumble.cli import main
from detumble.commands.app import app
from detumble.scenario import from_toml
from detumble.scenario.faults import validated

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


@dataclass(frozen=True)
class Block:
    """A fenced block: language, text, the line at which the text begins, and whether only blank lines part it from the last."""

    language: str
    text: str
    line: int
    adjoins: bool


def blocks(page: str) -> list[Block]:
    found: list[Block] = []
    lines = page.splitlines()
    fence, begin, adjoins = "", 0, False
    for at, line in enumerate(lines):
        if not fence and line.startswith("```"):
            fence, begin = line[3:].strip() or "plain", at + 1
        elif fence and line.startswith("```"):
            found.append(Block(fence, "\n".join(lines[begin:at]), begin + 1, adjoins))
            fence, adjoins = "", True
        elif not fence and line.strip():
            adjoins = False
    assert not fence, f"line {begin}: the block does not end"
    return found


def same(printed: str, shown: str) -> bool:
    """Compare what was printed with what a page shows; a line of `...` stands for any lines."""
    pattern = "".join(
        r"(?:.*\n)*?" if line.strip() == "..." else re.escape(line.rstrip()) + r"[ ]*\n" for line in shown.splitlines()
    )
    return re.fullmatch(pattern, printed.rstrip() + "\n" if printed.strip() else "") is not None


def commands(text: str) -> Iterator[tuple[str, str]]:
    """Split a console block into commands, each with what it prints."""
    for part in re.split(r"^\$ ", text.replace("\\\n", ""), flags=re.MULTILINE)[1:]:
        command, _, printed = part.partition("\n")
        yield command.strip(), printed


def call(arguments: list[str]) -> tuple[int, str]:
    """Run `detumble` in this process; gives its exit code and all that it printed."""
    printed = io.StringIO()
    argv, sys.argv = sys.argv, ["detumble", *arguments]
    try:
        with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
            main()
    except SystemExit as leaving:
        return (leaving.code if isinstance(leaving.code, int) else int(leaving.code is not None)), printed.getvalue()
    finally:
        sys.argv = argv
    return 0, printed.getvalue()


def over(base: Any, part: Any) -> Any:
    """Lay the tables of a part over those of a whole."""
    if not isinstance(base, dict) or not isinstance(part, dict):
        return part
    return {**base, **{name: over(base.get(name), value) for name, value in part.items()}}


class Reader:
    """Someone who tries everything that a page says, in the current folder."""

    def __init__(self, page: Path) -> None:
        self.page = page
        self.names: dict[str, Any] = {"__name__": "__main__"}
        self.code = 0
        self.base = detumble.load("paper").to_dict()

    def read(self) -> None:
        found = blocks(self.page.read_text(encoding="utf-8"))
        for block in found:
            name = named(block, "toml")
            if name:
                Path(name).write_text(block.text + "\n", encoding="utf-8")
        for block, after in itertools.zip_longest(found, found[1:]):
            if block.language == "python":
                told = after.text if after and after.adjoins and after.language == "text" else None
                self.python(block, told)
            elif block.language in ("console", "sh", "toml", "yaml", "plain"):
                getattr(self, block.language)(block)

    def python(self, block: Block, told: str | None) -> None:
        code = compile("\n" * (block.line - 1) + block.text, str(self.page), "exec")
        if named(block, "python"):
            return
        printed = io.StringIO()
        try:
            with contextlib.redirect_stdout(printed):
                exec(code, self.names)
        except Exception:
            pytest.fail(f"{self.where(block)}\n{traceback.format_exc()}", pytrace=False)
        if told is not None and not same(printed.getvalue(), told):
            pytest.fail(f"{self.where(block)}: prints\n{printed.getvalue()}", pytrace=False)

    def console(self, block: Block) -> None:
        listed = list(commands(block.text))
        assert listed, f"{self.where(block)}: no command"
        for (command, shown), (following, _) in zip(listed, [*listed[1:], ("", "")], strict=True):
            words = shlex.split(command)
            if command == "echo $?":
                assert shown.strip() == str(self.code), f"{self.where(block)}: exit code {self.code}"
            elif not self.is_there(block, words):
                assert is_detumble(words), f"{self.where(block)}: {command}"
                self.code, printed = call(words[1:])
                expected = self.code if following == "echo $?" else 0
                assert self.code == expected, f"{self.where(block)}: {command}: exit code {self.code}\n{printed}"
                if shown.strip() and not same(printed, shown):
                    pytest.fail(f"{self.where(block)}: {command}: prints\n{printed}", pytrace=False)

    def is_there(self, block: Block, words: list[str]) -> bool:
        """Make sure that a target of make or a script exists; tells whether it is one."""
        if words[0] == "make":
            assert all(f"\n{target}:" in (ROOT / "Makefile").read_text() for target in words[1:]), self.where(block)
        elif words[0].endswith("python"):
            assert (ROOT / words[1]).exists(), f"{self.where(block)}: no {words[1]}"
        return words[0] == "make" or words[0].endswith("python")

    def sh(self, block: Block) -> None:
        read = subprocess.run(["bash", "-n"], input=block.text, text=True, capture_output=True)
        assert not read.returncode, f"{self.where(block)}: {read.stderr}"
        for line in block.text.replace("\\\n", "").splitlines():
            words = shlex.split(line, comments=True)
            if words and not self.is_there(block, words) and is_detumble(words):
                try:
                    typer.main.get_command(app).commands[words[1]].make_context(words[1], words[2:])
                except Exception as error:  # the command line names it
                    pytest.fail(f"{self.where(block)}: {line}: {error!r}", pytrace=False)

    def plain(self, block: Block) -> None:
        """Commands without what they print; a scenario of the reader's own is the paper's."""
        for line in block.text.splitlines():
            if line.startswith(".venv/bin/detumble "):
                words = shlex.split(line)[1:]
                for word in words:
                    if word.endswith(".toml") and not Path(word).exists():
                        detumble.load("paper").save(word)
                code, printed = call(words)
                assert code == 0, f"{self.where(block)}: {line}\n{printed}"

    def toml(self, block: Block) -> None:
        where = self.where(block)
        if named(block, "toml"):
            self.base = from_toml(block.text, where).to_dict()
            return
        part = tomllib.loads(block.text)
        base = copy.deepcopy(self.base)
        if "grasp_point" in part.get("chaser", {}):
            base.pop("goal", None)
        validated(over(base, part), where)

    def yaml(self, block: Block) -> None:
        assert all(isinstance(part, dict) for part in yaml.safe_load_all(block.text)), self.where(block)

    def where(self, block: Block) -> str:
        return f"{self.page.name}:{block.line}"


def is_detumble(words: list[str]) -> bool:
    return words[0] in ("detumble", ".venv/bin/detumble")


def named(block: Block, language: str) -> str | None:
    """Name the file that a block stands for, if it is of that language and says so in its first line."""
    found = re.match(r"# (\S+\.(?:toml|py))\b", block.text)
    return found[1] if found and block.language == language else None
