# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Bytes that are no messages, and messages of another type, on the topics that the node and the program hear."""

from __future__ import annotations

import struct
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy")

from rclpy.serialization import serialize_message

from posemix import SE3

from .live import Live, at, detections, odometry, transform, values_of
from .program import Program, unavailable
from .test_live_node import MUG, STILL

NODE, PROGRAM = "node", "program"
WITH_PROGRAM = pytest.mark.skipif(bool(unavailable()), reason=unavailable())


@pytest.fixture(params=[NODE, pytest.param(PROGRAM, marks=WITH_PROGRAM)])
def world(request: Any, ros: None, domain: int, tmp_path: Path) -> Iterator[Live]:
    """The partner of a node or of a program that stands still."""
    if request.param == NODE:
        one = Live(parameters={**STILL, "least_existence": 0.0})
        try:
            yield one
        finally:
            one.close()
    else:
        source = '[[sources]]\nname = "detections"\nreliability = "reliable"\n[motion]\nmodel = "still"\n'
        running = Program(tmp_path, domain, source)
        try:
            yield running.ready().world
            assert running.process.poll() is None, "the program has ended"
        finally:
            running.close()


def wrong_bytes(good: bytes) -> Iterator[bytes]:
    """Of no message, of the beginning of one, and of one with other lengths in it."""
    yield from (b"", b"\0", good[:4], b"\xff" * 64, bytes(64), b"\0\7" + good[2:])
    for end in (5, 8, 12, 20, 21, len(good) // 2, len(good) - 1):
        yield good[:end]
    # The length of the name of the frame, then that of the array or of what stands there.
    for place in (12, 24, 28):
        for length in (0xFFFFFFFF, 0x7FFFFFFF, 1_000_000, 0):
            yield good[:place] + struct.pack("<I", length) + good[place + 4 :]
    yield good.replace(b"\0mug", b"\0m\0g") + bytes(1000)
    rng = np.random.default_rng(1)
    for _ in range(40):
        damaged = bytearray(good)
        for at_byte in rng.integers(4, len(good), 8):
            damaged[at_byte] = rng.integers(256)
        yield bytes(damaged)
    yield rng.bytes(100_000)


def test_bytes_that_are_no_message_are_dropped(world: Live) -> None:
    for publisher, message in (
        (world._detectors["detections"], detections(at(0.0), {"mug": MUG}, covariance=np.eye(6))),
        (world._tf, transform("odom", "camera", SE3(), at(0.0))),
        (world._static, transform("base", "camera", SE3(), 0)),
        (world._odometry, odometry(at(0.0), SE3())),
    ):
        for wrong in wrong_bytes(serialize_message(message)):
            publisher.publish(wrong)
            world.spin(0.01)
    answers(world, 1e6)
    # They have arrived: something of them was said.
    status = values_of(world.status("node"))
    assert int(status["refused"]) > 0


STRANGER = """
import rclpy, sys, time
from nav_msgs.msg import Odometry
rclpy.init(domain_id=int(sys.argv[1]))
publisher = rclpy.create_node("stranger").create_publisher(Odometry, "/posemix/detections", 10)
for _ in range(40):
    publisher.publish(Odometry())
    time.sleep(0.05)
"""


def test_a_publisher_of_another_type_is_not_heard(world: Live, domain: int) -> None:
    """In a process of its own: within one the middleware refuses a second type."""
    with subprocess.Popen([sys.executable, "-c", STRANGER, str(domain)]) as stranger:
        while stranger.poll() is None:
            world.spin(0.1)
    assert stranger.returncode == 0
    answers(world, 10.0)


def answers(world: Live, seconds: float) -> None:
    """Good images are taken in: later than damaged stamps may be, and so many that their clock counts."""
    for i in range(8):
        world.detect(detections(at(seconds + 0.1 * i), {"mug": MUG}))
        world.spin(0.05)
    assert "mug" in world.newest(at(seconds + 0.7))
