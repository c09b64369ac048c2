# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Object SLAM: simulated recordings, settings, live against batch."""

from __future__ import annotations

import copy
import pickle
from itertools import permutations

import numpy as np
import posemix as px
import pytest
from slam_scene import Scene, config, frame_input


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


def test_errors_along_the_viewing_ray_are_fractions_of_the_range() -> None:
    sd = px.SimulationSd(rotation_rad=[1e-3] * 3, translation_m=[1e-4, 1e-4, 0.045])
    mug = px.SimulationObject(id="mug", noise=[px.SimulationNoise(sd=sd, frame=px.NoiseFrame.ray)])
    far = px.SimulationSwing(mean_m=3.0, swing_m=0.5, waves=2)
    setting = px.SimulationConfig(path=px.SimulationPath(frames=500, range=far), objects=[mug])
    sequence = px.simulate(setting, seed=2).sequence
    truth = px.true_relative_pose(sequence, 0).translation
    ranges = np.linalg.norm(truth, axis=1)
    error = sequence.objects[0].detections.translation - truth
    along = (error * truth).sum(axis=1) / ranges**2
    assert along.std() == pytest.approx(0.045, rel=0.15)
    across = np.linalg.norm(error - along[:, None] * truth, axis=1) / ranges
    assert across.max() < 1e-3
    assert px.object_model(mug).noise.components[0].frame == px.NoiseFrame.ray


def moving_config() -> px.SimulationConfig:
    """A box on a conveyor, a mug that a gripper takes, and two cups of one class with false detections."""
    box = px.SimulationObject(id="box", conveyor=[px.SimulationConveyor(start_s=1.0, velocity_m_s=[0.1, 0, 0])])
    mug = px.SimulationObject(id="mug", held=[px.SimulationHeld(frame="gripper", start_s=1.0, stop_s=3.0)])
    cups = [
        px.SimulationObject(id="cup_1", class_id="cup", removed_s=2.0),
        px.SimulationObject(id="cup_2", class_id="cup", hand_held=[px.SimulationHandHeld(reach_m=[0.1, 0.1, 0.1])]),
    ]
    high = px.SimulationPlace(position_m=[0, 0, 0.4])
    low = px.SimulationPlace(position_m=[0.2, 0, 0.1], rotation_rad=[0, 0, 1])
    stops = [px.SimulationWaypoint(time_s=0.5, place=high), px.SimulationWaypoint(time_s=3.5, place=low)]
    return px.SimulationConfig(
        path=px.SimulationPath(frames=40, set_up=px.SimulationSetUp.still, view=px.SimulationView(focal_length_px=300)),
        objects=[box, mug, *cups],
        frames=[px.SimulationFrame(name="gripper", waypoints=stops)],
        clutter=[px.SimulationClutter(class_id="cup", rate_per_image=0.5)],
    )


def test_a_simulation_of_objects_that_move_has_their_truth() -> None:
    simulated = px.simulate(moving_config(), seed=3)
    box = simulated.object_truth["box"]
    np.testing.assert_allclose(box.translation[30] - box.translation[10], [0.2, 0, 0], atol=1e-8)
    grip = (simulated.frame_truth["gripper"].inverse() * simulated.object_truth["mug"])[10:31]
    assert grip.is_approx(grip[0], 1e-7)
    told = simulated.frames["gripper"].translation - simulated.frame_truth["gripper"].translation
    assert 1e-4 < told.std() < 1e-2
    assert px.is_known(simulated.object_truth["cup_1"]).tolist() == [True] * 20 + [False] * 20
    reach = simulated.object_truth["cup_2"].translation
    assert 0.01 < np.abs(reach - reach[0]).max() <= 0.1 + 1e-9


def test_detections_of_a_class_come_without_their_sources() -> None:
    simulated = px.simulate(moving_config(), seed=3)
    names = [{source for source in frame if source} for frame in simulated.sources]
    assert all("cup_1" not in frame for frame in names[20:]) and "cup_2" in set().union(*names)
    assert any(None in frame for frame in simulated.sources)
    models = {model.id: model for model in px.object_models(moving_config())}
    assert models["cup_1"].class_id == "cup"


@pytest.mark.parametrize(
    "tracker",
    [px.MultiObjectSlamSettings(), px.GaussianSumSettings(), px.ParticleFilterSettings(particles=20)],
    ids=["multi_object", "gaussian_sum", "particles"],
)
def test_a_refused_frame_leaves_no_trace(tracker: object) -> None:
    scene = Scene(12, tracker=tracker)
    expected, actual = (px.ObjectSlam(scene.prior, scene.models, scene.settings) for _ in range(2))
    for k in range(12):
        seen = {o.id: o.detections[k] for o in scene.sequence.objects if px.is_known(o.detections)[k]}
        good = frame_input(scene.sequence, k, seen)
        bad = [px.FrameInput(0.1, good.motion, [None]), px.FrameInput(0.1, good.motion, [None] * 3)]
        if k > 0:
            bad += [px.FrameInput(dt, good.motion, seen) for dt in (0.0, -1.0, np.nan, np.inf)]
        for frame in bad:
            with pytest.raises(ValueError, match="frame: "):
                actual.step(frame)
        estimate, wanted = actual.step(good), expected.step(good)
        assert estimate.camera == wanted.camera and estimate.objects == wanted.objects
        assert actual.posterior == expected.posterior


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
