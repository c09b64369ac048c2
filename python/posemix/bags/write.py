# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Writes estimates and mixtures over time to a bag, and reads them back."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np

from posemix._peers import peer
from posemix.bags.messages import (
    INSTALL,
    USER,
    connections_of,
    messages,
    opened,
    stamp_of,
)
from posemix.bags.states import DIAGNOSTICS, state_of
from posemix.bags.track_messages import (
    DETECTION,
    PATH,
    POSE,
    PoseMixture,
    Track,
    TrackMessages,
)
from posemix.interop.ros import covariance_from_ros, from_pose, from_pose_with_covariance
from posemix.lie import SE3
from posemix.mixture import Mixture

__all__ = ["Track", "read_track", "write"]


def _writer(path: Path, storage: str) -> Any:
    if storage == "ros1":
        return peer("rosbags.rosbag1", USER, INSTALL).Writer(path)
    rosbag2 = peer("rosbags.rosbag2", USER, INSTALL)
    plugin = getattr(rosbag2.StoragePlugin, storage.upper())
    return rosbag2.Writer(path, version=8, storage_plugin=plugin)


def _topics(track: Track) -> list[tuple[str, str, range]]:
    """Names and kinds of a track's topics, and the rows that have a message there."""
    n = len(track.stamps_ns)
    topics = [("pose", POSE, range(n))]
    if track.mixtures:
        topics.append(("mixture", DETECTION, range(n)))
    if track.states:
        topics.append(("state", DIAGNOSTICS, range(n)))
    if track.moves:
        topics.append(("path", PATH, range(n - 1, n)))
    return topics


def _fill(writer: Any, make: TrackMessages, tracks: Sequence[Track]) -> None:
    rows = []
    for track in tracks:
        for name, kind, of_rows in _topics(track):
            topic = writer.add_connection(f"{track.topic}/{name}", kind, typestore=make.store)
            rows += [(int(track.stamps_ns[i]), topic, track, i) for i in of_rows]
    for stamp, connection, track, i in sorted(rows, key=lambda row: row[0]):
        kind = connection.msgtype
        writer.write(connection, stamp, make.serialized(make.of(kind, track, i), kind))


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
    weight, and the pose has a covariance. A track with states also has /posemix/NAME/state of
    diagnostic_msgs/DiagnosticArray, one status with the health as its message and existence, `register_again` and
    probabilities of motion models as values; that of an object that moves /posemix/NAME/path, its whole path as one
    nav_msgs/Path at its last stamp. Covariances are in the form of tf2, of rotation vectors along the axes of
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
    make = TrackMessages(1 if storage == "ros1" else 2, frame)
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
        wanted = connections_of(reader, path, pose_topic, (POSE,))
        state_topic = empty.topic + "/state"
        for topic, kind in ((mixture_topic, DETECTION), (state_topic, DIAGNOSTICS)):
            if any(c.topic == topic for c in reader.connections):
                wanted += connections_of(reader, path, topic, (kind,))
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
    states = tuple(state_of(m.status[0]) for topic, _, m in found if topic == state_topic)
    return Track(name, class_id, stamps, means, covariances, mixtures, states)


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
