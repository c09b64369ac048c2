# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Detections and odometry of a bag as arrays."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from posemix._arrays import FloatArray
from posemix.bags.messages import connections_of, frame_of, messages, opened, stamp_of
from posemix.bags.transforms import Nanoseconds, Timeline, TransformBuffer
from posemix.interop.ros import from_pose
from posemix.lie import SE3

__all__ = ["Detections", "Recording", "read"]

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
    """

    frame: npt.NDArray[np.int64]
    class_id: tuple[str, ...]
    instance_id: tuple[str, ...]
    score: FloatArray
    poses: SE3
    covariance: FloatArray


@dataclass(frozen=True)
class Recording:
    """The detections and odometry in a bag. A frame is a message of the detector.

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
    """

    stamps_ns: Nanoseconds
    odometry: SE3
    has_odometry: npt.NDArray[np.bool_]
    camera_frame: str
    odometry_frame: str
    detections: Detections

    @property
    def stamps(self) -> FloatArray:
        """Seconds since the first frame, shape (f,)."""
        return np.asarray((self.stamps_ns - self.stamps_ns[0]) * 1e-9)


@dataclass
class _Rows:
    """Rows of detections while a bag is read."""

    stamps: list[int] = field(default_factory=list)
    cameras: list[str] = field(default_factory=list)
    frame: list[int] = field(default_factory=list)
    source: list[str] = field(default_factory=list)
    class_id: list[str] = field(default_factory=list)
    instance_id: list[str] = field(default_factory=list)
    score: list[float] = field(default_factory=list)
    poses: list[FloatArray] = field(default_factory=list)
    covariance: list[FloatArray] = field(default_factory=list)

    def take(self, message: Any, arrival: int, pose_of: str, where: str) -> None:
        index = len(self.stamps)
        self.stamps.append(stamp_of(message.header, arrival))
        self.cameras.append(frame_of(message.header))
        for number, detection in enumerate(message.detections):
            if len(detection.results) == 0:
                continue
            best = max(detection.results, key=_score)
            shape = best.pose.pose if pose_of == "result" else detection.bbox.center
            try:
                pose = from_pose(shape)
            except ValueError as error:
                stamp = self.stamps[-1]
                raise ValueError(f"{where}: detection {number} at {stamp} ns: {error}") from None
            self.frame.append(index)
            self.source.append(frame_of(detection.header) or self.cameras[-1])
            self.class_id.append(_class_of(best))
            self.instance_id.append(_instance_of(detection))
            self.score.append(_score(best))
            self.poses.append(pose.to_tq())
            self.covariance.append(np.array(best.pose.covariance, dtype=np.float64))


def _score(result: Any) -> float:
    return float(result.hypothesis.score if hasattr(result, "hypothesis") else result.score)


def _class_of(result: Any) -> str:
    return str(result.hypothesis.class_id if hasattr(result, "hypothesis") else result.id)


def _instance_of(detection: Any) -> str:
    return str(getattr(detection, "id", "") or getattr(detection, "tracking_id", ""))


@dataclass
class _Content:
    """The content of a bag after one pass over it."""

    rows: _Rows
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
    path: str | os.PathLike[str], detections: str, odometry: str | None, pose: str
) -> _Content:
    content = _Content(_Rows(), TransformBuffer(), [])
    with opened(path) as reader:
        kinds = ("vision_msgs/msg/Detection3DArray",)
        wanted = connections_of(reader, path, detections, kinds)
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
    pose: Literal["result", "bbox"] = "result",
    max_gap_s: float = 0.2,
) -> Recording:
    """Reads detections and odometry of a ROS 2 bag (sqlite3 or MCAP) or a ROS 1 bag.

    Odometry is interpolated at the stamps of the detections, along the geodesic between the messages before and after,
    and transformed from the robot's base to the camera by /tf and /tf_static. The result with the highest score is
    taken of every detection.

    Parameters
    ----------
    path : path
        The bag: a folder or file of ROS 2, a file of ROS 1.
    detections : str
        Topic of vision_msgs/Detection3DArray.
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
        For a missing topic (with a list of the existing topics), a topic of another type, a damaged bag, and frames
        that no transform connects.
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
    return Recording(stamps, poses, known, camera, frame, found)


def _detections(
    content: _Content, order: Nanoseconds, stamps: Nanoseconds, camera: str, max_gap_s: float
) -> Detections:
    rows = content.rows
    place = np.empty(len(order), dtype=np.int64)
    place[order] = np.arange(len(order))
    frame = place[np.array(rows.frame, dtype=np.int64)]
    poses = SE3.from_tq(np.array(rows.poses).reshape((-1, 7)))
    tq = poses.to_tq()
    for source in sorted(set(rows.source) - {camera}):
        here = np.array([name == source for name in rows.source])
        to_camera, known = content.buffer.lookup(
            camera, source, stamps[frame[here]], max_gap_s=max_gap_s
        )
        if not known.all():
            at = stamps[frame[here]][~known][0]
            raise ValueError(f"no transform from '{source}' to '{camera}' at {at} ns")
        tq[here] = (to_camera * poses[here]).to_tq()
    by_frame = np.argsort(frame, kind="stable")
    return Detections(
        frame[by_frame],
        tuple(rows.class_id[i] for i in by_frame),
        tuple(rows.instance_id[i] for i in by_frame),
        np.array(rows.score)[by_frame],
        SE3.from_tq(tq[by_frame].reshape((-1, 7))),
        np.array(rows.covariance).reshape((-1, 36))[by_frame],
    )


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
