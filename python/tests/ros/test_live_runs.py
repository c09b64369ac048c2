# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The node against runs over bags, its speed, and the program, in a real ROS 2."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy")
pytest.importorskip("rosbags")

import rclpy
from bags.bag_maker import T_BASE_CAMERA, BagMaker, base_at
from lifecycle_msgs.srv import GetState
from rclpy.serialization import deserialize_message

from posemix import SE3, bags
from posemix.bags.messages import opened
from posemix.interop.ros import covariance_to_ros

from .live import SECOND, Live, at, detections, values_of

ROOT = Path(__file__).resolve().parents[3]


def recorded(folder: Path, odometry: str) -> Path:
    """Four seconds of two objects, of which a detector of 10 Hz sees mixtures, late and with an image out of order."""
    bag = BagMaker("mcap", folder)
    bag.transform(0.0, "base", "camera", T_BASE_CAMERA, "/tf_static")
    for i in range(220):
        if odometry:
            bag.odometry(i / 50, base_at(i / 50))
        else:
            bag.transform(i / 50, "odom", "base", base_at(i / 50), "/tf")
    rng = np.random.default_rng(7)
    objects = {"7": SE3.exp([0.1, 0.2, 0.3, 3.0, 0.5, 0.4]), "9": SE3(translation=[2.0, -1.0, 0.2])}
    for i in range(40):
        seconds = i / 10 + 0.013
        back = (base_at(seconds) * T_BASE_CAMERA).inverse()
        noise = [SE3.exp(rng.normal(size=6) * [0.02, 0.02, 0.02, 0.005, 0.005, 0.005]) for _ in objects]
        seen = {name: back * pose * n for (name, pose), n in zip(objects.items(), noise, strict=True)}
        bag.detections(seconds, "camera", seen)
        arrival, *rest = bag.rows[-1]
        # Every seventh comes after the one behind it.
        bag.rows[-1] = (arrival + (SECOND // 7 if i % 7 == 3 else 0), *rest)
    return bag.write()


def heard(world: Live, message: Any) -> bool:
    """Whether the node has a message of odometry or detections."""
    engine = world.node._engine
    if hasattr(message, "detections"):
        count = world.counts()["images"] + engine.waiting
        world.sent = getattr(world, "sent", 0)
        return bool(count > world.sent and setattr(world, "sent", count) is None)
    header = message.transforms[0].header if hasattr(message, "transforms") else message.header
    line = engine.transforms._live.get("base") if hasattr(message, "transforms") else engine.around.odometry
    return line is not None and line.newest_ns == header.stamp.sec * SECOND + header.stamp.nanosec


@pytest.mark.parametrize("topic", ["", "/odom"])
def test_a_bag_through_the_node_is_the_run_over_the_bag(
    live: Callable[..., Live], tmp_path: Path, topic: str
) -> None:
    path = recorded(tmp_path, topic)
    source = {"odometry": topic} if topic else {"odometry_frame": "odom"}
    expected = bags.run_slam(path, detections="/objects", **source)
    assert expected.late > 0
    world = live(parameters={
        "least_existence": 0.0, "odometry_topic": topic, "detections.topic": "/objects", "transform_timeout_s": 5.0,
        **{f"qos_overrides.{t}.subscription.{k}": v for t in ("/objects", "/odom")
           for k, v in (("reliability", "reliable"), ("depth", 1000))},
    }, kinds={})  # fmt: skip
    publishers = {}
    with opened(path) as reader:
        stream = [(c.topic, c.msgtype, bytes(data)) for c, _, data in reader.messages()]
    for name, kind, data in stream:
        package, _, message = kind.split("/")
        cls = getattr(import_module(f"{package}.msg"), message)
        if name not in publishers:
            if name == "/tf_static":
                world.send_transform(deserialize_message(data, cls), static=True)
                continue
            publishers[name] = world.partner.create_publisher(cls, name, 100)
            world.until(lambda n=name: publishers[n].get_subscription_count() > 0, f"{name} is heard")
        sent = deserialize_message(data, cls)
        publishers[name].publish(sent)
        # One after the other, as they were recorded: the middleware has no order between topics.
        world.until(lambda m=sent: heard(world, m), f"a message of {name}")
    world.taken(40)
    world.newest(expected.objects[0].stamps_ns[-1])
    newest: dict[int, Any] = {}
    for m in world.objects:
        newest[m.header.stamp.sec * SECOND + m.header.stamp.nanosec] = m
    compared = 0
    for track in expected.objects:
        for k, stamp in enumerate(track.stamps_ns.tolist()):
            there = {d.id: d for d in newest[stamp].detections} if stamp in newest else {}
            if track.name not in there:
                continue
            compared += 1
            p, q = there[track.name].bbox.center.position, there[track.name].bbox.center.orientation
            np.testing.assert_array_equal([p.x, p.y, p.z, q.x, q.y, q.z, q.w], track.poses[k].to_tq())
            results, mixture = there[track.name].results, track.mixtures[k]
            order = np.argsort(-mixture.log_weights, kind="stable")
            np.testing.assert_allclose([r.hypothesis.score for r in results], mixture.weights[order], rtol=1e-12)
            leading = mixture[int(order[0])]
            covariance = covariance_to_ros(leading.mean, leading.covariance, reading="rotation_vector", frame="parent")
            np.testing.assert_allclose(results[0].pose.covariance, covariance, rtol=1e-9, atol=1e-15)
    # Of images that came out of order only the later one has an estimate at its stamp.
    assert compared >= 60 and max(newest) == expected.objects[0].stamps_ns[-1]


def test_latency_at_60_hz(live: Callable[..., Live], domain: int, capsys: pytest.CaptureFixture[str]) -> None:
    """The node is a process of its own on one core, and says what it adds, from the middleware's receipt on."""
    reliable = {"qos_overrides./posemix/detections.subscription.reliability": "reliable"}
    parameters = {"least_existence": 0.0, "diagnostics_hz": 5.0, **reliable}
    running = program("--ros-args", *[a for k, v in parameters.items() for a in ("-p", f"{k}:={v}")], domain=domain)
    os.sched_setaffinity(running.pid, {min(os.sched_getaffinity(0))})
    world = live(node=False)
    count = 420
    try:
        world.meet_program()
        cpu_s = cpu_time_s(running.pid)
        world.show_five_objects(count)
        cpu_s = cpu_time_s(running.pid) - cpu_s
        values = values_of(world.status("node", lambda s: "latency_99_ms" in values_of(s)))
    finally:
        running.send_signal(signal.SIGINT)
        running.communicate(timeout=10)
    with capsys.disabled():
        of = {key: values[f"latency_{key}_ms"] for key in ("mean", "median", "99", "worst")}
        print(
            f"\nadded latency at 60 Hz with five objects: mean {of['mean']} ms, median {of['median']} ms, "
            f"99 % {of['99']} ms, worst {of['worst']} ms, {1e3 * cpu_s / count:.2f} ms of CPU per image, "
            f"{values['images']} of {count} images, load of the machine {os.getloadavg()[0]:.1f}"
        )
    if os.getloadavg()[0] > 4 * (os.cpu_count() or 1):
        pytest.skip("the machine has too much else to do")
    assert values["without_odometry"] == "0"
    # A bound that a busy machine holds, and a node that waits for a timer or a time-out does not.
    assert float(values["latency_median_ms"]) < 100.0


def cpu_time_s(pid: int) -> float:
    """Time that the threads of a process have been on a core [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def program(*arguments: str, domain: int) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [sys.executable, "-m", "posemix.ros", *arguments], env={**os.environ, "ROS_DOMAIN_ID": str(domain)},
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
    )  # fmt: skip


def test_the_program_with_the_example_of_parameters(ros: None, domain: int) -> None:
    file = ROOT / "examples" / "ros" / "posemix.yaml"
    running = program("--ros-args", "--params-file", str(file), domain=domain)
    partner = rclpy.create_node("partner")
    client = partner.create_client(GetState, "/posemix/get_state")
    try:
        assert client.wait_for_service(timeout_sec=20.0)
        end = time.monotonic() + 10.0
        state = ""
        while state != "active" and time.monotonic() < end:
            future = client.call_async(GetState.Request())
            rclpy.spin_until_future_complete(partner, future, timeout_sec=1.0)
            state = future.result().current_state.label if future.done() else ""
        assert state == "active"
        running.send_signal(signal.SIGINT)
        text, _ = running.communicate(timeout=10)
        assert running.returncode == 0 and "no parameter" not in text and "Traceback" not in text, text
    finally:
        running.kill()
        partner.destroy_node()


def test_the_program_says_which_parameter_is_wrong(ros: None, domain: int) -> None:
    running = program("--ros-args", "-p", "motion.model:=flying", "-p", "max_gap:=0.1", domain=domain)
    text, _ = running.communicate(timeout=20)
    assert running.returncode == 1
    assert "motion.model is 'flying'" in text and "there is no parameter 'max_gap'" in text


@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM])
def test_the_program_writes_its_report_when_it_is_ended(
    live: Callable[..., Live], domain: int, tmp_path: Path, end: signal.Signals
) -> None:
    parameters = [
        "motion.model:=still", f"report_folder:={tmp_path}", "view_hz:=1000.0", "least_existence:=0.0",
        "qos_overrides./posemix/detections.subscription.reliability:=reliable",
    ]  # fmt: skip
    running = program("--ros-args", *(a for p in parameters for a in ("-p", p)), domain=domain)
    try:
        world = live(node=False)
        world.meet_program()
        for k in range(10):
            world.detect(detections(at(0.1 * k), {"mug": SE3(translation=[0.0, 0.0, 0.8])}))
            world.newest(at(0.1 * k))
        world.spin(0.3)
        running.send_signal(end)
        text, _ = running.communicate(timeout=20)
    finally:
        running.kill()
    assert running.returncode == 0 and "Traceback" not in text, text
    pages = list(tmp_path.glob("*/report.html"))
    assert len(pages) == 1 and f"report: {pages[0]}" in text
    assert json.loads((pages[0].parent / "trace.json").read_text())["frames"] == 10
