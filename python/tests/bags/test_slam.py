# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from .bag_maker import KINDS, T_BASE_CAMERA, T_ODOM_OBJECT, BagMaker, base_at

from posemix import (
    SE3,
    SO3,
    GaussianSumSettings,
    MotionModel,
    MultiObjectSlamSettings,
    ObjectModel,
    ObjectSlamSettings,
    SymmetryGroup,
    TrackHealth,
    bags,
)
from posemix.live_view import LiveRecording


@pytest.mark.parametrize("kind", KINDS)
def test_from_bag_to_bag(drive: Callable[..., Path], tmp_path: Path, kind: Any) -> None:
    out = tmp_path / ("out.bag" if kind == "ros1" else "out")
    found = bags.run_slam(
        drive(kind), out, detections="/objects", odometry="/odom", storage=kind
    )
    assert [model.id for model in found.models] == ["7", "9"]
    seconds = np.arange(20) / 10 + 0.013
    assert found.camera.poses.is_approx(base_at(seconds) * T_BASE_CAMERA, 1e-4)
    for track in found.objects:
        assert track.poses.is_approx(SE3.identity(20) * T_ODOM_OBJECT[track.name], 1e-3)
        written = bags.read_track(out, track.name)
        assert written.class_id == track.name
        assert written.poses.is_approx(track.poses, 1e-12)
        assert [len(m) for m in written.mixtures] == [len(m) for m in track.mixtures]
        assert written.states == track.states
        # The mode of a typical detector is certain only after some of its mode times.
        assert {state.health for state in track.states[-5:]} <= {TrackHealth.good, TrackHealth.ambiguous}
        assert (track.states[-1].existence or 0.0) > 0.95 and not track.moves
    # What 20 detections say is surer than what one says.
    first, last = (np.trace(track.covariances[i]) for i in (0, -1))
    assert last < first


def test_flips_are_the_results_of_a_detection(maker: Callable[[str], BagMaker]) -> None:
    """A detector that flips every other time: both ways round stay in the mixture."""
    bag = maker("mcap")
    flip = SE3(SO3.exp([0.0, 0.0, np.pi]))
    pose = SE3(translation=[0.0, 0.0, 1.0])
    for i in range(20):
        bag.odometry(i / 10, SE3())
        bag.detections(i / 10, "base", {"7": pose * flip if i % 2 else pose})
    found = bags.run_slam(bag.write(), detections="/objects", odometry="/odom")
    mixture = found.objects[0].mixtures[-1]
    assert len(mixture) >= 2
    angles = [(pose.inverse() * density.mean).rotation.angle() for density in mixture]
    assert min(angles) < 0.1
    assert max(angles) > 3.0


def test_views_see_every_estimate_of_a_bag(drive: Callable[..., Path], tmp_path: Path) -> None:
    """What views are shown is what the run returns, with the detections of the frame."""
    path = drive("mcap")
    alone = bags.run_slam(path, detections="/objects", odometry="/odom")
    with LiveRecording(tmp_path / "a") as one, LiveRecording(tmp_path / "b") as other:
        found = bags.run_slam(path, detections="/objects", odometry="/odom", view=[one, other])
        assert one.frames == other.frames == 20
        one.write_results()
    np.testing.assert_array_equal(found.camera.poses.to_tq(), alone.camera.poses.to_tq())
    trace = json.loads((tmp_path / "a" / "trace.json").read_text())
    np.testing.assert_allclose(trace["camera"]["pose"], found.camera.poses.to_tq(), atol=1e-8)
    recording = found.recording
    np.testing.assert_allclose(trace["stamps_s"], recording.stamps)
    for track in found.objects:
        shown = trace["objects"][track.name]
        np.testing.assert_allclose(shown["world"]["pose"], track.poses.to_tq(), atol=1e-8)
        rows = [i for i, name in enumerate(recording.detections.class_id) if name == track.name]
        seen = recording.detections.poses[np.array(rows)].to_tq()
        np.testing.assert_allclose(np.abs(shown["detection"]), np.abs(seen), atol=1e-8)
        assert shown["health"] == [state.health.name for state in track.states]
    with pytest.raises(ValueError, match="a view is of the multi-object filter"):
        settings = ObjectSlamSettings(tracker=GaussianSumSettings())
        bags.track_objects(recording, settings=settings, view=one)


def test_two_of_a_class(maker: Callable[[str], BagMaker]) -> None:
    bag = maker("mcap")
    places = [SE3(translation=[-0.2, 0.0, 1.0]), SE3(translation=[0.2, 0.0, 1.0])]
    for i in range(12):
        bag.odometry(i / 10, SE3())
        bag.detections(i / 10, "base", {"7": places[0]})
        message = bag.rows[-1][3]
        bag.rows.pop()
        bag.detections(i / 10, "base", {"7": places[1]})
        bag.rows[-1][3].detections.extend(message.detections)
    found = bags.run_slam(bag.write(), detections="/objects", odometry="/odom")
    assert [track.name for track in found.objects] == ["7_1", "7_2"]
    ends = sorted(track.poses.translation[-1, 0] for track in found.objects)
    np.testing.assert_allclose(ends, [-0.2, 0.2], atol=0.02)
    settings = ObjectSlamSettings(tracker=GaussianSumSettings())
    with pytest.raises(ValueError, match="class '7' has several models"):
        bags.track_objects(found.recording, settings=settings)


def test_models_of_ones_own(drive: Callable[..., Path], tmp_path: Path) -> None:
    mug = ObjectModel(id="mug", class_id="7", symmetries=SymmetryGroup(SE3(SO3.exp([[0, 0, np.pi]]))))
    path, out = drive("sqlite3"), tmp_path / "out"
    for tracker in (MultiObjectSlamSettings(), GaussianSumSettings()):
        found = bags.run_slam(
            path,
            detections="/objects",
            odometry="/odom",
            models=[mug],
            settings=ObjectSlamSettings(tracker=tracker),
        )
        assert found.ignored == {"9": 20}
        assert [track.name for track in found.objects] == ["mug"]
        assert found.objects[0].poses[-1].is_approx(T_ODOM_OBJECT["7"], 1e-3)
    out.mkdir()
    with pytest.raises(FileExistsError, match="something already"):
        bags.run_slam(path, out, detections="/objects")


def test_without_odometry(maker: Callable[[str], BagMaker]) -> None:
    bag = maker("mcap")
    for i in range(10):
        bag.detections(i / 10, "camera", {"7": SE3(translation=[0.0, 0.0, 1.0])})
    found = bags.run_slam(bag.write(), detections="/objects")
    assert found.camera.poses[-1].is_approx(SE3(), 0.05)


def test_poses_that_are_given_are_read(maker: Callable[[str], BagMaker]) -> None:
    bag, place = maker("mcap"), SE3(translation=[0.0, 0.0, 1.0])
    for i in range(10):
        pose = SE3.exp([0.0, 0.0, 0.1 * i, 0.5 * i, 0.0, 0.0])
        bag.odometry(i / 5, pose)
        bag.detections(i / 5, "base", {"7": pose.inverse() * place})
    settings = ObjectSlamSettings()
    motion = settings.motion
    motion.model = MotionModel.given
    settings.motion = motion
    found = bags.run_slam(bag.write(), detections="/objects", odometry="/odom", settings=settings)
    assert found.camera.poses[-1].is_approx(pose, 1e-3)
    assert found.objects[0].poses[-1].is_approx(place, 1e-3)


def test_messages_without_detections_are_images(maker: Callable[[str], BagMaker]) -> None:
    """An object alone in view that is not detected any more is lost, where the detector says so."""

    def last_health(empty_messages: bool) -> TrackHealth:
        bag = maker("mcap")
        bag.path = bag.path.parent / f"empty-{empty_messages}"
        pose = SE3(translation=[0.0, 0.0, 1.0])
        for i in range(60):
            bag.odometry(i / 5, SE3())
            if i < 30 or empty_messages:
                bag.detections(i / 5, "base", {"7": pose} if i < 30 else {})
        found = bags.run_slam(bag.write(), detections="/objects", odometry="/odom")
        return found.objects[0].states[-1].health

    assert last_health(empty_messages=True) == TrackHealth.lost
    assert last_health(empty_messages=False) in {TrackHealth.good, TrackHealth.ambiguous}


def test_stopped_by_progress(drive: Callable[..., Path]) -> None:
    calls: list[tuple[int, int]] = []

    def progress(done: int, total: int) -> bool:
        calls.append((done, total))
        return done < 5

    found = bags.run_slam(
        drive("mcap"), detections="/objects", odometry="/odom", progress=progress
    )
    assert calls == [(i, 20) for i in range(1, 6)]
    assert len(found.camera.stamps_ns) == 5
