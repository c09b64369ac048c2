# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Bags as a robot with a camera would record them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

pytest.importorskip("rosbags")

from .bag_maker import T_BASE_CAMERA, T_ODOM_OBJECT, BagMaker, base_at

from posemix import SE3


@pytest.fixture
def maker(tmp_path: Path) -> Callable[[str], BagMaker]:
    """An empty bag of a kind."""
    return lambda kind: BagMaker(kind, tmp_path)


@pytest.fixture
def drive(maker: Callable[[str], BagMaker]) -> Callable[..., Path]:
    """A bag of two seconds: odometry at 50 Hz, camera at 10 Hz between its stamps."""

    def written(kind: str, odometry: str = "topic", frame: str = "camera") -> Path:
        bag = maker(kind)
        bag.transform(0.0, "base", "mount", SE3(translation=[0.1, 0.0, 0.0]), "/tf_static")
        rest = SE3(translation=[-0.1, 0.0, 0.0]) * T_BASE_CAMERA
        bag.transform(0.0, "mount", "camera", rest, "/tf_static")
        for i in range(101):
            if odometry == "topic":
                bag.odometry(i / 50, base_at(i / 50))
            else:
                bag.transform(i / 50, "odom", "base", base_at(i / 50), "/tf")
        for i in range(20):
            seconds = i / 10 + 0.013
            seen_from = base_at(seconds)
            if frame == "camera":
                seen_from = seen_from * T_BASE_CAMERA
            bag.detections(
                seconds,
                frame,
                {name: seen_from.inverse() * pose for name, pose in T_ODOM_OBJECT.items()},
            )
        return bag.write()

    return written
