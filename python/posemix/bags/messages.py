# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Message types that rosbags does not have, and helpers for headers and topics."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from posemix._peers import peer

# Fields of vision_msgs 4 (ROS 2) and 0.0 (ROS 1), and of tf2_msgs, which rosbags does not have for ROS 1.
_ROS2 = {
    "ObjectHypothesis": "string class_id\nfloat64 score\n",
    "ObjectHypothesisWithPose": (
        "vision_msgs/ObjectHypothesis hypothesis\ngeometry_msgs/PoseWithCovariance pose\n"
    ),
    "BoundingBox3D": "geometry_msgs/Pose center\ngeometry_msgs/Vector3 size\n",
    "Detection3D": (
        "std_msgs/Header header\nvision_msgs/ObjectHypothesisWithPose[] results\n"
        "vision_msgs/BoundingBox3D bbox\nstring id\n"
    ),
    "Detection3DArray": "std_msgs/Header header\nvision_msgs/Detection3D[] detections\n",
    "Point2D": "float64 x\nfloat64 y\n",
    "Pose2D": "vision_msgs/Point2D position\nfloat64 theta\n",
    "BoundingBox2D": "vision_msgs/Pose2D center\nfloat64 size_x\nfloat64 size_y\n",
    "Detection2D": (
        "std_msgs/Header header\nvision_msgs/ObjectHypothesisWithPose[] results\n"
        "vision_msgs/BoundingBox2D bbox\nstring id\n"
    ),
    "Detection2DArray": "std_msgs/Header header\nvision_msgs/Detection2D[] detections\n",
}
_ROS1 = {
    "ObjectHypothesisWithPose": (
        "int64 id\nfloat64 score\ngeometry_msgs/PoseWithCovariance pose\n"
    ),
    "BoundingBox3D": _ROS2["BoundingBox3D"],
    "Detection3D": (
        "std_msgs/Header header\nvision_msgs/ObjectHypothesisWithPose[] results\n"
        "vision_msgs/BoundingBox3D bbox\nsensor_msgs/PointCloud2 source_cloud\n"
    ),
    "Detection3DArray": _ROS2["Detection3DArray"],
    "BoundingBox2D": "geometry_msgs/Pose2D center\nfloat64 size_x\nfloat64 size_y\n",
    "Detection2D": (
        "std_msgs/Header header\nvision_msgs/ObjectHypothesisWithPose[] results\n"
        "vision_msgs/BoundingBox2D bbox\nsensor_msgs/Image source_img\n"
    ),
    "Detection2DArray": _ROS2["Detection2DArray"],
}
_TF = "geometry_msgs/TransformStamped[] transforms\n"

# Texts of the messages of ROS 2 by package and name.
ROS2_MESSAGES = {"vision_msgs": _ROS2, "tf2_msgs": {"TFMessage": _TF}}

USER = "posemix.bags"
INSTALL = "posemix[bags]"


def typestore(ros: int) -> Any:
    """The typestore of rosbags for ROS 1 (Noetic) or 2 (Humble), with vision_msgs."""
    typesys = peer("rosbags.typesys", USER, INSTALL)
    stores = typesys.Stores
    store = typesys.get_typestore(stores.ROS2_HUMBLE if ros == 2 else stores.ROS1_NOETIC)
    types: dict[str, Any] = {}
    for name, text in (_ROS2 if ros == 2 else _ROS1).items():
        types.update(typesys.get_types_from_msg(text, f"vision_msgs/msg/{name}"))
    if ros == 1:
        types.update(typesys.get_types_from_msg(_TF, "tf2_msgs/msg/TFMessage"))
    store.register(types)
    return store


@contextmanager
def opened(path: str | os.PathLike[str]) -> Iterator[Any]:
    """A reader of a bag of any kind; raises ValueError naming the bag if it cannot be opened."""
    highlevel = peer("rosbags.highlevel", USER, INSTALL)
    place = Path(path)
    if not place.exists():
        raise FileNotFoundError(f"{place}: there is no such bag")
    try:
        reader = highlevel.AnyReader([place], default_typestore=typestore(2))
        reader.open()
    except Exception as error:
        raise ValueError(f"{place}: is no bag that can be read: {error}") from error
    try:
        yield reader
    finally:
        reader.close()


def connections_of(reader: Any, path: Any, topic: str, kinds: tuple[str, ...]) -> list[Any]:
    """The connections of a topic; raises ValueError with the existing topics, or the topic's wrong type."""
    found = [c for c in reader.connections if c.topic == topic]
    if not found:
        there = sorted({f"{c.topic} ({c.msgtype})" for c in reader.connections})
        raise ValueError(f"{path}: no topic {topic}; there are: {', '.join(there) or 'none'}")
    for connection in found:
        if connection.msgtype not in kinds:
            expected = " or ".join(kinds)
            raise ValueError(f"{path}: {topic} is of {connection.msgtype}, expected {expected}")
    return found


def messages(reader: Any, path: Any, connections: list[Any]) -> Iterator[tuple[str, int, Any]]:
    """Topics, arrival times [ns] and messages in order of time; raises ValueError if the bag is truncated."""
    stream = iter(reader.messages(connections))
    last = "the first message"
    while True:
        try:
            connection, arrival, data = next(stream)
            message = reader.deserialize(data, connection.msgtype)
        except StopIteration:
            return
        except Exception as error:
            raise ValueError(f"{path}: cannot be read after {last}: {error}") from error
        last = f"the message of {connection.topic} at {arrival} ns"
        yield connection.topic, arrival, message


def stamp_of(header: Any, otherwise: int) -> int:
    """The time of a header [ns], or `otherwise` if it is not set."""
    nanoseconds = int(header.stamp.sec) * 1_000_000_000 + int(header.stamp.nanosec)
    return nanoseconds or otherwise


def frame_of(header: Any) -> str:
    """The frame of a header, without the leading slash of old bags."""
    return str(header.frame_id).lstrip("/")
