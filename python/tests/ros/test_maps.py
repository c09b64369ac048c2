# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Maps that are saved and loaded, objects that are forgotten, models that change during a run; without ROS."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import posemix as px
import pytest
from ros.robot import ELSEWHERE, PLACES, SECOND, START, numbers, robot, where

from posemix import SE3, SO3
from posemix.ros import Image


def test_a_run_goes_on_to_the_last_bit(tmp_path: Path) -> None:
    path = str(tmp_path / "maps" / "a.state")
    one = robot()
    one.drive(0.0, 3.0, ["mug", "box"])
    one.engine.save(path)
    expected = one.drive(3.0, 5.0, ["mug", "jar"])
    two = robot()
    assert "goes on, with 2 objects" in two.engine.load(path, go_on=True)
    found = two.drive(3.0, 5.0, ["mug", "jar"])
    assert set(found.hypotheses) == {"mug", "box", "jar"} and found.stamp_ns == expected.stamp_ns
    np.testing.assert_array_equal(numbers(found), numbers(expected))
    np.testing.assert_array_equal(found.frame.camera.mean.to_tq(), expected.frame.camera.mean.to_tq())
    # With other settings it would be another run.
    three = robot(**{"filter.max_hypotheses": 5})
    with pytest.raises(ValueError, match="other parameters of: settings"):
        three.engine.load(path, go_on=True)
    # Beside a state that the node did not save last, what is in the note is of another one.
    note = json.loads((tmp_path / "maps" / "a.state.json").read_text())
    (tmp_path / "maps" / "a.state.json").write_text(json.dumps(note | {"state_sha256": "0"}))
    with pytest.raises(ValueError, match="cannot go on"):
        robot().engine.load(path, go_on=True)
    (tmp_path / "maps" / "a.state.json").write_text("nothing")
    assert "is looked for" in robot().engine.load(path)


def test_an_old_map_is_found_by_its_objects(tmp_path: Path) -> None:
    path = str(tmp_path / "a.state")
    one = robot()
    one.drive(0.0, 4.0, list(PLACES))
    one.engine.save(path)
    # The robot was switched off and on: its odometry begins elsewhere.
    two = robot(odometry=ELSEWHERE)
    assert "4 objects" in two.engine.load(path)
    found = two.drive(100.0, 103.0, ["mug"])
    assert set(found.hypotheses) == {"mug"} and "too_few_shared" in two.engine.map_state
    found = two.drive(103.0, 108.0, ["mug", "box"])
    assert "was found by 2 objects" in two.engine.map_state and any("was found" in n for n in two.engine.news)
    # The others are known before they are seen, in the world of the new run.
    assert set(found.hypotheses) == set(PLACES)
    for name, pose in PLACES.items():
        error = ((ELSEWHERE * pose).inverse() * where(found, name)).log()
        # The new run knows where it is in the old map by what it saw of two objects.
        assert np.linalg.norm(error[:3]) < 0.1 and np.linalg.norm(error[3:]) < 0.06, (name, error)
    again = two.drive(108.0, 112.0, list(PLACES))
    assert set(again.hypotheses) == set(PLACES) and two.engine.counts.refused == 0
    # What is merged can be saved in its turn.
    two.engine.save(path)
    three = robot()
    three.drive(0.0, 2.0, ["mug", "box", "can"])
    assert "was found" in three.engine.load(path)
    assert set(three.drive(2.0, 3.0, ["mug"]).hypotheses) == set(PLACES)


def test_what_belongs_to_a_run_goes_on_too(tmp_path: Path) -> None:
    """Classes of several objects, symmetries from the topic, and the odometry of an image that has another to come."""
    path = str(tmp_path / "a.state")
    nuts = {"nut": [SE3(SO3(), [0.1, 0.1, 0.8]), SE3(SO3(), [-0.1, -0.1, 0.8])]}
    one = robot(sources=["a", "b"], classes=["mug"])
    turn = SE3.from_tq([0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0])
    one.engine.set_symmetries({"mug": px.SymmetryGroup(turn, [])})
    for i in range(6):
        one.look(0.2 * i, ["mug"], nuts)
    one.engine.save(path)
    two = robot(sources=["a", "b"], classes=["mug"])
    assert "goes on, with 3 objects" in two.engine.load(path, go_on=True)
    for seconds in (1.0, 1.2, 1.4, 1.6, 1.8):
        expected, found = one.look(seconds, ["mug"], nuts), two.look(seconds, ["mug"], nuts)
        np.testing.assert_array_equal(numbers(found), numbers(expected))
    assert two.engine.counts.refused == 0


def test_a_map_whose_images_are_in_the_run_tells_nothing(tmp_path: Path) -> None:
    path, merged = str(tmp_path / "a.state"), str(tmp_path / "merged.state")
    one = robot()
    one.drive(0.0, 4.0, list(PLACES))
    one.engine.save(path)
    with pytest.raises(ValueError, match="tells nothing new"):
        one.engine.load(path)
    two = robot(odometry=ELSEWHERE)
    two.drive(100.0, 103.0, list(PLACES))
    assert "was found" in two.engine.load(path)
    two.engine.save(merged)
    for known in (path, merged):
        with pytest.raises(ValueError, match="tells nothing new"):
            two.engine.load(known)


def test_late_images_do_not_count_after_a_map_was_found(tmp_path: Path) -> None:
    path = str(tmp_path / "a.state")
    one = robot()
    one.drive(0.0, 4.0, ["mug", "box"])
    one.engine.save(path)
    found = []
    for late in (False, True):
        two = robot(odometry=ELSEWHERE)
        two.drive(100.0, 103.0, ["mug", "box"])
        assert "was found" in two.engine.load(path)
        if late:
            two.look(102.1, ["mug", "box"])
            assert two.engine.counts.too_late == 2
        found.append(numbers(two.look(103.0, ["mug", "box"])))
    np.testing.assert_array_equal(found[0], found[1])


def test_what_leads_nowhere_does_not_stay() -> None:
    one = robot()
    one.drive(0.0, 1.0, ["mug", "box"])
    one.engine.transforms.take("odom", "camera", [1e160, 0, 0, 0, 0, 0, 1], START + SECOND)
    one.engine.add(Image(START + SECOND, "camera", "", 0.0, (), (), (), ()))
    assert one.engine.ready(0.0) == [] and one.engine.counts.refused == 1
    # A detection that is nowhere in the camera's frame.
    one.engine.transforms.take("camera", "other", [1e308, 0, 0, 0, 0, 0, 1], None)
    far = px.ObservationComponent(SE3(translation=[1e308, 0.0, 0.0]))
    one.engine.add(Image(START + 11 * SECOND // 10, "camera", "", 0.0, ("mug",), (0.9,), ("other",), ([far],)))
    one.engine.ready(10.0)
    found = one.drive(1.2, 2.0, ["mug", "box"])
    assert set(found.hypotheses) == {"mug", "box"} and one.engine.waiting == 0


def test_what_is_no_map_changes_nothing(tmp_path: Path) -> None:
    one = robot()
    with pytest.raises(ValueError, match="nothing was seen"):
        one.engine.save(str(tmp_path / "a.state"))
    with pytest.raises(FileNotFoundError, match="no such map"):
        one.engine.load(str(tmp_path / "a.state"))
    (tmp_path / "b.state").write_bytes(b"something else")
    found = one.drive(0.0, 1.0, ["mug"])
    with pytest.raises(ValueError, match=r"b\.state"):
        one.engine.load(str(tmp_path / "b.state"))
    assert one.engine.map_state == "" and set(found.hypotheses) == {"mug"}
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError):
        one.engine.save(str(tmp_path / "file" / "a.state"))


def test_objects_are_forgotten() -> None:
    one = robot()
    with pytest.raises(ValueError, match="known are: none"):
        one.engine.forget(["mug"])
    one.drive(0.0, 2.0, ["mug", "box"])
    with pytest.raises(ValueError, match="no object 'cup'; known are: box, mug"):
        one.engine.forget(["mug", "cup"])
    found = one.engine.forget(["mug"])
    assert found is not None and set(found.hypotheses) == {"box"}
    assert set(one.drive(2.0, 2.4, ["box"]).hypotheses) == {"box"}
    assert set(one.drive(2.4, 2.8, ["box", "mug"]).hypotheses) == {"box", "mug"}
    # Symmetries that come now do not bring back what was forgotten.
    one.engine.forget(["mug"])
    one.engine.set_symmetries({"box": px.SymmetryGroup.turns([0, 0, 1], 2)})
    assert set(one.drive(2.8, 3.0, ["box"]).hypotheses) == {"box"}


@pytest.mark.parametrize("kept", [600, 10])
def test_symmetries_that_come_late(kept: int) -> None:
    """The object is seen in both of its equal orientations; one that is not seen any more is not lost."""
    one = robot(replay_images=kept)
    flipped = PLACES["mug"] * SE3(SO3.exp([0.0, 0.0, np.pi]))
    one.drive(0.0, 2.0, ["box"])
    for i in range(12):
        found = one.look(2.0 + 0.2 * i, ["mug"] if i % 2 else [], {} if i % 2 else {"mug": [flipped]})
    assert len(found.hypotheses["mug"]) == 2
    one.engine.set_symmetries({"mug": px.SymmetryGroup.turns([0, 0, 1], 2)})
    found = one.look(5.0, ["mug"])
    assert set(found.hypotheses) == {"mug", "box"} and len(found.hypotheses["mug"]) == 1
    assert found.hypotheses["mug"][0].probability > 0.8
    error = (where(found, "box") * PLACES["box"].inverse()).log()
    assert np.linalg.norm(error) < 0.05
    assert any("symmetries of mug came after" in text for text in one.engine.news)


@pytest.mark.parametrize("kept", [600, 4])
def test_several_of_a_class_that_is_not_declared(kept: int) -> None:
    one = robot(replay_images=kept)
    others = {"mug": [SE3(translation=[-0.3, 0.2, 1.0]), SE3(translation=[0.4, -0.2, 1.0])]}
    one.drive(0.0, 2.0, ["box", "mug"])
    for i in range(10):
        found = one.look(2.0 + 0.2 * i, ["mug", "box"], others)
    mugs = [name for name, of_class in found.classes.items() if of_class == "mug" and name in found.hypotheses]
    assert set(mugs) == {"mug", "mug_2", "mug_3"} and "box" in found.hypotheses
    places = [PLACES["mug"], *others["mug"]]
    for name in mugs:
        gaps = [np.linalg.norm(where(found, name).translation - place.translation) for place in places]
        assert min(gaps) < 0.02
    # Objects keep their names, and two detections at one place are still of one.
    late = one.look(4.2, ["mug", "box"], {"mug": [PLACES["mug"] * SE3(translation=[0.0, 0.0, 0.01])]})
    assert set(late.hypotheses) == set(found.hypotheses)
    # Switched off, the best one alone counts.
    two = robot(on_sight_instances=1)
    for i in range(10):
        found = two.look(0.2 * i, ["mug"], others)
    assert set(found.hypotheses) == {"mug"} and two.engine.counts.ignored == 20
