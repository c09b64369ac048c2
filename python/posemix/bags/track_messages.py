# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""An estimate over time, and the messages that it becomes."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from posemix._arrays import FloatArray, as_floats
from posemix.bags.messages import typestore
from posemix.bags.states import DIAGNOSTICS, TrackState, status_of
from posemix.bags.transforms import Nanoseconds
from posemix.density import ConcentratedGaussian
from posemix.interop.ros import covariance_to_ros, to_pose, to_pose_with_covariance
from posemix.lie import SE3
from posemix.mixture import Mixture

__all__ = ["Track"]

POSE = "geometry_msgs/msg/PoseWithCovarianceStamped"
DETECTION = "vision_msgs/msg/Detection3D"
PATH = "nav_msgs/msg/Path"

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
    states : tuple of TrackState, length n, or empty
        Existence, health and motion at each time.
    """

    name: str
    class_id: str
    stamps_ns: Nanoseconds
    poses: SE3
    covariances: FloatArray
    mixtures: tuple[PoseMixture, ...] = ()
    states: tuple[TrackState, ...] = ()

    def __post_init__(self) -> None:
        n = len(self.stamps_ns)
        as_floats(self.covariances, (6, 6), f"covariances of '{self.name}'")
        lists = (len(self.mixtures) or n, len(self.states) or n)
        if (self.poses.shape, len(self.covariances), *lists) != ((n,), n, n, n):
            raise ValueError(
                f"track '{self.name}': {n} stamps, poses of shape {self.poses.shape}, "
                f"{len(self.covariances)} covariances, {len(self.mixtures)} mixtures, "
                f"{len(self.states)} states"
            )

    @property
    def moves(self) -> bool:
        """Whether the object has models of motion."""
        return any(state.motion_models for state in self.states)

    @property
    def topic(self) -> str:
        """The topic prefix of the track in a bag: /posemix/NAME with letters, digits and _ only."""
        name = re.sub(r"\W", "_", self.name, flags=re.ASCII)
        return "/posemix/" + (f"_{name}" if name[:1].isdigit() else name)


class TrackMessages:
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
        return self.types[POSE](header=self.header(track.stamps_ns[i]), pose=inner)

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
        return self.types[DETECTION](header=header, results=results, bbox=box, **extra)

    def state(self, track: Track, i: int) -> Any:
        status = status_of(track.states[i], track.name, self.types)
        return self.types[DIAGNOSTICS](header=self.header(track.stamps_ns[i]), status=[status])

    def path(self, track: Track, i: int) -> Any:
        """All poses up to a row."""
        kind = self.types["geometry_msgs/msg/PoseStamped"]
        poses = [
            kind(header=self.header(track.stamps_ns[k]), pose=to_pose(track.poses[k], types=self.types))
            for k in range(i + 1)
        ]
        return self.types[PATH](header=self.header(track.stamps_ns[i]), poses=poses)

    def of(self, kind: str, track: Track, i: int) -> Any:
        """The message of a kind for a row of a track."""
        makers = {POSE: self.pose, DETECTION: self.detection, DIAGNOSTICS: self.state, PATH: self.path}
        return makers[kind](track, i)

    def _no_cloud(self, header: Any) -> Any:
        return self.types["sensor_msgs/msg/PointCloud2"](
            header=header, height=0, width=0, fields=[], is_bigendian=False, point_step=0,
            row_step=0, data=np.zeros(0, dtype=np.uint8), is_dense=True,
        )  # fmt: skip

    def serialized(self, message: Any, kind: str) -> Any:
        if self.ros == 1:
            return self.store.serialize_ros1(message, kind)
        return self.store.serialize_cdr(message, kind)
