# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""What a node of rclpy needs besides its life: parameters, message classes, topics with their quality of service."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Any

from rclpy.exceptions import InvalidTopicNameException
from rclpy.lifecycle import LifecycleNode
from rclpy.parameter import Parameter as RosParameter
from rclpy.qos import DurabilityPolicy, QoSPolicyKind, QoSProfile, qos_policy_name_from_kind
from rclpy.qos_overriding_options import QoSOverridingOptions
from rclpy.subscription import Subscription
from rclpy.validate_topic_name import validate_topic_name

from posemix.ros.cdr import LAYOUTS
from posemix.ros.configuration import class_parameters, source_parameters
from posemix.ros.parameters import Parameter, parameters

try:
    from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
except ImportError:  # Humble
    from rclpy.qos_event import PublisherEventCallbacks, SubscriptionEventCallbacks

__all__ = ["LATCHED", "STATIC", "NodeBase"]

_TYPES = {
    "builtin_interfaces": ("Time",),
    "std_msgs": ("Header", "ColorRGBA"),
    "geometry_msgs": (
        "Point", "Pose", "PoseWithCovariance", "Quaternion", "Transform", "TransformStamped", "Vector3",
    ),
    "vision_msgs": (
        "BoundingBox2D", "BoundingBox3D", "Detection2D", "Detection2DArray", "Detection3D", "Detection3DArray",
        "ObjectHypothesis", "ObjectHypothesisWithPose", "Pose2D",
    ),
    "tf2_msgs": ("TFMessage",),
    "nav_msgs": ("Odometry",),
    "sensor_msgs": ("CameraInfo",),
    "diagnostic_msgs": ("DiagnosticArray", "DiagnosticStatus", "KeyValue"),
    "visualization_msgs": ("Marker", "MarkerArray"),
}  # fmt: skip
_POLICIES = (QoSPolicyKind.HISTORY, QoSPolicyKind.DEPTH, QoSPolicyKind.RELIABILITY, QoSPolicyKind.DURABILITY)
# Received by all that subscribe later, too.
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
STATIC = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
# Whether callbacks may have the stamps of the middleware.
_HAS_INFORMATION = hasattr(Subscription, "CallbackType")
_QUIET_S = 5.0
_MOST_AT_ONCE = 200
_FORGOTTEN_S = 60.0
# Parameters that services read when they are called.
_ANY_TIME = {"map_file", "forget_ids"}
_LONGEST_QUEUE_S = 10.0


def _message_types() -> dict[str, Any]:
    found: dict[str, Any] = {}
    for package, names in _TYPES.items():
        module = import_module(f"{package}.msg")
        try:
            found |= {f"{package}/msg/{name}": getattr(module, name) for name in names}
        except AttributeError as error:
            raise ImportError(f"{error}; expected {package} of Humble or later") from None
    for name, layout in LAYOUTS.items():
        fields = found[name].get_fields_and_field_types()
        if fields != layout:
            raise ImportError(f"{name} has the fields {fields}; expected {layout}, as of Humble or later")
    status = found["diagnostic_msgs/msg/DiagnosticStatus"]
    # The field is a byte, which is no integer in Python's messages.
    found["diagnostic_msgs/msg/DiagnosticStatus"] = lambda level, **fields: status(
        level=bytes([level]), **fields
    )
    return found


class NodeBase(LifecycleNode):  # type: ignore[misc]
    """Parameters from their list, topics whose quality of service may be overridden, complaints.

    Parameters
    ----------
    name : str
        Name of the node.
    **options
        As for rclpy's Node, such as `parameter_overrides`.
    """

    def __init__(self, name: str, **options: Any) -> None:
        super().__init__(name, **options)
        self._types = _message_types()
        self._declared: list[Parameter] = []
        self._declare(parameters())
        self._declare_named()
        self._warn_of_unknown()
        self._heard: list[Any] = []
        self._motion: list[Callable[[], None]] = []
        self._problems: dict[str, tuple[float, str]] = {}
        self._logged: dict[str, float] = {}
        self._asked = (0.0, 0.0)
        self.add_on_set_parameters_callback(self._refuse_changes)

    def _is_configured(self) -> bool:
        """Whether parameters cannot be changed any more."""
        raise NotImplementedError

    def _work(self) -> None:
        """Goes on with what waits for messages of motion."""
        raise NotImplementedError

    def _declare(self, found: list[Parameter]) -> None:
        rcl = import_module("rcl_interfaces.msg")
        for parameter in found:
            self._declare_one(parameter, rcl)
            self._declared.append(parameter)

    def _declare_one(self, parameter: Parameter, rcl: Any) -> None:
        text = parameter.text
        words = ", ".join(f"'{word}'" for word in parameter.choices)
        descriptor = rcl.ParameterDescriptor(
            description=text, additional_constraints=f"One of {words}" if words else ""
        )
        value = parameter.default
        # A number that is written without a point is one, too.
        given = self._parameter_overrides.get(parameter.name)
        is_integer = given is not None and given.type_ == RosParameter.Type.INTEGER
        if isinstance(value, float) and is_integer:
            self.declare_parameter(parameter.name, float(given.value), descriptor, ignore_override=True)
        else:
            self.declare_parameter(parameter.name, value, descriptor)

    def _declare_named(self) -> None:
        """The parameters of the sources and classes that there are, also when these have changed."""
        values = self._values()
        named = [*source_parameters(values), *class_parameters(values)]
        wanted = {p.name: p for p in named}
        there = {p.name for p in self._declared} - {p.name for p in parameters()}
        for gone in there - set(wanted):
            self.undeclare_parameter(gone)
        self._declared = [p for p in self._declared if p.name not in there - set(wanted)]
        self._declare([p for name, p in wanted.items() if name not in there])

    def _values(self) -> dict[str, Any]:
        found = {}
        for parameter in self._declared:
            value = self.get_parameter(parameter.name).value
            found[parameter.name] = list(value) if isinstance(parameter.default, list) else value
        return found

    def _warn_of_unknown(self) -> None:
        for name in self._parameter_overrides:
            if not self.has_parameter(name) and not name.startswith("qos_overrides."):
                self.get_logger().warning(f"there is no parameter '{name}'; it is ignored")

    def _refuse_changes(self, changed: list[Any]) -> Any:
        rcl = import_module("rcl_interfaces.msg")
        mine = {parameter.name for parameter in self._declared} - _ANY_TIME
        names = [p.name for p in changed if p.name in mine]
        if names and self._is_configured():
            reason = f"{names[0]} is read when the node is configured: clean it up, set it and configure it again"
            return rcl.SetParametersResult(successful=False, reason=reason)
        return rcl.SetParametersResult(successful=True)

    def _require_topics(self, topics: Sequence[tuple[str, str]]) -> None:
        """Refuses what rclpy would, by the parameters that name the topics: it says nothing of a failed transition."""
        for name, topic in topics:
            try:
                validate_topic_name(topic)
            except InvalidTopicNameException as error:
                why = str(error).splitlines()[0]
                raise ValueError(f"{name} is '{topic}', which is no name of a topic: {why}") from None

    def _publisher(self, kind: str, topic: str, profile: QoSProfile) -> Any:
        return self.create_lifecycle_publisher(
            self._types[kind], topic, _copy(profile),
            event_callbacks=PublisherEventCallbacks(
                incompatible_qos=lambda e: self._incompatible(topic, "subscription", e), use_default_callbacks=False
            ),
            qos_overriding_options=QoSOverridingOptions(_POLICIES),
        )  # fmt: skip

    def _listen(
        self, kind: Any, topic: str, profile: QoSProfile, callback: Callable[[Any, float], None],
        *, read: Callable[[bytes], Any] | None = None, is_motion: bool = False,
    ) -> None:  # fmt: skip
        """Subscribes; `callback` has the message and the time at which it came [s], by a clock that does not jump.

        With `read` that makes messages of their bytes. Messages of motion are all taken before the images that may wait
        for them.
        """
        cls = self._types[kind] if isinstance(kind, str) else kind

        def give(message: Any, information: Any) -> None:
            try:
                callback(message if read is None else read(message), _arrival_s(information))
            except ValueError as error:
                self._complain(f"{topic}: {error}")

        def take_all() -> None:
            for _ in range(_MOST_AT_ONCE):
                found = subscription.handle.take_message(cls, read is not None)
                if found is None:
                    break
                give(*found)

        def take(message: Any, information: Any) -> None:
            give(message, information)
            if is_motion:
                self._work()

        if is_motion:
            self._motion.append(take_all)
        self._heard.append(
            subscription := self.create_subscription(
                cls, topic, take if _HAS_INFORMATION else lambda message: take(message, None), _copy(profile),
                event_callbacks=SubscriptionEventCallbacks(
                    incompatible_qos=lambda e: self._incompatible(topic, "publisher", e), use_default_callbacks=False
                ),
                qos_overriding_options=QoSOverridingOptions(_POLICIES), raw=read is not None,
            )
        )  # fmt: skip

    def _incompatible(self, topic: str, other: str, event: Any) -> None:
        policy = qos_policy_name_from_kind(event.last_policy_kind)
        self._complain(
            f"a {other} of {topic} has another {policy}, so that nothing passes; the parameters "
            f"qos_overrides.{self.resolve_topic_name(topic)}.* set ours",
            lasting=True,
        )

    def _be_deaf(self) -> None:
        """Lets go of all subscriptions."""
        for subscription in self._heard:
            self.destroy_subscription(subscription)
        self._heard, self._motion = [], []

    def _complain(self, why: str, *, lasting: bool = False) -> None:
        """Puts a problem into the log, not too often, and into the next diagnostics, or into all that follow."""
        now = time.monotonic()
        # The same at another stamp, or of another age, is the same.
        key = re.sub(r"\d+\.\d+|[\d.]{6,}", "", why)
        if now - self._logged.get(key, -_QUIET_S) >= _QUIET_S:
            self.get_logger().warning(why)
            self._logged[key] = now
        self._problems[key] = (float("inf") if lasting else now, why)

    def _recent_problems(self) -> list[str]:
        """What was complained of since the call before the last one, and what lasts."""
        now, since = time.monotonic(), self._asked[0]
        self._asked = (self._asked[1], now)
        self._problems = {key: of for key, of in self._problems.items() if now - of[0] < _FORGOTTEN_S}
        self._logged = {key: when for key, when in self._logged.items() if now - when < _FORGOTTEN_S}
        return [why for when, why in self._problems.values() if when >= since]


def _arrival_s(information: Any) -> float:
    """When the middleware received a message, where it says so, by the clock that does not jump [s]."""
    received = 0 if information is None else information["received_timestamp"]
    since_s = 1e-9 * (time.time_ns() - received)
    return time.monotonic() - (since_s if 0.0 < since_s < _LONGEST_QUEUE_S else 0.0)


def _copy(profile: QoSProfile) -> QoSProfile:
    """A profile that overrides may change."""
    return QoSProfile(depth=profile.depth, reliability=profile.reliability, durability=profile.durability)
