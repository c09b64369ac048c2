# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""A node under test, and a partner with a detector, odometry and a viewer."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TransformStamped
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetState
from nav_msgs.msg import Odometry
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile
from tf2_msgs.msg import TFMessage
from vision_msgs.msg import (
    Detection2D,
    Detection2DArray,
    Detection3D,
    Detection3DArray,
    ObjectHypothesisWithPose,
)
from visualization_msgs.msg import MarkerArray

from posemix import SE3
from posemix.ros.node import PosemixNode

SECOND = 1_000_000_000
START = 1_700_000_000 * SECOND
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
STATIC = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)

# One pose, or several that exclude each other with their scores, and a covariance for each or none.
Seen = SE3 | Sequence[tuple[SE3, float]]


def at(seconds: float) -> int:
    """A stamp [ns]."""
    return START + round(seconds * SECOND)


def set_stamp(stamp: Any, nanoseconds: int) -> None:
    stamp.sec, stamp.nanosec = divmod(nanoseconds, SECOND)


def set_pose(message: Any, pose: SE3) -> None:
    """Writes a Pose or a Transform."""
    x, y, z, *q = (float(v) for v in pose.to_tq())
    place = message.position if hasattr(message, "position") else message.translation
    turn = message.orientation if hasattr(message, "orientation") else message.rotation
    place.x, place.y, place.z = x, y, z
    turn.x, turn.y, turn.z, turn.w = q


def detections(
    stamp_ns: int, seen: Mapping[str, Seen | list[SE3]], *, frame: str = "camera", covariance: Any = None,
    flat: bool = False, published_ns: int | None = None,
) -> Any:  # fmt: skip
    """An array of detections; `flat` as detectors of boxes in the image publish it, with a stamp of its own."""
    array = Detection2DArray() if flat else Detection3DArray()
    set_stamp(array.header.stamp, stamp_ns if published_ns is None else published_ns)
    array.header.frame_id = frame
    for name, what in seen.items():
        for poses in what if isinstance(what, list) else [what]:
            detection = Detection2D() if flat else Detection3D()
            set_stamp(detection.header.stamp, stamp_ns)
            detection.header.frame_id = frame
            for pose, score in [(poses, 0.9)] if isinstance(poses, SE3) else poses:
                result = ObjectHypothesisWithPose()
                result.hypothesis.class_id, result.hypothesis.score = name, score
                set_pose(result.pose.pose, pose)
                if covariance is not None:
                    result.pose.covariance = np.asarray(covariance, dtype=float).ravel()
                detection.results.append(result)
            array.detections.append(detection)
    return array


def transform(parent: str, child: str, pose: SE3, stamp_ns: int = 0) -> Any:
    item = TransformStamped()
    item.header.frame_id, item.child_frame_id = parent, child
    set_stamp(item.header.stamp, stamp_ns)
    set_pose(item.transform, pose)
    return TFMessage(transforms=[item])


def odometry(stamp_ns: int, pose: SE3) -> Any:
    message = Odometry()
    message.header.frame_id, message.child_frame_id = "odom", "base"
    set_stamp(message.header.stamp, stamp_ns)
    set_pose(message.pose.pose, pose)
    return message


def values_of(status: Any) -> dict[str, str]:
    return {pair.key: pair.value for pair in status.values}


class Live:
    """A node and its partner, in one process and thread; every wait ends in time."""

    def __init__(
        self,
        parameters: Mapping[str, Any] | None = None,
        *,
        node: bool = True,
        active: bool = True,
        kinds: Mapping[str, Any] | None = None,
        detector_qos: Any = 100,
    ) -> None:
        topics: Mapping[str, Any] = {"detections": Detection3DArray} if kinds is None else kinds
        # The partner's messages must not be lost, which is the exception for sensor data.
        of_all = {"reliability": "reliable", "depth": 1000}
        reliable = {f"qos_overrides./posemix/{t}.subscription.{k}": v for t in topics for k, v in of_all.items()}
        given = {"diagnostics_hz": 20.0, "input_depth": 1000, **reliable, **(parameters or {})}
        overrides = [Parameter(name, value=value) for name, value in given.items()]
        # Without, the node under test is a program.
        self.node: Any = PosemixNode(parameter_overrides=overrides) if node else None
        self.partner = rclpy.create_node("partner")
        self.executor = SingleThreadedExecutor()
        for one in filter(None, (self.node, self.partner)):
            self.executor.add_node(one)
        self.objects: list[Any] = []
        self.transforms: list[Any] = []
        self.diagnostics: list[Any] = []
        self.markers: list[Any] = []
        of = self.partner
        self._detectors = {
            topic: of.create_publisher(kind or Detection3DArray, f"/posemix/{topic}", detector_qos)
            for topic, kind in topics.items()
        }
        self._tf = of.create_publisher(TFMessage, "/tf", 100)
        self._static = of.create_publisher(TFMessage, "/tf_static", STATIC)
        self._odometry = of.create_publisher(Odometry, "/odom", 100)
        of.create_subscription(Detection3DArray, "/posemix/objects", self.objects.append, LATCHED)
        of.create_subscription(TFMessage, "/tf", self._take_transforms, 100)
        of.create_subscription(DiagnosticArray, "/diagnostics", self.diagnostics.append, 10)
        of.create_subscription(MarkerArray, "/posemix/markers", self.markers.append, LATCHED)
        self._state = of.create_client(GetState, "/posemix/get_state")
        self._change = of.create_client(ChangeState, "/posemix/change_state")
        if node and active:
            assert self.change(Transition.TRANSITION_CONFIGURE)
            assert self.change(Transition.TRANSITION_ACTIVATE)
            self.until(self._is_connected, "the partner is connected")

    def _take_transforms(self, message: Any) -> None:
        self.transforms += [t for t in message.transforms if t.header.frame_id == "map"]

    def _is_connected(self) -> bool:
        publishers = [*self._detectors.values(), self._tf, self._static]
        subscribed = [self.partner.count_publishers(t) for t in ("/posemix/objects", "/diagnostics")]
        return all(p.get_subscription_count() > 0 for p in publishers) and all(subscribed)

    def meet_program(self) -> None:
        """Waits for a node in another process, until it has found the partner, too: what is sent before is lost."""
        self.until(self._is_connected, "the program is there", 20.0)
        self.until(lambda: self.diagnostics, "the program speaks", 20.0)
        self.spin(0.3)  # its readers know the partner as soon as its writers do, or a moment later

    def close(self) -> None:
        self.executor.shutdown()
        for node in filter(None, (self.node, self.partner)):
            node.destroy_node()

    def until(self, condition: Callable[[], Any], what: str, timeout_s: float = 10.0) -> Any:
        """Spins until the condition holds, and returns what it says."""
        end = time.monotonic() + timeout_s
        while True:
            found = condition()
            if found:
                return found
            assert time.monotonic() < end, f"after {timeout_s} s not yet: {what}; {self.counts()}"
            self.executor.spin_once(timeout_sec=0.02)

    def spin(self, seconds: float) -> None:
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.executor.spin_once(timeout_sec=0.01)

    def call(self, client: Any, request: Any) -> Any:
        self.until(client.service_is_ready, f"{client.srv_name} is there")
        future = client.call_async(request)
        return self.until(lambda: future.done() and future.result(), f"{client.srv_name} answers")

    def change(self, transition: int) -> bool:
        request = ChangeState.Request()
        request.transition.id = transition
        return bool(self.call(self._change, request).success)

    @property
    def state(self) -> str:
        return str(self.call(self._state, GetState.Request()).current_state.label)

    def detect(self, message: Any, topic: str = "detections") -> None:
        self._detectors[topic].publish(message)

    def watch(self, first: float, images: int, seen: Mapping[str, Seen | list[SE3]], period: float = 0.2) -> None:
        """So many images, one after the other."""
        before = self.counts()["images"]
        for i in range(images):
            self.detect(detections(at(first + period * i), seen))
            self.taken(before + i + 1)

    def move(self, stamp_ns: int, odom_camera: SE3) -> None:
        """T_odom_camera in /tf."""
        self._tf.publish(transform("odom", "camera", odom_camera, stamp_ns))

    def send_transform(self, message: Any, static: bool = False) -> None:
        (self._static if static else self._tf).publish(message)

    def send_odometry(self, message: Any) -> None:
        self._odometry.publish(message)

    def counts(self) -> dict[str, int]:
        """What became of the images, by the node itself."""
        engine = self.node and self.node._engine
        return {} if not engine else dict(vars(engine.counts))

    def show_five_objects(self, images: int) -> None:
        """Shows five objects to a moving camera at 60 Hz, until the last estimate has all of them."""
        rng = np.random.default_rng(3)
        places = {f"object_{i}": SE3.exp([*rng.normal(size=3), *rng.uniform(-0.3, 0.3, 2), 1.0]) for i in range(5)}
        scene = []
        for i in range(images):
            camera = SE3(translation=[0.001 * i, 0.0, 0.0])
            errors = rng.normal(size=(5, 6)) * [0.01, 0.01, 0.01, 0.003, 0.003, 0.003]
            of_camera = camera.inverse()
            seen = {id_: of_camera * places[id_] * SE3.exp(e) for id_, e in zip(places, errors, strict=True)}
            scene.append((camera, detections(at(i / 60), seen)))
        begin = time.monotonic()
        for i, (camera, message) in enumerate(scene):
            self.move(at(i / 60), camera)
            self.spin(max(begin + (i + 0.2) / 60 - time.monotonic(), 0.0))
            self.detect(message)
            self.spin(max(begin + (i + 1) / 60 - time.monotonic(), 0.0))
        assert set(self.newest(at((images - 1) / 60))) == set(places)

    def taken(self, images: int) -> None:
        """Waits until so many images were taken in."""
        self.until(lambda: self.counts().get("images", 0) >= images, f"{images} images are taken in")

    def newest(self, stamp_ns: int) -> dict[str, Any]:
        """The objects at a stamp by their ids, waiting for the message."""

        def found() -> Any:
            here = [m for m in self.objects if m.header.stamp.sec * SECOND + m.header.stamp.nanosec == stamp_ns]
            return here[-1] if here else None

        message = self.until(found, f"objects at {stamp_ns}")
        return {d.id: d for d in message.detections}

    def status(self, name: str, condition: Callable[[Any], Any] = lambda status: True) -> Any:
        """The newest diagnostic status of a name that meets a condition, from now on."""
        self.diagnostics.clear()

        def found() -> Any:
            all_of = [s for m in self.diagnostics for s in m.status if s.name == f"posemix: {name}" and condition(s)]
            return all_of[-1] if all_of else None

        try:
            return self.until(found, f"a status of {name}")
        except AssertionError as error:
            last = [(s.name, s.message, values_of(s)) for m in self.diagnostics[-1:] for s in m.status]
            raise AssertionError(f"{error}; the last one is {last}") from None
