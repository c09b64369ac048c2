# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Estimates as messages: objects and transforms as bytes, diagnostics of classes that are given, without any ROS."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np

from posemix._arrays import FloatArray
from posemix._core import ObjectHypothesis, TrackHealth
from posemix.bags.states import DIAGNOSTICS, TrackState, status_of
from posemix.density import ConcentratedGaussian
from posemix.interop.ros import covariance_to_ros
from posemix.lie import SE3
from posemix.ros.cdr import Writer
from posemix.ros.estimates import EngineCounts, LiveEstimate

__all__ = ["Outputs", "latency_values"]

# Of health, where an object has no frame in /tf: it is not confirmed, or should be seen and is not.
_NOT_IN_TF = (TrackHealth.none, TrackHealth.tentative, TrackHealth.lost)
# Bytes of the numbers of a result, and of a box.
_RESULT, _BOX = 352, 80


def _world_row(world: ConcentratedGaussian[SE3] | None) -> FloatArray:
    assert world is not None
    return world.mean.to_tq()


def _numbers(
    hypotheses: Sequence[Sequence[ObjectHypothesis]], worlds: Sequence[ConcentratedGaussian[SE3] | None]
) -> tuple[bytes, bytes]:
    """Of every hypothesis score, pose and covariance of its result, of every object pose and size of its box."""
    all_of = [h for of_object in hypotheses for h in of_object]
    n, scores = len(all_of), []
    for of_object in hypotheses:
        # The rest is the probability that none of the detections was of the object.
        total = sum(h.probability for h in of_object)
        scores += [h.probability / total for h in of_object]
    rows = [h.pose.to_tq() for h in all_of] + [_world_row(world) for world in worlds]
    poses = SE3.from_tq(np.array(rows).reshape((-1, 7)))
    covariances = np.array([h.covariance for h in all_of]).reshape((-1, 6, 6))
    results, boxes = np.empty((n, _RESULT // 8), dtype="<f8"), np.zeros((len(worlds), _BOX // 8), dtype="<f8")
    results[:, 0] = scores
    numbers = poses.to_tq()
    results[:, 1:8], boxes[:, :7] = numbers[:n], numbers[n:]
    results[:, 8:] = covariance_to_ros(poses[:n], covariances, reading="rotation_vector", frame="parent")
    return results.tobytes(), boxes.tobytes()


def latency_values(latencies_s: Collection[float]) -> dict[str, str]:
    """Mean, median, 99 % and worst of latencies [s], for diagnostics; empty where there are none."""
    if not latencies_s:
        return {}
    ordered = sorted(latencies_s)
    found = {
        "mean": sum(ordered) / len(ordered), "median": ordered[len(ordered) // 2],
        "99": ordered[int(0.99 * (len(ordered) - 1))], "worst": ordered[-1],
    }  # fmt: skip
    return {f"latency_{key}_ms": f"{1e3 * value:.3f}" for key, value in found.items()}


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

    def objects(self, estimate: LiveEstimate) -> bytes:
        """The Detection3DArray: one detection per object that exists, whose results are the hypotheses.

        The messages are those of `posemix.bags.write`; all poses and covariances are converted at once, for speed.
        """
        least, world = self._values["least_existence"], str(self._values["world_frame"])
        existences, worlds = estimate.frame.existences, estimate.frame.objects
        names = [name for name in estimate.hypotheses if (existences[name] or 0.0) >= least]
        results, boxes = _numbers([estimate.hypotheses[name] for name in names], [worlds[name] for name in names])
        out = Writer()
        out.header(estimate.stamp_ns, world)
        out.count(len(names))
        place = 0
        for i, name in enumerate(names):
            out.header(estimate.stamp_ns, world)
            count = len(estimate.hypotheses[name])
            out.count(count)
            for _ in range(count):
                out.string(estimate.classes[name])
                out.doubles(results[place : place + _RESULT])
                place += _RESULT
            out.doubles(boxes[_BOX * i : _BOX * (i + 1)])
            out.string(name)
        return out.data()

    def nothing(self, stamp_ns: int) -> bytes:
        """The Detection3DArray without objects."""
        out = Writer()
        out.header(stamp_ns, str(self._values["world_frame"]))
        out.count(0)
        return out.data()

    def transform_stamp(self, estimate: LiveEstimate) -> int:
        """The stamp in /tf of an estimate [ns]."""
        offset_s: float = self._values["transform_time_offset_s"]
        return estimate.stamp_ns + round(offset_s * 1e9)

    def transforms(
        self, estimate: LiveEstimate, below: tuple[str, SE3] | None = None, sent: Collection[str] = ()
    ) -> tuple[dict[str, list[float]], bytes]:
        """The TFMessage: confirmed objects in the world, and a frame that is `below` it, with T_frame_body.

        The numbers of these frames come first. Those that were `sent` with this stamp are left out.
        """
        frame, found = estimate.frame, []
        if self._values["publish_tf"]:
            healths, worlds = frame.healths, frame.objects
            for name in estimate.hypotheses:
                if healths[name] not in _NOT_IN_TF:
                    found.append((str(self._values["tf_prefix"]) + name, _world_row(worlds[name])))
        if below is not None:
            found.append((below[0], (frame.camera.mean * below[1].inverse()).to_tq()))
        found = [(child, row) for child, row in found if child not in sent]
        stamp_ns = self.transform_stamp(estimate)
        out = Writer()
        out.count(len(found))
        for child, row in found:
            out.header(stamp_ns, str(self._values["world_frame"]))
            out.string(child)
            out.doubles(row.astype("<f8").tobytes())
        return {child: row.tolist() for child, row in found}, out.data()

    def diagnostics(self, stamp_ns: int, statuses: Sequence[Any]) -> Any:
        """The DiagnosticArray of statuses."""
        return self.types[DIAGNOSTICS](header=self.header(stamp_ns, ""), status=list(statuses))

    def object_statuses(self, estimate: LiveEstimate, node: str, in_view: Mapping[str, bool]) -> list[Any]:
        """One status per object that was seen: health, existence, register again, probability of the mode, in view."""
        found = []
        for name in estimate.hypotheses:
            of_object = estimate.frame.object(name)
            status = status_of(TrackState.of(of_object), f"{node}: {name}", self.types)
            if of_object.mode_probability is not None:
                status.values.append(self._pair("mode_probability", repr(of_object.mode_probability)))
            status.values.append(self._pair("hypotheses", str(len(estimate.hypotheses[name]))))
            if name in in_view:
                status.values.append(self._pair("in_view", str(in_view[name]).lower()))
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
