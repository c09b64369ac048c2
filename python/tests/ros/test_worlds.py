# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""In which world the objects of a run are, what other detectors say of them, and what becomes of maps; without ROS."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import posemix as px
import pytest
from ros.robot import PLACES, SECOND, START, Robot, robot, where

from posemix import SE3
from posemix.ros import Image, configuration

DAY_S = 86400.0
BASE_CAMERA = SE3.exp([-1.2, 0.3, 0.8, 1.0, 0.2, 0.5])


def image(seconds: float, names: list[str], *, source: str = "", arrival_s: float = 0.0) -> Image:
    """What a camera that stands still sees, of a detector."""
    poses = tuple([px.ObservationComponent(PLACES[name])] for name in names)
    return Image(
        START + round(seconds * SECOND), "camera", source, arrival_s, tuple(names), (0.9,) * len(names),
        ("camera",) * len(names), poses,
    )  # fmt: skip


@pytest.mark.parametrize("model", ["odometry", "given"])
def test_a_world_is_that_of_an_odometry_that_comes_late(model: str) -> None:
    one = robot(**{"motion.model": model})
    for i in range(3):
        one.engine.add(image(0.2 * i, ["mug"]))
        one.engine.ready(10.0)  # the time for waiting is over
    for i in range(3, 6):
        stamp = START + round(0.2 * i * SECOND)
        one.engine.transforms.take("odom", "camera", BASE_CAMERA.to_tq().tolist(), stamp)
        one.engine.add(image(0.2 * i, ["mug"]))
        (found,) = one.engine.ready(0.0)
    np.testing.assert_allclose(((BASE_CAMERA * PLACES["mug"]).inverse() * where(found, "mug")).log(), 0.0, atol=5e-3)
    # Under `given` nothing was said before; else that world is forgotten, with a word.
    assert one.engine.counts.dropped == (3 if model == "given" else 0)
    assert one.engine.counts.resets == (0 if model == "given" else 1)
    assert model == "given" or "odometry has come" in one.engine.why_reset
    assert "has no pose of 'camera' in 'odom'" in one.engine.complaint


def test_an_object_stays_that_another_detector_does_not_find() -> None:
    def existence(empty: str) -> float:
        one = robot(**{"motion.model": "still", "sources": ["mugs", "others"]})
        found = None
        for i in range(300):
            if i % 10 == 0:
                one.engine.add(image(0.1 * i, ["mug"]))
            # The other one has found a thing of its own before.
            one.engine.add(image(0.1 * i + 0.05, ["box"] if i < 30 else [], source=empty))
            found = (one.engine.ready(0.0) or [found])[-1]
        assert found is not None
        return found.frame.existences["mug"] or 0.0

    assert existence("others") > 0.999
    # The one that has found it, and finds it no more.
    assert existence("") < 0.5


def saved_map(place: Path, names: list[str]) -> bytes:
    """A map of a kitchen with objects; returns what is in its file."""
    first = robot()
    first.drive(0.0, 4.0, names)
    first.engine.save(str(place))
    return place.read_bytes()


def test_a_map_is_kept_and_found_again_where_the_clock_jumps(tmp_path: Path) -> None:
    place = tmp_path / "kitchen.state"
    kept = saved_map(place, list(PLACES))
    second = robot()
    second.engine.load(str(place))
    second.drive(100.0, 104.0, ["mug", "box"])
    assert "was found" in second.engine.map_state
    second.drive(DAY_S, DAY_S + 2.0, ["can"])
    assert second.engine.counts.resets == 1 and "after the newest one before it" in second.engine.why_reset
    with pytest.raises(ValueError, match="it would be lost"):
        second.engine.save(str(place), over_unknown=False)
    assert place.read_bytes() == kept
    assert "is looked for" in second.engine.map_state
    found = second.drive(DAY_S + 2.0, DAY_S + 6.0, ["mug", "box"])
    assert "was found" in second.engine.map_state and set(found.hypotheses) == set(PLACES)
    second.engine.save(str(place), over_unknown=False)


def test_a_map_saved_by_hand_is_looked_for_after_a_jump_of_the_clock(tmp_path: Path) -> None:
    place = tmp_path / "kitchen.state"
    one = robot()
    one.drive(0.0, 4.0, ["mug", "box"])
    one.engine.save(str(place))
    found = one.drive(DAY_S, DAY_S + 5.0, ["mug", "box", "can"])
    assert one.engine.counts.resets == 1 and "was found" in one.engine.map_state
    assert set(found.hypotheses) == {"mug", "box", "can"}
    one.engine.save(str(place), over_unknown=False)
    # Who wants to forget does.
    one.engine.reset()
    assert one.engine.map_state == ""


def test_a_map_saved_elsewhere_is_not_the_one_that_is_missing(tmp_path: Path) -> None:
    place = tmp_path / "kitchen.state"
    saved_map(place, ["mug", "box"])
    second = robot()
    second.engine.load(str(place))
    second.drive(100.0, 101.0, ["can"])
    second.engine.save(str(tmp_path / "other.state"))
    with pytest.raises(ValueError, match="it would be lost"):
        second.engine.save(str(place), over_unknown=False)


def test_late_images_are_complained_of() -> None:
    one: Robot = robot(**{"motion.model": "still"})
    for seconds in (0.0, 5.0, 3.0):
        one.engine.add(image(seconds, ["mug"]))
        one.engine.ready(0.0)
    assert one.engine.counts.too_late == 1
    assert "2.0 s older than the newest one" in one.engine.complaint


def test_parameters_that_have_no_effect_are_refused(tmp_path: Path) -> None:
    (tmp_path / "models_info.json").write_text('{"1": {"diameter": 50}}')
    with pytest.raises(ValueError, match="classes, which is empty"):
        configuration({"models_info": str(tmp_path / "models_info.json")})


def test_infinity_where_it_has_a_meaning() -> None:
    assert configuration({"filter.noise_scale_detections": math.inf}).tracker.filter.noise_scale_detections == math.inf
    with pytest.raises(ValueError, match="max_gap_s is inf"):
        configuration({"max_gap_s": math.inf})


def test_a_run_that_goes_on_is_not_merged_with_itself(tmp_path: Path) -> None:
    place = str(tmp_path / "kitchen.state")
    saved_map(Path(place), ["mug", "box", "jar"])
    second = robot()
    second.engine.load(place, go_on=True)
    second.drive(4.0, 5.0, ["mug"])
    second.engine.lose("for the test")
    second.engine.load(place, go_on=True)
    second.drive(4.0, 6.0, ["mug", "box", "jar"])
    assert second.engine.map_state == "goes on"
    # A map that cannot go on leaves nothing behind.
    third = robot(**{"filter.max_hypotheses": 5})
    with pytest.raises(ValueError, match="cannot go on"):
        third.engine.load(place, go_on=True)
    third.engine.lose("for the test")
    assert third.engine.map_state == ""


def test_what_was_saved_during_the_run_is_what_is_looked_for(tmp_path: Path) -> None:
    place = tmp_path / "kitchen.state"
    saved_map(place, ["mug", "box"])
    second = robot()
    second.engine.load(str(place))
    second.drive(100.0, 104.0, ["mug", "box", "can"])
    assert "was found" in second.engine.map_state
    second.engine.save(str(place))
    found = second.drive(DAY_S, DAY_S + 5.0, ["mug", "box"])
    assert "was found" in second.engine.map_state and set(found.hypotheses) == {"mug", "box", "can"}


@pytest.mark.parametrize("source", ["yolo@v2", "yolo"])
def test_names_of_detectors_may_be_any(source: str) -> None:
    one = robot(**{
        "motion.model": "still", "sources": ["mugs", source], f"{source}.topic": "others", "cameras": ["camera"],
        "body_frame": "base_link",
    })  # fmt: skip
    one.engine.transforms.take("base_link", "camera", BASE_CAMERA.to_tq().tolist(), None)
    for i in range(20):
        one.engine.add(image(0.2 * i, ["mug"]))
        one.engine.add(image(0.2 * i + 0.1, [], source=source))
        one.engine.ready(0.0)
    assert (one.engine.counts.images, one.engine.counts.refused, one.engine.counts.resets) == (40, 0, 0)


def test_late_images_that_show_nothing_are_complained_of() -> None:
    one = robot(**{"motion.model": "still"})
    for seconds, seen in ((0.0, ["mug"]), (5.0, ["mug"]), (3.0, [])):
        one.engine.add(image(seconds, seen))
        one.engine.ready(0.0)
    assert one.engine.counts.too_late == 1 and "2.0 s older than the newest one" in one.engine.complaint
