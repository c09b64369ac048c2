# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The node in a real ROS 2: life cycle, parameters, quality of service, services, outputs."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy")

from lifecycle_msgs.msg import Transition
from rcl_interfaces.srv import DescribeParameters
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import CameraInfo
from std_srvs.srv import Trigger
from vision_msgs.msg import Detection3DArray
from visualization_msgs.msg import MarkerArray

from posemix import SE3, SO3

from .live import LATCHED, Live, at, detections, values_of

MUG = SE3(SO3.exp([0.1, 0.2, 0.3]), [0.1, 0.0, 0.8])
BOX = SE3(SO3.exp([0.0, 0.0, 1.0]), [-0.2, 0.1, 1.0])
STILL = {"motion.model": "still"}


def test_life_cycle(live: Callable[..., Live]) -> None:
    world = live(parameters={**STILL, "least_existence": 0.0}, active=False)
    assert world.state == "unconfigured"
    assert world.change(Transition.TRANSITION_CONFIGURE) and world.state == "inactive"
    world.detect(detections(at(0.0), {"mug": MUG}))
    world.spin(0.2)
    assert world.counts()["images"] == 0 and not world.objects
    assert world.change(Transition.TRANSITION_ACTIVATE) and world.state == "active"
    world.until(world._is_connected, "the partner is connected")
    world.watch(1.0, 2, {"mug": MUG})
    assert world.newest(at(1.2))["mug"].results[0].hypothesis.class_id == "mug"
    assert world.change(Transition.TRANSITION_DEACTIVATE)
    world.detect(detections(at(2.0), {"mug": MUG}))
    world.spin(0.2)
    assert world.counts()["images"] == 2
    # What is known outlives a pause, and nothing a clean-up.
    assert world.change(Transition.TRANSITION_ACTIVATE)
    world.until(world._is_connected, "the partner is connected again")
    world.watch(3.0, 1, {"box": BOX})
    assert set(world.newest(at(3.0))) == {"mug", "box"}
    assert world.change(Transition.TRANSITION_DEACTIVATE) and world.change(Transition.TRANSITION_CLEANUP)
    assert world.state == "unconfigured" and world.counts() == {}
    assert world.change(Transition.TRANSITION_CONFIGURE) and world.change(Transition.TRANSITION_ACTIVATE)
    assert world.counts()["images"] == 0
    assert world.change(Transition.TRANSITION_ACTIVE_SHUTDOWN) and world.state == "finalized"


def test_parameters(live: Callable[..., Live]) -> None:
    world = live(parameters={"filter.max_hypotheses": 5, "max_gap_s": 1}, active=False)
    node = world.node
    described = world.partner.create_client(DescribeParameters, "/posemix/describe_parameters")
    names = ["filter.max_hypotheses", "motion.model", "detections.type"]
    found = world.call(described, DescribeParameters.Request(names=names)).descriptors
    assert all(len(d.description) > 10 for d in found) and "still" in found[1].additional_constraints
    assert node.get_parameter("max_gap_s").value == 1.0
    assert world.change(Transition.TRANSITION_CONFIGURE)
    assert node._configuration.tracker.filter.max_hypotheses == 5
    result = node.set_parameters([Parameter("max_gap_s", value=0.1)])[0]
    assert not result.successful and "max_gap_s" in result.reason
    assert world.change(Transition.TRANSITION_CLEANUP)
    assert node.set_parameters([Parameter("max_gap_s", value=0.1)])[0].successful
    for name, wrong in (("motion.model", "running"), ("max_gap_s", -1.0), ("filter.max_hypotheses", 0)):
        before = node.get_parameter(name)
        assert node.set_parameters([Parameter(name, value=wrong)])[0].successful
        assert not world.change(Transition.TRANSITION_CONFIGURE) and world.state == "unconfigured"
        node.set_parameters([before])
    assert world.change(Transition.TRANSITION_CONFIGURE) and node._configuration["max_gap_s"] == 0.1


def test_a_publisher_whose_quality_of_service_does_not_fit_is_reported(live: Callable[..., Live]) -> None:
    poor = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
    world = live(parameters=STILL, active=False, detector_qos=poor)
    assert world.change(Transition.TRANSITION_CONFIGURE) and world.change(Transition.TRANSITION_ACTIVATE)
    status = world.status("node", lambda s: "RELIABILITY" in s.message)
    assert status.level == b"\x01" and "/posemix/detections" in status.message
    world.detect(detections(at(0.0), {"mug": MUG}))
    world.spin(0.3)
    assert world.counts()["images"] == 0


def test_sensor_data_is_taken_by_default(live: Callable[..., Live]) -> None:
    poor = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
    plain = {"qos_overrides./posemix/detections.subscription.reliability": "best_effort"}
    world = live(parameters={**STILL, **plain}, detector_qos=poor)

    def sent() -> bool:
        world.detect(detections(at(0.1 * world.counts()["images"]), {"mug": MUG}))
        return world.counts()["images"] > 0

    world.until(sent, "an image is taken in")


def test_what_is_published(live: Callable[..., Live]) -> None:
    world = live(parameters={**STILL, "markers_hz": 1000.0, "least_existence": 0.0})
    flipped = MUG * SE3(SO3.exp([0.0, 0.0, np.pi]))
    world.watch(0.0, 12, {"mug": [[(MUG, 0.6), (flipped, 0.4)]], "box": BOX}, period=0.5)
    found = world.newest(at(5.5))
    mug = found["mug"]
    assert set(found) == {"mug", "box"} and len(mug.results) == 2
    weights = [r.hypothesis.score for r in mug.results]
    assert sum(weights) == pytest.approx(1.0) and weights == sorted(weights, reverse=True)
    covariance = np.array(mug.results[0].pose.covariance).reshape((6, 6))
    assert np.linalg.eigvalsh(covariance)[0] > 0 and np.allclose(covariance, covariance.T)
    leading = mug.results[0].pose.pose.position
    np.testing.assert_allclose([leading.x, leading.y, leading.z], MUG.translation, atol=0.02)
    # The box is confirmed, and so in /tf, as is the camera.
    world.until(lambda: {t.child_frame_id for t in world.transforms} >= {"box", "camera"}, "transforms")
    status = world.status("box", lambda s: s.message == "good")
    values = values_of(status)
    assert status.level == b"\x00" and float(values["existence"]) > 0.95 and values["register_again"] == "false"
    assert float(values["mode_probability"]) > 0.9
    assert world.status("mug").message == "ambiguous"
    node = values_of(world.status("node"))
    assert node["images"] == "12" and float(node["latency_99_ms"]) > 0.0
    ellipsoids = [m for m in world.markers[-1].markers if m.ns == "mug/ellipsoids"]
    assert len(ellipsoids) == 2 and ellipsoids[0].color.a > ellipsoids[1].color.a
    assert {m.ns for m in world.markers[-1].markers} >= {"box/axes", "box/ellipsoids", "box/name", "mug/axes"}


def test_a_report_on_request_and_at_the_end(live: Callable[..., Live], tmp_path: Path) -> None:
    given = {**STILL, "report_folder": str(tmp_path / "runs"), "view_hz": 1000.0}
    world = live(parameters=given)
    ask = world.partner.create_client(Trigger, "/posemix/report")
    answer = world.call(ask, Trigger.Request())
    assert not answer.success and "there is no frame to report so far" in answer.message
    world.watch(1.0, 5, {"mug": MUG})
    answer = world.call(ask, Trigger.Request())
    assert answer.success, answer.message
    page = Path(answer.message)
    assert page.parent.parent == tmp_path / "runs" and page.name == "report.html"
    stamps = json.loads((page.parent / "trace.json").read_text())["stamps_s"]
    np.testing.assert_allclose(stamps, [1e-9 * at(1.0 + 0.2 * i) for i in range(5)], atol=1e-6)
    # What comes meanwhile is in the report at the end, and a new run has a folder of its own.
    world.watch(2.0, 3, {"mug": MUG, "box": BOX})
    assert world.change(Transition.TRANSITION_DEACTIVATE)
    found = json.loads((page.parent / "trace.json").read_text())
    assert found["frames"] == 8 and found["order"] == ["mug", "box"]
    written = page.stat().st_mtime_ns
    assert world.change(Transition.TRANSITION_CLEANUP)
    assert page.stat().st_mtime_ns == written, "there was nothing new to report"
    assert world.change(Transition.TRANSITION_CONFIGURE)
    assert len(list((tmp_path / "runs").iterdir())) == 2


def test_a_view_that_cannot_be_is_an_error(live: Callable[..., Live], tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    no_folder = {"report_folder": str(tmp_path / "file")}
    for given in ({"view": "rviz"}, no_folder, {"view": "foxglove", "view_address": "x"}):
        world = live(parameters={**STILL, **given}, active=False)
        assert not world.change(Transition.TRANSITION_CONFIGURE) and world.state == "unconfigured"
        world.close()
    world = live(parameters=STILL)
    answer = world.call(world.partner.create_client(Trigger, "/posemix/report"), Trigger.Request())
    assert not answer.success and "report_folder is empty" in answer.message


def test_what_is_in_view_by_the_cameras_matrix(live: Callable[..., Live]) -> None:
    world = live(parameters={**STILL, "least_existence": 0.0, "camera_info_topics": ["/camera/info"]})
    info = CameraInfo(width=640, height=480, k=np.array([500.0, 0, 320, 0, 500, 240, 0, 0, 1]))
    info.header.frame_id = "camera"
    topic = world.partner.create_publisher(CameraInfo, "/camera/info", 10)
    world.until(lambda: topic.get_subscription_count() > 0, "camera info is heard")
    # 1.2 m aside at one metre is 600 pixels off the centre.
    world.watch(0.0, 3, {"mug": MUG, "box": SE3(translation=[1.2, 0.0, 1.0])})
    assert "in_view" not in values_of(world.status("mug"))
    topic.publish(info)
    assert values_of(world.status("mug", lambda s: "in_view" in values_of(s)))["in_view"] == "true"
    assert values_of(world.status("box"))["in_view"] == "false"
    info.k = np.zeros(9)
    topic.publish(info)
    world.status("node", lambda s: "camera 'camera' has focal lengths of 0" in s.message)


def test_reset(live: Callable[..., Live]) -> None:
    world = live(parameters={**STILL, "least_existence": 0.0})
    world.watch(0.0, 3, {"mug": MUG})
    reset = world.partner.create_client(Trigger, "/posemix/reset")
    assert world.call(reset, Trigger.Request()).success
    # An earlier stamp than before is no jump now.
    world.watch(-5.0, 1, {"box": BOX})
    assert set(world.newest(at(-5.0))) == {"box"} and world.counts()["resets"] == 1


def test_bad_parameters_are_named_when_the_node_is_configured(live: Callable[..., Live]) -> None:
    world = live(parameters=STILL)
    assert world.change(Transition.TRANSITION_DEACTIVATE) and world.change(Transition.TRANSITION_CLEANUP)
    complaints: list[str] = []
    world.node.get_logger = lambda: SimpleNamespace(error=complaints.append, warning=print, info=print)

    def refused(name: str, value: Any) -> str:
        before = world.node.get_parameter(name)
        world.node.set_parameters([Parameter(name, value=value)])
        assert not world.change(Transition.TRANSITION_CONFIGURE) and world.state == "unconfigured"
        world.node.set_parameters([before])
        return complaints[-1]

    assert "detections.topic is '~/my topic'" in refused("detections.topic", "~/my topic")
    assert "odometry_topic is 'a b'" in refused("odometry_topic", "a b")
    assert "sources.topic" not in refused("sources", ["my-detector"])
    assert "my-detector.topic is '~/my-detector'" in complaints[-1]
    assert "cannot be configured" in refused("filter.max_hypotheses", -1)
    # One that is of another type where the names are declared.
    world.node._parameter_overrides["b.frame"] = Parameter("b.frame", value=5)
    assert "b.frame" in refused("sources", ["b"])
    assert "b.frame" in refused("sources", ["b"])
    # As the node says itself: clean it up, set it and configure it again.
    world.node.set_parameters([Parameter("sources", value=["others"])])
    assert world.change(Transition.TRANSITION_CONFIGURE) and world.change(Transition.TRANSITION_ACTIVATE)
    assert world.node.has_parameter("others.clutter") and not world.node.has_parameter("detections.clutter")


def test_a_node_that_cannot_be_configured_says_so_and_may_be_set(live: Callable[..., Live]) -> None:
    world = live(parameters={**STILL, "qos_overrides./tf.publisher.reliability": "nonsense"}, active=False)
    complaints: list[str] = []
    world.node.get_logger = lambda: SimpleNamespace(error=complaints.append, warning=print, info=print)
    assert not world.change(Transition.TRANSITION_CONFIGURE) and world.state == "unconfigured"
    assert "cannot be configured" in complaints[-1]
    assert world.node.set_parameters([Parameter("on_sight", value=False)])[0].successful


def test_a_reset_while_inactive_is_seen_by_those_who_come_later(live: Callable[..., Live]) -> None:
    world = live(parameters={**STILL, "least_existence": 0.0})
    world.watch(0.0, 3, {"mug": MUG})
    assert world.change(Transition.TRANSITION_DEACTIVATE)
    reset = world.partner.create_client(Trigger, "/posemix/reset")
    assert world.call(reset, Trigger.Request()).success
    assert world.change(Transition.TRANSITION_ACTIVATE)
    late: list[Any] = []
    world.partner.create_subscription(Detection3DArray, "/posemix/objects", late.append, LATCHED)
    world.until(lambda: late and not late[-1].detections, "an empty array")


def test_diagnostics_go_on_where_a_simulated_clock_stands_still(live: Callable[..., Live]) -> None:
    world = live(parameters={**STILL, "use_sim_time": True})
    assert world.status("node").message == "good"


def test_what_was_forgotten_is_not_shown_to_those_who_come_later(live: Callable[..., Live]) -> None:
    world = live(parameters={**STILL, "least_existence": 0.0})
    world.watch(0.0, 3, {"mug": MUG})
    reset = world.partner.create_client(Trigger, "/posemix/reset")
    assert world.call(reset, Trigger.Request()).success
    world.until(lambda: not world.objects[-1].detections, "an empty array")
    late: list[Any] = []
    world.partner.create_subscription(Detection3DArray, "/posemix/objects", late.append, LATCHED)
    world.until(lambda: late, "the last message")
    assert not late[-1].detections and late[-1].header.frame_id == "map"


def test_markers_are_there_for_those_who_come_later(live: Callable[..., Live]) -> None:
    world = live(parameters={**STILL, "least_existence": 0.0})
    world.watch(0.0, 3, {"mug": MUG})
    late: list[Any] = []
    world.partner.create_subscription(MarkerArray, "/posemix/markers", late.append, LATCHED)
    world.until(lambda: any(len(m.markers) > 1 for m in late), "markers of the mug")
    reset = world.partner.create_client(Trigger, "/posemix/reset")
    assert world.call(reset, Trigger.Request()).success
    world.until(lambda: len(late[-1].markers) == 1, "that all are deleted")
