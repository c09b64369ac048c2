# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""`posemix live`, which is without ROS, in a real ROS 2 over Fast DDS."""

from __future__ import annotations

import signal
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy")

from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import Empty
from vision_msgs.msg import Detection2DArray, Detection3DArray

from posemix import SE3

from .live import LATCHED, Live, at, detections, odometry, transform
from .program import PROGRAM, Program, environment, unavailable
from .test_live_input import camera_at, numbers, seen_at
from .test_live_node import BOX, MUG

pytestmark = pytest.mark.skipif(bool(unavailable()), reason=unavailable())

STILL = '[motion]\nmodel = "still"\n'
PATIENT = "[live]\ntransform_timeout_s = 5.0\n"  # transforms that a loaded machine delivers late
RELIABLE = '[[sources]]\nname = "detections"\nreliability = "reliable"\n'


@pytest.fixture
def program(ros: None, domain: int, tmp_path: Path) -> Iterator[Callable[..., Program]]:
    """Starts the program with a partner."""
    made: list[Program] = []

    def make(text: str = "", **options: Any) -> Program:
        made.append(Program(tmp_path, domain, RELIABLE + text, **options))
        return made[-1]

    yield make
    for one in made:
        one.close()


def drive(world: Live, until: float) -> None:
    for i in range(round(until / 0.05) + 1):
        world.move(at(0.05 * i), camera_at(0.05 * i))


def test_objects_transforms_and_diagnostics(program: Callable[..., Program]) -> None:
    running = program(PATIENT).ready()
    world = running.world
    drive(world, 6.1)
    for i in range(31):
        world.detect(detections(at(0.2 * i), seen_at(0.2 * i)))
    values = running.until("images", 31)
    assert values["without_odometry"] == values["dropped"] == "0"
    found = world.newest(at(6.0))
    assert set(found) == {"mug", "box"}
    mug = found["mug"].results[0]
    assert mug.hypothesis.class_id == "mug"
    assert sum(r.hypothesis.score for r in found["mug"].results) == pytest.approx(1.0)
    p = mug.pose.pose.position
    np.testing.assert_allclose([p.x, p.y, p.z], MUG.translation, atol=0.02)
    world.until(
        lambda: {"mug", "box", "odom"} <= {t.child_frame_id for t in world.transforms}, "transforms"
    )
    assert world.status("mug").message == "good"
    # What is latched is received by those that come late, too.
    late: list[Any] = []
    world.partner.create_subscription(Detection3DArray, "/posemix/objects", late.append, LATCHED)
    world.until(lambda: late, "the last objects")


@pytest.mark.parametrize("topic", ["", "/odom"])
def test_it_says_what_the_node_says(
    live: Callable[..., Live], program: Callable[..., Program], topic: str
) -> None:
    """The node of rclpy and the program hear the same, late and out of order, and one with all results."""
    reliable = {f"qos_overrides./odom.subscription.{k}": v for k, v in (("reliability", "reliable"), ("depth", 1000))}
    world = live(parameters={"least_existence": 0.0, "odometry_topic": topic, "transform_timeout_s": 5.0, **reliable})
    settings = {"live.odometry_topic": topic, "live.publish_tf": False, "live.publish_world_tf": False,
                "live.transform_timeout_s": 5.0}  # fmt: skip
    twin = program(
        name="twin", settings={**settings, "sources.0.topic": "/posemix/detections"}, world=world
    )
    said: list[Any] = []
    world.partner.create_subscription(Detection3DArray, "/twin/objects", said.append, LATCHED)
    # Of the partner detections, /tf and /tf_static, of the node /tf.
    twin.until("publishers", 5 if topic else 4)
    senders = [world._detectors["detections"], world._tf, *([world._odometry] if topic else [])]
    world.until(lambda: all(p.get_subscription_count() >= 2 for p in senders), "both are there")
    if topic:
        world.send_transform(transform("base", "camera", SE3()), static=True)
    for i in range(80):
        if topic:
            world.send_odometry(odometry(at(0.05 * i), camera_at(0.05 * i)))
        else:
            world.move(at(0.05 * i), camera_at(0.05 * i))
        world.spin(0.002)
    rng = np.random.default_rng(5)
    for count, i in enumerate([0, 1, 3, 2, 4, 6, 5, 7, 8, 10, 9, 11, 12, 13, 15, 14, 16, 17, 18]):
        seen: dict[str, Any] = seen_at(0.2 * i + 0.013)
        seen["mug"] = ((seen["mug"], 0.7), (seen["mug"] * SE3.exp([0.0, 0.0, 2.0, 0.0, 0.0, 0.0]), 0.3))
        spread = rng.normal(size=(6, 6))
        covariance = 1e-6 * (spread @ spread.T + np.eye(6))
        world.detect(detections(at(0.2 * i + 0.013), seen, covariance=covariance))
        world.taken(count + 1)
        twin.until("images", count + 1)
    last = at(3.6 + 0.013)
    of_node = world.newest(last)
    world.until(lambda: said and said[-1].header.stamp == world.objects[-1].header.stamp, "the program's last")
    of_program = {d.id: d for d in said[-1].detections}
    assert set(of_program) == set(of_node) == {"mug", "box"}
    assert len(of_node["mug"].results) >= 2
    np.testing.assert_allclose(numbers(of_program), numbers(of_node), rtol=1e-9, atol=1e-12)
    values = twin.values()
    assert values["late"] == str(world.counts()["late"]) != "0"
    assert values["without_odometry"] == "0"


def test_two_detectors_and_a_reset(program: Callable[..., Program]) -> None:
    text = STILL + '[[sources]]\nname = "fine"\ntype = "Detection2DArray"\nreliability = "reliable"\n'
    running = program(text, kinds={"detections": None, "fine": Detection2DArray}).ready()
    world = running.world
    world.detect(detections(at(0.0), {"mug": MUG}))
    running.until("images", 1)
    world.detect(detections(at(0.2), {"box": BOX}, flat=True, published_ns=at(0.3)), "fine")
    running.until("images", 2)
    assert set(world.newest(at(0.2))) == {"mug", "box"}
    reset = world.partner.create_publisher(Empty, "/posemix/reset", 1)
    running.until("publishers", 5)
    world.until(lambda: reset.get_subscription_count() > 0, "the reset is heard")
    reset.publish(Empty())
    running.until("resets", 1)
    world.detect(detections(at(0.4), {"box": BOX}))
    running.until("images", 3)
    assert set(world.newest(at(0.4))) == {"box"}


def test_what_is_wrong_is_said_and_it_lives(program: Callable[..., Program]) -> None:
    running = program(STILL).ready()
    world = running.world
    world.detect(detections(at(0.0), {"mug": MUG}, covariance=-2 * np.eye(6)))
    world.status("node", lambda s: "detection 0" in s.message and "positive definite" in s.message)
    wrong = detections(at(0.1), {"mug": MUG})
    wrong.detections[0].results[0].pose.pose.position.z = float("nan")
    world.detect(wrong)
    world.status("node", lambda s: "not finite" in s.message)
    wrong = transform("camera", "tool", SE3(), at(0.2))
    wrong.transforms[0].transform.rotation.w = 0.0
    world.send_transform(wrong)
    world.status("node", lambda s: '"tool"' in s.message)
    assert running.until("refused", 2)["images"] == "0"
    world.detect(detections(at(1.0), {"mug": MUG}))
    running.until("images", 1)
    assert set(world.newest(at(1.0))) == {"mug"}


def test_quality_of_service_that_does_not_fit_is_said(program: Callable[..., Program]) -> None:
    poor = QoSProfile(depth=10, reliability=ReliabilityPolicy.BEST_EFFORT)
    running = program(STILL, detector_qos=poor)
    world = running.world
    status = world.status("node", lambda s: "has another reliability" in s.message)
    assert "a publisher of /posemix/detections" in status.message and status.level == b"\x01"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_it_ends_at_once_and_writes_its_results(
    program: Callable[..., Program], tmp_path: Path, number: int
) -> None:
    running = program(STILL).ready()
    seconds, text = running.stop(number)
    assert running.process.returncode == 0 and seconds < 1.0, text
    assert "waits for /posemix/detections, publishes /posemix/objects" in text
    out = tmp_path / "run"
    running = program(STILL, arguments=["--out", str(out), "--quiet"], world=running.world).ready()
    for i in range(5):
        running.world.detect(detections(at(0.2 * i), {"mug": MUG}))
    running.until("images", 5)
    running.stop(number)
    assert running.process.returncode == 0
    assert {"trace.json", "object_mug.tum", "metrics.json"} <= {p.name for p in out.iterdir()}
    first = (out / "object_mug.tum").read_text().splitlines()[-1].split()
    assert float(first[0]) == pytest.approx(1_700_000_000.8)


def test_a_wrong_file_is_refused(ros: None, tmp_path: Path, domain: int) -> None:
    config = tmp_path / "wrong.toml"
    config.write_text('schema = 1\n[live]\nworld_frames = "map"\n')
    done = subprocess.run(
        [PROGRAM, "live", config], env=environment(domain), capture_output=True, text=True, timeout=20
    )
    assert done.returncode == 3 and "wrong.toml:3" in done.stderr and "world_frame" in done.stderr


def test_latency_of_the_program_at_60_hz(
    program: Callable[..., Program], capsys: pytest.CaptureFixture[str]
) -> None:
    running = program(settings={"live.diagnostics_hz": 5}).ready()
    world = running.world
    count = 420
    world.show_five_objects(count)
    values = running.until("images", count)
    with capsys.disabled():
        print(
            f"\nadded latency of posemix live at 60 Hz with five objects: median {values['latency_median_ms']} ms, "
            f"99 % {values['latency_99_ms']} ms, {values['images']} of {count} images"
        )
    assert values["without_odometry"] == "0"
    # A bound that a busy machine holds, and a program that waits for a timer or a time-out does not.
    assert float(values["latency_median_ms"]) < 100.0
