# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Writes estimates and mixtures over time to a bag, and reads them back."""

from __future__ import annotations

import os
import re
import shutil
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from posemix._arrays import FloatArray, as_floats
from posemix._peers import peer
from posemix.bags.messages import (
    INSTALL,
    USER,
    connections_of,
    messages,
    opened,
    stamp_of,
    typestore,
)
from posemix.bags.transforms import Nanoseconds
from posemix.density import ConcentratedGaussian
from posemix.interop.ros import (
    covariance_from_ros,
    covariance_to_ros,
    from_pose,
    from_pose_with_covariance,
    to_pose,
    to_pose_with_covariance,
)
from posemix.lie import SE3
from posemix.mixture import Mixture

__all__ = ["Track", "read_track", "write"]

_POSE = "geometry_msgs/msg/PoseWithCovarianceStamped"
_DETECTION = "vision_msgs/msg/Detection3D"

PoseMixture = Mixture[ConcentratedGaussian[SE3]]


@dataclass(frozen=True)
class Track:
    """An estimate over time, T_world_x.

    Attributes
    ----------
    name : str
        Name of the object, or "camera".
    class_id : str
        Class of the object, "" for the camera.
    stamps_ns : ndarray of int, shape (n,)
        Times [ns].
    poses : SE3, shape (n,)
        Estimates.
    covariances : ndarray, shape (n, 6, 6)
        Covariances of the left perturbation (world frame), rotation (rad) before translation (m).
    mixtures : tuple of Mixture, length n, or empty
        The hypotheses at each time.
    """

    name: str
    class_id: str
    stamps_ns: Nanoseconds
    poses: SE3
    covariances: FloatArray
    mixtures: tuple[PoseMixture, ...] = ()

    def __post_init__(self) -> None:
        n = len(self.stamps_ns)
        as_floats(self.covariances, (6, 6), f"covariances of '{self.name}'")
        counts = (self.poses.shape, len(self.covariances), len(self.mixtures) or n)
        if counts != ((n,), n, n):
            raise ValueError(
                f"track '{self.name}': {n} stamps, poses of shape {self.poses.shape}, "
                f"{len(self.covariances)} covariances, {len(self.mixtures)} mixtures"
            )

    @property
    def topic(self) -> str:
        """The topic prefix of the track in a bag: /posemix/NAME with letters, digits and _ only."""
        name = re.sub(r"\W", "_", self.name, flags=re.ASCII)
        return "/posemix/" + (f"_{name}" if name[:1].isdigit() else name)


class _Messages:
    """Makes the messages for one kind of bag."""

    def __init__(self, ros: int, frame: str) -> None:
        self.ros, self.frame = ros, frame
        self.store = typestore(ros)
        self.types = self.store.types

    def header(self, stamp_ns: int) -> Any:
        sec, nanosec = divmod(int(stamp_ns), 1_000_000_000)
        time = self.types["builtin_interfaces/msg/Time"](sec=sec, nanosec=nanosec)
        extra = {"seq": 0} if self.ros == 1 else {}
        return self.types["std_msgs/msg/Header"](stamp=time, frame_id=self.frame, **extra)

    def pose(self, track: Track, i: int) -> Any:
        values = covariance_to_ros(
            track.poses[i], track.covariances[i], reading="rotation_vector", frame="parent"
        )
        inner = self.types["geometry_msgs/msg/PoseWithCovariance"](
            pose=to_pose(track.poses[i], types=self.types), covariance=values
        )
        return self.types[_POSE](header=self.header(track.stamps_ns[i]), pose=inner)

    def _result(self, track: Track, weight: float, density: ConcentratedGaussian[SE3]) -> Any:
        pose = to_pose_with_covariance(
            density, reading="rotation_vector", frame="parent", types=self.types
        )
        kind = self.types["vision_msgs/msg/ObjectHypothesisWithPose"]
        if self.ros == 1:
            if not track.class_id.isdecimal():
                raise ValueError(
                    f"track '{track.name}': got the class '{track.class_id}', expected an integer as "
                    "vision_msgs of ROS 1 has it"
                )
            return kind(id=int(track.class_id), score=weight, pose=pose)
        hypothesis = self.types["vision_msgs/msg/ObjectHypothesis"](
            class_id=track.class_id, score=weight
        )
        return kind(hypothesis=hypothesis, pose=pose)

    def detection(self, track: Track, i: int) -> Any:
        """The components as results, the heaviest first."""
        mixture = track.mixtures[i]
        order = np.argsort(-mixture.log_weights, kind="stable")
        weights = mixture.weights
        results = [self._result(track, float(weights[k]), mixture[int(k)]) for k in order]
        size = self.types["geometry_msgs/msg/Vector3"](x=0.0, y=0.0, z=0.0)
        box = self.types["vision_msgs/msg/BoundingBox3D"](
            center=to_pose(track.poses[i], types=self.types), size=size
        )
        header = self.header(track.stamps_ns[i])
        extra = {"source_cloud": self._no_cloud(header)} if self.ros == 1 else {"id": track.name}
        return self.types[_DETECTION](header=header, results=results, bbox=box, **extra)

    def _no_cloud(self, header: Any) -> Any:
        return self.types["sensor_msgs/msg/PointCloud2"](
            header=header, height=0, width=0, fields=[], is_bigendian=False, point_step=0,
            row_step=0, data=np.zeros(0, dtype=np.uint8), is_dense=True,
        )  # fmt: skip

    def serialized(self, message: Any, kind: str) -> Any:
        if self.ros == 1:
            return self.store.serialize_ros1(message, kind)
        return self.store.serialize_cdr(message, kind)


def _writer(path: Path, storage: str) -> Any:
    if storage == "ros1":
        return peer("rosbags.rosbag1", USER, INSTALL).Writer(path)
    rosbag2 = peer("rosbags.rosbag2", USER, INSTALL)
    plugin = getattr(rosbag2.StoragePlugin, storage.upper())
    return rosbag2.Writer(path, version=8, storage_plugin=plugin)


def _fill(writer: Any, make: _Messages, tracks: Sequence[Track]) -> None:
    rows = []
    for track in tracks:
        pose = writer.add_connection(track.topic + "/pose", _POSE, typestore=make.store)
        rows += [(stamp, pose, track, i) for i, stamp in enumerate(track.stamps_ns.tolist())]
        if track.mixtures:
            mixture = writer.add_connection(
                track.topic + "/mixture", _DETECTION, typestore=make.store
            )
            rows += [(stamp, mixture, track, i) for i, stamp in enumerate(track.stamps_ns.tolist())]
    for stamp, connection, track, i in sorted(rows, key=lambda row: row[0]):
        kind = connection.msgtype
        message = make.pose(track, i) if kind == _POSE else make.detection(track, i)
        writer.write(connection, stamp, make.serialized(message, kind))


def write(
    path: str | os.PathLike[str],
    tracks: Sequence[Track],
    *,
    frame: str,
    storage: Literal["mcap", "sqlite3", "ros1"] = "mcap",
) -> None:
    """Writes tracks to a bag, as a whole or not at all.

    A track has the topic /posemix/NAME/pose of geometry_msgs/PoseWithCovarianceStamped. A track with mixtures also has
    /posemix/NAME/mixture of vision_msgs/Detection3D, whose results are the components, heaviest first: score is the
    weight, and the pose has a covariance. Covariances are in the form of tf2, of rotation vectors along the axes of
    `frame`.

    Parameters
    ----------
    path : path
        The bag to write: a folder for ROS 2, or a file for ROS 1. It must not exist.
    tracks : sequence of Track
        The tracks to write.
    frame : str
        Name of the world frame, the messages' frame_id.
    storage : {"mcap", "sqlite3", "ros1"}
        The kind of bag. Classes are integers in ROS 1.

    Raises
    ------
    FileExistsError
        If `path` exists.
    ValueError
        For two tracks with the same topic, and in ROS 1 for classes that are not integers.
    """
    if storage not in ("mcap", "sqlite3", "ros1"):
        raise ValueError(f"storage is '{storage}'; expected 'mcap', 'sqlite3' or 'ros1'")
    topics = [track.topic for track in tracks]
    for topic in topics:
        if topics.count(topic) > 1:
            raise ValueError(f"two tracks have the topic {topic}")
    target = Path(path)
    if target.exists():
        raise FileExistsError(f"{target}: there is something already")
    make = _Messages(1 if storage == "ros1" else 2, frame)
    folder = Path(tempfile.mkdtemp(dir=target.parent, prefix=f".{target.name}."))
    try:
        with _writer(folder / target.name, storage) as writer:
            _fill(writer, make, tracks)
        os.replace(folder / target.name, target)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def read_track(path: str | os.PathLike[str], name: str) -> Track:
    """Reads a track that `write` wrote.

    Parameters
    ----------
    path : path
        The bag.
    name : str
        Name of the track.

    Raises
    ------
    ValueError
        If the bag has no such track; the message lists the existing topics.
    """
    empty = Track(name, "", np.zeros(0, dtype=np.int64), SE3.identity(0), np.zeros((0, 6, 6)))
    with opened(path) as reader:
        pose_topic, mixture_topic = empty.topic + "/pose", empty.topic + "/mixture"
        wanted = connections_of(reader, path, pose_topic, (_POSE,))
        if any(c.topic == mixture_topic for c in reader.connections):
            wanted += connections_of(reader, path, mixture_topic, (_DETECTION,))
        found = list(messages(reader, path, wanted))
    poses = [(t, m) for topic, t, m in found if topic == pose_topic]
    means = SE3.from_tq(np.array([from_pose(m.pose.pose).to_tq() for _, m in poses]))
    values = np.array([m.pose.covariance for _, m in poses])
    covariances = covariance_from_ros(means, values, reading="rotation_vector", frame="parent")
    stamps = np.array([stamp_of(m.header, t) for t, m in poses], dtype=np.int64)
    detections = [m for topic, _, m in found if topic == mixture_topic]
    class_id = ""
    if detections:
        first = detections[0].results[0]
        class_id = str(first.hypothesis.class_id if hasattr(first, "hypothesis") else first.id)
    mixtures = tuple(_mixture(message) for message in detections)
    return Track(name, class_id, stamps, means, covariances, mixtures)


def _mixture(message: Any) -> PoseMixture:
    densities = [
        from_pose_with_covariance(result.pose, reading="rotation_vector", frame="parent")
        for result in message.results
    ]
    weights = [
        result.hypothesis.score if hasattr(result, "hypothesis") else result.score
        for result in message.results
    ]
    return Mixture(densities, weights)
