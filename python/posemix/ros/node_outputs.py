# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""A node that publishes what an engine knows: objects, transforms, markers and diagnostics."""

from __future__ import annotations

import time
from collections import deque
from typing import Any

from rclpy.qos import QoSProfile

from posemix.ros.configuration import Configuration
from posemix.ros.engine import Engine
from posemix.ros.estimates import LiveEstimate
from posemix.ros.markers import markers
from posemix.ros.node_base import LATCHED
from posemix.ros.node_watch import WatchedNode
from posemix.ros.outputs import Outputs, latency_values
from posemix.ros.services import Services
from posemix.ros.sight import CameraSights

__all__ = ["PublishingNode"]

# Of a frame of its own in /tf the node knows so many again.
_MOST_OWN = 1000


class PublishingNode(WatchedNode):
    """Publishes estimates, offers the services, and says what is wrong.

    Parameters
    ----------
    name : str
        Name of the node.
    **options
        As for rclpy's Node, such as `parameter_overrides`.
    """

    def __init__(self, name: str, **options: Any) -> None:
        self._engine: Engine | None = None
        super().__init__(name, **options)
        self._latencies: deque[float] = deque(maxlen=1000)
        self._last: LiveEstimate | None = None
        self._next_markers_s = 0.0
        # Whether the last markers are not those of the last estimate.
        self._are_markers_old = False
        # What this node has put below the world in /tf and hears itself, by frame: stamp [ns] and numbers.
        self._own_frames: dict[str, deque[tuple[int, list[float]]]] = {}
        # Stamp of the last estimate in /tf [ns], and the frames that were sent with it.
        self._in_tf: tuple[int, set[str]] | None = None
        self._publishers_made: list[Any] = []
        self._offered: Services | None = None

    def _is_configured(self) -> bool:
        return self._engine is not None

    def _offer(self, found: Configuration, engine: Engine) -> None:
        self._configuration = found
        self._make, self._sights = Outputs(self._types, found.values), CameraSights()
        self._objects = self._published("vision_msgs/msg/Detection3DArray", "~/objects", LATCHED)
        self._markers = self._published("visualization_msgs/msg/MarkerArray", "~/markers", LATCHED)
        self._diagnostics = self._published("diagnostic_msgs/msg/DiagnosticArray", "/diagnostics", QoSProfile(depth=10))
        self._tf = self._published("tf2_msgs/msg/TFMessage", "/tf", QoSProfile(depth=100))
        self._offered = Services(self, engine, self._after_service)

    def _published(self, kind: str, topic: str, profile: QoSProfile) -> Any:
        self._publishers_made.append(self._publisher(kind, topic, profile))
        return self._publishers_made[-1]

    def _take_back(self) -> None:
        """Lets go of all that was offered, and forgets the engine."""
        for publisher in self._publishers_made:
            self.destroy_lifecycle_publisher(publisher)
        self._publishers_made.clear()
        if self._offered is not None:
            self._offered.destroy()
        self._engine = self._last = self._offered = self._in_tf = None
        self._own_frames.clear()
        self._latencies.clear()

    def _is_own(self, name: str, stamp_ns: int, row: Any) -> bool:
        """Whether this node has sent such a transform from the world."""
        return (stamp_ns, list(row)) in self._own_frames.get(name, ())

    def _after_service(self, found: LiveEstimate | None) -> None:
        """What is known has changed without an image."""
        self._last = found
        if found is not None:
            self._publish(found, is_new=False)
        else:
            # The last message stays for those that subscribe later.
            self._in_tf = None
            self._are_markers_old = True
            self._mark()
            self._objects.publish(self._make.nothing(self.get_clock().now().nanoseconds))

    def _publish(self, estimate: LiveEstimate, *, is_new: bool = True) -> None:
        self._objects.publish(self._make.objects(estimate))
        if is_new:
            self._latencies.append(time.monotonic() - estimate.arrival_s)
        self._publish_transforms(estimate)
        self._last = estimate
        self._show_live(estimate)
        self._are_markers_old = True
        self._mark()

    def _publish_transforms(self, estimate: LiveEstimate) -> None:
        """Readers of /tf take one transform of a frame and a time, and complain of others."""
        if self._engine is None:
            return
        if self._in_tf is None or self._in_tf[0] != estimate.stamp_ns:
            self._in_tf = (estimate.stamp_ns, set())
        sent = self._in_tf[1]
        below = self._engine.around.below_world(estimate)
        if isinstance(below, str):
            self._complain(below)
            below = None
        frames, transforms = self._make.transforms(estimate, below, sent)
        sent.update(frames)
        if frames:
            stamp_ns = self._make.transform_stamp(estimate)
            for name, row in frames.items():
                self._own_frames.setdefault(name, deque(maxlen=_MOST_OWN)).appendleft((stamp_ns, row))
            self._tf.publish(transforms)

    def _mark(self) -> None:
        """Publishes markers where anybody looks at them, not too often; the last ones from a timer."""
        of, now = self._configuration, time.monotonic()
        is_time = of["markers_hz"] > 0 and now >= self._next_markers_s
        if not is_time or not self._are_markers_old or self._markers.get_subscription_count() == 0:
            return
        self._next_markers_s, self._are_markers_old = now + 1.0 / of["markers_hz"], False
        self._markers.publish(markers(self._last, self._make, of["markers_sigmas"], of["world_frame"]))

    def _diagnose(self) -> None:
        engine = self._engine
        if engine is None:
            return
        self._mark()
        recent = self._recent_problems()
        values = {"waiting": str(engine.waiting), "sources": str(len(self._configuration.sources))}
        if engine.map_state:
            values["map"] = engine.map_state
        values |= latency_values(self._latencies)
        name = self.get_name()
        statuses = [self._make.node_status(name, engine.counts, recent, values)]
        if self._last is not None:
            in_view = self._sights.in_view(self._last, engine.transforms, self._configuration["max_gap_s"])
            statuses += self._make.object_statuses(self._last, name, in_view)
        stamp = self.get_clock().now().nanoseconds
        self._diagnostics.publish(self._make.diagnostics(stamp, statuses))
