# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Maps and single objects through the node's services, in a real ROS 2."""

from __future__ import annotations

import signal
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("rclpy")
pytest.importorskip("rosbags")

from lifecycle_msgs.msg import Transition
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter
from std_srvs.srv import Trigger

from posemix import SE3

from .live import SECOND, Live, at, detections, values_of
from .test_live_node import BOX, MUG, STILL
from .test_live_runs import program

JAR = SE3.exp([0.3, -0.4, 0.2, 0.1, 0.3, 1.2])
ALL = {"mug": MUG, "box": BOX, "jar": JAR}
# Of the new world in the old one, after the robot was switched off.
MOVED = SE3.exp([0.0, 0.0, 0.6, 0.8, -0.3, 0.0])


def trigger(world: Live, name: str) -> Any:
    return world.call(world.partner.create_client(Trigger, f"/posemix/{name}"), Trigger.Request())


def set_parameter(world: Live, name: str, value: Any) -> Any:
    client = world.partner.create_client(SetParameters, "/posemix/set_parameters")
    request = SetParameters.Request(parameters=[Parameter(name, value=value).to_parameter_msg()])
    return world.call(client, request).results[0]


def test_single_objects_are_forgotten(live: Callable[..., Live]) -> None:
    world = live(parameters={**STILL, "least_existence": 0.0})
    world.watch(0.0, 3, {"mug": MUG, "box": BOX})
    answer = trigger(world, "forget")
    assert not answer.success and "forget_ids is empty" in answer.message
    assert set_parameter(world, "forget_ids", ["cup"]).successful
    answer = trigger(world, "forget")
    assert not answer.success and "no object 'cup'; known are: box, mug" in answer.message
    assert set_parameter(world, "forget_ids", ["mug"]).successful
    assert trigger(world, "forget").success
    world.until(lambda: {d.id for d in world.objects[-1].detections} == {"box"}, "the mug is forgotten")
    world.watch(1.0, 1, {"box": BOX})
    assert set(world.newest(at(1.0))) == {"box"}
    world.watch(1.4, 1, {"mug": MUG})
    assert set(world.newest(at(1.4))) == {"box", "mug"}


def test_maps_are_saved_and_loaded(live: Callable[..., Live], tmp_path: Path) -> None:
    world = live(parameters={**STILL, "least_existence": 0.0, "diagnostics_hz": 20.0})
    assert "map_file is empty" in trigger(world, "save").message
    file = tmp_path / "kitchen.state"
    assert set_parameter(world, "map_file", str(file)).successful
    answer = trigger(world, "save")
    assert not answer.success and "nothing was seen" in answer.message
    assert "no such map" in trigger(world, "load").message
    world.watch(0.0, 12, ALL)
    assert trigger(world, "save").success and file.exists()
    # A new world, in which two of them are seen from elsewhere.
    assert trigger(world, "reset").success
    seen = {name: MOVED.inverse() * pose for name, pose in ALL.items() if name != "jar"}
    world.watch(100.0, 3, seen)
    answer = trigger(world, "load")
    assert answer.success and "3 objects" in answer.message
    world.watch(101.0, 3, seen)
    found = world.newest(at(101.4))
    assert set(found) == set(ALL)
    place = found["jar"].bbox.center.position
    expected = (MOVED.inverse() * JAR).translation
    np.testing.assert_allclose([place.x, place.y, place.z], expected, atol=0.05)
    assert "was found by 2 objects" in values_of(world.status("node", lambda s: "map" in values_of(s)))["map"]
    file.write_bytes(file.read_bytes()[:-5])
    answer = trigger(world, "load")
    assert not answer.success and "cut off" in answer.message


def test_a_map_is_saved_at_the_end_and_loaded_at_the_beginning(live: Callable[..., Live], tmp_path: Path) -> None:
    file = tmp_path / "a.state"
    given = {
        **STILL, "least_existence": 0.0, "map_file": str(file), "save_map": True, "load_map": True, "map_goes_on": True,
    }  # fmt: skip
    world = live(parameters=given)
    world.watch(0.0, 5, ALL)
    assert not file.exists()
    assert world.change(Transition.TRANSITION_DEACTIVATE) and file.exists()
    assert world.change(Transition.TRANSITION_CLEANUP) and world.change(Transition.TRANSITION_CONFIGURE)
    assert world.change(Transition.TRANSITION_ACTIVATE)
    world.until(world._is_connected, "the partner is connected again")
    world.watch(2.0, 1, {"mug": MUG})
    assert set(world.newest(at(2.0))) == set(ALL)
    # Of other settings it is no run that could go on.
    assert world.change(Transition.TRANSITION_DEACTIVATE) and world.change(Transition.TRANSITION_CLEANUP)
    world.node.set_parameters([Parameter("filter.max_hypotheses", value=5)])
    assert not world.change(Transition.TRANSITION_CONFIGURE)


def sighted(world: Live, seconds: float, seen: dict[str, SE3]) -> dict[str, Any]:
    """The objects after an image, by the program: it may miss the first ones."""

    def taken() -> bool:
        world.detect(detections(at(seconds), seen))
        world.spin(0.1)
        stamps = [m.header.stamp.sec * SECOND + m.header.stamp.nanosec for m in world.objects]
        return at(seconds) in stamps

    world.until(taken, f"objects at {seconds} s", 30.0)
    return world.newest(at(seconds))


@pytest.mark.parametrize("end", ["killed", "interrupted"])
def test_the_program_is_ended_and_started_again_with_its_map(
    live: Callable[..., Live], domain: int, tmp_path: Path, end: str
) -> None:
    file = tmp_path / "a.state"
    given = {"least_existence": 0.0, "motion.model": "still", "map_file": file, "load_map": True}
    given |= {"save_map": True, "qos_overrides./posemix/detections.subscription.reliability": "reliable"}
    arguments = ["--ros-args", *[a for k, v in given.items() for a in ("-p", f"{k}:={v}")]]
    running = program(*arguments, domain=domain)
    try:
        world = live(node=False)
        world.meet_program()
        for i in range(8):
            assert set(sighted(world, 0.2 * i, ALL)) == set(ALL)
        if end == "killed":
            assert trigger(world, "save").success
            running.kill()
        else:
            running.send_signal(signal.SIGINT)
        running.communicate(timeout=10)
        assert file.exists() and (running.returncode == 0) == (end == "interrupted")
        world.close()
        # The robot stands elsewhere, and so does the world of the new run.
        running = program(*arguments, domain=domain)
        world = live(node=False)
        world.meet_program()
        seen = {name: MOVED.inverse() * ALL[name] for name in ("mug", "box")}
        for i in range(8):
            found = sighted(world, 50.0 + 0.2 * i, seen)
        assert set(found) == set(ALL)
        place = found["jar"].bbox.center.position
        expected = (MOVED.inverse() * JAR).translation
        np.testing.assert_allclose([place.x, place.y, place.z], expected, atol=0.05)
    finally:
        running.kill()
        running.communicate(timeout=10)
