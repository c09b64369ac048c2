# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Results are values of classes that C++ makes: documented, immutable, comparable, picklable."""

from __future__ import annotations

import copy
import dataclasses
import doctest
import inspect
import pickle
from typing import Any

import numpy as np
import posemix as px
import pytest
from conftest import two_modes
from posemix import _core


def records() -> list[Any]:
    """One result of each kind that is quick to make."""
    mixture = two_modes()
    camera = px.ConcentratedGaussian(px.SE3(), px.pose_covariance(0.01, 0.01))
    tracker = px.MultiObjectFilter(camera, [px.ObjectSensor()])
    report = tracker.update(0, px.SE3(translation=[0, 0, 0.8]))
    joint = px.GaussianSumFilter(camera)
    joint.add_object(px.SE3(translation=[0, 0, 0.8]), px.default_detector_noise())
    seen = px.Detection(1, px.SE3(translation=[0, 0, 0.81]), px.default_detector_noise())
    settings = px.ReductionSettings(max_components=1, bound_loss=True)
    return [
        px.reduce(mixture, settings),
        px.reduce(mixture, settings).report,
        px.merge(list(mixture), mixture.weights),
        px.moments(mixture),
        px.fuse(mixture, mixture),
        px.fuse(mixture[0], mixture[1]),
        px.kl_monte_carlo(mixture, mixture, seed=1),
        px.to_projected(mixture, seed=1),
        px.fit_mixture(mixture.sample(500, seed=1), px.EmSettings(), seed=1),
        px.fit_mixture_by_bic(mixture.sample(500, seed=1), px.EmSettings(components=2), seed=1),
        px.success_probability(mixture, px.ToleranceBox(0.1, 0.01), px.SE3(), seed=1),
        px.best_grasp(mixture, px.ToleranceBox(0.1, 0.01), seed=1),
        report,
        tracker.hypotheses(0)[0],
        seen,
        joint.update([seen]),
        *recordings(),
        *learned(),
        *fiducials(),
        px.find_slam_method("smoothed"),
        px.symmetric_pose_error(px.SE3(), px.SE3(translation=[0, 0, 1.0]), px.SymmetryGroup()),
        px.PlattCalibration(2.0),
        px.LogisticModel([1.0, 2.0], bias=0.5),
        px.reliability([0.2, 0.3], [True, False], bins=1)[0],
        px.ToleranceBox(0.1, [1.0, 2.0, 3.0]),
        px.NamedPose("camera", px.PoseKind.camera),
        px.MixtureFile("a", "b", mixture),
        px.StampedPoses([0.0, 1.0], px.with_misses([px.SE3(), None])),
    ]


def recordings() -> list[Any]:
    """A recording of one object, a job with it, and an estimate from it."""
    camera = px.ConcentratedGaussian(px.SE3(), px.pose_covariance(0.01, 0.01))
    candidate = px.Candidate("mug", px.SE3(), score=0.5)
    detections = px.with_misses([px.SE3(translation=[0, 0, 0.8]), None])
    mug = px.ObjectRecording("mug", detections, world_truth=px.SE3.identity((2,)))
    sequence = px.Sequence([0.0, 0.1], px.SE3.identity((2,)), objects=[mug], candidates=[[candidate], []])
    job = px.SlamJob("one", "", sequence, camera, [px.ObjectModel(id="mug")], px.ObjectSlamSettings())
    seen = px.FrameInput(detections={"mug": detections[0]})
    estimate = px.ObjectSlam(camera, job.models, px.ObjectSlamSettings(record_hypotheses=True)).step(seen)
    single = px.find_slam_method("riekf").settings()
    single.record_hypotheses = True
    joint = px.ObjectSlam(camera, job.models, single).step(seen)
    one = estimate.object("mug")
    placed = px.ConcentratedGaussian(detections[0], px.pose_covariance(0.01, 0.01))
    association = px.associate([placed], [px.Candidate("mug", detections[0])], px.NoiseComponent())[0]
    return [candidate, mug, sequence, job, seen, estimate, estimate.report, one, one.alternatives[0],
            joint, joint.hypotheses[0], association]  # fmt: skip


def learned() -> list[Any]:
    """The noise of a detector and of grasps."""
    rng = np.random.default_rng(1)
    truth = px.SE3(translation=np.tile([0.0, 0.0, 1.0], (60, 1)))
    errors = rng.normal(size=(60, 6)) * 0.01
    settings = px.NoiseFitSettings(max_components=1, frame=px.NoiseFrame.object)
    noise = px.fit_noise(truth, truth * px.SE3.exp(errors), settings=settings)
    mixture = px.fit_error_mixture(errors, seed=1)
    consensus = px.fuse_estimates(px.SE3(translation=[0, 0, 1.0]), mixture.errors, seed=1)
    return [noise, noise.fits[0], noise.correlation, noise.correlation.inlier, mixture, consensus]


def fiducials() -> list[Any]:
    """Parts of a rig that sees tags."""
    model = px.CameraModel([600.0, 600.0, 320.0, 240.0], px.DistortionModel.radtan, [0.1, 0.0, 0.0, 0.0])
    corners = [[500.2, 300.1], [531.5, 301.9], [532.3, 270.4], [500.9, 268.8]]
    stated = px.StatedPose(px.SE3(), np.eye(6))
    minima = px.tag_minima(corners, 0.15, model)
    return [model, px.CornerNoise(0.3), stated, px.RigCamera("left", model, (640, 480), ["/tags"], stated),
            px.TagMap({1: 0.2}, 0.1, {4}, {1: stated}), px.CornerSighting(0.5, "/tags", 1, corners), minima[0],
            px.fit_corner_noise([minima])]  # fmt: skip


def named(record: Any) -> str:
    return type(record).__name__


@pytest.mark.parametrize("record", records(), ids=named)
def test_a_result_is_a_documented_value(record: Any) -> None:
    cls = type(record)
    fields = [name for name, value in vars(cls).items() if isinstance(value, property)]
    assert fields and "Attributes\n----------" in cls.__doc__
    for name in fields:
        assert getattr(cls, name).__doc__, f"{named(record)}.{name} has no text"
        with pytest.raises(AttributeError):
            setattr(record, name, getattr(record, name))
    for other in (copy.copy(record), copy.deepcopy(record), pickle.loads(pickle.dumps(record))):
        assert other == record and repr(other) == repr(record)
    assert record != 1 and named(record) in repr(record)


def test_what_python_may_make_is_as_a_dataclass() -> None:
    candidate = px.Candidate("mug", camera_object=px.SE3())
    assert candidate.score == 0.0 and "Attributes" in px.Candidate.__doc__
    better = dataclasses.replace(candidate, score=2.0)
    assert better.score == 2.0 and better.class_id == "mug" and better != candidate
    assert better == candidate.replace(score=2.0)
    assert [field.name for field in dataclasses.fields(px.Candidate)] == ["class_id", "camera_object", "score"]
    with pytest.raises(TypeError, match="Candidate needs 'camera_object'"):
        px.Candidate("mug")
    with pytest.raises(TypeError, match="got two values of 'class_id'"):
        px.Candidate("mug", px.SE3(), class_id="box")
    with pytest.raises(TypeError, match="takes 3 values; got 4"):
        px.Candidate("mug", px.SE3(), 1.0, 2.0)
    with pytest.raises(TypeError, match="score is 'high'; expected float"):
        px.Candidate("mug", px.SE3(), "high")


def test_results_hold_the_package_s_densities() -> None:
    fused = px.fuse(two_modes(), two_modes())
    assert isinstance(fused, px.FuseResult) and isinstance(fused.density, px.Mixture)
    assert fused.iterations is None and fused.second is None
    assert isinstance(fused.density[0], px.ConcentratedGaussian)
    assert isinstance(px.moments(two_modes()).density.mean, px.SE3)


def test_two_opposite_densities_fuse_in_two_modes() -> None:
    half_turn = px.SO3.exp([0, 0, np.pi])
    wide = [px.ProjectedGaussian.at_mean(r, np.eye(3)) for r in (px.SO3(), half_turn)]
    fused = px.fuse(*wide)
    assert fused.second is not None and isinstance(fused.second.density, px.ProjectedGaussian)
    assert fused.second.log_overlap == pytest.approx(fused.log_overlap, abs=1e-6)


def test_bounds_of_em_are_in_its_units() -> None:
    samples = two_modes().sample(200, seed=1)
    unit = [0.1, 0.1, 0.1, 0.01, 0.01, 0.01]
    fit = px.fit_mixture(samples, px.EmSettings(unit=unit, min_sd=10.0, max_sd=10.0), seed=1)
    sds = np.sqrt(np.diagonal(fit.mixture[0].covariance))
    np.testing.assert_allclose(sds, 10.0 * np.array(unit), rtol=1e-9)


def documented() -> list[doctest.DocTest]:
    finder = doctest.DocTestFinder(exclude_empty=True)
    found = []
    for name, value in vars(_core).items():
        if inspect.isclass(value) or callable(value):
            found += finder.find(value, name, module=False, globs={})
    return [test for test in found if test.examples]


@pytest.mark.parametrize("test", documented(), ids=lambda test: test.name)
def test_examples_of_compiled_docstrings_run(test: doctest.DocTest) -> None:
    assert doctest.DocTestRunner().run(test).failed == 0


def test_what_python_made_cannot_be_changed_in_place() -> None:
    """A change would be made to a copy alone, and be lost."""
    candidate = px.Candidate("mug", px.SE3())
    frame = px.FrameInput(dt=0.1, detections={"mug": px.SE3()}, candidates=[candidate], images=["left"])
    assert frame.candidates == (candidate,) and frame.images == ("left",)
    assert list(frame.detections) == ["mug"] and isinstance(frame.detections, dict)
    for change in ("frame.candidates.append(candidate)", "frame.images.append('right')"):
        with pytest.raises(AttributeError, match="append"):
            eval(change, {"frame": frame, "candidate": candidate})
    for change in ("x['cup'] = pose", "del x['mug']", "x.clear()", "x.update(cup=pose)", "x |= {'cup': pose}"):
        with pytest.raises(TypeError, match="is a copy that cannot be changed"):
            exec(change, {"x": frame.detections, "pose": px.SE3()})
    track = px.ObjectRecording("mug", px.SE3.identity((5,)))
    sequence = px.Sequence(np.arange(5.0), px.SE3.identity((5,)), objects=[track], candidates=[[candidate]] * 5)
    assert sequence.objects == (track,) and sequence.candidates == ((candidate,),) * 5
    with pytest.raises(ValueError, match="read-only"):
        sequence.stamps[:] = 0
    tags = px.TagMap({1: 0.2}, 0.1, {4})
    assert tags.ignored == {4} and isinstance(tags.ignored, frozenset) and tags.size_m == {1: 0.2}


def test_what_was_made_takes_its_own_values_back() -> None:
    """Tuples and frozen dicts as well as lists and dicts."""
    made = [px.FrameInput(dt=0.1, detections={"mug": px.SE3()}, images=["left"]), px.TagMap({1: 0.2}, 0.1, {4})]
    made += [record for record in records() if isinstance(record, (px.Sequence, px.FrameInput, px.CameraModel))]
    for record in made:
        fields = {field.name: getattr(record, field.name) for field in dataclasses.fields(record)}
        assert record.replace(**fields) == record == type(record)(**fields)
        assert pickle.loads(pickle.dumps(record)) == record == copy.deepcopy(record)
        for value in fields.values():
            assert type(copy.deepcopy(value)) is type(pickle.loads(pickle.dumps(value))) is type(value)
    assert made[0].replace(detections={"mug": px.SE3()}, images=["left"]) == made[0]
    assert dataclasses.asdict(made[0])["images"] == ("left",)


def test_the_text_of_a_result_has_the_values_of_its_attributes() -> None:
    light = px.Mixture(list(two_modes()), [1.0, 1e-8])
    report = px.reduce(light, px.ReductionSettings(prune_below=1e-4)).report
    assert report.destination == [0, None]
    assert "destination=[0, None]" in repr(report)
