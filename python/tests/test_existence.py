# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Existence and health of objects, in estimates, runs and settings."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import posemix as px
import pytest
from slam_scene import Scene

BODY = px.ConcentratedGaussian(px.SE3(), px.pose_covariance(1e-3, 1e-3))
CUP = px.SE3(translation=[0.0, 0.0, 1.0])
NEAR = px.SE3(translation=[0.3, 0.0, 1.0])


def test_settings_hold_distributions() -> None:
    settings = px.ExistenceSettings(object_rate=px.BetaDistribution(a=3, b=2), lifetime_s=60.0)
    assert settings.object_rate == px.BetaDistribution(a=3.0, b=2.0)
    tracker = px.MultiObjectSlamSettings(existence=settings, health=px.HealthSettings(register_again_s=1))
    assert tracker.existence.lifetime_s == 60.0 and tracker.health.register_again_s == 1.0
    assert pickle.loads(pickle.dumps(tracker)) == tracker
    wrong = px.MultiObjectSlamSettings(existence=px.ExistenceSettings(birth_probability=1.5))
    with pytest.raises(ValueError, match="birth_probability is 1.5"):
        px.ObjectSlam(BODY, [px.ObjectModel(id="cup")], px.ObjectSlamSettings(tracker=wrong))


def test_existence_of_one_instance() -> None:
    existence = px.Existence()
    start = existence.probability
    assert start == pytest.approx(px.ExistenceSettings().birth_probability)
    for _ in range(5):
        existence.predict(1.0)
        existence.update(px.Sighting.detected, 1.0)
    assert existence.probability > 0.9 and existence.detection_probability > 0.6
    unseen = copy.copy(existence)
    unseen.update(px.Sighting.out_of_view, 1.0)
    assert unseen.probability == existence.probability
    for _ in range(5):
        existence.predict(1.0)
        existence.update(px.Sighting.missed, 1.0)
    assert existence.visible_probability < 0.5 < unseen.visible_probability
    assert repr(unseen).startswith("<Existence 0.9")
    with pytest.raises(ValueError, match="dt"):
        existence.predict(-1.0)
    with pytest.raises(ValueError, match="lifetime_s is -1"):
        px.Existence(px.ExistenceSettings(lifetime_s=-1))


def test_existence_is_learned() -> None:
    real = [px.InstanceCounts(20.0, 15.0 + i, True) for i in range(4)]
    clutter = [px.InstanceCounts(20.0, 1.0 * i, False) for i in range(4)]
    fitted = px.fit_existence([*real, *clutter], px.ExistenceSettings(lifetime_s=7.0))
    assert fitted.lifetime_s == 7.0
    mean = fitted.object_rate.a / (fitted.object_rate.a + fitted.object_rate.b)
    assert mean > 0.6 > fitted.clutter_rate.a / (fitted.clutter_rate.a + fitted.clutter_rate.b)
    with pytest.raises(ValueError, match=r"\d"):
        px.fit_existence(real)


def cups(**settings: object) -> px.ObjectSlam:
    """Two models of a class, before a camera that stays where it is."""
    models = [px.ObjectModel(id=name, class_id="cup") for name in ("left", "right")]
    return px.ObjectSlam(BODY, models, px.ObjectSlamSettings(motion=px.MotionSettings(), **settings))


def test_what_is_not_seen_any_more_is_lost() -> None:
    slam = cups()
    for _ in range(20):
        both = [px.Candidate("cup", CUP, 1.0), px.Candidate("cup", NEAR, 1.0)]
        estimate = slam.step(px.FrameInput(0.5, px.SE3(), candidates=both))
    assert slam.is_confirmed(0) and slam.is_confirmed(1)
    assert slam.existence(0) == estimate.existences["left"] > 0.95
    assert estimate.healths == {"left": px.TrackHealth.good, "right": px.TrackHealth.good}
    assert estimate.register_again == {"left": False, "right": False}
    assert slam.instance_counts(0).detections == pytest.approx(slam.instance_counts(0).images)
    for _ in range(12):
        left = px.FrameInput(0.5, px.SE3(), candidates=[px.Candidate("cup", CUP, 1.0)])
        estimate = slam.step(left)
    right = estimate.object("right")
    assert right.health == px.TrackHealth.lost and right.register_again
    assert right.existence == estimate.existences["right"]
    assert estimate.object("left").health == px.TrackHealth.good
    assert right.motion_models == [] and right.twist is None
    restored = pickle.loads(pickle.dumps(estimate))
    assert restored == estimate and restored.healths == estimate.healths


def test_images_without_detections_count() -> None:
    seen = px.FrameInput(0.5, px.SE3(), candidates=[px.Candidate("cup", CUP, 1.0)])
    blind, looking = cups(), cups()
    for slam in (blind, looking):
        for _ in range(10):
            slam.step(seen)
    for _ in range(12):
        blind.step(px.FrameInput(0.5, px.SE3()))
        looking.step(px.FrameInput(0.5, px.SE3(), images=[""]))
    assert blind.step(px.FrameInput(0.5, px.SE3())).object("left").health == px.TrackHealth.good
    lost = looking.step(px.FrameInput(0.5, px.SE3(), images=[""]))
    assert lost.object("left").health == px.TrackHealth.lost


def test_objects_ahead_of_time_and_other_trackers() -> None:
    slam = cups()
    assert slam.object_at(0, 1.0) is None and slam.existence(0) is None
    estimate = slam.step(px.FrameInput(candidates=[px.Candidate("cup", CUP, 1.0)]))
    ahead = slam.object_at(0, 1.0)
    assert ahead is not None and ahead.mean.is_approx(estimate.objects["left"].mean, 1e-12)
    with pytest.raises(ValueError, match="dt"):
        slam.object_at(0, -1.0)
    with pytest.raises(ValueError, match="2"):
        slam.existence(2)
    other = px.ObjectSlam(BODY, [px.ObjectModel(id="cup")], px.ObjectSlamSettings(tracker=px.GaussianSumSettings()))
    for ask in (other.existence, other.is_confirmed, other.instance_counts, lambda k: other.object_at(k, 0.0)):
        with pytest.raises(ValueError, match="is there with MultiObjectSlamSettings alone"):
            ask(0)
    frame = other.step(px.FrameInput(detections=[CUP]))
    assert frame.existences == {"cup": None} and frame.healths == {} and frame.register_again == {}


def test_stamped_slam_knows_objects_ahead_of_time() -> None:
    slam = px.StampedSlam(BODY, [px.ObjectModel(id="cup")], motion=px.MotionSettings(model=px.MotionModel.still))
    assert slam.hypotheses("cup") == []
    slam.add(px.Observation([px.ObservationComponent(CUP)], object="cup", stamp_s=1.0))
    found = slam.estimate()
    assert found is not None
    world = found.estimate.objects["cup"]
    ahead = slam.object_at("cup", 1.5)
    assert ahead is not None and ahead.mean.is_approx(world.mean, 1e-12)
    assert slam.hypotheses("cup")[0].pose.is_approx(world.mean, 1e-12)
    for ask in (slam.hypotheses, lambda name: slam.object_at(name, 2.0)):
        with pytest.raises(ValueError, match="mug"):
            ask("mug")


def test_a_given_camera() -> None:
    settings = px.ObjectSlamSettings(motion=px.MotionSettings(model=px.MotionModel.given))
    slam = px.ObjectSlam(BODY, [px.ObjectModel(id="cup")], settings)
    slam.step(px.FrameInput(camera=px.SE3()))
    moved = px.SE3(translation=[0.5, 0.0, 0.0])
    estimate = slam.step(px.FrameInput(0.1, camera=moved))
    assert estimate.camera.mean.is_approx(moved, 1e-3)
    frame = px.FrameInput(0.1, camera=moved, images=["left", "right"])
    assert pickle.loads(pickle.dumps(frame)) == frame and frame.replace(images=[]).images == ()


def test_runs_and_metrics() -> None:
    scene = Scene()
    run = scene.run()
    last = run[-1]
    existences = run.existences("mug")
    assert existences.shape == (80,) and existences[-1] == last.existences["mug"]
    assert np.isnan(existences[: np.argmax(run.object("mug").known)]).all()
    assert run.healths("mug")[-1] == last.healths["mug"]
    assert run.motion_models("mug").shape == (80, 0) and run.twists(0).shape == (80, 0)
    metrics = px.evaluate(scene.sequence, run).objects[0]
    assert metrics.existence == last.existences["mug"] and metrics.health == last.healths["mug"]
    assert sum(metrics.health_shares) == pytest.approx(1.0)
    share = np.mean([health == px.TrackHealth.good for health in run.healths(0)])
    assert metrics.health_shares[2] == pytest.approx(share)
    joint = Scene(10, tracker=px.GaussianSumSettings())
    other = joint.run()
    assert np.isnan(other.existences(0)).all() and set(other.healths(0)) == {px.TrackHealth.none}
    assert px.evaluate(joint.sequence, other).objects[0].health is None
    with pytest.raises(ValueError, match="no object is called 'cup'"):
        run.healths("cup")
