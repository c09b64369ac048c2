# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The memory of the program over a long recording, faster than it was recorded.

A short one unless POSEMIX_SOAK_IMAGES says how many images; an hour at 60 Hz has 216,000:

    POSEMIX_SOAK_IMAGES=216000 build/ros/run python -m pytest -s python/tests/ros/test_live_soak.py
"""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("rclpy")
pytest.importorskip("rosbags")

from posemix import SE3

from .live import SECOND, Live, at, detections
from .test_live_runs import cpu_time_s, program

IMAGES = int(os.environ.get("POSEMIX_SOAK_IMAGES", "2000"))
RATE = 60
# Images that are on their way.
AHEAD = 6
# What the allocator and caches may take after the first quarter [MB].
LEAST_GROWTH_MB = 6.0


def resident_mb(pid: int) -> float:
    """Memory of a process [MB]."""
    line = next(x for x in Path(f"/proc/{pid}/status").read_text().splitlines() if x.startswith("VmRSS"))
    return int(line.split()[1]) / 1024


def newest_sent(world: Live) -> int:
    stamp = world.objects[-1].header.stamp if world.objects else None
    return 0 if stamp is None else stamp.sec * SECOND + stamp.nanosec


def test_memory_does_not_grow(live: Callable[..., Live], domain: int, capsys: pytest.CaptureFixture[str]) -> None:
    topic = "qos_overrides./posemix/detections.subscription.reliability"
    # What is kept for symmetries that come late is filled early.
    parameters = {"least_existence": 0.0, "replay_images": 200, topic: "reliable"}
    running = program("--ros-args", *[a for k, v in parameters.items() for a in ("-p", f"{k}:={v}")], domain=domain)
    world = live(node=False)
    rng = np.random.default_rng(11)
    places = {f"object_{i}": SE3.exp([*rng.normal(size=3), *rng.uniform(-0.4, 0.4, 2), 1.2]) for i in range(5)}
    rows: list[tuple[int, float]] = []
    step = max(IMAGES // 16, 1)
    begin = time.monotonic()
    try:
        world.meet_program()
        cpu_s = cpu_time_s(running.pid)
        for i in range(IMAGES):
            angle = 2.0 * np.pi * i / (20 * RATE)
            camera = SE3(translation=[0.2 * np.cos(angle), 0.2 * np.sin(angle), 0.0])
            # Each is out of sight for a part of the way, and now and then an image shows nothing.
            seen = {
                name: camera.inverse() * pose * SE3.exp(rng.normal(size=6) * [0.01, 0.01, 0.01, 0.003, 0.003, 0.003])
                for k, (name, pose) in enumerate(places.items())
                if (i // (7 * RATE)) % 6 != k and i % 97
            }
            drift = SE3.exp([0.0, 0.0, 1e-6 * i, 0.0, 0.0, 0.0])
            world.move(at(i / RATE), drift * camera)
            world.detect(detections(at(i / RATE), seen))
            if i >= AHEAD:
                reached = at((i - AHEAD) / RATE)
                world.until(lambda t=reached: newest_sent(world) >= t, f"objects at image {i - AHEAD}")
            for heard in (world.objects, world.transforms, world.diagnostics, world.markers):
                del heard[:-1]
            if i % step == step - 1:
                rows.append((i + 1, resident_mb(running.pid)))
                if IMAGES > 10_000:
                    with capsys.disabled():
                        print(f"{rows[-1][0]} images, {rows[-1][1]:.1f} MB", flush=True)
        cpu_s = cpu_time_s(running.pid) - cpu_s
    finally:
        running.send_signal(signal.SIGINT)
        running.communicate(timeout=10)
    growth = rows[-1][1] - rows[len(rows) // 4][1]
    with capsys.disabled():
        took_s = time.monotonic() - begin
        print(f"\n{IMAGES / RATE:.0f} s at {RATE} Hz in {took_s:.0f} s, {1e3 * cpu_s / IMAGES:.2f} ms of CPU per image")
        print("resident memory [MB]: " + ", ".join(f"{n}: {mb:.1f}" for n, mb in rows))
    assert growth < LEAST_GROWTH_MB, rows
