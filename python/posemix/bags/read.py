# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Detections and odometry of a bag as arrays."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from posemix._arrays import FloatArray
from posemix._core import Observation
from posemix.bags.messages import connections_of, frame_of, messages, opened, stamp_of
from posemix.bags.observations import moved
from posemix.bags.rows import DetectionRows, PoseOf
from posemix.bags.transforms import Nanoseconds, Timeline, TransformBuffer
from posemix.interop.ros import from_pose
from posemix.lie import SE3

__all__ = ["Detections", "Recording", "read"]

_DETECTION_TYPES = ("vision_msgs/msg/Detection3DArray", "vision_msgs/msg/Detection2DArray")
_TF_TYPES = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")


@dataclass(frozen=True)
class Detections:
    """All detections of a recording, one row each.

    Attributes
    ----------
    frame : ndarray of int, shape (n,)
        Index of the frame in the recording.
    class_id, instance_id : tuple of str, length n
        Class of the object, and its instance; "" if the detector names none.
    score : ndarray, shape (n,)
        Confidence of the detector.
    poses : SE3, shape (n,)
        T_camera_object.
    covariance : ndarray, shape (n, 36)
        Covariance of the message (see `posemix.interop.ros`), in the frame of the message; zeros if the detector
        gives none.
    observations : tuple of Observation, length n, or empty
        All results of the class with their weights and covariances, poses T_camera_object. Stamps in seconds since the
        first frame.
    """

    frame: npt.NDArray[np.int64]
    class_id: tuple[str, ...]
    instance_id: tuple[str, ...]
    score: FloatArray
    poses: SE3
    covariance: FloatArray
    observations: tuple[Observation, ...] = ()


@dataclass(frozen=True)
class Recording:
    """The detections and odometry in a bag.

    A frame is a message of the detector, or what it has with one stamp where detections have stamps of their own.

    Attributes
    ----------
    stamps_ns : ndarray of int, shape (f,)
        Times of the frames, increasing [ns].
    odometry : SE3, shape (f,)
        T_odom_camera.
    has_odometry : ndarray of bool, shape (f,)
        Whether the odometry is known.
    camera_frame, odometry_frame : str
        Names of the frames; the latter is "" without odometry.
    detections : Detections
        All detections.
    arrivals_ns : ndarray of int, shape (f,), or empty
        Times at which the frames were recorded [ns].
    """

    stamps_ns: Nanoseconds
    odometry: SE3
    has_odometry: npt.NDArray[np.bool_]
    camera_frame: str
    odometry_frame: str
    detections: Detections
    arrivals_ns: Nanoseconds = field(default_factory=lambda: np.zeros(0, dtype=np.int64))

    @property
    def stamps(self) -> FloatArray:
        """Seconds since the first frame, shape (f,)."""
        return np.asarray((self.stamps_ns - self.stamps_ns[0]) * 1e-9)


@dataclass
class _Content:
    """The content of a bag after one pass over it."""

    rows: DetectionRows
    buffer: TransformBuffer
    odometry: list[tuple[int, FloatArray]]
    odometry_frame: str = ""
    base_frame: str = ""


def _take_odometry(content: _Content, message: Any, arrival: int, where: str) -> None:
    frames = frame_of(message.header), str(message.child_frame_id).lstrip("/")
    known = content.odometry_frame, content.base_frame
    if content.odometry and frames != known:
        raise ValueError(f"{where}: is of {frames} after {known}; expected one pair of frames")
    content.odometry_frame, content.base_frame = frames
    pose = from_pose(message.pose.pose).to_tq()
    content.odometry.append((stamp_of(message.header, arrival), pose))


def _take_transforms(content: _Content, message: Any, is_static: bool) -> None:
    for item in message.transforms:
        child = str(item.child_frame_id).lstrip("/")
        stamp = None if is_static else stamp_of(item.header, 0)
        content.buffer.add(frame_of(item.header), child, from_pose(item.transform), stamp)


def _content(
    path: str | os.PathLike[str], detections: str, odometry: str | None, pose: PoseOf
) -> _Content:
    content = _Content(DetectionRows(), TransformBuffer(), [])
    with opened(path) as reader:
        wanted = connections_of(reader, path, detections, _DETECTION_TYPES)
        if pose == "bbox" and any(c.msgtype == _DETECTION_TYPES[1] for c in wanted):
            raise ValueError(
                f"{path}: {detections} has boxes in the image, which have no pose; expected pose = \"result\""
            )
        if odometry is not None:
            wanted += connections_of(reader, path, odometry, ("nav_msgs/msg/Odometry",))
        for topic in ("/tf", "/tf_static"):
            if any(c.topic == topic for c in reader.connections):
                wanted += connections_of(reader, path, topic, _TF_TYPES)
        for topic, arrival, message in messages(reader, path, wanted):
            if topic == detections:
                content.rows.take(message, arrival, pose, f"{path}: {topic}")
            elif topic == odometry:
                _take_odometry(content, message, arrival, f"{path}: {topic}")
            else:
                _take_transforms(content, message, topic == "/tf_static")
    if not content.rows.stamps:
        raise ValueError(f"{path}: no message on {detections}")
    return content


def read(
    path: str | os.PathLike[str],
    *,
    detections: str,
    odometry: str | None = None,
    odometry_frame: str | None = None,
    camera_frame: str | None = None,
    pose: PoseOf = "result",
    max_gap_s: float = 0.2,
) -> Recording:
    """Reads detections and odometry of a ROS 2 bag (sqlite3 or MCAP) or a ROS 1 bag.

    Odometry is interpolated at the stamps of the detections, along the geodesic between the messages before and after,
    and transformed from the robot's base to the camera by /tf and /tf_static. Of every detection all results of the
    class of the best one are an observation; `Detections.poses` are those with the highest score.

    Parameters
    ----------
    path : path
        The bag: a folder or file of ROS 2, a file of ROS 1.
    detections : str
        Topic of vision_msgs/Detection3DArray, or of vision_msgs/Detection2DArray whose results have poses.
    odometry : str, optional
        Topic of nav_msgs/Odometry, T_odom_base.
    odometry_frame : str, optional
        Used instead of `odometry`: the frame in /tf relative to which the camera moves, such as "odom".
    camera_frame : str, optional
        Frame of the resulting detections, by default that of the first message. Detections in other frames are
        transformed to it.
    pose : {"result", "bbox"}
        The pose of a detection: that of its best result, or the centre of its box.
    max_gap_s : float
        Longest gap between two odometry messages or transforms that is interpolated [s].

    Raises
    ------
    FileNotFoundError
        If there is no such bag.
    ValueError
        For a missing topic (with a list of the existing topics), a topic of another type, a damaged bag, a covariance
        that is not symmetric positive definite and no placeholder (see `is_placeholder_covariance`), and frames that no
        transform connects.
    """
    if odometry is not None and odometry_frame is not None:
        raise ValueError("odometry and odometry_frame are both given; expected one of them")
    content = _content(path, detections, odometry, pose)
    rows = content.rows
    order = np.argsort(np.array(rows.stamps), kind="stable")
    stamps = np.array(rows.stamps, dtype=np.int64)[order]
    if (np.diff(stamps) == 0).any():
        at = stamps[:-1][np.diff(stamps) == 0][0]
        raise ValueError(f"{path}: {detections} has two messages with the stamp {at} ns")
    camera = (camera_frame or rows.cameras[0]).lstrip("/")
    try:
        found = _detections(content, order, stamps, camera, max_gap_s)
        poses, known = _odometry(content, stamps, camera, odometry_frame, max_gap_s)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    frame = content.odometry_frame or odometry_frame or ""
    arrivals = np.array(rows.arrivals, dtype=np.int64)[order]
    return Recording(stamps, poses, known, camera, frame, found, arrivals)


def _detections(
    content: _Content, order: Nanoseconds, stamps: Nanoseconds, camera: str, max_gap_s: float
) -> Detections:
    rows = content.rows
    place = np.empty(len(order), dtype=np.int64)
    place[order] = np.arange(len(order))
    frame = place[np.array(rows.frame, dtype=np.int64)]
    poses = SE3.from_tq(np.array(rows.poses).reshape((-1, 7)))
    tq = poses.to_tq()
    components = list(rows.components)
    for source in sorted(set(rows.source) - {camera}):
        here = np.array([name == source for name in rows.source])
        to_camera, known = content.buffer.lookup(
            camera, source, stamps[frame[here]], max_gap_s=max_gap_s
        )
        if not known.all():
            at = stamps[frame[here]][~known][0]
            raise ValueError(f"no transform from '{source}' to '{camera}' at {at} ns")
        tq[here] = (to_camera * poses[here]).to_tq()
        for row, by in zip(np.flatnonzero(here), to_camera, strict=True):
            components[row] = moved(components[row], by)
    by_frame = np.argsort(frame, kind="stable")
    seconds = (stamps - stamps[0]) * 1e-9
    return Detections(
        frame[by_frame],
        tuple(rows.class_id[i] for i in by_frame),
        tuple(rows.instance_id[i] for i in by_frame),
        np.array(rows.score)[by_frame],
        SE3.from_tq(tq[by_frame].reshape((-1, 7))),
        np.array(rows.covariance).reshape((-1, 36))[by_frame],
        tuple(
            Observation(
                components[i], class_id=rows.class_id[i], stamp_s=float(seconds[frame[i]]), score=rows.score[i]
            )
            for i in by_frame
        ),
    )  # fmt: skip


def _odometry(
    content: _Content,
    stamps: Nanoseconds,
    camera: str,
    odometry_frame: str | None,
    max_gap_s: float,
) -> tuple[SE3, npt.NDArray[np.bool_]]:
    none = np.zeros(len(stamps), dtype=bool)
    if odometry_frame is not None:
        poses, known = content.buffer.lookup(
            odometry_frame.lstrip("/"), camera, stamps, max_gap_s=max_gap_s
        )
        if not known.any():
            raise ValueError(
                f"no transform from '{camera}' to '{odometry_frame}' at the stamps of the detections"
            )
        return poses, known
    if not content.odometry:
        return SE3.identity(len(stamps)), none
    times = np.array([stamp for stamp, _ in content.odometry], dtype=np.int64)
    line = Timeline(times, SE3.from_tq(np.array([row for _, row in content.odometry])))
    base, known = line.at(stamps, max_gap_s)
    to_camera, joined = content.buffer.lookup(
        content.base_frame, camera, stamps, max_gap_s=max_gap_s
    )
    return base * to_camera, known & joined
