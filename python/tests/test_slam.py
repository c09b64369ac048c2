# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Object SLAM: simulated recordings, live against batch, metrics against numpy."""

from __future__ import annotations

import copy
import os
import pickle
import signal
import threading
import time
from itertools import permutations

import numpy as np
import posemix as px
import pytest


def config(frames: int = 80) -> px.SimulationConfig:
    mug = px.SimulationObject(id="mug", position_m=[0.1, 0, 0], noise=[noise(0.7), noise(0.3, 12.0)])
    box = px.SimulationObject(
        id="box", position_m=[-0.2, 0.1, 0], misses=px.SimulationRuns(fraction=0.3, mean_run_s=0.5)
    )
    return px.SimulationConfig(path=px.SimulationPath(frames=frames), objects=[mug, box])


def noise(weight: float, degrees: float = 4.0) -> px.SimulationNoise:
    sd = px.SimulationSd(rotation_rad=np.full(3, np.radians(degrees)), translation_m=[0.005] * 3)
    return px.SimulationNoise(weight=weight, sd=sd)


class Scene:
    """A simulated recording and what the filter is told."""

    def __init__(self, frames: int = 80, **settings: object) -> None:
        c = config(frames)
        self.simulated = px.simulate(c, seed=3)
        self.sequence = self.simulated.sequence
        self.models = [px.object_model(o) for o in c.objects]
        self.prior = px.camera_prior(c, self.simulated)
        self.settings = px.ObjectSlamSettings(motion=px.motion_settings(c), **settings)

    def run(self, **options: object) -> px.SlamRun:
        return px.run(self.sequence, self.prior, self.models, self.settings, **options)


def frame_input(sequence: px.Sequence, k: int, seen: object) -> px.FrameInput:
    """The frame as a live caller gives it; nothing moves before the first one."""
    if k == 0:
        return px.FrameInput(detections=seen)
    motion = sequence.odometry[k - 1].inverse() * sequence.odometry[k]
    return px.FrameInput(sequence.stamps[k] - sequence.stamps[k - 1], motion, seen)


def test_a_miss_is_a_row_of_nan() -> None:
    poses = px.with_misses([px.SE3(), None, px.SE3(translation=[1.0, 0, 0])])
    assert px.is_known(poses).tolist() == [True, False, True]
    masked = px.with_misses(px.SE3.identity((3,)), known=[True, True, False])
    assert px.is_known(masked).tolist() == [True, True, False]
    again = px.with_misses(poses._data)
    np.testing.assert_array_equal(again._data, poses._data)
    with pytest.raises(ValueError, match="not finite|holds nan"):
        px.with_misses([[np.nan, 0, 0, 0, 0, 0, 1.0]])
    with pytest.raises(ValueError, match=r"known has shape \(2,\); expected \(3,\)"):
        px.with_misses(poses, known=[True, False])


def test_a_sequence_is_checked_and_pickles() -> None:
    scene = Scene(20)
    again = pickle.loads(pickle.dumps(scene.sequence))
    assert repr(again) == "<Sequence of 20 frames over 1.9 s, objects mug, box>"
    np.testing.assert_array_equal(again.objects[1].detections._data, scene.sequence.objects[1].detections._data)
    known = px.is_known(scene.sequence.objects[1].detections)
    assert 0 < known.sum() < 20
    with pytest.raises(ValueError, match="larger than the one before"):
        px.Sequence(np.zeros(3))
    with pytest.raises(ValueError, match="stamps|frames|odometry"):
        px.Sequence(np.arange(3.0), odometry=px.SE3.identity((2,)))


def test_settings_nest_and_are_values() -> None:
    settings = px.ObjectSlamSettings()
    settings.motion.noise.covariance = px.pose_covariance(0.1, 0.2)
    settings.motion.noise.covariance[0, 0] = 7.0
    assert settings.motion.noise.covariance[0, 0] == 7.0
    filter = px.MultiObjectSettings(max_hypotheses=5)
    settings.tracker = px.MultiObjectSlamSettings(filter=filter)
    assert settings.tracker.filter.max_hypotheses == 5
    assert copy.deepcopy(settings) == settings == pickle.loads(pickle.dumps(settings))
    assert settings != px.ObjectSlamSettings()
    assert "covariance=diag([7, 0.01, 0.01, 0.04, 0.04, 0.04])" in repr(settings.motion.noise)
    model = px.ObjectModel(id="mug", independent_start=np.eye(6))
    assert pickle.loads(pickle.dumps(model)) == model
    with pytest.raises(TypeError):
        settings.tracker = px.MotionSettings()
    with pytest.raises(TypeError, match="ObjectModel has no setting 'name'"):
        px.ObjectModel(name="mug")


def test_simulation_repeats_and_its_truth_is_consistent() -> None:
    one, two = Scene(30), Scene(30)
    a, b = (s.sequence.objects[0].detections._data for s in (one, two))
    np.testing.assert_array_equal(a, b)
    truth = px.true_relative_pose(one.sequence, 0)
    camera = one.sequence.camera_truth
    assert (camera * truth).is_approx(px.true_world_pose(one.sequence, 0), 1e-7)
    errors = (truth.inverse() * one.sequence.objects[0].detections).log()
    assert 0.02 < errors[:, :3].std() < 0.4
    with pytest.raises(ValueError, match="frames"):
        px.simulate(config(0), seed=1)


def test_live_equals_batch() -> None:
    scene = Scene()
    run = scene.run()
    slam = px.ObjectSlam(scene.prior, scene.models, scene.settings)
    sequence = scene.sequence
    for k in range(len(sequence)):
        seen = {o.id: o.detections[k] for o in sequence.objects if px.is_known(o.detections)[k]}
        estimate = slam.step(frame_input(sequence, k, seen))
        assert estimate.report.statuses == run[k].report.statuses
        assert estimate.camera == run[k].camera
        assert list(estimate.objects) == ["mug", "box"]
    assert estimate.objects == run[-1].objects
    assert estimate.mode_probabilities == run[-1].mode_probabilities
    mug = estimate.object("mug")
    assert mug.world == estimate.objects["mug"] and mug.relative == estimate.relative["mug"]
    assert mug.mode_probability == estimate.mode_probabilities["mug"]
    assert mug.alternatives == [] and estimate.alternatives == {}
    assert mug.status == estimate.report.statuses[0]
    assert repr(estimate) == "<FrameEstimate of 2 objects, seen: mug, box>"
    with pytest.raises(ValueError, match="no object 'cup', expected one of: mug, box"):
        estimate.object("cup")
    assert slam.posterior == run.posterior
    assert slam.estimate.mean[0].is_approx(run.camera.poses[-1], 1e-12)
    assert slam.pose_index(1) == run.pose_indices[1]
    assert slam.multi_object is not None and slam.multi_object.object_count == 2
    assert slam.detections(0) == int(px.is_known(sequence.objects[0].detections).sum())
    assert repr(slam) == "<ObjectSlam of 2 objects, seen: mug, box>"
    other = copy.copy(slam)
    other.step(px.FrameInput(0.1))
    assert slam.posterior == run.posterior != other.posterior
    with pytest.raises(ValueError, match="no object is called 'cup'; expected one of mug, box"):
        slam.step(px.FrameInput(0.1, None, {"cup": px.SE3()}))
    with pytest.raises(ValueError, match="detections"):
        slam.step(px.FrameInput(0.1, None, [None]))


def test_run_is_arrays() -> None:
    scene = Scene()
    run = scene.run(record_hypotheses=True)
    mug = run.relative("mug")
    assert len(run) == 80 and mug.poses.shape == (80,) and mug.covariances.shape == (80, 6, 6)
    frame = run[-1]
    assert frame.relative["mug"].mean.is_approx(mug.poses[-1], 0.0)
    np.testing.assert_array_equal(frame.relative["mug"].covariance, mug.covariances[-1])
    assert frame.alternatives["mug"][0].probability > 0.5
    assert run.mode_probabilities(0)[-1] == frame.mode_probabilities["mug"]
    assert run.hypotheses("mug")[0].pose.is_approx(run.object(0).poses[-1], 1e-9)
    with pytest.warns(DeprecationWarning, match=r"SlamRun.alternatives is now SlamRun.hypotheses\(object\)"):
        assert run.alternatives == [run.hypotheses(0), run.hypotheses(1)]
    assert (run.seconds[1:] > 0).all()
    first = np.argmax(px.is_known(scene.sequence.objects[1].detections))
    assert run.object("box").known.tolist() == [k >= first for k in range(80)]
    assert "<table>" in run._repr_html_() and "mug" in run._repr_html_()
    for by_id in (run.object, run.hypotheses):
        with pytest.raises(ValueError, match="no object is called 'cup'"):
            by_id("cup")
    for frame in (80, -81):
        with pytest.raises(IndexError, match="of 80"):
            run[frame]


def test_metrics_by_numpy() -> None:
    scene = Scene()
    run = scene.run()
    metrics = px.evaluate(scene.sequence, run)
    camera, truth = run.camera.poses, scene.sequence.camera_truth
    position = np.linalg.norm(camera.translation - truth.translation, axis=1)
    assert metrics.camera.position_rmse_m == pytest.approx(np.sqrt((position**2).mean()))
    angles = (camera.rotation * truth.rotation.inverse()).angle()
    assert metrics.camera.rotation_rmse_deg == pytest.approx(np.degrees(np.sqrt((angles**2).mean())))
    mug = run.relative("mug")
    true_mug = px.true_relative_pose(scene.sequence, 0)
    e = (true_mug * mug.poses.inverse()).log()
    squared = np.einsum("ni,nij,nj->n", e, np.linalg.inv(mug.covariances), e)
    assert metrics.objects[0].relative_anees == pytest.approx(squared.mean() / 6)
    last = px.squared_normalized_error(run[-1].relative["mug"], true_mug[-1])
    assert last == pytest.approx(squared[-1])
    assert metrics.objects[0].relative.position_rmse_m < metrics.objects[0].detection_relative.position_rmse_m
    assert pickle.loads(pickle.dumps(metrics)) == metrics
    assert "mug from the camera" in repr(metrics) and "<table>" in metrics._repr_html_()
    blind = px.Sequence(scene.sequence.stamps, scene.sequence.odometry, None, [
        px.ObjectRecording(o.id, o.detections) for o in scene.sequence.objects
    ])  # fmt: skip
    nothing = px.evaluate(blind, px.run(blind, scene.prior, scene.models, scene.settings))
    assert nothing.camera.position_rmse_m is None
    assert "camera: not known" in repr(nothing)


def test_gaussian_sum_smoothing_particles_and_baselines() -> None:
    scene = Scene(40)
    joint = Scene(40, tracker=px.GaussianSumSettings())
    run = joint.run(record_hypotheses=True)
    assert len(run[-1].hypotheses) == len(run.posterior)
    assert run[-1].mode_probabilities == {"mug": None, "box": None}
    riekf = px.find_slam_method("riekf")
    models = riekf.models(joint.models)
    single = px.run(joint.sequence, joint.prior, models, riekf.settings(joint.settings.motion))
    assert len(single.posterior) == 1 and len(models[0].noise.components) == 1
    tracker = px.ParticleFilterSettings(particles=50)
    particles = px.ObjectSlamSettings(motion=scene.settings.motion, tracker=tracker)
    by_particles = px.run(scene.sequence, scene.prior, scene.models, particles)
    smoothed = px.run_smoothed(scene.sequence, scene.prior, scene.models, settings=scene.settings)
    for result in (single, by_particles, smoothed):
        found = px.evaluate(scene.sequence, result).objects[0]
        assert found.relative.position_rmse_m < 0.02


def test_methods_by_name() -> None:
    names = [method.name for method in px.slam_methods()]
    assert names[0] == "multi_object" and "midway" in names and "rbpf" in names
    mixture = px.find_slam_method("max_mixture")
    assert mixture.tracker.noise_use == px.NoiseUse.most_likely
    assert mixture.title == "max-mixture" and mixture.smoothing is None and mixture.description
    assert px.find_slam_method("smoothed").smoothing == px.SmoothingSettings()
    with pytest.raises(ValueError, match="method 'ekf', expected one of: multi_object, "):
        px.find_slam_method("ekf")
    scene = Scene(5)
    job = px.SlamJob("five", "", scene.sequence, scene.prior, scene.models, scene.settings)
    riekf = job.using("riekf")
    assert riekf.method == "riekf" and len(riekf.models[0].noise.components) == 1
    assert len(px.run(riekf).posterior) == 1
    smoothed = job.using(px.find_slam_method("smoothed"))
    assert smoothed.smoothing == px.SmoothingSettings() and len(px.run(smoothed)) == 5


def test_fixed_lag_smoother_equals_run_smoothed() -> None:
    scene = Scene(30)
    smoothing = px.SmoothingSettings(lag_frames=5)
    run = px.run_smoothed(scene.sequence, scene.prior, scene.models, smoothing, scene.settings)
    smoother = px.FixedLagSmoother(scene.prior, scene.models, smoothing, scene.settings)
    sequence, estimates = scene.sequence, []
    for k in range(len(sequence)):
        seen = px.with_misses(np.stack([o.detections._data[k] for o in sequence.objects]))
        estimate = smoother.step(frame_input(sequence, k, seen))
        assert (estimate is None) == (k < 5)
        estimates += [] if estimate is None else [estimate]
    twin = copy.copy(smoother)
    estimates += smoother.finish()
    assert len(estimates) == 30 and len(twin.finish()) == 5
    for a, b in zip(estimates, run, strict=True):
        assert a.camera.mean.is_approx(b.camera.mean, 1e-9)
    assert smoother.slam.detections(0) == 30 and smoother.joint is not None
    candidate = px.Candidate("mug", px.SE3())
    with pytest.raises(ValueError, match="name a class"):
        smoother.step(px.FrameInput(0.1, None, [None, None], [candidate]))


def test_progress_sees_every_frame_and_can_stop() -> None:
    scene = Scene(40)
    calls: list[tuple[int, int]] = []
    scene.run(progress=lambda done, total: calls.append((done, total)))
    assert calls == [(k + 1, 40) for k in range(40)]
    stopped = scene.run(progress=lambda done, total: done < 10)
    assert len(stopped) == 10 and len(stopped.stamps) == 10
    with pytest.raises(ZeroDivisionError):
        scene.run(progress=lambda done, total: bool(1 // 0))


def test_ctrl_c_stops_a_long_run() -> None:
    scene = Scene(20_000)
    interrupt = threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT))
    interrupt.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            for _ in range(100):
                scene.run()
    finally:
        interrupt.cancel()


def test_other_threads_go_on_during_a_run() -> None:
    scene = Scene(3000)
    counted = [0]
    done = threading.Event()

    def count() -> None:
        while not done.is_set():
            counted[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    before = counted[0]
    scene.run()
    during = counted[0] - before
    done.set()
    thread.join()
    assert during > 5


def test_candidates_of_one_class_become_instances() -> None:
    places = [px.SE3(translation=[x, 0, 1.0]) for x in (-0.2, 0.2)]
    models = [px.ObjectModel(id=f"can_{k}", class_id="can") for k in range(3)]
    prior = px.ConcentratedGaussian(px.SE3(), px.pose_covariance(1e-3, 1e-3))
    slam = px.ObjectSlam(prior, models)
    candidates = [px.Candidate("can", place, 0.9) for place in places]
    report = slam.step(px.FrameInput(detections=[None] * 3, candidates=candidates)).report
    assert [c.status for c in report.candidates] == [px.CandidateStatus.fresh] * 2
    report = slam.step(px.FrameInput(0.1, px.SE3(), [None] * 3, candidates[::-1])).report
    assert [c.object for c in report.candidates] == [1, 0]
    recorded = px.Sequence(
        [0.0, 0.1], px.SE3.identity((2,)),
        objects=[px.ObjectRecording(m.id, px.with_misses([None, None])) for m in models],
        candidates=[candidates, candidates],
    )  # fmt: skip
    run = px.run(recorded, prior, models)
    assert run.object("can_2").known.tolist() == [False, False]
    assert run.relative("can_0").poses[0].is_approx(places[0], 1e-6)


def test_association_by_brute_force() -> None:
    rng = np.random.default_rng(1)
    cost = rng.random((5, 7))
    columns = px.least_cost_assignment(cost)
    best = min(sum(cost[i, c] for i, c in enumerate(p)) for p in permutations(range(7), 5))
    assert cost[range(5), columns].sum() == pytest.approx(best)
    where = px.ConcentratedGaussian(px.SE3(translation=[0, 0, 1.0]), px.pose_covariance(0.02, 0.01))
    noise = px.NoiseComponent(covariance=px.pose_covariance(0.05, 0.01))
    near = px.Candidate("can", px.SE3(translation=[0.005, 0, 1.0]), 0.5)
    far = px.Candidate("can", px.SE3(translation=[0.5, 0, 1.0]), 0.5)
    found = px.associate([where], [far, near], noise)
    assert [a.status for a in found] == [px.CandidateStatus.fresh, px.CandidateStatus.assigned]
