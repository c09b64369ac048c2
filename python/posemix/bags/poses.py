# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Trajectories with covariances, by whatever node published them."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from posemix.bags.messages import connections_of, frame_of, messages, opened, stamp_of
from posemix.bags.write import Track
from posemix.interop.ros import Frame, Reading, covariance_from_ros, from_pose
from posemix.lie import SE3

__all__ = ["read_poses"]

_KINDS = (
    "nav_msgs/msg/Odometry",
    "geometry_msgs/msg/PoseWithCovarianceStamped",
    "geometry_msgs/msg/PoseStamped",
)


def read_poses(
    path: str | os.PathLike[str],
    topic: str,
    *,
    reading: Reading = "rotation_vector",
    frame: Frame = "parent",
) -> Track:
    """Reads the poses of a topic of a bag, and their covariances.

    With a second track as the truth, `posemix.consistency` says whether the errors are as the covariances say::

        odometry, truth = bags.read_poses(path, "/odom"), bags.read_poses(path, "/truth")
        stamps, true_stamps = ((track.stamps_ns - truth.stamps_ns[0]) * 1e-9 for track in (odometry, truth))
        report = posemix.consistency(
            odometry.poses, odometry.covariances, truth.poses, stamps=stamps, truth_stamps=true_stamps,
        )

    Parameters
    ----------
    path : path
        The bag: a folder or file of ROS 2, a file of ROS 1.
    topic : str
        Topic of nav_msgs/Odometry, geometry_msgs/PoseWithCovarianceStamped or geometry_msgs/PoseStamped.
    reading, frame
        What the covariances are of; see `posemix.interop.ros`.

    Returns
    -------
    Track
        In the order of the stamps, with the name of the topic. Covariances of PoseStamped are NaN.

    Raises
    ------
    ValueError
        If the bag has no such topic (with a list of the existing topics), no message on it, or two messages with the
        same stamp, or poses in different frames.
    """
    with opened(path) as reader:
        wanted = connections_of(reader, path, topic, _KINDS)
        found = [(t, m) for _, t, m in messages(reader, path, wanted)]
    if not found:
        raise ValueError(f"{path}: no message on {topic}")
    frames = sorted({frame_of(m.header) for _, m in found})
    if len(frames) > 1:
        raise ValueError(f"{path}: {topic} has poses in the frames {', '.join(frames)}; expected one")
    stamps = np.array([stamp_of(m.header, t) for t, m in found], dtype=np.int64)
    order = np.argsort(stamps, kind="stable")
    stamps = stamps[order]
    if (np.diff(stamps) == 0).any():
        at = stamps[:-1][np.diff(stamps) == 0][0]
        raise ValueError(f"{path}: {topic} has two messages with the stamp {at} ns")
    inner = [found[i][1].pose for i in order]
    poses = SE3.from_tq(np.array([from_pose(_pose_of(p)).to_tq() for p in inner]))
    if hasattr(inner[0], "covariance"):
        values = np.array([p.covariance for p in inner], dtype=np.float64)
        covariances = covariance_from_ros(poses, values, reading=reading, frame=frame)
    else:
        covariances = np.full((len(inner), 6, 6), np.nan)
    return Track(topic, "", stamps, poses, covariances)


def _pose_of(inner: Any) -> Any:
    """The pose of a PoseWithCovariance, or the pose itself."""
    return inner.pose if hasattr(inner, "covariance") else inner
