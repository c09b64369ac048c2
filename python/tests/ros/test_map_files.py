# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""What must not be lost: maps in files, and a run when a message or a parameter is bad; without ROS."""

from __future__ import annotations

import math
import shutil
from pathlib import Path
from typing import Any

import pytest
from ros.robot import PLACES, robot

from posemix import SE3, SO3
from posemix.ros import configuration
from posemix.ros.maps import read_map


def test_a_map_that_is_not_found_is_kept_through_a_reset(tmp_path: Path) -> None:
    place = tmp_path / "kitchen.state"
    first = robot()
    first.drive(0.0, 2.0, ["mug", "box", "jar"])
    first.engine.save(str(place))
    kept = place.read_bytes()
    second = robot()
    second.engine.load(str(place))
    second.drive(0.0, 1.0, ["can"])
    second.engine.reset()
    second.drive(2.0, 3.0, ["can"])
    with pytest.raises(ValueError, match="it would be lost"):
        second.engine.save(str(place), over_unknown=False)
    assert place.read_bytes() == kept
    second.engine.save(str(place))
    second.engine.save(str(place), over_unknown=False)


def test_a_kill_between_a_map_and_its_note_costs_neither(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class Killed(BaseException):
        pass

    def kill(self: Path, target: Any) -> None:
        raise Killed

    place = tmp_path / "kitchen.state"
    one = robot()
    one.drive(0.0, 1.0, ["mug", "box", "jar"])
    one.engine.save(str(place))
    old, note = place.read_bytes(), read_map(str(place))
    one.drive(1.0, 2.0, ["mug", "box", "jar"])
    with monkeypatch.context() as patch:
        patch.setattr(Path, "replace", kill)
        with pytest.raises(Killed):
            one.engine.save(str(place))
    assert place.read_bytes() == old
    kept = read_map(str(place))
    assert note.odometry is not None and kept.odometry is not None and kept.odometry[0] == note.odometry[0]
    assert kept.start_ns == note.start_ns and kept.lineage == note.lineage
    for _ in range(2):
        one.engine.save(str(place))
    new = read_map(str(place))
    assert place.read_bytes() != old and new.start_ns == note.start_ns
    assert new.odometry is not None and new.odometry[0] > note.odometry[0]
    assert sorted(p.name for p in tmp_path.iterdir()) == ["kitchen.state", "kitchen.state.json"]
    assert (tmp_path / "kitchen.state.json").stat().st_size < 4000


def test_a_map_goes_through_a_link_keeps_its_mode_and_touches_no_other_file(tmp_path: Path) -> None:
    one = robot()
    one.drive(0.0, 1.0, ["mug", "box", "jar"])
    other = tmp_path / "kitchen.next"
    other.write_text("precious")
    place, disk = tmp_path / "kitchen", tmp_path / "disk" / "kitchen.state"
    disk.parent.mkdir()
    one.engine.save(str(disk))
    disk.chmod(0o600)
    before = disk.read_bytes()
    place.symlink_to(disk)
    one.drive(1.0, 2.0, ["mug", "box", "jar"])
    one.engine.save(str(place))
    assert place.is_symlink() and disk.read_bytes() != before and disk.stat().st_mode & 0o777 == 0o600
    assert other.read_text() == "precious" and read_map(str(place)).start_ns is not None
    assert sorted(p.name for p in disk.parent.iterdir()) == ["kitchen.state", "kitchen.state.json"]


def test_a_map_is_written_over_maps_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    one = robot()
    one.drive(0.0, 1.0, ["mug"])
    (tmp_path / "notes.txt").write_text("precious")
    (tmp_path / "package.json").write_text("{}")
    for name in ("notes.txt", "package"):
        with pytest.raises(ValueError, match="is there and no map"):
            one.engine.save(str(tmp_path / name))
    assert (tmp_path / "notes.txt").read_text() == "precious" and (tmp_path / "package.json").read_text() == "{}"
    one.engine.save("~/mug.state")
    one.engine.save("~/mug.state")
    assert (tmp_path / "home" / "mug.state").exists()
    assert "the map is looked for" in robot().engine.load("~/mug.state")


@pytest.mark.parametrize("name", ["", "\0", "mug\0x", "a\nb"])
def test_a_message_with_a_bad_name_is_refused_as_a_whole(name: str) -> None:
    one = robot(on_sight=True)
    one.drive(0.0, 1.0, ["mug"])
    images = one.engine.counts.images
    PLACES[name] = PLACES["box"]
    try:
        assert one.look(1.2, ["jar", name]) is None
    finally:
        del PLACES[name]
    assert one.engine.counts.refused == 1 and one.engine.counts.images == images and one.engine.counts.resets == 0
    assert "without control characters" in one.engine.complaint
    found = one.look(1.4, ["mug"])
    assert set(found.frame.ids) >= {"mug"} and "jar" not in found.hypotheses


@pytest.mark.parametrize(
    "given", [{"transform_time_offset_s": math.nan}, {"markers_hz": math.inf}, {"cameras": ["cam", "/cam"]}]
)
def test_parameters_that_cannot_be_are_refused(given: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=next(iter(given))):
        configuration(given)


def test_frames_may_begin_with_a_slash() -> None:
    one = robot(odom_frame="/odom", world_frame="/map")
    assert one.drive(0.0, 1.0, ["mug"]) is not None and one.engine.counts.without_odometry == 0


def test_one_of_several_in_an_old_map_is_of_their_class(tmp_path: Path) -> None:
    places = [SE3(SO3(), [0.1, 0.1, 1.0]), SE3(SO3(), [-0.2, 0.25, 1.0])]
    old, new = robot(), robot()
    for i in range(20):
        old.look(0.2 * i, ["mug", "box", "jar"], {"nut": places})
    old.engine.save(str(tmp_path / "old.state"))
    new.engine.load(str(tmp_path / "old.state"))
    for i in range(20):
        new.look(0.2 * i, ["mug", "box", "jar"], {"nut": places[:1]})
    assert "was found" in new.engine.map_state and new.engine._run is not None
    nuts = [model for model in new.engine._run.slam.objects if model.id.startswith("nut")]
    assert len(nuts) > 1 and {model.class_id for model in nuts} == {"nut"}


def test_a_copy_of_a_map_without_its_note_tells_nothing_new(tmp_path: Path) -> None:
    one = robot()
    one.drive(0.0, 2.0, ["mug", "box", "jar"])
    one.engine.save(str(tmp_path / "own.state"))
    shutil.copy(tmp_path / "own.state", tmp_path / "copy.state")
    with pytest.raises(ValueError, match="tells nothing new"):
        one.engine.load(str(tmp_path / "copy.state"))
    other = robot()
    other.engine.load(str(tmp_path / "copy.state"))
    other.drive(0.0, 2.0, ["mug", "box", "jar"])
    assert "was found" in other.engine.map_state
    with pytest.raises(ValueError, match="tells nothing new"):
        other.engine.load(str(tmp_path / "copy.state"))
