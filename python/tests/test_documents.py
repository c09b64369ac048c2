# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The Python code of the documents runs."""

from __future__ import annotations

import re
from importlib.metadata import version
from pathlib import Path

import posemix as px
import pytest

DOCS = Path(__file__).resolve().parents[2] / "docs"
README = DOCS.parent / "README.md"
PAGES = [path for path in [README, *sorted(DOCS.glob("*.md"))] if "```python\n" in path.read_text()]


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.name)
def test_the_code_of_a_page_runs(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """All blocks of a page, one after the other, in an empty folder."""
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    text = page.read_text()
    for block in re.finditer(r"```python\n(.*?)```", text, re.DOTALL):
        line = text.count("\n", 0, block.start(1))
        exec(compile("\n" * line + block[1], str(page), "exec"), names)  # noqa: S102


def test_the_readme_begins_with_an_install_and_shows_the_picture_that_its_code_draws(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The same captions, and as many shapes; the numbers are those of the estimates, which get better."""
    text = README.read_text()
    install, code = re.findall(r"```\w+\n(.*?)```", text, re.DOTALL)[:2]
    assert "pip install ." in install
    shown = re.search(r"!\[.*?\]\((.*?)\)", text)
    assert shown and text.index(code) < shown.start() < text.index("\n## ")
    monkeypatch.chdir(tmp_path)
    exec(compile(code, str(README), "exec"), {})  # noqa: S102
    drawn = (tmp_path / "out/picture.svg").read_text()
    assert shape_of(drawn) == shape_of((README.parent / shown[1]).read_text())


def shape_of(picture: str) -> tuple[list[str], list[str]]:
    """Words of the captions, and the kinds of the shapes."""
    words = re.findall(r"[A-Za-z]{3,}", " ".join(re.findall(r"<text[^>]*>([^<]*)<", picture)))
    return words, sorted(set(re.findall(r"<(\w+)", picture)))


@pytest.mark.parametrize("page", ["docs/architecture.md", "CONTRIBUTING.md"])
def test_the_files_that_a_page_names_exist(page: str) -> None:
    """The map of the code is that of the code."""
    root = DOCS.parent
    folders = r"bench|cmake|configs|docs|include|python|report|src|tests|tools|\.ci"
    named = re.findall(rf"`((?:{folders})/[\w./*-]+)`", (root / page).read_text())
    assert named
    assert [path for path in named if not list(root.glob(path.rstrip("/")))] == []


def test_the_version_is_that_of_the_build_files() -> None:
    found = re.search(r"project\(posemix VERSION (\S+)", (DOCS.parent / "CMakeLists.txt").read_text())
    assert found and px.__version__ == version("posemix") == found[1]
