# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""`posemix live`, killed while it writes its results (POSEMIX_LIVE_KILLS times, 6 by default)."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("rclpy")

from .live import at, detections
from .program import PROGRAM, SOURCE, Program, unavailable
from .test_live_node import MUG

pytestmark = pytest.mark.skipif(bool(unavailable()), reason=unavailable())


PAGE = "report.html"


def names(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*")}


def ended(folder: Path, domain: int, out: Path, kill_after_s: float | None = None) -> tuple[float, int]:
    """The program takes in three images and is told to end; how long that took [s], and its exit code."""
    running = Program(folder, domain, SOURCE + '[motion]\nmodel = "still"\n', arguments=["--out", str(out), "--report"])
    try:
        running.ready()
        for i in range(3):
            running.world.detect(detections(at(0.1 * i), {"mug": MUG}))
            running.until("images", i + 1)
        begin = time.monotonic()
        running.process.send_signal(signal.SIGINT)
        if kill_after_s is not None:
            time.sleep(kill_after_s)
            running.process.kill()
        running.process.communicate(timeout=20)
        return time.monotonic() - begin, running.process.returncode
    finally:
        running.close()


def test_a_kill_leaves_a_whole_result_or_none(ros: None, domain: int, tmp_path: Path) -> None:
    whole, out, settings = tmp_path / "whole", tmp_path / "out", tmp_path / "settings"
    settings.mkdir()
    seconds, code = ended(settings, domain, whole)
    assert code == 0
    rng = np.random.default_rng(7)
    codes = []
    for _ in range(int(os.environ.get("POSEMIX_LIVE_KILLS", "6"))):
        codes.append(ended(settings, domain, out, rng.uniform(0.0, seconds))[1])
        # What is there by its last file is all there, and can be read.
        if (out / "metrics.json").exists():
            # The page is made of it afterwards, and is whole or not there.
            assert names(whole) - {PAGE} <= names(out)
            assert not (out / PAGE).exists() or (out / PAGE).read_text().rstrip().endswith("</html>")
            assert json.loads((out / "metrics.json").read_text())["frames"] == 3
            subprocess.run([PROGRAM, "report", out, "--quiet", "--out", tmp_path / "page.html"], check=True)
    assert -signal.SIGKILL in codes, "no kill came in time"
    assert ended(settings, domain, out)[1] == 0
    # A kill in the page leaves its hidden part, as of every single file (docs/reliability.md).
    assert {name for name in names(out) if not name.startswith(f".{PAGE}.partial-")} == names(whole)
    assert {path.name for path in tmp_path.iterdir()} <= {"whole", "out", "settings", "page.html"}
