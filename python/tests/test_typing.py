# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""What a type checker sees of the installed package."""

from __future__ import annotations

import subprocess
import sys
import types
from pathlib import Path

import posemix as px
import pytest

pytest.importorskip("mypy")

EXAMPLES = sorted((Path(__file__).parents[2] / "examples").glob("*.py"))


def complaints(folder: Path, *files: Path) -> str:
    """What mypy has to say of files; the package is the installed one, as `folder` has none."""
    command = [sys.executable, "-m", "mypy", "--strict", "--config-file=", f"--cache-dir={folder / 'cache'}"]
    done = subprocess.run([*command, *map(str, files)], cwd=folder, capture_output=True, text=True)
    assert done.returncode in (0, 1), done.stdout + done.stderr
    return "" if done.returncode == 0 else done.stdout


def test_every_public_name_is_seen(tmp_path: Path) -> None:
    public = [n for n, v in vars(px).items() if not n.startswith("_") and not isinstance(v, types.ModuleType)]
    assert len(public) > 200 and "SimulationConfig" in public
    lines = ["import posemix", *(f"posemix.{name}" for name in public), "posemix.nothing"]
    (tmp_path / "names.py").write_text("\n".join(lines) + "\n")
    found = complaints(tmp_path, tmp_path / "names.py")
    assert '"nothing"' in found and found.count(": error:") == 1, found


def test_the_examples_are_fully_typed(tmp_path: Path) -> None:
    assert len(EXAMPLES) == 5
    assert complaints(tmp_path, *EXAMPLES) == ""


def test_wrong_uses_are_found(tmp_path: Path) -> None:
    """Attributes and arguments have types of their own, not Any."""
    wrong = [
        "px.ObjectSlamSettings().tracker = 5", "px.SimulationConfig().objects.append(px.SimulationObject())",
        "px.FrameInput(dt='now')", "px.SlamRun.alternative", "px.fuse(px.SE3(), px.SE3())",
        "px.MultiObjectSettings().max_hypotheses = 'many'",
        "px.Sequence(np.zeros(1)).objects.append(px.ObjectRecording('mug', px.SE3.identity(1)))",
    ]  # fmt: skip
    (tmp_path / "wrong.py").write_text("import numpy as np, posemix as px\n" + "\n".join(wrong) + "\n")
    found = complaints(tmp_path, tmp_path / "wrong.py")
    for line in range(2, len(wrong) + 2):
        assert f"wrong.py:{line}: error:" in found, f"{wrong[line - 2]} is not found: {found}"
