# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""What comes to the node late, twice, wrong or not at all, in a real ROS 2."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy")

from geometry_msgs.msg import Transform, Vector3
from happypose_msgs.msg import ContinuousSymmetry, ObjectSymmetries, ObjectSymmetriesArray
from rosgraph_msgs.msg import Clock
from vision_msgs.msg import Detection2DArray

from posemix import SE3, SO3

from .live import LATCHED, SECOND, Live, at, detections, odometry, set_pose, set_stamp, transform, values_of
from .test_live_node import BOX, MUG, STILL

SEEN_ALWAYS = {"least_existence": 0.0}


def camera_at(seconds: float) -> SE3:
    """T_odom_camera of a camera that goes by."""
    return SE3.exp([0.0, 0.05 * seconds, 0.0, 0.1 * seconds, 0.0, 0.0])


def seen_at(seconds: float) -> dict[str, Any]:
    rng = np.random.default_rng(round(100 * seconds))
    noise = SE3.exp(rng.normal(size=6) * [0.01, 0.01, 0.01, 0.002, 0.002, 0.002])
    back = camera_at(seconds).inverse()
    return {"mug": back * MUG * noise, "box": back * BOX * noise}


def drive(world: Live, until: float, gap: tuple[float, float] = (9.0, 9.0)) -> None:
    """Odometry in /tf, but for a gap."""
    for i in range(round(until / 0.05) + 1):
        if not gap[0] < 0.05 * i < gap[1]:
            world.move(at(0.05 * i), camera_at(0.05 * i))


def numbers(objects: dict[str, Any]) -> np.ndarray:
    """All numbers of the objects of a message."""
    rows = []
    for name in sorted(objects):
        for result in objects[name].results:
            p, q = result.pose.pose.position, result.pose.pose.orientation
            rows.append([result.hypothesis.score, p.x, p.y, p.z, q.x, q.y, q.z, q.w, *result.pose.covariance])
    return np.array(rows)


def test_order_does_not_matter(live: Callable[..., Live]) -> None:
    found = []
    for order in ([0.0, 0.2, 0.4, 0.6, 0.8, 1.0], [0.0, 0.4, 0.2, 0.8, 0.6, 1.0]):
        world = live(parameters=SEEN_ALWAYS)
        drive(world, 1.2)
        for i, seconds in enumerate(order):
            world.detect(detections(at(seconds), seen_at(seconds)))
            world.taken(i + 1)
        found.append(numbers(world.newest(at(1.0))))
        late = world.counts()["late"]
        assert late == (0 if order == sorted(order) else 4) and world.counts()["without_odometry"] == 0
        # Older than the history: refused and counted, and nothing else.
        world.detect(detections(at(-0.5), seen_at(0.0)))
        world.taken(7)
        assert world.counts()["too_late"] == 2
        world.close()
    np.testing.assert_array_equal(found[0], found[1])


def test_two_detectors(live: Callable[..., Live]) -> None:
    fine = {
        **STILL, **SEEN_ALWAYS, "sources": ["rough", "fine"], "fine.type": "Detection2DArray",
        "rough.rotation_sd_deg": 5.0, "rough.translation_sd_m": 0.05,
        "fine.rotation_sd_deg": 0.5, "fine.translation_sd_m": 0.002,
    }  # fmt: skip
    kinds = {"rough": None, "fine": Detection2DArray}
    spreads = []
    for topics in (["rough"], ["rough", "fine"]):
        world = live(parameters=fine, kinds=kinds)
        count = 0
        for i in range(6):
            for topic in topics:
                count += 1
                # As happypose has it: the array is stamped when it is published, its detections as the image.
                late = {"flat": True, "published_ns": at(0.2 * i + 0.15)} if topic == "fine" else {}
                world.detect(detections(at(0.2 * i), {"mug": MUG}, covariance=np.eye(6), **late), topic)
                world.taken(count)
        mug = world.newest(at(1.0))["mug"]
        spreads.append(np.sqrt(np.array(mug.results[0].pose.covariance)[[0, 7, 14]]))
        world.close()
    assert (spreads[1] < 0.2 * spreads[0]).all()


def symmetries_of_box() -> Any:
    half = Transform()
    set_pose(half, SE3(SO3.exp([0.0, 0.0, np.pi])))
    round_ = ContinuousSymmetry(axis=Vector3(x=0.0, y=0.0, z=1.0))
    return ObjectSymmetriesArray(objects=[
        ObjectSymmetries(class_id="box", symmetries_discrete=[half]),
        ObjectSymmetries(class_id="can", symmetries_continuous=[round_]),
    ])  # fmt: skip


def test_symmetries_may_come_late(live: Callable[..., Live]) -> None:
    turned = BOX * SE3(SO3.exp([0.0, 0.0, np.pi]))
    images = [{"box": BOX if i % 2 else turned} for i in range(8)]
    found = []
    for late in (False, True):
        world = live(parameters={**STILL, **SEEN_ALWAYS, "symmetries_topic": "/symmetries"})
        publisher = world.partner.create_publisher(ObjectSymmetriesArray, "/symmetries", LATCHED)
        if not late:
            publisher.publish(symmetries_of_box())
            world.until(lambda w=world: "can" in w.node._engine._known.symmetries, "symmetries")
        for i, seen in enumerate(images):
            world.detect(detections(at(0.3 * i), seen))
            world.taken(i + 1)
        if late:
            assert len(world.newest(at(2.1))["box"].results) == 2
            world.objects.clear()
            publisher.publish(symmetries_of_box())
        found.append(world.newest(at(2.1)))
        world.close()
    assert len(found[0]["box"].results) == 1
    np.testing.assert_array_equal(numbers(found[0]), numbers(found[1]))


def test_a_gap_in_the_transforms(live: Callable[..., Live]) -> None:
    world = live(parameters={**SEEN_ALWAYS, "transform_timeout_s": 1.0})
    drive(world, 3.0, gap=(0.92, 2.04))
    for i in range(3):
        world.detect(detections(at(0.3 * i), seen_at(0.3 * i)))
    world.taken(3)
    for i in (4, 5):
        world.detect(detections(at(0.3 * i), seen_at(0.3 * i)))
    world.spin(0.05)
    assert world.counts()["images"] == 3 and int(values_of(world.status("node"))["waiting"]) == 2
    world.status("node", lambda s: "no odometry at" in s.message)
    world.taken(5)
    assert world.counts()["without_odometry"] == 2
    # The transform that comes while an image waits is in time.
    world.detect(detections(at(3.5), seen_at(3.5)))
    world.spin(0.05)
    world.move(at(3.5), camera_at(3.5))
    world.taken(6)
    assert world.counts()["without_odometry"] == 2

    def is_joined() -> bool:
        stamps = [t.header.stamp for t in world.transforms if t.child_frame_id == "odom"]
        return any((s.sec, s.nanosec) == divmod(at(3.5), SECOND) for s in stamps)

    world.until(is_joined, "map -> odom at the last image")


def test_detections_in_a_frame_that_is_not_known_are_dropped(live: Callable[..., Live]) -> None:
    world = live(parameters={**STILL, **SEEN_ALWAYS, "camera_frame": "camera", "transform_timeout_s": 0.1})
    world.detect(detections(at(0.0), {"mug": MUG}, frame="nowhere"))
    world.status("node", lambda s: "no transform from 'nowhere' to 'camera'" in s.message)
    assert world.counts()["dropped"] == 1 and world.counts()["images"] == 0
    world.send_transform(transform("camera", "nowhere", SE3(translation=[0.0, 0.0, 1.0])), static=True)
    world.detect(detections(at(1.0), {"mug": MUG}, frame="nowhere"))
    world.taken(1)
    assert world.newest(at(1.0))["mug"].bbox.center.position.z == pytest.approx(1.0 + MUG.translation[2], abs=1e-6)


def test_more_images_than_may_wait(live: Callable[..., Live]) -> None:
    world = live(parameters={"queue_size": 3, "transform_timeout_s": 30.0})
    for i in range(10):
        world.detect(detections(at(0.1 * i), {"mug": MUG}))
    world.until(lambda: world.counts()["dropped"] == 7, "seven are dropped")
    assert world.node._engine.waiting == 3
    world.status("node", lambda s: "queue_size" in s.message)


def test_odometry_from_its_topic(live: Callable[..., Live]) -> None:
    reliable = {"qos_overrides./odom.subscription.reliability": "reliable"}
    world = live(parameters={**SEEN_ALWAYS, **reliable, "odometry_topic": "/odom"})
    world.send_transform(transform("base", "camera", SE3(translation=[0.0, 0.0, 0.3])), static=True)
    world.until(lambda: world._odometry.get_subscription_count() > 0, "odometry is heard")
    for i in range(30):
        world.send_odometry(odometry(at(0.05 * i), camera_at(0.05 * i)))
    arm = SE3(translation=[0.0, 0.0, 0.3]).inverse()
    for i in range(5):
        seen = {name: arm * pose for name, pose in seen_at(0.2 * i).items()}
        world.detect(detections(at(0.2 * i), seen))
    world.taken(5)
    assert world.counts()["without_odometry"] == 0
    mug = world.newest(at(0.8))["mug"].results[0].pose.pose.position
    np.testing.assert_allclose([mug.x, mug.y, mug.z], MUG.translation, atol=0.02)


def test_a_rig_of_two_cameras(live: Callable[..., Live]) -> None:
    world = live(parameters={**STILL, **SEEN_ALWAYS, "cameras": ["left", "right"]})
    places = {"left": SE3(translation=[-0.1, 0.0, 0.0]), "right": SE3.exp([0.0, 0.2, 0.0, 0.1, 0.0, 0.0])}
    for name, place in places.items():
        world.send_transform(transform("base_link", name, place), static=True)
    for i in range(6):
        name = ("left", "right")[i % 2]
        world.detect(detections(at(0.2 * i), {"mug": places[name].inverse() * MUG}, frame=name))
    world.taken(6)
    mug = world.newest(at(1.0))["mug"].results[0].pose.pose.position
    np.testing.assert_allclose([mug.x, mug.y, mug.z], MUG.translation, atol=1e-3)
    world.detect(detections(at(1.2), {"mug": MUG}, frame="third"))
    world.status("node", lambda s: "'third'" in s.message)


def test_stamps_that_jump_back(live: Callable[..., Live]) -> None:
    world = live(parameters=SEEN_ALWAYS)

    def see(seconds: float, name: str) -> None:
        world.move(at(seconds), SE3())
        world.detect(detections(at(seconds), {name: MUG}))

    for i in range(4):
        see(100.0 + 0.2 * i, "mug")
        world.taken(i + 1)
    for i in range(8):
        see(40.0 + 0.2 * i, "box")
        world.until(lambda i=i: world.counts()["refused"] + world.counts()["images"] == 5 + i, "an image more")
    # Four images in which it may be a wrong stamp; then as if the node had been started anew: the mug is forgotten.
    assert set(world.newest(at(41.4))) == {"box"}
    assert world.counts()["refused"] == 4
    assert world.counts()["resets"] == 1 and world.counts()["without_odometry"] == 0


def test_one_wrong_stamp_costs_one_image(live: Callable[..., Live]) -> None:
    world = live(parameters={**STILL, **SEEN_ALWAYS})
    world.watch(100.0, 3, {"mug": MUG})
    for i, wrong in enumerate((5.0, 9000.0, 0.0, 50.0, 20.0, 8000.0)):
        world.detect(detections(at(wrong), {"mug": MUG}))
        world.until(lambda i=i: world.counts()["refused"] == i + 1, "it is refused")
        world.watch(101.0 + i, 1, {"mug": MUG})
    assert set(world.newest(at(106.0))) == {"mug"}
    assert world.counts()["resets"] == 0 and world.counts()["images"] == 9


def test_a_clock_that_jumps_back(live: Callable[..., Live]) -> None:
    world = live(parameters={**STILL, **SEEN_ALWAYS, "use_sim_time": True})
    clock = world.partner.create_publisher(Clock, "/clock", 10)

    def tick(seconds: float) -> None:
        message = Clock()
        set_stamp(message.clock, at(seconds))
        clock.publish(message)
        world.until(lambda: world.node.get_clock().now().nanoseconds == at(seconds), "the clock is heard")

    world.until(lambda: clock.get_subscription_count() > 0, "the clock's subscriber")
    tick(10.0)
    world.watch(10.0, 3, {"mug": MUG})
    resets = world.counts()["resets"]
    # Less than the stamps may jump back; the clock says it.
    tick(8.0)
    world.until(lambda: world.counts()["resets"] == resets + 1, "a reset")
    world.watch(8.0, 1, {"box": BOX})
    # The empty array after the jump may have the same stamp.
    world.until(lambda: set(world.newest(at(8.0))) == {"box"}, "the box alone")


def test_stamps_far_ahead(live: Callable[..., Live]) -> None:
    world = live(parameters={**STILL, **SEEN_ALWAYS})
    world.watch(0.0, 2, {"mug": MUG})
    world.detect(detections(at(9000.0), {"mug": MUG}))
    world.until(lambda: world.counts()["refused"] == 1, "one wrong stamp is refused")
    world.watch(1.0, 1, {"mug": MUG})
    for i in range(6):
        world.detect(detections(at(9000.0 + i), {"mug": MUG}))
    world.until(lambda: world.counts()["resets"] == 1 and world.counts()["images"] == 5, "the clock is another one")


def test_what_is_wrong_in_a_message_is_said_and_the_node_lives(live: Callable[..., Live]) -> None:
    world = live(parameters={**STILL, **SEEN_ALWAYS})
    world.detect(detections(at(0.0), {"mug": MUG}, covariance=-2 * np.eye(6)))
    world.status("node", lambda s: "detection 0" in s.message and "positive definite" in s.message)
    assert world.counts()["refused"] == 1
    world.watch(1.0, 1, {"mug": MUG})
    assert set(world.newest(at(1.0))) == {"mug"}


def test_what_is_not_seen_any_more_is_lost(live: Callable[..., Live]) -> None:
    world = live(parameters={**STILL, "empty_is_image": True})
    world.watch(0.0, 20, {"mug": MUG, "box": BOX}, period=0.5)
    world.watch(10.0, 24, {}, period=0.5)
    status = world.status("box")
    assert status.message == "lost" and status.level == b"\x02"
    assert values_of(status)["register_again"] == "true"
    world.spin(0.1)
    world.transforms.clear()
    world.watch(22.0, 1, {"mug": MUG}, period=0.5)
    world.until(lambda: [t for t in world.transforms if t.child_frame_id == "mug"], "the mug is seen again")
    assert "box" not in {t.child_frame_id for t in world.transforms}
