# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Runs over recordings: arrays, metrics against numpy, smoothing, progress."""

from __future__ import annotations

import copy
import os
import pickle
import signal
import threading
import time

import numpy as np
import posemix as px
import pytest
from slam_scene import Scene, frame_input


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
    # A shell starts programs in the background without it.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    interrupt = threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT))
    interrupt.start()
    try:
        with pytest.raises(KeyboardInterrupt):
            for _ in range(100):
                scene.run()
    finally:
        interrupt.cancel()
        signal.signal(signal.SIGINT, before)


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
