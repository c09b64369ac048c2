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
    done = subprocess.run(
        [sys.executable, str(EXAMPLES / f"{name}.py")], capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stderr == ""
