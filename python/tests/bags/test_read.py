# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
from __future__ import annotations

import contextlib
import sqlite3
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from .bag_maker import KINDS, SECOND, START, T_BASE_CAMERA, T_ODOM_OBJECT, BagMaker, base_at

from posemix import SE3, bags, interpolate
from posemix.bags.transforms import Timeline


def check(recording: bags.Recording) -> None:
    seconds = np.arange(20) / 10 + 0.013
    np.testing.assert_array_equal(
        recording.stamps_ns, START + np.round(seconds * SECOND).astype(np.int64)
    )
    np.testing.assert_allclose(recording.stamps, np.arange(20) / 10, atol=1e-9)
    assert recording.has_odometry.all()
    assert recording.odometry.is_approx(base_at(seconds) * T_BASE_CAMERA, 1e-7)
    found = recording.detections
    assert found.class_id[:2] == ("7", "9")
    np.testing.assert_array_equal(found.frame, np.repeat(np.arange(20), 2))
    np.testing.assert_array_equal(found.score, 0.9)
    np.testing.assert_allclose(found.covariance[0].reshape((6, 6)), 0.01 * np.eye(6))
    seen = recording.odometry[found.frame] * found.poses
    assert seen[::2].is_approx(SE3.identity(20) * T_ODOM_OBJECT["7"], 1e-7)
    assert seen[1::2].is_approx(SE3.identity(20) * T_ODOM_OBJECT["9"], 1e-7)


@pytest.mark.parametrize("kind", KINDS)
def test_odometry_topic(drive: Callable[..., Path], kind: str) -> None:
    recording = bags.read(drive(kind), detections="/objects", odometry="/odom")
    check(recording)
    assert (recording.camera_frame, recording.odometry_frame) == ("camera", "odom")
    expected = "" if kind == "ros1" else "track 7"
    assert recording.detections.instance_id[0] == expected


@pytest.mark.parametrize("kind", KINDS)
def test_odometry_in_tf(drive: Callable[..., Path], kind: str) -> None:
    path = drive(kind, odometry="tf")
    check(bags.read(path, detections="/objects", odometry_frame="odom"))


def test_detections_in_the_base_frame(drive: Callable[..., Path]) -> None:
    path = drive("mcap", frame="base")
    check(bags.read(path, detections="/objects", odometry="/odom", camera_frame="camera"))
    as_written = bags.read(path, detections="/objects", odometry="/odom")
    assert as_written.camera_frame == "base"
    assert as_written.odometry.is_approx(base_at(np.arange(20) / 10 + 0.013), 1e-7)


def test_pose_from_the_box(drive: Callable[..., Path]) -> None:
    recording = bags.read(drive("mcap"), detections="/objects", odometry="/odom", pose="bbox")
    np.testing.assert_allclose(recording.detections.poses.translation, 9.0)


def test_without_odometry(drive: Callable[..., Path]) -> None:
    recording = bags.read(drive("sqlite3"), detections="/objects")
    assert not recording.has_odometry.any()
    assert recording.odometry_frame == ""


def test_gaps_in_odometry_are_not_filled(maker: Callable[[str], BagMaker]) -> None:
    bag = maker("mcap")
    for seconds in (0.0, 0.1, 1.0, 1.1):
        bag.odometry(seconds, base_at(seconds))
    for seconds in (-0.05, 0.05, 0.5, 1.0, 1.2):
        bag.detections(seconds, "base", {})
    recording = bags.read(bag.write(), detections="/objects", odometry="/odom")
    assert recording.has_odometry.tolist() == [False, True, False, True, False]
    assert len(recording.detections.frame) == 0


def test_missing_topic_lists_those_there_are(drive: Callable[..., Path]) -> None:
    path = drive("mcap")
    with pytest.raises(ValueError, match=r"no topic /poses; there are: /objects \(vision_msgs"):
        bags.read(path, detections="/poses")
    with pytest.raises(ValueError, match="/odom is of nav_msgs/msg/Odometry, expected vision_msgs"):
        bags.read(path, detections="/odom")
    with pytest.raises(ValueError, match="both given"):
        bags.read(path, detections="/objects", odometry="/odom", odometry_frame="odom")
    with pytest.raises(FileNotFoundError, match="no such bag"):
        bags.read(path.parent / "other", detections="/objects")


def test_frames_that_no_transform_joins(drive: Callable[..., Path]) -> None:
    path = drive("mcap")
    with pytest.raises(ValueError, match="no transform joins 'camera' and 'map'.*base, camera"):
        bags.read(path, detections="/objects", odometry_frame="map")
    with pytest.raises(ValueError, match="no transform joins 'camera' and 'optical'"):
        bags.read(path, detections="/objects", camera_frame="optical")


@pytest.mark.parametrize("kind", KINDS)
def test_types_that_nobody_knows(maker: Callable[[str], BagMaker], kind: str) -> None:
    from rosbags.typesys import get_types_from_msg

    bag = maker(kind)
    bag.store.register(get_types_from_msg("float64 value\n", "custom_msgs/msg/Thing"))
    bag.detections(0.0, "camera", {"7": SE3()})
    bag.add(0.0, "/thing", "custom_msgs/msg/Thing", bag.make("custom_msgs/msg/Thing", value=1.0))
    path = bag.write()
    assert len(bags.read(path, detections="/objects").stamps_ns) == 1
    with pytest.raises(ValueError, match="/thing is of custom_msgs/msg/Thing, expected vision_msgs"):
        bags.read(path, detections="/thing")


@pytest.mark.parametrize("kind", KINDS)
def test_truncated_bag(drive: Callable[..., Path], kind: str) -> None:
    path = drive(kind)
    data = path if path.is_file() else next(p for p in path.iterdir() if p.suffix != ".yaml")
    whole = data.read_bytes()
    data.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(ValueError, match=str(path)):
        bags.read(path, detections="/objects", odometry="/odom")


def test_two_messages_with_one_stamp(maker: Callable[[str], BagMaker]) -> None:
    bag = maker("sqlite3")
    for _ in range(2):
        bag.detections(0.5, "camera", {})
    with pytest.raises(ValueError, match="two messages with the stamp"):
        bags.read(bag.write(), detections="/objects")


def test_two_parents() -> None:
    buffer = bags.TransformBuffer()
    buffer.add("map", "base", SE3(), 0)
    with pytest.raises(ValueError, match="'base' has two parents, 'map' and 'odom'"):
        buffer.add("odom", "base", SE3(), 1)


def test_a_ring_of_frames() -> None:
    buffer = bags.TransformBuffer()
    buffer.add("a", "b", SE3())
    buffer.add("b", "a", SE3())
    with pytest.raises(ValueError, match="form a ring"):
        buffer.lookup("a", "b", np.array([0]), max_gap_s=1.0)


def test_between_two_stamps_is_the_geodesic() -> None:
    a, b = SE3.exp([0.1, 0.2, 0.3, 1, 2, 3]), SE3.exp([-1.0, 0.5, 0.3, -1, 2, 0])
    stamps = np.array([300, 100], dtype=np.int64) * SECOND
    line = Timeline(stamps, SE3.from_tq(np.stack([b.to_tq(), a.to_tq()])))
    at = np.array([50, 100, 125, 250, 300, 301], dtype=np.int64) * SECOND
    poses, found = line.at(at, max_gap_s=1000.0)
    assert found.tolist() == [False, True, True, True, True, False]
    assert poses[1:5].is_approx(interpolate(a, b, [0.0, 0.125, 0.75, 1.0]), 1e-12)
    assert line.at(at, max_gap_s=10.0)[1].tolist() == [False, True, False, False, True, False]


def test_bags_without_definitions(drive: Callable[..., Path]) -> None:
    """As ROS 2 Humble writes them: the types are posemix's own."""
    path = drive("sqlite3")
    (file,) = path.glob("*.db3")
    with contextlib.closing(sqlite3.connect(file)) as database:
        tables = [row[0] for row in database.execute("SELECT name FROM sqlite_master WHERE type = 'table'")]
        assert "message_definitions" in tables
        database.execute("DELETE FROM message_definitions")
        database.commit()
    check(bags.read(path, detections="/objects", odometry="/odom"))
