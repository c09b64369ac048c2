# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The lifecycle node, over the user's own rclpy."""

from __future__ import annotations

import time
from collections import deque
from importlib import import_module
from typing import Any

from rclpy.clock import JumpThreshold
from rclpy.duration import Duration
from rclpy.lifecycle import LifecycleState, TransitionCallbackReturn
from rclpy.qos import QoSProfile, ReliabilityPolicy

from posemix.lie import SE3
from posemix.ros.configuration import Source, configuration
from posemix.ros.engine import Engine
from posemix.ros.estimates import LiveEstimate
from posemix.ros.markers import markers
from posemix.ros.messages import images_of, symmetries_of
from posemix.ros.node_base import LATCHED, STATIC, NodeBase
from posemix.ros.outputs import Outputs

__all__ = ["PosemixNode"]


class PosemixNode(NodeBase):
    """Takes detections and odometry, publishes objects. Parameters are read at `configure`.

    Parameters
    ----------
    name : str
        Name of the node.
    **options
        As for rclpy's Node, such as `parameter_overrides`.
    """

    def __init__(self, name: str = "posemix", **options: Any) -> None:
        self._engine: Engine | None = None
        super().__init__(name, **options)
        self._latencies: deque[float] = deque(maxlen=1000)
        self._last: LiveEstimate | None = None
        self._next_markers_s = 0.0
        self._bad = 0
        # What this node has put below the world in /tf, and hears itself.
        self._own_frames: set[str] = set()
        self._own_timers: list[Any] = []
        self._jumps: Any = None

    def _is_configured(self) -> bool:
        return self._engine is not None

    # --- lifecycle

    def on_configure(self, state: LifecycleState) -> Any:
        """Reads the parameters; fails, with the reason in the log, where they are not valid."""
        try:
            found = configuration(self._values())
            if found["symmetries_topic"]:
                _symmetries_type()
            self._engine = Engine(found)
        except (ValueError, OSError, ImportError) as error:
            self.get_logger().error(f"cannot be configured: {error}")
            return TransitionCallbackReturn.FAILURE
        self._configuration = found
        self._make = Outputs(self._types, found.values)
        self._objects = self._publisher("vision_msgs/msg/Detection3DArray", "~/objects", LATCHED)
        self._markers = self._publisher("visualization_msgs/msg/MarkerArray", "~/markers", LATCHED)
        self._diagnostics = self._publisher("diagnostic_msgs/msg/DiagnosticArray", "/diagnostics", QoSProfile(depth=10))
        self._tf = self._publisher("tf2_msgs/msg/TFMessage", "/tf", QoSProfile(depth=100))
        trigger = import_module("std_srvs.srv").Trigger
        self._own_services = [self.create_service(trigger, "~/reset", self._reset)]
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state: LifecycleState) -> Any:
        """Begins to listen."""
        of = self._configuration
        sensor = QoSProfile(depth=of["input_depth"], reliability=ReliabilityPolicy.BEST_EFFORT)
        for source in of.sources:
            kind = f"vision_msgs/msg/{source.type}"
            self._listen(kind, source.topic, sensor, lambda message, s=source: self._take_detections(s, message))
        self._listen("tf2_msgs/msg/TFMessage", "/tf", QoSProfile(depth=100), self._take_transforms, True)
        self._listen("tf2_msgs/msg/TFMessage", "/tf_static", STATIC, self._take_static, True)
        if of["odometry_topic"]:
            self._listen("nav_msgs/msg/Odometry", of["odometry_topic"], sensor, self._take_odometry, True)
        if of["symmetries_topic"]:
            self._listen(_symmetries_type(), of["symmetries_topic"], LATCHED, self._take_symmetries)
        self._own_timers = [
            self.create_timer(1.0 / of["diagnostics_hz"], self._diagnose),
            self.create_timer(0.5 * of["transform_timeout_s"], self._work),
        ]
        threshold = JumpThreshold(
            min_forward=None, min_backward=Duration(nanoseconds=-1), on_clock_change=True
        )
        self._jumps = self.get_clock().create_jump_callback(threshold, post_callback=self._after_jump)
        return super().on_activate(state)

    def on_deactivate(self, state: LifecycleState) -> Any:
        """Listens no more; what is known is kept."""
        self._be_deaf()
        return super().on_deactivate(state)

    def on_cleanup(self, state: LifecycleState) -> Any:
        """Forgets everything, the parameters too."""
        self._clear()
        return TransitionCallbackReturn.SUCCESS

    def on_shutdown(self, state: LifecycleState) -> Any:
        """Lets go of everything."""
        self._be_deaf()
        self._clear()
        return TransitionCallbackReturn.SUCCESS

    def _be_deaf(self) -> None:
        super()._be_deaf()
        for timer in self._own_timers:
            self.destroy_timer(timer)
        self._own_timers = []
        if self._jumps is not None:
            self._jumps.unregister()
            self._jumps = None

    def _clear(self) -> None:
        if self._engine is None:
            return
        for publisher in (self._objects, self._markers, self._diagnostics, self._tf):
            self.destroy_lifecycle_publisher(publisher)
        for service in self._own_services:
            self.destroy_service(service)
        self._engine = self._last = None
        self._bad = 0
        self._problems.clear()
        self._own_frames.clear()
        self._latencies.clear()

    # --- input

    def _take_detections(self, source: Source, message: Any) -> None:
        engine = self._engine
        if engine is None:
            return
        try:
            found = images_of(
                message, source=source.name, arrival_s=time.monotonic(), now_ns=self.get_clock().now().nanoseconds,
                pose=source.pose, frame=source.frame, least_score=source.least_score,
            )  # fmt: skip
        except ValueError as error:
            engine.counts.refused += 1
            self._bad += 1
            self._complain(str(error))
            return
        for image in found:
            engine.add(image)
        self._work()

    def _take_transforms(self, message: Any, *, is_static: bool = False) -> None:
        engine = self._engine
        if engine is None:
            return
        world = self._configuration["world_frame"]
        for item in message.transforms:
            parent, name = item.header.frame_id.lstrip("/"), item.child_frame_id.lstrip("/")
            if parent == world and name in self._own_frames:
                continue
            stamp = None if is_static else _nanoseconds(item.header.stamp)
            t, q = item.transform.translation, item.transform.rotation
            engine.transforms.take(parent, name, (t.x, t.y, t.z, q.x, q.y, q.z, q.w), stamp)

    def _take_static(self, message: Any) -> None:
        self._take_transforms(message, is_static=True)

    def _take_odometry(self, message: Any) -> None:
        engine = self._engine
        if engine is None:
            return
        p, q = message.pose.pose.position, message.pose.pose.orientation
        try:
            engine.around.add_odometry(
                message.header.frame_id.lstrip("/"), message.child_frame_id.lstrip("/"),
                (p.x, p.y, p.z, q.x, q.y, q.z, q.w), _nanoseconds(message.header.stamp),
            )  # fmt: skip
        except ValueError as error:
            self._complain(str(error))

    def _take_symmetries(self, message: Any) -> None:
        if self._engine is None:
            return
        try:
            found = self._engine.set_symmetries(symmetries_of(message))
        except ValueError as error:
            self._complain(str(error))
            return
        if found is not None:
            self.get_logger().info("symmetries came after detections: those that are kept were taken in again")
            self._publish(found, is_new=False)

    def _after_jump(self, jump: Any) -> None:
        if self._engine is not None:
            self._engine.reset()
            self._last = None
            self._complain("the clock has jumped back: all is forgotten")

    def _reset(self, request: Any, response: Any) -> Any:
        if self._engine is not None:
            self._engine.reset()
            self._last = None
        response.success, response.message = True, "all objects are forgotten"
        return response

    # --- output

    def _work(self) -> None:
        engine = self._engine
        if engine is None or not engine.waiting:
            return
        # The executor takes one message of each topic in a round, in which what is fast would fall behind.
        for take_all in self._motion:
            take_all()
        resets = engine.counts.resets
        for estimate in engine.ready(time.monotonic()):
            self._publish(estimate)
        if engine.counts.resets > resets:
            self._complain("stamps have jumped back: all before is forgotten")
        bad = engine.counts.dropped + engine.counts.refused + engine.counts.without_odometry
        if bad > self._bad:
            self._complain(engine.complaint)
        self._bad = bad

    def _publish(self, estimate: LiveEstimate, *, is_new: bool = True) -> None:
        self._objects.publish(self._make.objects(estimate))
        if is_new:
            self._latencies.append(time.monotonic() - estimate.arrival_s)
        transforms = self._make.transforms(estimate, self._below_world(estimate))
        if transforms.transforms:
            self._own_frames.update(item.child_frame_id for item in transforms.transforms)
            self._tf.publish(transforms)
        self._last = estimate
        rate, now = self._configuration["markers_hz"], time.monotonic()
        if rate > 0 and now >= self._next_markers_s and self._markers.get_subscription_count() > 0:
            self._next_markers_s = now + 1.0 / rate
            of = self._configuration
            self._markers.publish(markers(estimate, self._make, of["markers_sigmas"], of["world_frame"]))

    def _below_world(self, estimate: LiveEstimate) -> tuple[str, SE3] | None:
        """The frame that this node puts below the world, and T_frame_body.

        With odometry it is that of the odometry, without it the root of the tree in which the body is.
        """
        of, engine = self._configuration, self._engine
        assert engine is not None
        if not of["publish_world_tf"]:
            return None
        world = of["world_frame"]
        if of.has_odometry:
            child, pose = str(of["odom_frame"]), estimate.odometry
            if child == world:
                return None
            above = engine.transforms.parent(child)
        else:
            child = engine.transforms.root(estimate.body)
            pose = engine.transforms.at(child, estimate.body, estimate.stamp_ns, of["max_gap_s"])
            above = world if child == world else None
        if above is not None and (above != world or child == world):
            self._complain(
                f"'{child if child != world else estimate.body}' is below '{above}' in /tf already, so that this node "
                f"does not say where it is in '{world}' (publish_world_tf)"
            )
            return None
        return None if pose is None else (child, pose)

    def _diagnose(self) -> None:
        engine = self._engine
        if engine is None:
            return
        recent = self._recent_problems(2.0 / self._configuration["diagnostics_hz"])
        values = {"waiting": str(engine.waiting), "sources": str(len(self._configuration.sources))}
        if self._latencies:
            ordered = sorted(self._latencies)
            values["latency_median_ms"] = f"{1e3 * ordered[len(ordered) // 2]:.3f}"
            values["latency_99_ms"] = f"{1e3 * ordered[int(0.99 * (len(ordered) - 1))]:.3f}"
        name = self.get_name()
        statuses = [self._make.node_status(name, engine.counts, recent, values)]
        if self._last is not None:
            statuses += self._make.object_statuses(self._last, name)
        stamp = self.get_clock().now().nanoseconds
        self._diagnostics.publish(self._make.diagnostics(stamp, statuses))


def _symmetries_type() -> Any:
    try:
        return import_module("happypose_msgs.msg").ObjectSymmetriesArray
    except ImportError:
        raise ImportError("symmetries_topic needs the package happypose_msgs in the ROS workspace") from None


def _nanoseconds(stamp: Any) -> int:
    return int(stamp.sec) * 1_000_000_000 + int(stamp.nanosec)
