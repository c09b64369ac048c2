# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Filters, noise and symmetries: against closed forms and numpy."""

from __future__ import annotations

import copy
import json
import math
import pickle

import numpy as np
import posemix as px
import pytest

SD = px.pose_covariance(0.02, 0.01)


def noise(*weights: float, clutter: float = 0.0) -> px.DetectorNoise:
    components = [px.NoiseComponent(weight=w, covariance=SD * 4**k) for k, w in enumerate(weights)]
    return px.DetectorNoise(components, px.Clutter(weight=clutter, volume_m3=2.0))


def test_detector_noise_is_a_value() -> None:
    mixed = noise(0.6, 0.3, clutter=0.1)
    assert [c.weight for c in mixed.components] == pytest.approx([0.6, 0.3])
    assert mixed.log_clutter_density == pytest.approx(math.log(0.1 / (8 * math.pi**2 * 2.0)))
    assert pickle.loads(pickle.dumps(mixed)) == mixed == copy.copy(mixed)
    assert mixed != noise(0.6, 0.4)
    assert repr(mixed) == "<DetectorNoise of 2: 0.6 object, 0.3 object; clutter 0.1>"
    single = mixed.single_gaussian().components[0].covariance
    np.testing.assert_allclose(single, SD * (0.6 + 4 * 0.3) / 0.9)
    with pytest.raises(ValueError, match="weight"):
        noise(-1.0)


def test_components_hold_poses_and_optional_arrays() -> None:
    offset = px.SE3(px.SO3.exp([0, 0, 1.0]), [0.1, 0, 0])
    component = px.NoiseComponent(offset=offset, frame=px.NoiseFrame.ray)
    assert component.offset.is_approx(offset, 0.0)
    model = px.ObjectModel(id="mug")
    assert model.independent_start is None
    model.independent_start = 2 * SD
    assert pickle.loads(pickle.dumps(model)) == model
    np.testing.assert_array_equal(model.independent_start, 2 * SD)
    component.run_length = 4.0
    again = pickle.loads(pickle.dumps(component))
    assert again == component
    with pytest.raises(TypeError, match="offset is of type int; expected an SE3 or a matrix"):
        px.NoiseComponent(offset=3)


def test_noise_of_the_ray_is_in_metres_along_the_camera() -> None:
    ray = px.NoiseComponent(covariance=px.pose_covariance(0.1, [0.01, 0.01, 0.05]), frame=px.NoiseFrame.ray)
    ahead = px.along_camera(ray, px.SE3(translation=[0, 0, 2.0]))
    expected = px.pose_covariance(0.1, [0.02, 0.02, 0.1])
    np.testing.assert_allclose(ahead.covariance, expected, atol=1e-15)
    assert px.default_detector_noise().components[0].frame == px.NoiseFrame.ray


def turn(degrees: float, axis: list[float]) -> px.SE3:
    return px.SE3(px.SO3.exp(math.radians(degrees) * np.array(axis)))


def test_closest_is_the_least_over_the_group() -> None:
    quarter = [turn(90 * k, [0, 0, 1.0]) for k in range(1, 4)]
    elements = px.SE3.from_tq([g.to_tq() for g in quarter])
    group = px.SymmetryGroup(elements)
    assert len(group.elements) == 4
    rng = np.random.default_rng(1)
    poses = px.SE3.exp(rng.normal(size=(30, 6)))
    references = px.SE3.exp(rng.normal(size=(30, 6)))
    weight = np.diag([4.0, 4, 1, 9, 9, 9])
    found = group.closest(poses, references, weight)
    costs = []
    for g in group.elements:
        z = ((poses * g).inverse() * references).log()
        costs.append(np.einsum("ni,ij,nj->n", z, weight, z))
    z = (found.inverse() * references).log()
    got = np.einsum("ni,ij,nj->n", z, weight, z)
    np.testing.assert_allclose(got, np.min(costs, axis=0), rtol=1e-9)


def test_what_is_not_observed_makes_no_error_smaller() -> None:
    axes = [px.SymmetryAxis(direction=d) for d in ([1.0, 0, 0], [0, 0, 1.0])]
    ball = px.SymmetryGroup(axes=axes)
    rng = np.random.default_rng(2)
    places = np.tile([0.1, 0.0, 0.0], (20, 1))
    seen = px.SE3(px.SO3.exp(rng.normal(size=(20, 3))), places)
    covariance = px.pose_covariance([0.1, 0.1, 0.1], [0.01, 0.01, 0.2])
    nearest = ball.closest_observed(
        seen, px.SE3(), np.linalg.inv(covariance + ball.unobserved_covariance())
    )
    np.testing.assert_allclose(nearest.rotation.log(), 0.0, atol=1e-9)
    np.testing.assert_allclose(nearest.translation, places, atol=1e-12)


def test_symmetry_groups_are_values_and_are_checked() -> None:
    axis = px.SymmetryAxis(direction=[0, 0, 2.0], point=[0.1, 0, 5.0])
    group = px.SymmetryGroup(axes=[axis])
    np.testing.assert_allclose(group.axes[0].point, [0.1, 0, 0], atol=1e-12)
    variance = math.pi**2 / 3
    assert group.unobserved_covariance()[2, 2] == pytest.approx(variance)
    assert pickle.loads(pickle.dumps(group)) == group
    assert px.SymmetryGroup().is_trivial and group != px.SymmetryGroup()
    with pytest.raises(ValueError, match="product|missing|group"):
        px.SymmetryGroup(px.SE3.from_tq([turn(90, [0, 0, 1.0]).to_tq()]))


def test_group_of_a_bop_entry() -> None:
    entry = json.loads(
        '{"diameter": 120.0, "symmetries_continuous": [{"axis": [0, 0, 1], "offset": [10, 0, 0]}],'
        ' "symmetries_discrete": [[1,0,0,0, 0,-1,0,0, 0,0,-1,0, 0,0,0,1]]}'
    )
    group = px.SymmetryGroup.from_bop(entry)
    assert len(group.elements) == 2
    np.testing.assert_allclose(group.axes[0].point, [0.01, 0, 0], atol=1e-12)
    with pytest.raises(ValueError, match="diameter"):
        px.SymmetryGroup.from_bop({})


def test_symmetric_errors() -> None:
    group = px.SymmetryGroup(axes=[px.SymmetryAxis()])
    estimate = px.SE3(px.SO3.exp([0, 0, 1.0]), [0.003, 0.004, 0])
    error = px.symmetric_pose_error(estimate, px.SE3(), group)
    assert error.rotation_rad == pytest.approx(0.0, abs=1e-6)
    assert error.translation_m == pytest.approx(0.005)
    ring = [[0.05 * math.cos(a), 0.05 * math.sin(a), 0] for a in np.arange(8)]
    moved = px.max_symmetric_surface_distance(px.SE3(translation=[0, 0, 0.01]), px.SE3(), ring, group)
    assert moved == pytest.approx(0.01, abs=1e-6)


def prior(sd: float = 0.001) -> px.ConcentratedGaussian[px.SE3]:
    return px.ConcentratedGaussian(px.SE3(), px.pose_covariance(sd, sd))


def test_gaussian_sum_start_and_linear_update_by_numpy() -> None:
    settings = px.GaussianSumSettings(update=px.UpdateRule.linearized, summary=px.Summary.best)
    tracker = px.GaussianSumFilter(prior(0.05), settings)
    seen = px.SE3(px.SO3.exp([0.3, -0.2, 0.1]), [0.1, 0.2, 0.9])
    detector = noise(1.0)
    assert tracker.add_object(seen, detector) == 1
    start = tracker.posterior[0]
    adjoint = seen.adjoint()
    p = prior(0.05).covariance
    np.testing.assert_allclose(start.covariance[:6, :6], p, atol=1e-15)
    np.testing.assert_allclose(start.covariance[6:, :6], p, atol=1e-15)
    np.testing.assert_allclose(start.covariance[6:, 6:], p + adjoint @ SD @ adjoint.T, atol=1e-12)
    detection = seen * px.SE3.exp([0.01, 0, 0.02, 0.002, 0, 0])
    report = tracker.update([px.Detection(1, detection, detector)])
    h = np.hstack([-np.eye(6), np.eye(6)])
    at = detection.adjoint()
    residual = (detection * seen.inverse()).log()
    noise_world = seen.adjoint() @ SD @ seen.adjoint().T
    s = h @ start.covariance @ h.T + noise_world
    gain = start.covariance @ h.T @ np.linalg.inv(s)
    joint = px.SE3.exp((gain @ residual).reshape(2, 6)) * start.mean
    assert tracker.posterior[0].mean.is_approx(joint, 2e-4)
    squared = residual @ np.linalg.solve(s, residual)
    log_likelihood = -0.5 * (squared + math.log(np.linalg.det(2 * math.pi * s)))
    assert report.log_evidence == pytest.approx(log_likelihood, abs=0.05)
    assert report.gated == [False] and not at.shape == ()


def test_gaussian_sum_predictions() -> None:
    tracker = px.GaussianSumFilter(prior())
    motion = px.SE3(px.SO3.exp([0, 0, 0.1]), [0.1, 0, 0])
    tracker.predict_with_odometry(motion, SD)
    moved = tracker.posterior[0]
    assert moved.mean[0].is_approx(motion, 1e-12)
    ad = motion.adjoint()
    np.testing.assert_allclose(moved.covariance, prior().covariance + ad @ SD @ ad.T, atol=1e-12)
    other = pickle.loads(pickle.dumps(tracker))
    other.predict(lambda h: px.ConcentratedGaussian(h.mean, 4 * h.covariance))
    np.testing.assert_allclose(other.posterior[0].covariance, 4 * moved.covariance, rtol=1e-12)
    assert tracker.posterior[0] == moved
    other.predict_random_walk(SD)
    with pytest.raises(ValueError, match="camera|pose"):
        tracker.update([px.Detection(3, motion, noise(1.0))])
    with pytest.raises(ZeroDivisionError):
        tracker.predict(lambda h: 1 / 0)


def test_gaussian_sum_branches_and_reduces() -> None:
    tracker = px.GaussianSumFilter(
        prior(), px.GaussianSumSettings(reduction=px.ReductionSettings(max_components=3))
    )
    tracker.add_object(px.SE3(translation=[0, 0, 1.0]), noise(0.7, 0.3))
    report = tracker.update([px.Detection(1, px.SE3(translation=[0, 0, 1.01]), noise(0.7, 0.3))])
    assert len(tracker.posterior) == 3
    assert report.reductions[0].components_before == 4
    assert tracker.summarise().mean.shape == (2,)
    assert repr(tracker) == "<GaussianSumFilter of 3 hypotheses over 2 poses>"


def plain() -> px.MultiObjectSettings:
    """Nothing is learned: independent detections with known noise."""
    return px.MultiObjectSettings(
        noise_scale_detections=math.inf, camera_gain=1.0, camera_rotation_correction=1.0,
        camera_position_correction=1.0,
    )  # fmt: skip


def test_multi_object_filter_averages_like_information() -> None:
    sensor = px.ObjectSensor(noise=noise(0.999, clutter=0.001))
    tracker = px.MultiObjectFilter(prior(1e-6), [sensor], plain())
    rng = np.random.default_rng(2)
    truth = px.SE3(translation=[0.1, 0, 0.8])
    detections = [truth * px.SE3.exp(rng.normal(size=6) * np.sqrt(SD.diagonal())) for _ in range(40)]
    for k, detection in enumerate(detections):
        if k:
            tracker.predict_with_odometry(px.SE3(), px.pose_covariance(1e-6, 1e-6), dt=0.1)
        report = tracker.update(0, detection)
        assert report.started == (k == 0)
    found = tracker.relative(0, tracker.leading(0))
    errors = np.array([(truth.inverse() * d).log() for d in detections])
    estimate = (truth.inverse() * found.mean).log()
    np.testing.assert_allclose(estimate, errors.mean(axis=0), atol=2e-3)
    body = found.body_covariance.diagonal()
    np.testing.assert_allclose(body, SD.diagonal() / 40, rtol=0.15)


def test_multi_object_filter_keeps_two_answers_apart() -> None:
    tracker = px.MultiObjectFilter(prior(), [px.ObjectSensor(noise=noise(0.9, clutter=0.1))] * 2, plain())
    here = px.SE3(translation=[0, 0, 0.8])
    flipped = here * turn(180, [0, 0, 1.0])
    for k in range(12):
        tracker.predict_random_walk(px.pose_covariance(1e-4, 1e-4), dt=0.1)
        tracker.update(0, flipped if k % 3 == 0 else here)
    hypotheses = tracker.hypotheses(0)
    assert len(hypotheses) == 2
    leader = hypotheses[tracker.leading(0)]
    assert leader.pose.rotation.angle() < 0.1
    assert tracker.mode_probability(0) > 0.5
    weights = [h.log_weight for h in hypotheses] + [tracker.log_absent(0)]
    assert np.exp(weights).sum() == pytest.approx(1.0)
    assert tracker.hypotheses(1) == [] and tracker.leading(1) is None
    camera = tracker.camera_mixture
    assert camera.weights.sum() == pytest.approx(1.0)
    mixture = tracker.object_mixture(0)
    assert len(mixture) >= len(tracker.hypotheses(0))
    with pytest.raises(ValueError, match="object 1 has no hypothesis"):
        tracker.object_mixture(1)
    assert repr(tracker) == "<MultiObjectFilter of 2 objects, hypotheses [2, 0]>"
    other = copy.deepcopy(tracker)
    other.forget(0)
    assert other.hypotheses(0) == [] and len(tracker.hypotheses(0)) == 2
    assert tracker.pose_index(0) == 1 and tracker.joint().mean.shape == (2,)


def test_multi_object_filter_refuses() -> None:
    tracker = px.MultiObjectFilter(prior(), [px.ObjectSensor()])
    with pytest.raises(ValueError, match="object"):
        tracker.update(3, px.SE3())
    with pytest.raises(ValueError, match="no.* hypothes|hypotheses; there is none"):
        tracker.relative(0, 0)
    with pytest.raises(ValueError, match=r"q has shape \(3, 3\)"):
        tracker.predict_random_walk(np.eye(3), 0.1)
    with pytest.raises(ValueError):
        px.MultiObjectFilter(prior(), [px.ObjectSensor()], px.MultiObjectSettings(max_hypotheses=0))


def test_a_camera_of_a_rig_is_calibrated() -> None:
    start = px.ConcentratedGaussian(px.SE3(), px.pose_covariance(1e-3, 1e-3))
    truth = px.SE3(px.SO3.exp([0, 0.3, 0]), [0.1, 0, 0])
    off = px.pose_covariance(0.03, 0.02)
    rig = px.MultiObjectFilter(start, [px.ObjectSensor(noise=noise(1.0))])
    stated = px.SE3(px.SO3.exp([0, 0.32, 0]), [0.11, 0, 0])
    assert rig.add_camera(px.ConcentratedGaussian(stated, off)) == 0
    assert rig.extrinsic_count == 1
    seen = px.SE3(px.SO3(), [0, 0, 1])
    second = px.ObservationSource(camera=0)
    for _ in range(20):
        rig.update(0, px.Observation(components=[px.ObservationComponent(pose=seen)]))
        from_second = truth.inverse() * seen
        rig.update(0, px.Observation(components=[px.ObservationComponent(pose=from_second)]), second)
    known = rig.extrinsic(0)
    assert np.trace(known.covariance) < 0.5 * np.trace(off)
    assert np.linalg.norm((known.mean.inverse() * truth).log()) < 0.01
    predicted = rig.predicted_detection(0, 0, second)
    assert predicted.mean.is_approx(truth.inverse() * seen, 0.02)
    with pytest.raises(ValueError, match="there is no camera 1"):
        rig.extrinsic(1)
    with pytest.raises(ValueError, match="too late"):
        rig.add_camera(known)
    camera = px.BodyCamera(name="right", body_camera=stated, covariance=off)
    np.testing.assert_allclose(camera.covariance, off)
    assert px.BodyCamera(name="left").covariance is None


def test_a_group_of_a_wide_tolerance_can_be_copied() -> None:
    nearly_half = px.SE3(px.SO3.exp([[0, 0, np.pi + 0.02]]))
    group = px.SymmetryGroup(nearly_half, tolerance=px.SymmetryTolerance(rotation_rad=0.1))
    model = px.ObjectModel(id="mug", symmetries=group)
    for again in (copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))):
        assert again(group) == group and again(model) == model
    ball = px.SymmetryGroup(axes=[px.SymmetryAxis(direction=axis, point=[0, 0, 0.1]) for axis in np.eye(3)])
    assert pickle.loads(pickle.dumps(ball)).axes == ball.axes


def test_a_fold_that_the_tolerance_cannot_tell_apart_is_refused() -> None:
    assert px.SymmetryGroup.turns([0, 0, 1], 719).elements.shape == (719,)
    for fold in (720, 721, 1000):
        with pytest.raises(ValueError, match=f"{fold} turns .* tolerance of 0.5 deg .* at most 719"):
            px.SymmetryGroup.turns([0, 0, 1], fold)
