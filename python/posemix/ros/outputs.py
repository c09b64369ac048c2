# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Estimates as messages: objects, transforms, diagnostics. Message classes are given, so that no ROS is needed here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from posemix._core import ObjectEstimate, TrackHealth
from posemix.bags.states import DIAGNOSTICS, TrackState, status_of
from posemix.bags.track_messages import Track, TrackMessages
from posemix.interop.ros import to_pose
from posemix.lie import SE3
from posemix.ros.engine import EngineCounts, LiveEstimate

__all__ = ["Outputs", "is_confirmed"]

_UNCONFIRMED = (TrackHealth.none, TrackHealth.tentative)


def is_confirmed(estimate: ObjectEstimate) -> bool:
    """Whether the object is confirmed, and not lost."""
    return estimate.health not in (*_UNCONFIRMED, TrackHealth.lost)


class Outputs:
    """Makes the node's messages.

    Parameters
    ----------
    types : mapping of str to type
        Message classes by name, such as "vision_msgs/msg/Detection3D".
    values : mapping
        Values of the node's parameters.
    """

    def __init__(self, types: Mapping[str, Any], values: Mapping[str, Any]) -> None:
        self.types, self._values = types, values
        self._make = TrackMessages(2, str(values["world_frame"]), types)

    def header(self, stamp_ns: int, frame: str) -> Any:
        """A header."""
        sec, nanosec = divmod(stamp_ns, 1_000_000_000)
        time = self.types["builtin_interfaces/msg/Time"](sec=sec, nanosec=nanosec)
        return self.types["std_msgs/msg/Header"](stamp=time, frame_id=frame)

    def objects(self, estimate: LiveEstimate) -> Any:
        """The Detection3DArray: one detection per object that exists, whose results are the hypotheses."""
        found = [
            self._make.detection(self._track(estimate, name), 0)
            for name in estimate.mixtures
            if (estimate.frame.existences[name] or 0.0) >= self._values["least_existence"]
        ]
        header = self.header(estimate.stamp_ns, str(self._values["world_frame"]))
        return self.types["vision_msgs/msg/Detection3DArray"](header=header, detections=found)

    def _track(self, estimate: LiveEstimate, name: str) -> Track:
        world = estimate.frame.objects[name]
        assert world is not None
        return Track(
            name, estimate.classes[name], np.array([estimate.stamp_ns]),
            SE3.from_tq(world.mean.to_tq()[None]), world.covariance[None], (estimate.mixtures[name],),
        )  # fmt: skip

    def transforms(self, estimate: LiveEstimate, *, world_child: str) -> Any:
        """The TFMessage: confirmed objects in the world, and the world's child (`odom_frame` or the body); "": none."""
        frame, found = estimate.frame, []
        if self._values["publish_tf"]:
            for name in estimate.mixtures:
                world = frame.objects[name]
                if world is not None and is_confirmed(frame.object(name)):
                    found.append((str(self._values["tf_prefix"]) + name, world.mean))
        if world_child:
            of_body = estimate.odometry is not None and world_child != estimate.body
            back = estimate.odometry.inverse() if of_body and estimate.odometry is not None else SE3()
            if of_body or world_child == estimate.body:
                found.append((world_child, frame.camera.mean * back))
        stamp_ns = estimate.stamp_ns + round(self._values["transform_time_offset_s"] * 1e9)
        return self.types["tf2_msgs/msg/TFMessage"](
            transforms=[self._transform(stamp_ns, child, pose) for child, pose in found]
        )

    def _transform(self, stamp_ns: int, child: str, pose: SE3) -> Any:
        at = to_pose(pose, types=self.types)
        vector = self.types["geometry_msgs/msg/Vector3"](x=at.position.x, y=at.position.y, z=at.position.z)
        inner = self.types["geometry_msgs/msg/Transform"](translation=vector, rotation=at.orientation)
        header = self.header(stamp_ns, str(self._values["world_frame"]))
        return self.types["geometry_msgs/msg/TransformStamped"](
            header=header, child_frame_id=child, transform=inner
        )

    def diagnostics(self, stamp_ns: int, statuses: Sequence[Any]) -> Any:
        """The DiagnosticArray of statuses."""
        return self.types[DIAGNOSTICS](header=self.header(stamp_ns, ""), status=list(statuses))

    def object_statuses(self, estimate: LiveEstimate, node: str) -> list[Any]:
        """One status per object that was seen: health, existence, register again, probability of the mode."""
        found = []
        for name in estimate.mixtures:
            of_object = estimate.frame.object(name)
            status = status_of(TrackState.of(of_object), f"{node}: {name}", self.types)
            if of_object.mode_probability is not None:
                status.values.append(self._pair("mode_probability", repr(of_object.mode_probability)))
            status.values.append(self._pair("hypotheses", str(len(estimate.mixtures[name]))))
            found.append(status)
        return found

    def _pair(self, key: str, value: str) -> Any:
        return self.types["diagnostic_msgs/msg/KeyValue"](key=key, value=value)

    def node_status(
        self, node: str, counts: EngineCounts, problems: Sequence[str], values: Mapping[str, str]
    ) -> Any:
        """The status of the node: what became of the images, and what is wrong at the moment."""
        everything = {key: str(value) for key, value in vars(counts).items()} | dict(values)
        return self.types["diagnostic_msgs/msg/DiagnosticStatus"](
            level=1 if problems else 0, name=f"{node}: node", message="; ".join(problems) or "good", hardware_id="",
            values=[self._pair(key, value) for key, value in everything.items()],
        )  # fmt: skip
