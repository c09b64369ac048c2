# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""One object that moves: motion models, the filter, the smoother."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import posemix as px
import pytest

STEP = 0.1
CAMERA = px.SE3(rotation=px.SO3.exp([-2.2, 0, 0]), translation=[0, -0.65, 0.45])


def sds(rotation: float, translation: float) -> np.ndarray:
    return np.repeat([rotation, translation], 3)


def noise() -> px.DetectorNoise:
    return px.DetectorNoise(
        [px.NoiseComponent(weight=0.98, covariance=px.pose_covariance(np.radians(2), 0.003))],
        clutter=px.Clutter(weight=0.02, volume_m3=1.0),
    )


def recording(seed: int, count: int = 60) -> tuple[list[px.MovingObjectStep], list[px.SE3]]:
    """An object that stands still, then moves on with a constant twist, and its true poses."""
    rng = np.random.default_rng(seed)
    steps, truth = [], []
    for k in range(count):
        t = STEP * max(0, k - count // 2)
        truth.append(px.SE3(rotation=px.SO3.exp([0.2, 0.1, 0.3 * t]), translation=[0.1 * t, -0.05 * t, 0.02]))
        error = px.SE3.exp(np.concatenate([rng.normal(0, np.radians(2), 3), rng.normal(0, 0.003, 3)]))
        seen = px.ObservationComponent(CAMERA.inverse() * truth[-1] * error)
        steps.append(px.MovingObjectStep(px.Observation([seen], stamp_s=STEP * k), px.exact_camera(CAMERA)))
    return steps, truth


def models() -> px.MotionModels:
    moving = px.ConstantVelocityMotion(acceleration_sds=sds(0.2, 0.05), start_sds=sds(0.5, 0.2))
    return px.MotionModels(
        models=[px.PutDownMotion(), moving], rates=np.array([[0.0, 0.2], [0.2, 0.0]]), start=[0.8, 0.2]
    )


def millimetres(estimate: px.MovingObjectEstimate, truth: px.SE3) -> float:
    return 1e3 * float(np.linalg.norm(estimate.hypotheses[0].world.mean.translation - truth.translation))


def test_a_moving_object_is_followed_and_smoothed() -> None:
    steps, truth = recording(1)
    tracker = px.MovingObjectFilter(px.ObjectSensor(noise=noise()), models())
    assert tracker.time_s is None
    for step in steps:
        report = tracker.update(step.observation, step.camera)
    assert report.right_probability > 0.9 and report.residual.shape == (6,)
    now = tracker.estimate()
    assert now.time_s == tracker.time_s == steps[-1].observation.stamp_s
    assert now.models[1] > 0.9 and millimetres(now, truth[-1]) < 10
    assert now.hypotheses[0].twist[3:] == pytest.approx([0.1, -0.05, 0], abs=0.03)
    total = now.lost_probability + sum(h.probability for h in now.hypotheses)
    assert total == pytest.approx(1)
    ahead = tracker.estimate_at(now.time_s + 0.5).hypotheses[0]
    assert ahead.world.mean.translation[0] > now.hypotheses[0].world.mean.translation[0] + 0.03
    seen = tracker.relative_mixture(px.exact_camera(CAMERA))
    assert len(seen) == len(tracker.object_mixture())

    smoothing = px.smooth_moving_object(px.ObjectSensor(noise=noise()), models(), steps)
    assert len(smoothing.estimates) == len(smoothing.filtered) == len(smoothing.reports) == len(steps)
    filtered = [millimetres(e, pose) for e, pose in zip(smoothing.filtered, truth, strict=True)]
    smoothed = [millimetres(e, pose) for e, pose in zip(smoothing.estimates, truth, strict=True)]
    assert np.mean(smoothed) < 0.9 * np.mean(filtered)
    # The still part is known to be still from its beginning.
    assert smoothing.estimates[5].models[0] > smoothing.filtered[5].models[0]


def test_a_smoother_keeps_the_last_steps() -> None:
    steps, _ = recording(2, 20)
    smoother = px.MovingObjectSmoother(px.ObjectSensor(noise=noise()), models(), most_steps=5)
    for step in steps:
        smoother.update(step.observation, step.camera)
    assert [e.time_s for e in smoother.smoothed()] == [s.observation.stamp_s for s in steps[-5:]]
    assert smoother.filter.observation_count == len(steps)
    with pytest.raises(ValueError, match="most_steps"):
        px.MovingObjectSmoother(px.ObjectSensor(), most_steps=0)


def test_a_smoother_takes_steps_without_observations_and_changes_of_the_camera() -> None:
    steps, _ = recording(3, 20)
    kept = px.MovingObjectSmoother(px.ObjectSensor(noise=noise()), models())
    changed = px.MovingObjectSmoother(px.ObjectSensor(noise=noise()), models())
    for step in steps:
        if step.observation.stamp_s > 1.0:
            kept.predict(step.observation.stamp_s - 0.05)
            changed.predict(step.observation.stamp_s - 0.05, change=1e-4 * np.eye(6))
        kept.update(step.observation, step.camera)
        changed.update(step.observation, step.camera, change=1e-4 * np.eye(6))
    assert len(kept.smoothed()) == len(changed.smoothed()) == 29
    for a, b in zip(kept.smoothed()[12:], changed.smoothed()[12:], strict=True):
        assert np.trace(a.hypotheses[0].world.covariance) < np.trace(b.hypotheses[0].world.covariance)
    indefinite = np.eye(6)
    indefinite[0, 5] = indefinite[5, 0] = 2.0
    with pytest.raises(ValueError, match="semidefinite"):
        kept.predict(5.0, change=indefinite)
    assert kept.filter.time_s == steps[-1].observation.stamp_s


def test_an_object_in_a_gripper_moves_with_it() -> None:
    tracker = px.MovingObjectFilter(px.ObjectSensor(noise=noise()), px.MotionModels(models=[px.AttachedMotion()]))
    for k in range(20):
        gripper = px.SE3(translation=[0.02 * k, 0, 0])
        seen = px.ObservationComponent(CAMERA.inverse() * gripper)
        tracker.update(px.Observation([seen], stamp_s=STEP * k), px.exact_camera(CAMERA), [px.KnownFrame(gripper)])
    later = tracker.estimate_at(2.0, [px.KnownFrame(px.SE3(translation=[0.5, 0, 0]))])
    assert later.hypotheses[0].world.mean.translation == pytest.approx([0.5, 0, 0], abs=0.003)
    with pytest.raises(ValueError, match="frames"):
        tracker.update(px.Observation([seen], stamp_s=3.0), px.exact_camera(CAMERA))


def test_models_and_cameras_are_as_they_were_made() -> None:
    made = models()
    assert made == models() and pickle.loads(pickle.dumps(made)) == made
    assert isinstance(made.models[1], px.ConstantVelocityMotion)
    assert px.StaticMotion() == px.StaticMotion() and list(px.MotionModels().models) == [px.StaticMotion()]
    assert len(px.calm_and_agile().models) == 2
    agile = px.calm_and_agile(px.ConstantVelocityMotion(acceleration_sds=sds(0.1, 0.2))).models[1]
    assert agile.acceleration_sds == pytest.approx(sds(0.5, 1.0))
    density = px.ConcentratedGaussian(CAMERA, px.pose_covariance(0.01, 0.002))
    still, moving = px.still_camera(density), px.camera_on_arm(density)
    assert np.array_equal(still.constant_covariance, density.covariance) and not still.frame.covariance.any()
    assert np.array_equal(moving.frame.covariance, density.covariance) and not moving.constant_covariance.any()
    tracker = px.MovingObjectFilter(px.ObjectSensor(noise=noise()), made)
    twin = copy.copy(tracker)
    step = recording(3, 1)[0][0]
    twin.update(step.observation, step.camera)
    assert tracker.observation_count == 0 and twin.observation_count == 1
    with pytest.raises(ValueError, match="rates"):
        px.MovingObjectFilter(px.ObjectSensor(), px.MotionModels(models=[px.StaticMotion()], rates=np.zeros((2, 2))))


def test_a_moving_object_in_object_slam() -> None:
    """An object of constant velocity and one that a gripper holds, next to one that stands still."""
    velocity = 0.1
    held = px.MotionModels(models=[px.AttachedMotion(frame=0)])
    settings = px.MultiObjectSlamSettings(frames=["gripper"], moving=px.MovingObjectSettings(lost_rate=1e-4))
    objects = [
        px.ObjectModel(id="plate", noise=noise()),
        px.ObjectModel(id="box", noise=noise(), motion=px.MotionModels(models=[px.ConstantVelocityMotion()])),
        px.ObjectModel(id="cup", noise=noise(), motion=held),
    ]
    start = px.ConcentratedGaussian(px.SE3(), px.pose_covariance(1e-3, 1e-3))
    slam = px.ObjectSlam(start, objects, px.ObjectSlamSettings(tracker=settings))
    for k in range(30):
        x = velocity * 0.1 * k
        gripper = px.SE3(translation=[0, x, 0.5])
        seen = {
            "plate": px.SE3(translation=[0.2, 0, 1]),
            "box": px.SE3(translation=[x, 0, 1]),
            "cup": gripper * px.SE3(translation=[0, 0, 0.1]),
        }
        estimate = slam.step(px.FrameInput(0.1, px.SE3(), seen, frames=[px.KnownFrame(gripper)]))
    twist = estimate.object("box").twist
    assert twist is not None and twist.mean[3] == pytest.approx(velocity, abs=0.01)
    later = slam.object_at(1, 1.0)
    assert later is not None and later.mean.translation[0] == pytest.approx(0.29 + velocity, abs=0.02)
    assert estimate.object("cup").world.mean.translation[1] == pytest.approx(0.29, abs=0.01)
    assert estimate.object("plate").twist is None
