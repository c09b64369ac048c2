# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""ROS 2 over the loopback device, in a domain of the session's own."""

from __future__ import annotations

import fcntl
import os
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

# Domains above 101 have ports that the system gives to others.
DOMAINS = range(20, 101)


@pytest.fixture(scope="session")
def domain() -> Iterator[int]:
    """A domain in which no other session of these tests is."""
    for number in DOMAINS:
        with open(Path(tempfile.gettempdir()) / f"posemix-ros-domain-{number}", "w") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                continue
            yield number
            return
    pytest.fail("all domains are in use")


@pytest.fixture(scope="session")
def ros(domain: int) -> Iterator[None]:
    """rclpy, initialised."""
    rclpy = pytest.importorskip("rclpy")
    assert os.environ.get("FASTDDS_DEFAULT_PROFILES_FILE"), "run by build/ros/run, nothing leaves the loopback device"
    rclpy.init(domain_id=domain)
    yield
    rclpy.shutdown()


@pytest.fixture
def live(ros: None) -> Iterator[Callable[..., Any]]:
    """Makes an active node with these parameters and a partner that talks to it."""
    from .live import Live

    made: list[Live] = []

    def make(**options: Any) -> Live:
        made.append(Live(**options))
        return made[-1]

    yield make
    for one in made:
        one.close()
