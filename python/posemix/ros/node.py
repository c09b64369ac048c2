# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The lifecycle node, over the user's own rclpy."""

from __future__ import annotations

import time
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

from rclpy.clock import Clock, ClockType, JumpThreshold
from rclpy.duration import Duration
from rclpy.lifecycle import LifecycleState, TransitionCallbackReturn
from rclpy.qos import QoSProfile, ReliabilityPolicy

from posemix.ros.cdr import (
    DetectionArray,
    PosedFrame,
    read_detections_2d,
    read_detections_3d,
    read_odometry,
    read_transforms,
)
from posemix.ros.configuration import Configuration, Source, configuration, names
from posemix.ros.engine import Engine
from posemix.ros.messages import images_of, symmetries_of
from posemix.ros.node_base import LATCHED, STATIC
from posemix.ros.node_outputs import PublishingNode

__all__ = ["PosemixNode"]


class PosemixNode(PublishingNode):
    """Takes detections and odometry, publishes objects. Parameters are read at `configure`.

    Parameters
    ----------
    name : str
        Name of the node.
    **options
        As for rclpy's Node, such as `parameter_overrides`.
    """

    def __init__(self, name: str = "posemix", **options: Any) -> None:
        super().__init__(name, **options)
        self._bad = 0
        self._own_timers: list[Any] = []
        self._jumps: Any = None

    # --- lifecycle

    def on_configure(self, state: LifecycleState) -> Any:
        """Reads the parameters; fails, with the reason in the log, where they are not valid."""
        try:
            self._declare_named()
            found = configuration(self._values())
            self._require_topics(_topics(found))
            if found["symmetries_topic"]:
                _symmetries_type()
            engine = Engine(found)
            if found["load_map"] and found["map_file"] and Path(found["map_file"]).expanduser().exists():
                self.get_logger().info(engine.load(found["map_file"], go_on=found["map_goes_on"]))
            self._begin_watch(found.values)
            self._offer(found, engine)
            self._engine = engine
        except Exception as error:  # rclpy says nothing of what is raised here
            self.get_logger().error(f"cannot be configured: {error}")
            self._clear()
            return TransitionCallbackReturn.FAILURE
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state: LifecycleState) -> Any:
        """Begins to listen; where it cannot, the reason is in the log, and the node is as it was."""
        try:
            self._hear()
        except Exception as error:  # rclpy says nothing of what is raised here
            self.get_logger().error(f"cannot be activated: {error}")
            self._be_deaf()
            return TransitionCallbackReturn.FAILURE
        done = super().on_activate(state)
        if self._engine is not None and self._engine.is_empty and self._engine.counts.resets:
            # While it was inactive it may have been reset.
            self._after_service(None)
        return done

    def _hear(self) -> None:
        of = self._configuration
        sensor = QoSProfile(depth=of["input_depth"], reliability=ReliabilityPolicy.BEST_EFFORT)
        for source in of.sources:
            self._listen(
                f"vision_msgs/msg/{source.type}", source.topic, sensor, partial(self._take_detections, source),
                read=read_detections_3d if source.type == "Detection3DArray" else read_detections_2d,
            )  # fmt: skip
        moving: dict[str, Any] = {"read": read_transforms, "is_motion": True}
        self._listen("tf2_msgs/msg/TFMessage", "/tf", QoSProfile(depth=100), self._take_transforms, **moving)
        self._listen("tf2_msgs/msg/TFMessage", "/tf_static", STATIC, self._take_static, **moving)
        if of["odometry_topic"]:
            moving["read"] = read_odometry
            self._listen("nav_msgs/msg/Odometry", of["odometry_topic"], sensor, self._take_odometry, **moving)
        for topic in names(of["camera_info_topics"]):
            self._listen("sensor_msgs/msg/CameraInfo", topic, sensor, lambda message, _: self._sights.take(message))
        if of["symmetries_topic"]:
            self._listen(_symmetries_type(), of["symmetries_topic"], LATCHED, self._take_symmetries)
        # A clock that is simulated may stand still, in which images wait all the same.
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self._own_timers = [
            self.create_timer(1.0 / of["diagnostics_hz"], self._diagnose, clock=steady),
            self.create_timer(0.5 * of["transform_timeout_s"], self._work, clock=steady),
        ]
        threshold = JumpThreshold(
            min_forward=None, min_backward=Duration(nanoseconds=-1), on_clock_change=True
        )
        self._jumps = self.get_clock().create_jump_callback(threshold, post_callback=self._after_jump)

    def on_deactivate(self, state: LifecycleState) -> Any:
        """Listens no more; what is known is kept."""
        self._be_deaf()
        self.save_at_end()
        return super().on_deactivate(state)

    def on_cleanup(self, state: LifecycleState) -> Any:
        """Forgets everything, the parameters too."""
        self._clear()
        return TransitionCallbackReturn.SUCCESS

    def on_shutdown(self, state: LifecycleState) -> Any:
        """Lets go of everything."""
        self._be_deaf()
        self.save_at_end()
        self._clear()
        return TransitionCallbackReturn.SUCCESS

    def save_at_end(self) -> None:
        """Saves the map, where `save_map` says so and there is one."""
        path, engine = self.get_parameter("map_file").value, self._engine
        if engine is None or not (path and self._configuration["save_map"]) or not engine.counts.images:
            return
        try:
            engine.save(path, over_unknown=False)
        except (ValueError, OSError) as error:
            self.get_logger().error(f"the map is not saved: {error}")

    def _be_deaf(self) -> None:
        super()._be_deaf()
        for timer in self._own_timers:
            self.destroy_timer(timer)
        self._own_timers = []
        if self._jumps is not None:
            self._jumps.unregister()
            self._jumps = None

    def _clear(self) -> None:
        self.end_watch()
        self._take_back()
        self._bad = 0
        self._problems.clear()

    # --- input

    def _take_detections(self, source: Source, message: DetectionArray, arrival_s: float) -> None:
        engine = self._engine
        if engine is None:
            return
        try:
            found = images_of(
                message, source=source.name, arrival_s=arrival_s, now_ns=self.get_clock().now().nanoseconds,
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

    def _take_transforms(self, transforms: list[PosedFrame], arrival_s: float, *, is_static: bool = False) -> None:
        engine = self._engine
        if engine is None:
            return
        world = self._configuration["world_frame"]
        for item in transforms:
            parent, name = item.header.frame_id.lstrip("/"), item.child_frame_id.lstrip("/")
            stamp_ns = item.header.stamp.nanoseconds
            if parent != world or not self._is_own(name, stamp_ns, item.row):
                engine.transforms.take(parent, name, item.row, None if is_static else stamp_ns)

    def _take_static(self, transforms: list[PosedFrame], arrival_s: float) -> None:
        self._take_transforms(transforms, arrival_s, is_static=True)

    def _take_odometry(self, message: PosedFrame, arrival_s: float) -> None:
        if self._engine is not None:
            self._engine.around.add_odometry(
                message.header.frame_id.lstrip("/"), message.child_frame_id.lstrip("/"), message.row,
                message.header.stamp.nanoseconds,
            )  # fmt: skip

    def _take_symmetries(self, message: Any, arrival_s: float) -> None:
        if self._engine is None:
            return
        found = self._engine.set_symmetries(symmetries_of(message))
        if found is not None:
            self._publish(found, is_new=False)

    def _after_jump(self, jump: Any) -> None:
        if self._engine is not None:
            self._engine.lose("the clock has jumped back: all is forgotten")
            self._after_service(None)
            self._complain(self._engine.why_reset)

    # --- work

    def _work(self) -> None:
        engine = self._engine
        if engine is None or not engine.waiting:
            return
        # The executor takes one message of each topic in a round, in which what is fast would fall behind.
        for take_all in self._motion:
            take_all()
        resets = engine.counts.resets
        try:
            for estimate in engine.ready(time.monotonic()):
                self._publish(estimate)
        except ValueError as error:  # from a timer it would end the node
            self._complain(str(error))
        if engine.counts.resets > resets:
            self._complain(engine.why_reset)
            if engine.is_empty:
                self._after_service(None)
        while engine.news:
            self.get_logger().info(engine.news.popleft())
        of = engine.counts
        bad = of.dropped + of.refused + of.without_odometry + of.too_late
        if bad > self._bad:
            self._complain(engine.complaint)
        self._bad = bad


def _topics(found: Configuration) -> list[tuple[str, str]]:
    """What is listened to, after the parameter that names it."""
    owners = names(found["sources"])
    topics = [(f"{owner}.topic", source.topic) for owner, source in zip(owners, found.sources, strict=True)]
    topics += [(name, found[name]) for name in ("odometry_topic", "symmetries_topic") if found[name]]
    return topics + [("camera_info_topics", topic) for topic in names(found["camera_info_topics"])]


def _symmetries_type() -> Any:
    try:
        return import_module("happypose_msgs.msg").ObjectSymmetriesArray
    except ImportError:
        raise ImportError("symmetries_topic needs the package happypose_msgs in the ROS workspace") from None
