"""The documentation runs: Python blocks, commands with what they print, scenarios, and tables made from the code.

In README.md and docs/*.md, page by page and in order, in a folder of the page's own:

- a ```python block is executed, the blocks of a page sharing their names; a ```text block straight after it is what it prints
- in a ```console block, `$ detumble ...` is run and prints what follows; it leaves with 0 unless `$ echo $?` says otherwise
- in what is printed a line of `...` stands for any lines
- a ```toml block that begins with a comment `# name.toml` is a whole scenario, there as that file; any other is a part of one

What lies between `<!-- table: name -->` and `<!-- end -->` comes from the code;
`python tests/python/test_docs.py` writes it anew.
"""

from __future__ import annotations

import contextlib
import copy
import io
import itertools
import json
import re
import shlex
import sys
import tomllib
import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
import typer

import detumble
from detumble.cli import main
from detumble.commands.app import app
from detumble.metrics import METRICS
from detumble.scenario import LAWS, Scenario, from_toml, with_settings
from detumble.scenario.faults import validated
from detumble.scenario.wording import number, pretty
from detumble.variables import VARIABLES

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
REFERENCE = ROOT / "docs" / "reference.md"


# Blocks


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


def is_whole(block: Block) -> str | None:
    """Name the file that a TOML block stands for."""
    named = re.match(r"# (\S+\.toml)\b", block.text)
    return named[1] if named else None


def over(base: Any, part: Any) -> Any:
    """Lay the tables of a part over those of a whole."""
    if not isinstance(base, dict) or not isinstance(part, dict):
        return part
    return {**base, **{name: over(base.get(name), value) for name, value in part.items()}}


# Running a page


class Reader:
    """Someone who tries everything that a page says."""

    def __init__(self, page: Path) -> None:
        self.page = page
        self.names: dict[str, Any] = {"__name__": "__main__"}
        self.code = 0
        self.base = detumble.load("paper").to_dict()

    def read(self) -> None:
        found = blocks(self.page.read_text(encoding="utf-8"))
        for block in found:
            name = is_whole(block) if block.language == "toml" else None
            if name:
                Path(name).write_text(block.text + "\n", encoding="utf-8")
        for block, after in itertools.zip_longest(found, found[1:]):
            if block.language == "python":
                told = after.text if after and after.adjoins and after.language == "text" else None
                self.python(block, told)
            elif block.language == "console":
                self.console(block)
            elif block.language == "toml":
                self.toml(block)
            elif block.language == "plain":
                self.plain(block)

    def python(self, block: Block, told: str | None) -> None:
        printed = io.StringIO()
        try:
            with contextlib.redirect_stdout(printed):
                exec(compile("\n" * (block.line - 1) + block.text, str(self.page), "exec"), self.names)
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
            elif words[0] == "make":
                assert all(f"\n{target}:" in (ROOT / "Makefile").read_text() for target in words[1:]), self.where(block)
            elif words[0].endswith("python"):
                assert (ROOT / words[1]).exists(), f"{self.where(block)}: no {words[1]}"
            else:
                assert words[0] in ("detumble", ".venv/bin/detumble"), f"{self.where(block)}: {command}"
                self.code, printed = call(words[1:])
                expected = self.code if following == "echo $?" else 0
                assert self.code == expected, f"{self.where(block)}: {command}: exit code {self.code}\n{printed}"
                if shown.strip() and not same(printed, shown):
                    pytest.fail(f"{self.where(block)}: {command}: prints\n{printed}", pytrace=False)

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
        if is_whole(block):
            self.base = from_toml(block.text, where).to_dict()
            return
        part = tomllib.loads(block.text)
        base = copy.deepcopy(self.base)
        if "grasp_point" in part.get("chaser", {}):
            base.pop("goal", None)
        validated(over(base, part), where)

    def where(self, block: Block) -> str:
        return f"{self.page.name}:{block.line}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_everything_shown_runs_and_prints_what_is_shown(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import matplotlib.pyplot as plt

    plt.switch_backend("Agg")
    monkeypatch.chdir(tmp_path)
    try:
        Reader(page).read()
    finally:
        plt.close("all")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_links_within_the_project_lead_somewhere(page: Path) -> None:
    for target, anchor in re.findall(r"\]\(([^)#\s]*)#?([^)\s]*)\)", page.read_text(encoding="utf-8")):
        if "://" in target:
            continue
        aim = page.parent / target if target else page
        assert aim.exists(), target
        if anchor:
            heads = re.findall(r"^#+ (.*)$", aim.read_text(encoding="utf-8"), re.MULTILINE)
            assert anchor in {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}, anchor


def test_a_page_that_shows_something_wrong_is_found_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    wrong = (
        "```python\n1 / 0\n```",
        "```python\nprint(1)\n```\n\n```text\n2\n```",
        "```console\n$ detumble run nowhere.toml\n```",
        "```console\n$ detumble --version\ndetumble 9\n```",
        "```console\n$ rm -r results\n```",
        "```toml\n[chaser]\nmas = 1.0\n```",
        "```toml\n# mine.toml\n[chaser]\nmass = 1.0\n```",
    )
    page = tmp_path / "page.md"
    for text in wrong:
        page.write_text(text, encoding="utf-8")
        with pytest.raises((AssertionError, detumble.ScenarioError, pytest.fail.Exception)):
            Reader(page).read()


# Tables made from the code


def fields_table() -> str:
    """Every field of a scenario, from its JSON Schema: a table for each section, laws' channels side by side with their law."""
    schema = Scenario.schema()
    parts: list[str] = []
    _section(schema, schema, "", parts)
    return "\n\n".join(parts)


def _section(schema: dict[str, Any], section: dict[str, Any], path: str, parts: list[str]) -> None:
    rows: list[tuple[str, ...]] = []
    inner: list[tuple[str, dict[str, Any]]] = []
    kind = ""
    for name, raw in section["properties"].items():
        field = _resolved(schema, raw)
        items = _resolved(schema, field.get("items", {}))
        dotted = f"{path}.{name}" if path else name
        if name == "stack" and path.startswith("laws."):
            rows.append(
                (name, "tables `translation`, `rotation`", "none", "gains for the stack; same fields as before")
            )
        elif "const" in field and name in section["required"]:
            kind = f"`{name} = {json.dumps(field['const'])}`"
        elif "properties" in field:
            inner.append((dotted, field))
        elif "properties" in items:
            inner.append((f"[{dotted}]", items))
        elif "discriminator" in items:
            inner += [(f"[{dotted}]", _resolved(schema, choice)) for choice in items["oneOf"]]
        else:
            default = "required" if name in section.get("required", ()) else _default(field)
            rows.append((name, _kind(field), default, field.get("description", "")))
    if rows:
        title = f"### `[{path}]`" if path else "### at the top of the file"
        title += f", {kind}" if kind else ""
        about = [section["description"].split("\n")[0]] if path else []
        head = ("field", "takes", "default", "meaning")
        parts.append("\n\n".join([title, *about, _markdown(head, [(f"`{row[0]}`", *row[1:]) for row in rows])]))
    for dotted, field in inner:
        _section(schema, field, dotted, parts)


def _resolved(schema: dict[str, Any], node: dict[str, Any]) -> dict[str, Any]:
    return schema["$defs"][node["$ref"].rsplit("/", 1)[1]] if "$ref" in node else node


def _kind(field: dict[str, Any]) -> str:
    if "const" in field:
        return f'`"{field["const"]}"`'
    if "enum" in field:
        return " or ".join(f'`"{choice}"`' for choice in field["enum"])
    if field.get("type") in ("string", "boolean"):
        return {"string": "text", "boolean": "`true` or `false`"}[field["type"]]
    if field.get("type") == "array" and field["items"]["type"] in ("string", "array"):
        return {"string": "list of paths", "array": "list of rows"}[field["items"]["type"]]
    shape, numbers = _shape(field)
    unit = field.get("unit", "1")
    limits = _limits(numbers)
    return ", ".join(part for part in (shape, pretty(unit) if unit != "1" else "", limits) if part)


def _shape(field: dict[str, Any]) -> tuple[str, dict[str, Any]]:
    """Say what shape a field has, and give the schema of one of its numbers."""
    if "oneOf" in field:
        single, several = field["oneOf"]
        numbers = single.get("items", single)
        return ("3 numbers or 3×3" if several["items"].get("type") == "array" else "1 number or 3"), numbers
    if field["type"] == "array":
        return f"{field['minItems']} numbers", field["items"]
    return ("odd whole number" if field["type"] == "integer" else "number"), field


def _limits(numbers: dict[str, Any]) -> str:
    signs = (("exclusiveMinimum", ">"), ("minimum", "≥"), ("exclusiveMaximum", "<"), ("maximum", "≤"))
    if numbers.get("minimum", 1.0) == -numbers.get("maximum", 1.0):
        return f"± {_plain(numbers['maximum'])}"
    return ", ".join(f"{sign} {_plain(numbers[key])}" for key, sign in signs if key in numbers)


def _default(field: dict[str, Any]) -> str:
    if "default" not in field:
        return "none"
    return f"`{_literal(field['default'])}`"


def _literal(value: Any) -> str:
    if isinstance(value, list):
        return "[" + ", ".join(_literal(element) for element in value) + "]"
    return _plain(value) if isinstance(value, float) else json.dumps(value)


def _plain(value: float) -> str:
    return number(float(value)).removesuffix(".0")


def metrics_table() -> str:
    head = ("attribute", "JSON key", "unit", "what is counted")
    return _markdown(head, [(f"`{m.name}`", f"`{m.key}`", m.unit or "–", m.definition) for m in METRICS])


def variables_table() -> str:
    head = ("variable", "over", "unit", "meaning, frame")
    rows = [(f"`{v.name}`", f"time, {v.across}".removesuffix(", "), v.unit, v.meaning) for v in VARIABLES]
    return _markdown(head, rows)


def _markdown(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    cells = [[cell.replace("|", "\\|") for cell in row] for row in rows]
    return "\n".join(["| " + " | ".join(row) + " |" for row in [list(head), ["---"] * len(head), *cells]])


TABLES: dict[str, Callable[[], str]] = {
    "fields": fields_table,
    "metrics": metrics_table,
    "variables": variables_table,
}


def with_tables(page: str) -> str:
    """Write every marked table of a page anew."""

    def written(found: re.Match[str]) -> str:
        return f"{found[1]}\n\n{TABLES[found[2]]()}\n\n{found[3]}"

    return re.sub(r"(<!-- table: (\w+) -->)\n.*?(<!-- end -->)", written, page, flags=re.DOTALL)


def test_tables_of_the_reference_match_the_code() -> None:
    page = REFERENCE.read_text(encoding="utf-8")
    assert set(re.findall(r"<!-- table: (\w+) -->", page)) == set(TABLES)
    assert with_tables(page) == page, "python tests/python/test_docs.py writes them anew"


# What the reference says of the command line


def part_of_reference(heading: str) -> str:
    """Give the part of the reference from a heading to the next."""
    page = REFERENCE.read_text(encoding="utf-8")
    found = re.search(rf"^##+ {re.escape(heading)}$.*?(?=^##|\Z)", page, re.DOTALL | re.MULTILINE)
    assert found, heading
    return found[0]


def keys(command: str) -> set[str]:
    """Read the keys that the reference lists for a command."""
    part = part_of_reference(f"`detumble {command}`")
    return set(re.findall(r"^\| `([\w.<>\[\]]+)` \|", part, re.MULTILINE))


def flattened(value: Any, path: str = "") -> set[str]:
    """Give the keys of an object as the reference writes them: laws and back ends as `<law>`, `<backend>`."""
    if isinstance(value, list):
        return set().union({path}, *(flattened(item, f"{path}[]") for item in value if isinstance(item, dict)))
    if not isinstance(value, dict):
        return {path}
    found: set[str] = set()
    for name, inner in value.items():
        known = {**dict.fromkeys(LAWS, "<law>"), "portable": "<backend>", "avx2": "<backend>", "avx512": "<backend>"}
        known |= dict.fromkeys(detumble.scenarios(), "<name>") if path == "scenarios" else {}
        shown = known.get(name, name)
        found |= flattened(inner, f"{path}.{shown}" if path else shown)
    return found


METRIC_KEYS = {metric.key for metric in METRICS}


def test_the_reference_lists_every_command_and_option() -> None:
    for name, command in typer.main.get_command(app).commands.items():
        part = part_of_reference(f"`detumble {name}`")
        for option in (option for parameter in command.params for option in parameter.opts if option.startswith("--")):
            assert option in part, (name, option)


@pytest.mark.parametrize("command", ["run", "paper", "scenarios", "bench"])
def test_the_reference_lists_every_key_of_the_json(command: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("detumble.commands.bench.SECONDS", 1e-3)
    code, printed = call([command, *(["paper"] if command == "run" else []), "--json"])
    assert code == 0
    object_ = json.loads(printed[printed.index("{") :])
    found = {key for key in flattened(object_) if not key.endswith("[]")}
    leaves = {key.rsplit(".", 1)[-1] for key in found}
    if command in ("run", "paper"):
        assert leaves >= METRIC_KEYS
        found = {key for key in found if key.rsplit(".", 1)[-1] not in METRIC_KEYS - {"capture_time_s"}}
    listed = keys(command)
    nested = {key for key in found if any(other.startswith((key + "[", key + ".")) for other in found)}
    assert found - nested == listed - nested


def test_the_reference_lists_attributes_and_events() -> None:
    short = with_settings(detumble.load("paper"), ["time.duration=60.0"])
    flight = detumble.simulate(short)
    attributes = re.findall(r"^\| (`.*?`) \|", part_of_reference("Time series"), re.MULTILINE)
    named = {name for row in attributes for name in re.findall(r"`(\w+)`", row)}
    assert named - {variable.name for variable in VARIABLES} == set(flight.data.attrs)

    part = part_of_reference("Events and warnings")
    events = re.findall(r"^\| `(\w+)` \|", part, re.MULTILINE)
    assert events == ["captured", "settled", "diverged"]
    assert [event.name for event in flight.events] == ["captured", "settled"]
    details = flight.events[0].details
    for name in (*details, *details["before"], *details["after"]):
        assert f"`{name}`" in part, name


def test_the_reference_lists_every_file_written(tmp_path: Path) -> None:
    page = REFERENCE.read_text(encoding="utf-8")
    for command in (["run", "paper"], ["paper"]):
        code, printed = call([*command, "--out", str(tmp_path / command[0])])
        assert code == 0, printed
        for file in (tmp_path / command[0]).iterdir():
            assert f"`{file.name}`" in page or f"`{file.stem}`" in page, file.name


if __name__ == "__main__":
    REFERENCE.write_text(with_tables(REFERENCE.read_text(encoding="utf-8")), encoding="utf-8", newline="\n")
