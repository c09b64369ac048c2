# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Estimates as messages: objects, transforms, diagnostics. Message classes are given, so that no ROS is needed here."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from posemix._arrays import FloatArray
from posemix._core import TrackHealth
from posemix.bags.states import DIAGNOSTICS, TrackState, status_of
from posemix.density import ConcentratedGaussian
from posemix.interop.ros import covariance_to_ros
from posemix.lie import SE3
from posemix.ros.estimates import EngineCounts, LiveEstimate

__all__ = ["Outputs", "fill_pose"]

# Of health, where an object has no frame in /tf: it is not confirmed, or should be seen and is not.
_NOT_IN_TF = (TrackHealth.none, TrackHealth.tentative, TrackHealth.lost)


def fill_pose(message: Any, row: Sequence[float]) -> None:
    """Writes tx, ty, tz, qx, qy, qz, qw into a Pose or Transform."""
    is_pose = hasattr(message, "position")
    place = message.position if is_pose else message.translation
    turn = message.orientation if is_pose else message.rotation
    place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w = row


def _world_row(world: ConcentratedGaussian[SE3] | None) -> FloatArray:
    assert world is not None
    return world.mean.to_tq()


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

    def header(self, stamp_ns: int, frame: str) -> Any:
        """A header."""
        sec, nanosec = divmod(stamp_ns, 1_000_000_000)
        time = self.types["builtin_interfaces/msg/Time"](sec=sec, nanosec=nanosec)
        return self.types["std_msgs/msg/Header"](stamp=time, frame_id=frame)

    def objects(self, estimate: LiveEstimate) -> Any:
        """The Detection3DArray: one detection per object that exists, whose results are the hypotheses.

        The messages are those of `posemix.bags.write`; all poses and covariances are converted at once, for speed.
        """
        least = self._values["least_existence"]
        existences, worlds = estimate.frame.existences, estimate.frame.objects
        names = [name for name in estimate.hypotheses if (existences[name] or 0.0) >= least]
        array = self.types["vision_msgs/msg/Detection3DArray"]()
        array.header = header = self.header(estimate.stamp_ns, str(self._values["world_frame"]))
        if not names:
            return array
        all_of = [h for name in names for h in estimate.hypotheses[name]]
        rows = [h.pose.to_tq() for h in all_of] + [_world_row(worlds[name]) for name in names]
        poses = SE3.from_tq(np.array(rows))
        covariances = covariance_to_ros(
            poses[: len(all_of)], np.array([h.covariance for h in all_of]), reading="rotation_vector", frame="parent"
        )
        numbers = poses.to_tq().tolist()
        results = [
            self._result(h.probability, row, values)
            for h, row, values in zip(all_of, numbers, covariances, strict=False)
        ]
        place = 0
        for name, row in zip(names, numbers[len(all_of) :], strict=True):
            found = self.types["vision_msgs/msg/Detection3D"]()
            found.header, found.id = header, name
            fill_pose(found.bbox.center, row)
            end = place + len(estimate.hypotheses[name])
            found.results = results[place:end]
            # The rest is the probability that none of the detections was of the object.
            total = sum(result.hypothesis.score for result in found.results)
            for result in found.results:
                result.hypothesis.class_id = estimate.classes[name]
                result.hypothesis.score /= total
            array.detections.append(found)
            place = end
        return array

    def _result(self, weight: float, row: Sequence[float], covariance: FloatArray) -> Any:
        result = self.types["vision_msgs/msg/ObjectHypothesisWithPose"]()
        result.hypothesis.score = weight
        fill_pose(result.pose.pose, row)
        result.pose.covariance = covariance
        return result

    def transforms(self, estimate: LiveEstimate, below: tuple[str, SE3] | None = None) -> Any:
        """The TFMessage: confirmed objects in the world, and a frame that is `below` it, with T_frame_body."""
        frame, found = estimate.frame, []
        if self._values["publish_tf"]:
            healths, worlds = frame.healths, frame.objects
            for name in estimate.hypotheses:
                if healths[name] not in _NOT_IN_TF:
                    found.append((str(self._values["tf_prefix"]) + name, _world_row(worlds[name])))
        if below is not None:
            found.append((below[0], (frame.camera.mean * below[1].inverse()).to_tq()))
        stamp_ns = estimate.stamp_ns + round(self._values["transform_time_offset_s"] * 1e9)
        message = self.types["tf2_msgs/msg/TFMessage"]()
        header = self.header(stamp_ns, str(self._values["world_frame"]))
        for child, row in found:
            item = self.types["geometry_msgs/msg/TransformStamped"]()
            item.header, item.child_frame_id = header, child
            fill_pose(item.transform, row.tolist())
            message.transforms.append(item)
        return message

    def diagnostics(self, stamp_ns: int, statuses: Sequence[Any]) -> Any:
        """The DiagnosticArray of statuses."""
        return self.types[DIAGNOSTICS](header=self.header(stamp_ns, ""), status=list(statuses))

    def object_statuses(self, estimate: LiveEstimate, node: str) -> list[Any]:
        """One status per object that was seen: health, existence, register again, probability of the mode."""
        found = []
        for name in estimate.hypotheses:
            of_object = estimate.frame.object(name)
            status = status_of(TrackState.of(of_object), f"{node}: {name}", self.types)
            if of_object.mode_probability is not None:
                status.values.append(self._pair("mode_probability", repr(of_object.mode_probability)))
            status.values.append(self._pair("hypotheses", str(len(estimate.hypotheses[name]))))
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
