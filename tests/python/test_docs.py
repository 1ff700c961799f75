"""The documentation runs: Python blocks, commands with what they print, scenarios. See `pages`."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml

import detumble
from pages import PAGES, Reader


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


@pytest.mark.parametrize(
    "wrong",
    [
        "```python\n1 / 0\n```",
        "```python\nprint(1)\n```\n\n```text\n2\n```",
        "```python\n# there.py\nprint(1\n```",
        "```console\n$ detumble run nowhere.toml\n```",
        "```console\n$ detumble --version\ndetumble 9\n```",
        "```console\n$ rm -r results\n```",
        "```sh\nif true; then\n```",
        "```sh\ndetumble campaign paper --out results/mc \\\n  --schedule tcp://here:8786\n```",
        "```sh\n.venv/bin/python scripts/nothing.py\n```",
        "```toml\n[chaser]\nmas = 1.0\n```",
        "```toml\n# mine.toml\n[chaser]\nmass = 1.0\n```",
        "```yaml\nkind: {Job\n```",
    ],
)
def test_a_page_that_shows_something_wrong_is_found_out(
    wrong: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    page = tmp_path / "page.md"
    page.write_text(wrong, encoding="utf-8")
    with pytest.raises((AssertionError, SyntaxError, detumble.ScenarioError, yaml.YAMLError, pytest.fail.Exception)):
        Reader(page).read()


EXTENDING = Path(__file__).parents[2] / "docs" / "extending.md"
EXCERPTS = re.findall(
    r"^```(?:rust|py) (\S+)\n(.*?)^```$", EXTENDING.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL
)


@pytest.mark.parametrize(("file", "excerpt"), EXCERPTS)
def test_excerpts_of_sources_stand_in_them(file: str, excerpt: str) -> None:
    assert excerpt in (EXTENDING.parents[1] / file).read_text(encoding="utf-8")


def test_every_excerpt_names_its_source() -> None:
    assert (
        len(EXCERPTS)
        == EXTENDING.read_text(encoding="utf-8").count("```rust") + EXTENDING.read_text(encoding="utf-8").count("```py")
        > 5
    )
