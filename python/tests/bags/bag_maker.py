# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Writes bags of all three kinds."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from posemix import SE3, SO3
from posemix.bags.messages import typestore
from posemix.interop.ros import to_pose

SECOND = 1_000_000_000
START = 1_700_000_000 * SECOND
KINDS = ["sqlite3", "mcap", "ros1"]

T_BASE_CAMERA = SE3.exp([-1.2, 1.2, -1.2, 0.1, 0.0, 0.3])
T_ODOM_OBJECT = {"7": SE3.exp([0.1, 0.2, 0.3, 3.0, 0.5, 0.4]), "9": SE3(translation=[2.0, -1.0, 0.2])}


def base_at(seconds: Any) -> SE3:
    """T_odom_base: a steady screw motion, which interpolation on geodesics finds exactly."""
    return SE3.exp(np.multiply.outer(np.asarray(seconds), [0.0, 0.02, 0.2, 0.5, 0.1, 0.0]))


class BagMaker:
    """Messages and a bag of one kind."""

    def __init__(self, kind: str, folder: Path) -> None:
        self.ros = 1 if kind == "ros1" else 2
        self.kind = kind
        self.path = folder / ("bag.bag" if self.ros == 1 else "bag")
        self.store = typestore(self.ros)
        self.rows: list[tuple[int, str, str, Any]] = []

    def make(self, name: str, **fields: Any) -> Any:
        return self.store.types[name](**fields)

    def header(self, seconds: float, frame: str) -> Any:
        sec, nanosec = divmod(START + round(seconds * SECOND), SECOND)
        time = self.make("builtin_interfaces/msg/Time", sec=sec, nanosec=nanosec)
        extra = {"seq": 0} if self.ros == 1 else {}
        return self.make("std_msgs/msg/Header", stamp=time, frame_id=frame, **extra)

    def add(self, seconds: float, topic: str, kind: str, message: Any) -> None:
        # Messages arrive later than their stamps.
        self.rows.append((START + round((seconds + 0.05) * SECOND), topic, kind, message))

    def vector(self, values: Any) -> Any:
        x, y, z = (float(v) for v in values)
        return self.make("geometry_msgs/msg/Vector3", x=x, y=y, z=z)

    def transform(self, seconds: float, parent: str, child: str, pose: SE3, topic: str) -> None:
        q = to_pose(pose, types=self.store.types).orientation
        inner = self.make(
            "geometry_msgs/msg/Transform", translation=self.vector(pose.translation), rotation=q
        )
        item = self.make(
            "geometry_msgs/msg/TransformStamped",
            header=self.header(seconds, parent), child_frame_id=child, transform=inner,
        )  # fmt: skip
        kind = "tf2_msgs/msg/TFMessage"
        self.add(seconds, topic, kind, self.make(kind, transforms=[item]))

    def odometry(self, seconds: float, pose: SE3, covariance: Any = None) -> None:
        zeros = np.zeros(36)
        twist = self.make(
            "geometry_msgs/msg/Twist", linear=self.vector(np.zeros(3)), angular=self.vector(np.zeros(3))
        )
        message = self.make(
            "nav_msgs/msg/Odometry",
            header=self.header(seconds, "odom"),
            child_frame_id="base",
            pose=self.make(
                "geometry_msgs/msg/PoseWithCovariance",
                pose=to_pose(pose, types=self.store.types),
                covariance=zeros if covariance is None else covariance,
            ),
            twist=self.make(
                "geometry_msgs/msg/TwistWithCovariance", twist=twist, covariance=zeros
            ),
        )  # fmt: skip
        self.add(seconds, "/odom", "nav_msgs/msg/Odometry", message)

    def pose(self, seconds: float, topic: str, pose: SE3, frame: str = "odom") -> None:
        kind = "geometry_msgs/msg/PoseStamped"
        inner = to_pose(pose, types=self.store.types)
        self.add(seconds, topic, kind, self.make(kind, header=self.header(seconds, frame), pose=inner))

    def result(self, class_id: str, score: float, pose: SE3) -> Any:
        shaped = self.make(
            "geometry_msgs/msg/PoseWithCovariance",
            pose=to_pose(pose, types=self.store.types), covariance=0.01 * np.eye(6).ravel(),
        )  # fmt: skip
        kind = "vision_msgs/msg/ObjectHypothesisWithPose"
        if self.ros == 1:
            return self.make(kind, id=int(class_id), score=score, pose=shaped)
        inner = self.make("vision_msgs/msg/ObjectHypothesis", class_id=class_id, score=score)
        return self.make(kind, hypothesis=inner, pose=shaped)

    def detections(self, seconds: float, frame: str, poses: dict[str, SE3]) -> None:
        header = self.header(seconds, frame)
        found = []
        for class_id, pose in poses.items():
            box = self.make(
                "vision_msgs/msg/BoundingBox3D",
                center=to_pose(SE3(SO3(), [9.0, 9.0, 9.0]), types=self.store.types),
                size=self.vector([0.1, 0.1, 0.1]),
            )
            worse = self.result("3", 0.1, SE3())
            results = [worse, self.result(class_id, 0.9, pose)]
            extra: dict[str, Any] = {"id": f"track {class_id}"}
            if self.ros == 1:
                extra = {"source_cloud": self.cloud(header)}
            found.append(
                self.make(
                    "vision_msgs/msg/Detection3D", header=header, results=results, bbox=box, **extra
                )
            )
        kind = "vision_msgs/msg/Detection3DArray"
        self.add(seconds, "/objects", kind, self.make(kind, header=header, detections=found))

    def cloud(self, header: Any) -> Any:
        return self.make(
            "sensor_msgs/msg/PointCloud2",
            header=header, height=0, width=0, fields=[], is_bigendian=False, point_step=0, row_step=0,
            data=np.zeros(0, dtype=np.uint8), is_dense=True,
        )  # fmt: skip

    def write(self) -> Path:
        if self.ros == 1:
            from rosbags.rosbag1 import Writer

            writer = Writer(self.path)
        else:
            from rosbags.rosbag2 import StoragePlugin, Writer as Writer2

            plugin = StoragePlugin[self.kind.upper()]
            writer = Writer2(self.path, version=8, storage_plugin=plugin)
        with writer:
            connections = {
                topic: writer.add_connection(topic, kind, typestore=self.store)
                for topic, kind in {row[1]: row[2] for row in self.rows}.items()
            }
            for arrival, topic, kind, message in sorted(self.rows, key=lambda row: row[0]):
                data = (
                    self.store.serialize_ros1(message, kind)
                    if self.ros == 1
                    else self.store.serialize_cdr(message, kind)
                )
                writer.write(connections[topic], arrival, data)
        return self.path
