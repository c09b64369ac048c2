# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The Python code of the documents runs."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

DOCS = Path(__file__).resolve().parents[2] / "docs"
PAGES = [path for path in sorted(DOCS.glob("*.md")) if "```python\n" in path.read_text()]


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.name)
def test_the_code_of_a_page_runs(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """All blocks of a page, one after the other, in an empty folder."""
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    text = page.read_text()
    for block in re.finditer(r"```python\n(.*?)```", text, re.DOTALL):
        line = text.count("\n", 0, block.start(1))
        exec(compile("\n" * line + block[1], str(page), "exec"), names)  # noqa: S102


@pytest.mark.parametrize("page", ["docs/architecture.md", "CONTRIBUTING.md"])
def test_the_files_that_a_page_names_exist(page: str) -> None:
    """The map of the code is that of the code."""
    root = DOCS.parent
    folders = r"bench|cmake|configs|docs|include|python|report|src|tests|tools|\.ci"
    named = re.findall(rf"`((?:{folders})/[\w./*-]+)`", (root / page).read_text())
    assert named
    assert [path for path in named if not list(root.glob(path.rstrip("/")))] == []
