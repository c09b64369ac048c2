# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Views of a long run, with viewers that read nothing."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import pytest
from live_scene import LiveScene
from test_live_rerun import free_port

from posemix.live_view import FoxgloveView, LiveFrame, RerunView, View

STATM = Path("/proc/self/statm")
pytestmark = pytest.mark.skipif(not STATM.exists(), reason="needs /proc")
FRAMES = 2400


def resident_mb() -> float:
    return int(STATM.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6


def growth_mb(view: View) -> float:
    """What memory grows by in the second half of many frames."""
    scene = LiveScene(20)
    for _ in scene.steps():
        pass
    frame = LiveFrame.of(scene.slam)
    assert frame is not None
    half = 0.0
    for k in range(FRAMES):
        assert view.show(LiveFrame(10.0 + 0.2 * k, frame.estimate, frame.hypotheses))
        if k % 10 == 9:  # much faster than life, but so that the queue of the server does not fill
            time.sleep(0.01)
        if k == FRAMES // 2:
            half = resident_mb()
    return resident_mb() - half


def in_a_process(measure: Callable[[], float]) -> float:
    """What is measured in a process of its own, in which no other test leaves threads and memory behind."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        return pool.submit(measure).result(timeout=120)


def rerun_growth_mb() -> float:
    with RerunView(f":{free_port()}", memory_limit="4MB") as view:
        return growth_mb(view)


def test_rerun_keeps_no_more_than_its_limit() -> None:
    """By 1 MB; with the default limit, which is not reached, by 6.5 MB and more."""
    pytest.importorskip("rerun")
    assert in_a_process(rerun_growth_mb) < 4.0


def test_foxglove_drops_what_a_viewer_does_not_read() -> None:
    pytest.importorskip("foxglove")
    client = pytest.importorskip("foxglove_client")
    view = FoxgloveView(f"127.0.0.1:{free_port()}")
    with client.FoxgloveClient(view.port or 0) as deaf:
        deaf.wait_for("/posemix/scene")
        deaf.subscribe("/posemix/tf", "/posemix/scene")
        for _ in range(100):
            if view._scene.has_sinks():
                break
            time.sleep(0.05)
        assert view._scene.has_sinks()
        assert growth_mb(view) < 12.0
        start = time.monotonic()
        view.close()
        assert time.monotonic() - start < 10.0
