# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The examples run and find what they expect."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.mark.parametrize("name", ["fuse_and_reduce", "grasp", "learn_noise", "live_slam"])
def test_an_example_finds_what_it_expects(name: str) -> None:
    run(name)


def run(name: str, *arguments: str) -> str:
    done = subprocess.run(
        [sys.executable, str(EXAMPLES / f"{name}.py"), *arguments], capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stderr == ""
    return done.stdout


def test_the_example_of_live_views(tmp_path: Path) -> None:
    shown = run("live_view", "report", "--folder", str(tmp_path / "run"), "--seconds", "5")
    assert (tmp_path / "run" / "report.html").exists() and "mug: ambiguous" in shown
    for view, module, ending in (("rerun", "rerun", "rrd"), ("foxglove", "foxglove", "mcap")):
        pytest.importorskip(module)
        run("live_view", view, "--address", str(tmp_path / f"a.{ending}"), "--seconds", "2")
        assert (tmp_path / f"a.{ending}").stat().st_size > 1000
