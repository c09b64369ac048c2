# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""What the node puts into /tf, below the world and of objects."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

pytest.importorskip("rclpy")

from posemix import SE3

from .live import Live, at, transform
from .test_live_node import MUG, STILL


def test_the_world_is_above_the_odometry_unless_something_else_is(live: Callable[..., Live]) -> None:
    world = live(parameters={"least_existence": 0.0})
    world.move(at(0.0), SE3(translation=[1.0, 0.0, 0.0]))
    world.watch(0.0, 1, {"mug": MUG})
    found = world.until(lambda: [t for t in world.transforms if t.child_frame_id == "odom"], "map -> odom")
    shift = found[-1].transform.translation
    np.testing.assert_allclose([shift.x, shift.y, shift.z], 0.0, atol=1e-9)
    world.send_transform(transform("earth", "odom", SE3(), at(0.5)))
    world.until(lambda: world.node._engine.transforms.parent("odom") == "earth", "earth -> odom")
    world.transforms.clear()
    world.move(at(1.0), SE3(translation=[1.0, 0.0, 0.0]))
    world.watch(1.0, 1, {"mug": MUG})
    world.status("node", lambda s: "'odom' is below 'earth'" in s.message)
    assert not [t for t in world.transforms if t.child_frame_id == "odom"]


def test_a_frame_is_in_tf_once_of_a_time_also_where_a_second_image_of_it_knows_more(live: Callable[..., Live]) -> None:
    world = live(parameters={"least_existence": 0.0, "transform_timeout_s": 0.1})
    world.move(at(0.0), SE3())
    world.watch(0.0, 1, {"mug": MUG})
    # The odometry comes after the time for waiting, and then the image of another detector.
    world.watch(0.2, 1, {"mug": MUG})
    assert world.counts()["without_odometry"] == 1
    world.move(at(0.2), SE3())
    world.until(lambda: world.node._engine.transforms.at("odom", "camera", at(0.2), 1.0) is not None, "the odometry")
    for _ in range(2):
        world.watch(0.2, 1, {"mug": MUG})
    world.move(at(0.4), SE3())
    world.watch(0.4, 1, {"mug": MUG})
    stamps = [t.header.stamp.nanosec for t in world.until(
        lambda: world.transforms if len(world.transforms) >= 3 else None, "map -> odom of three times"
    )]  # fmt: skip
    assert stamps == [0, 200_000_000, 400_000_000]


def test_nobody_else_puts_the_odometry_below_the_world(live: Callable[..., Live]) -> None:
    world = live(parameters={"least_existence": 0.0})
    world.move(at(0.0), SE3())
    world.watch(0.0, 1, {"mug": MUG})
    world.until(lambda: [t for t in world.transforms if t.child_frame_id == "odom"], "map -> odom")
    # Its own transforms, which it hears, are none of another's.
    world.move(at(0.5), SE3())
    world.watch(0.5, 1, {"mug": MUG})
    assert world.status("node").message == "good"
    world.send_transform(transform("map", "odom", SE3(translation=[0.0, 1.0, 0.0]), at(0.5)))
    world.until(lambda: world.node._engine.transforms.parent("odom") == "map", "map -> odom of another")
    world.transforms.clear()
    world.move(at(1.0), SE3())
    world.watch(1.0, 1, {"mug": MUG})
    world.status("node", lambda s: "'odom' is below 'map'" in s.message)
    # The partner hears its own transform, too.
    assert not [t for t in world.transforms if t.child_frame_id == "odom" and t.transform.translation.y != 1.0]


def test_without_odometry_the_world_is_above_the_tree_of_the_camera(live: Callable[..., Live]) -> None:
    world = live(parameters={**STILL, "least_existence": 0.0})
    place = SE3.exp([0.3, 0.2, 0.1, 0.5, 0.6, 0.7])
    world.send_transform(transform("base_link", "camera", place), static=True)
    world.until(lambda: world.node._engine.transforms.parent("camera"), "base_link -> camera")
    world.watch(0.0, 1, {"mug": MUG})
    found = world.until(lambda: [t for t in world.transforms if t.child_frame_id == "base_link"], "map -> base_link")
    shift = found[-1].transform.translation
    np.testing.assert_allclose([shift.x, shift.y, shift.z], place.inverse().translation, atol=1e-9)
    world.send_transform(transform("map", "earth", SE3()), static=True)
    world.send_transform(transform("earth", "base_link", SE3()), static=True)
    world.until(lambda: world.node._engine.transforms.root("camera") == "map", "map -> earth -> base_link")
    world.watch(1.0, 1, {"mug": MUG})
    assert "'camera' is below 'map'" in world.status("node", lambda s: s.message != "good").message
