# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Bytes of messages against those of the middleware, for random messages."""

from __future__ import annotations

import struct
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

rclpy = pytest.importorskip("rclpy")

from geometry_msgs.msg import TransformStamped
from nav_msgs.msg import Odometry
from rclpy.serialization import deserialize_message, serialize_message
from tf2_msgs.msg import TFMessage
from vision_msgs.msg import (
    Detection2D,
    Detection2DArray,
    Detection3D,
    Detection3DArray,
    ObjectHypothesisWithPose,
)

from posemix import SE3, TrackHealth
from posemix.density import ConcentratedGaussian
from posemix.interop.ros import covariance_to_ros
from posemix.ros.cdr import read_detections_2d, read_detections_3d, read_odometry, read_transforms
from posemix.ros.messages import images_of
from posemix.ros.outputs import Outputs

SEEDS = range(40)
WORDS = ["", "a", "mug", "obj_000005", "Gefäß", "κούπα", "x" * 300]


def header(rng: np.random.Generator, message: Any) -> None:
    message.stamp.sec, message.stamp.nanosec = int(rng.integers(-(2**31), 2**31)), int(rng.integers(0, 10**9))
    message.frame_id = str(rng.choice(WORDS))


def posed(rng: np.random.Generator, message: Any) -> None:
    place = message.position if hasattr(message, "position") else message.translation
    turn = message.orientation if hasattr(message, "orientation") else message.rotation
    place.x, place.y, place.z = rng.normal(size=3).tolist()
    turn.x, turn.y, turn.z, turn.w = rng.normal(size=4).tolist()


def result(rng: np.random.Generator) -> Any:
    found = ObjectHypothesisWithPose()
    found.hypothesis.class_id, found.hypothesis.score = str(rng.choice(WORDS)), float(rng.random())
    posed(rng, found.pose.pose)
    half = rng.normal(size=(6, 6))
    found.pose.covariance = (half @ half.T).ravel() if rng.random() < 0.5 else np.zeros(36)
    return found


def array(rng: np.random.Generator, flat: bool) -> Any:
    message = Detection2DArray() if flat else Detection3DArray()
    header(rng, message.header)
    for _ in range(rng.integers(0, 5)):
        detection = Detection2D() if flat else Detection3D()
        header(rng, detection.header)
        detection.results = [result(rng) for _ in range(rng.integers(0, 4))]
        detection.id = str(rng.choice(WORDS))
        if flat:
            detection.bbox.size_x = float(rng.random())
        else:
            posed(rng, detection.bbox.center)
        message.detections.append(detection)
    return message


def same(found: Any, expected: Any) -> None:
    """All fields that were read are those of the message."""
    if hasattr(found, "_fields"):
        for name in found._fields:
            if name != "w" or hasattr(expected, "w"):
                same(getattr(found, name), getattr(expected, name))
    elif isinstance(found, list):
        assert len(found) == len(expected)
        for one, other in zip(found, expected, strict=True):
            same(one, other)
    else:
        np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize("seed", SEEDS)
def test_detections_are_read(seed: int) -> None:
    rng = np.random.default_rng(seed)
    message = array(rng, flat=False)
    found = read_detections_3d(serialize_message(message))
    same(found, message)
    # And they are taken for the same images.
    for one, other in zip(images_of(found), images_of(message), strict=True):
        assert (one.stamp_ns, one.frame, one.class_ids, one.scores) == (
            other.stamp_ns, other.frame, other.class_ids, other.scores
        )  # fmt: skip
        assert one.components == other.components
    message = array(rng, flat=True)
    found = read_detections_2d(serialize_message(message))
    assert found.detections == [] or found.detections[0].bbox.center is None
    same(found._replace(detections=[]), SimpleNamespace(header=message.header, detections=[]))
    for one, other in zip(found.detections, message.detections, strict=True):
        for name in ("header", "results", "id"):
            same(getattr(one, name), getattr(other, name))


@pytest.mark.parametrize("seed", SEEDS)
def test_motion_is_read(seed: int) -> None:
    rng = np.random.default_rng(seed)
    message = TFMessage()
    for _ in range(rng.integers(0, 5)):
        item = TransformStamped()
        header(rng, item.header)
        item.child_frame_id = str(rng.choice(WORDS))
        posed(rng, item.transform)
        message.transforms.append(item)
    found = read_transforms(serialize_message(message))
    assert len(found) == len(message.transforms)
    for one, other in zip(found, message.transforms, strict=True):
        same(one.header, other.header)
        p, q = other.transform.translation, other.transform.rotation
        assert one.child_frame_id == other.child_frame_id and one.row == (p.x, p.y, p.z, q.x, q.y, q.z, q.w)
    odometry = Odometry()
    header(rng, odometry.header)
    odometry.child_frame_id = str(rng.choice(WORDS))
    posed(rng, odometry.pose.pose)
    read = read_odometry(serialize_message(odometry))
    same(read.header, odometry.header)
    p, q = odometry.pose.pose.position, odometry.pose.pose.orientation
    assert read.child_frame_id == odometry.child_frame_id and read.row == (p.x, p.y, p.z, q.x, q.y, q.z, q.w)


def test_the_other_order_of_bytes_is_read() -> None:
    one = struct.pack(">iI", -5, 7) + struct.pack(">I", 4) + b"map\0" + struct.pack(">I", 4) + b"cup\0"
    row = struct.pack(">7d", 1, 2, 3, 0, 0, 0, 1)
    padding = bytes(-(4 + len(one)) % 8)
    found = read_transforms(b"\0\0\0\0" + struct.pack(">I", 1) + one + padding + row)
    assert found[0].header.stamp == (-5, 7) and found[0].header.stamp.nanoseconds == -4_999_999_993
    assert found[0].child_frame_id == "cup" and found[0].row == (1, 2, 3, 0, 0, 0, 1)


def test_what_is_no_message_is_refused() -> None:
    data = serialize_message(array(np.random.default_rng(4), flat=False))
    for end in range(len(data)):
        with pytest.raises(ValueError, match="ends after|begins with"):
            read_detections_3d(data[:end])
    with pytest.raises(ValueError, match="begins with 00 07"):
        read_detections_3d(b"\0\7" + data[2:])
    rng = np.random.default_rng(5)
    for _ in range(300):
        damaged = bytearray(data)
        damaged[rng.integers(4, len(data))] = rng.integers(256)
        try:
            images_of(read_detections_3d(bytes(damaged)))
        except ValueError:
            pass


def estimate(rng: np.random.Generator) -> Any:
    """What Outputs takes of a LiveEstimate, at random."""

    def density() -> Any:
        half = rng.normal(size=(6, 6))
        return ConcentratedGaussian(SE3.exp(rng.normal(size=6)), half @ half.T + np.eye(6))

    names = [f"{rng.choice(WORDS)}{i}" for i in range(rng.integers(0, 5))]
    hypotheses = {}
    for name in names:
        of = [density() for _ in range(rng.integers(1, 4))]
        hypotheses[name] = [
            SimpleNamespace(pose=d.mean, covariance=d.covariance, probability=float(rng.random())) for d in of
        ]
    frame = SimpleNamespace(
        existences={name: float(rng.random()) for name in names}, objects={name: density() for name in names},
        healths={name: [TrackHealth.good, TrackHealth.lost][rng.integers(2)] for name in names}, camera=density(),
    )  # fmt: skip
    return SimpleNamespace(
        stamp_ns=int(rng.integers(0, 2**31)) * 10**9 + 5, frame=frame, hypotheses=hypotheses,
        classes={name: str(rng.choice(WORDS)) for name in names},
    )  # fmt: skip


@pytest.mark.parametrize("seed", SEEDS)
def test_outputs_are_written(seed: int) -> None:
    rng = np.random.default_rng(seed)
    of = estimate(rng)
    values = {
        "least_existence": 0.3, "world_frame": str(rng.choice(WORDS)), "publish_tf": True, "tf_prefix": "p/",
        "transform_time_offset_s": 0.25,
    }  # fmt: skip
    make = Outputs({}, values)
    data = make.objects(of)
    message = deserialize_message(data, Detection3DArray)
    # But for what fills the gaps before numbers, which has no meaning.
    assert len(serialize_message(message)) == len(data)
    there = [name for name in of.hypotheses if of.frame.existences[name] >= 0.3]
    assert [d.id for d in message.detections] == there
    assert (message.header.stamp.sec, message.header.stamp.nanosec) == divmod(of.stamp_ns, 10**9)
    for detection in message.detections:
        assert detection.header == message.header and message.header.frame_id == values["world_frame"]
        centre = np.array(of.frame.objects[detection.id].mean.to_tq())
        p, q = detection.bbox.center.position, detection.bbox.center.orientation
        np.testing.assert_allclose([p.x, p.y, p.z, q.x, q.y, q.z, q.w], centre, rtol=1e-15)
        total = sum(h.probability for h in of.hypotheses[detection.id])
        for r, h in zip(detection.results, of.hypotheses[detection.id], strict=True):
            assert r.hypothesis.class_id == of.classes[detection.id]
            assert r.hypothesis.score == pytest.approx(h.probability / total)
            p = r.pose.pose.position
            np.testing.assert_allclose([p.x, p.y, p.z], h.pose.translation, rtol=1e-15)
            expected = covariance_to_ros(h.pose, h.covariance, reading="rotation_vector", frame="parent")
            np.testing.assert_allclose(r.pose.covariance, expected, rtol=1e-12, atol=1e-12)
    rows, data = make.transforms(of, ("odom", SE3.exp(rng.normal(size=6))))
    transforms = deserialize_message(data, TFMessage)
    assert len(serialize_message(transforms)) == len(data)
    names = list(rows)
    assert [t.child_frame_id for t in transforms.transforms] == names
    good = [name for name in of.hypotheses if of.frame.healths[name] == TrackHealth.good]
    assert names == [f"p/{name}" for name in good] + ["odom"]
    for item, name in zip(transforms.transforms, good, strict=False):
        t = item.transform.translation
        np.testing.assert_array_equal([t.x, t.y, t.z], of.frame.objects[name].mean.translation)
        assert item.header.stamp.sec * 10**9 + item.header.stamp.nanosec == of.stamp_ns + 250_000_000
