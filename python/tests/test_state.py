# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""States that are saved and loaded, objects that are forgotten, and old maps in new worlds."""

from __future__ import annotations

import copy
import math
import pickle
import threading
from pathlib import Path

import numpy as np
import posemix as px
import pytest
from slam_scene import Scene, frame_input

MUG = px.SE3.exp([0.1, 0.2, 0.3, 0.0, 0.0, 0.6])
BOX = px.SE3.exp([0.3, 0.0, 0.1, 0.2, 0.0, 0.7])
JAR = px.SE3.exp([0.0, 0.4, 0.1, -0.2, 0.1, 0.8])


def seen(name: str, pose: px.SE3, stamp_s: float) -> px.Observation:
    return px.Observation([px.ObservationComponent(pose)], object=name, stamp_s=stamp_s)


def stamped(names: tuple[str, ...] = ("mug", "box")) -> px.StampedSlam:
    start = px.ConcentratedGaussian(px.SE3(), px.pose_covariance(0.001, 0.002))
    return px.StampedSlam(start, [px.ObjectModel(id=name) for name in names])


def give(slam: px.StampedSlam, stamps: np.ndarray) -> None:
    for t in map(float, stamps):
        slam.add_odometry(t, px.SE3.exp([0, 0, 0, 0.01 * t, 0, 0]))
        slam.add(seen("mug", MUG, t + 0.02))
        slam.add(seen("box", BOX, t - 0.03))


def test_a_loaded_state_goes_on_to_the_last_bit(tmp_path: Path) -> None:
    slam = stamped()
    give(slam, np.arange(10.0, 11.0, 0.1))
    path = tmp_path / "map.state"
    slam.save(path)
    assert path.read_bytes() == slam.state_bytes()
    others = [
        px.StampedSlam.load(path),
        px.StampedSlam.load(str(path)),
        px.StampedSlam.from_bytes(slam.state_bytes()),
        pickle.loads(pickle.dumps(slam)),
        copy.deepcopy(slam),
    ]
    for each in (slam, *others):
        each.estimate()
        give(each, np.arange(11.0, 11.5, 0.1))
        each.add(seen("box", BOX, 10.9))  # which is late
        each.estimate()
    assert slam.counts.replayed > 0
    for each in others:
        assert each.state_bytes() == slam.state_bytes()
    assert [path.name for path in tmp_path.iterdir()] == ["map.state"]


def test_frames_go_on_to_the_last_bit(tmp_path: Path) -> None:
    scene = Scene(frames=30)
    slam = px.ObjectSlam(scene.prior, scene.models, scene.settings)
    detections = [track.detections for track in scene.sequence.objects]
    for k in range(30):
        if k == 15:
            slam.save(tmp_path / "map.state")
            loaded = px.ObjectSlam.load(tmp_path / "map.state")
        given = frame_input(scene.sequence, k, [of[k] for of in detections])
        estimate = slam.step(given)
        if k >= 15:
            assert np.array_equal(loaded.step(given).camera.covariance, estimate.camera.covariance)
    assert pickle.loads(pickle.dumps(slam)).state_bytes() == loaded.state_bytes()


def test_only_one_tracker_has_a_state() -> None:
    scene = Scene(frames=3, tracker=px.ParticleFilterSettings())
    slam = px.ObjectSlam(scene.prior, scene.models, scene.settings)
    for refused in (slam.state_bytes, lambda: slam.save("none"), lambda: pickle.dumps(slam), lambda: slam.forget(0)):
        with pytest.raises(ValueError, match="expected the multi-object filter"):
            refused()


def test_what_is_no_state_is_refused(tmp_path: Path) -> None:
    state = stamped().state_bytes()
    with pytest.raises(ValueError, match="not a saved state"):
        px.StampedSlam.from_bytes(b"nothing")
    with pytest.raises(ValueError, match="cut off"):
        px.StampedSlam.from_bytes(state[:-1])
    flipped = bytearray(state)
    flipped[len(state) // 2] ^= 1
    with pytest.raises(ValueError, match="checksum"):
        px.StampedSlam.from_bytes(bytes(flipped))
    with pytest.raises(ValueError, match="one of StampedSlam, expected one of ObjectSlam"):
        px.ObjectSlam.from_bytes(state)
    with pytest.raises(ValueError, match=r"none\.state"):
        px.StampedSlam.load(tmp_path / "none.state")
    with pytest.raises(OSError, match="folder"):
        stamped().save(tmp_path / "folder" / "map.state")


def test_the_head_says_what_a_state_is(tmp_path: Path) -> None:
    slam = stamped()
    slam.save(tmp_path / "map.state")
    info = px.state_info(tmp_path / "map.state")
    assert info == px.state_info(slam.state_bytes())
    assert info.is_stamped and info.version == px.__version__
    assert len(slam.state_bytes()) == 48 + info.payload_bytes
    with pytest.raises(TypeError, match="neither bytes nor a path"):
        px.state_info(3)


def test_differences_of_the_configuration_are_named() -> None:
    assert stamped().configuration_differences(stamped()) == []
    assert stamped().configuration_differences(stamped(("mug", "jar"))) == ["object 'jar'"]
    start = px.ConcentratedGaussian(px.SE3(), px.pose_covariance(0.001, 0.002))
    other = px.ObjectSlamSettings(tracker=px.MultiObjectSlamSettings(confirming_detections=5))
    slam = px.ObjectSlam(start, [px.ObjectModel(id="mug")])
    assert slam.configuration_differences(px.ObjectSlam(start, [px.ObjectModel(id="mug")], other)) == ["settings"]


def test_an_object_is_forgotten_as_of_its_stamp() -> None:
    slam = stamped()
    give(slam, np.arange(10.0, 10.5, 0.1))
    assert slam.finish().estimate.objects["mug"] is not None
    assert slam.forget("mug") == px.StampAdmission.taken
    slam.add(seen("mug", MUG, 10.3))  # from before
    estimate = slam.finish().estimate
    assert estimate.objects["mug"] is None and estimate.objects["box"] is not None
    assert slam.hypotheses("mug") == []
    slam.add(seen("mug", JAR, 10.6))
    assert slam.finish().estimate.object("mug").status == px.DetectionStatus.started
    slam.forget("mug", stamp_s=10.9)
    assert slam.finish().stamp_s == 10.9 and slam.estimate().estimate.objects["mug"] is None
    with pytest.raises(ValueError, match="no object 'cup', expected one of: mug, box"):
        slam.forget("cup")
    start = px.ConcentratedGaussian(px.SE3(), px.pose_covariance(0.001, 0.002))
    live = px.ObjectSlam(start, [px.ObjectModel(id="mug")])
    live.step(px.FrameInput(detections={"mug": MUG}))
    live.forget(0)
    assert live.pose_index(0) is None
    with pytest.raises(ValueError):
        live.forget(1)


def test_an_old_map_is_found_in_a_new_world() -> None:
    old, now = stamped(("mug", "box", "jar")), stamped(("mug", "box", "jar"))
    moved = px.SE3.exp([0, 0, 0.5, 0.2, 0, 0])
    for t in map(float, np.arange(0.0, 1.0, 0.1)):
        for slam in (old, now):
            slam.add_odometry(t, px.SE3())
        for name, pose in (("mug", MUG), ("box", BOX), ("jar", JAR)):
            old.add(seen(name, pose, t))
            if name != "jar":
                now.add(seen(name, moved * pose, t))
    old.estimate()
    now.estimate()
    found = px.relocalise(old, now)
    assert found.outcome == px.RelocaliseOutcome.found
    assert {one.new_object for one in found.agreed} == {"mug", "box"} and found.disagreeing == []
    assert found.new_old.mean.is_approx(moved, 1e-6)
    jar = {one.object: one for one in found.objects}["jar"]
    assert jar.world.mean.is_approx(moved * JAR, 1e-6) and not jar.is_agreed
    assert np.trace(jar.given_camera) < np.trace(jar.world.covariance)
    models = px.models_with_priors(old, found)
    begun = px.ObjectSlam(px.ConcentratedGaussian(px.SE3(), px.pose_covariance(0.001, 0.002)), models)
    assert begun.step(px.FrameInput()).objects["jar"].mean.is_approx(moved * JAR, 1e-6)
    few = px.relocalise(old, now, px.RelocaliseSettings(least_objects=3))
    assert few.outcome == px.RelocaliseOutcome.too_few_shared and few.new_old is None
    with pytest.raises(ValueError, match="too_few_shared, expected found"):
        px.models_with_priors(old, few)
    with pytest.raises(TypeError, match="expected an ObjectSlam or a StampedSlam"):
        px.relocalise(old, "now")
    assert pickle.loads(pickle.dumps(found)) == found


def test_saving_leaves_other_threads_running(tmp_path: Path) -> None:
    slam = stamped()
    give(slam, np.arange(10.0, 12.0, 0.1))
    failed = []

    def save(k: int) -> None:
        try:
            for _ in range(20):
                slam.save(tmp_path / f"{k}.state")
                px.StampedSlam.load(tmp_path / f"{k}.state")
        except Exception as error:  # of a thread, for the test
            failed.append(error)

    threads = [threading.Thread(target=save, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    give(slam, np.arange(12.0, 14.0, 0.1))
    for thread in threads:
        thread.join()
    assert failed == []


def test_a_prior_has_the_density_of_the_package() -> None:
    world = px.ConcentratedGaussian(px.SE3(translation=[0.1, 0.2, 0.3]), px.pose_covariance(math.radians(1.0), 0.002))
    prior = px.ObjectPrior(world=world, probability=0.9)
    assert isinstance(prior.world, px.ConcentratedGaussian)
    assert (prior.world.mean.matrix() == world.mean.matrix()).all()
    assert (prior.world.covariance == world.covariance).all()
    assert "sd 1, 1, 1 deg; 2, 2, 2 mm" in repr(prior) and "probability=0.9" in repr(prior)
    assert prior == copy.deepcopy(prior) == pickle.loads(pickle.dumps(prior))
    assert prior != px.ObjectPrior(world=px.ConcentratedGaussian(px.SE3(), world.covariance), probability=0.9)


def test_a_prior_needs_its_density() -> None:
    with pytest.raises(TypeError, match="ObjectPrior: expected a value of world"):
        px.ObjectPrior(probability=0.9)  # type: ignore[call-arg]
