# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Arguments: what is accepted as a pose, and errors that name the argument and what was expected."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import posemix as px
import pytest

CAMERA = px.ConcentratedGaussian(px.SE3(), px.pose_covariance(1e-3, 1e-3))
POSE = px.SE3(px.SO3.exp([0.1, 0.2, 0.3]), [0.1, 0.0, 0.9])
MISS = px.with_misses([None])[0]
STACK = px.SE3.identity((2,))


def slam() -> px.ObjectSlam:
    return px.ObjectSlam(CAMERA, [px.ObjectModel(id="mug")])


def tracker() -> px.MultiObjectFilter:
    return px.MultiObjectFilter(CAMERA, [px.ObjectSensor()])


Take = Callable[[Any], Any]
PLACES: dict[str, tuple[str, Take]] = {
    "motion": ("FrameInput.motion", lambda pose: px.FrameInput(0.1, pose).motion),
    "candidate": ("Candidate.camera_object", lambda pose: px.Candidate("mug", pose).camera_object),
    "by id": (
        r"FrameInput.detections\['mug'\]", lambda pose: px.FrameInput(0.1, None, {"mug": pose}).detections["mug"]
    ),
    "offset": ("NoiseComponent.offset", lambda pose: px.NoiseComponent(offset=pose).offset),
    "update": ("camera_object", lambda pose: tracker().update(0, pose) and POSE),
    "odometry": ("motion", lambda pose: tracker().predict_with_odometry(pose, np.eye(6), 0.1) or POSE),
}


@pytest.mark.parametrize(("name", "take"), PLACES.values(), ids=PLACES)
def test_a_pose_may_be_a_matrix(name: str, take: Take) -> None:
    assert take(POSE).is_approx(POSE, 0.0)
    assert take(POSE.matrix()).is_approx(POSE, 1e-12)
    assert take(POSE.matrix().tolist()).is_approx(POSE, 1e-12)


@pytest.mark.parametrize(("name", "take"), PLACES.values(), ids=PLACES)
def test_what_is_no_pose_is_refused_by_name(name: str, take: Take) -> None:
    reflection = np.diag([-1.0, 1.0, 1.0, 1.0])
    with pytest.raises(ValueError, match=f"{name} is not finite.*expected a pose, or None"):
        take(MISS)
    with pytest.raises(ValueError, match=rf"{name} is an array of poses of shape \(2,\); expected one pose"):
        take(STACK)
    with pytest.raises(ValueError, match=rf"{name} has shape \(3, 3\); expected an SE3 or a matrix of shape \(4, 4\)"):
        take(np.eye(3))
    with pytest.raises(ValueError, match=f"{name} is no pose: "):
        take(reflection)
    with pytest.raises(TypeError, match=f"{name} is of type str; expected an SE3 or a matrix"):
        take("here")


def test_matrices_stand_for_poses_in_arrays() -> None:
    matrices = np.stack([np.eye(4), POSE.matrix()])
    assert px.with_misses(matrices)[1].is_approx(POSE, 1e-12)
    mixed = px.with_misses([POSE.matrix(), None, POSE])
    assert px.is_known(mixed).tolist() == [True, False, True] and mixed[0].is_approx(POSE, 1e-12)
    assert px.Sequence([0.0, 1.0], odometry=matrices).odometry[1].is_approx(POSE, 1e-12)
    estimate = slam().step(px.FrameInput(detections=[POSE.matrix()]))
    assert estimate.objects["mug"].mean.is_approx(POSE, 1e-6)
    with pytest.raises(ValueError, match=r"poses\[1\] has shape \(3, 3\)"):
        px.with_misses([POSE, np.eye(3)])


def test_arguments_of_the_trackers_are_named() -> None:
    mug = px.ObjectModel(id="mug")
    for make in (px.ObjectSlam, lambda c, o: px.FixedLagSmoother(c, o, px.SmoothingSettings())):
        with pytest.raises(TypeError, match="camera is .*SE3; expected a ConcentratedGaussian over one pose"):
            make(px.SE3(), [mug])
        with pytest.raises(TypeError, match=r"objects\[1\] is .*str; expected an ObjectModel"):
            make(CAMERA, [mug, "box"])
        with pytest.raises(TypeError, match="objects is .*ObjectModel; expected a sequence"):
            make(CAMERA, mug)
    with pytest.raises(TypeError, match="camera is .*SE3; expected a ConcentratedGaussian over one pose"):
        px.MultiObjectFilter(px.SE3(), [px.ObjectSensor()])
    with pytest.raises(TypeError, match="prior is .*SE3; expected a ConcentratedGaussian"):
        px.GaussianSumFilter(px.SE3())
    with pytest.raises(TypeError, match="input is .*dict; expected a FrameInput"):
        slam().step({"mug": px.SE3()})
    sequence = px.Sequence([0.0])
    with pytest.raises(TypeError, match="sequence is .*SE3; expected a Sequence or a SlamJob"):
        px.run(px.SE3(), CAMERA, [])
    with pytest.raises(TypeError, match="camera_prior is .*SE3; expected a ConcentratedGaussian"):
        px.run(sequence, px.SE3(), [])
    with pytest.raises(TypeError, match=r"models\[0\] is .*str; expected an ObjectModel"):
        px.run(sequence, CAMERA, ["mug"])


def test_indices_that_do_not_exist_are_refused() -> None:
    live = slam()
    for by_index in (live.detections, live.pose_index):
        for index in (1, 7, 1000):
            with pytest.raises(ValueError, match=f"there is no object {index}"):
                by_index(index)
    of_filter = tracker()
    getters: list[Callable[[int], Any]] = [
        of_filter.noise_scale, of_filter.hypotheses, of_filter.leading, of_filter.mode_probability,
        of_filter.log_absent, of_filter.pose_index, of_filter.forget, lambda index: of_filter.update(index, px.SE3()),
        lambda index: of_filter.relative(index, 0),
    ]  # fmt: skip
    for getter in getters:
        with pytest.raises(ValueError, match="object 7|no object"):
            getter(7)
    of_filter.update(0, POSE)
    with pytest.raises(ValueError, match="there is none at index 5|no hypothesis 5"):
        of_filter.relative(0, 5)


def test_models_of_one_class_must_be_alike() -> None:
    half_turn = px.SymmetryGroup.turns([0, 0, 1.0], 2)
    bolts = [px.ObjectModel(id="a", class_id="bolt"), px.ObjectModel(id="b", class_id="bolt", symmetries=half_turn)]
    with pytest.raises(ValueError, match="'a' and 'b' are of class 'bolt', but their symmetries differ"):
        px.ObjectSlam(CAMERA, bolts)
    noise = px.DetectorNoise([px.NoiseComponent(covariance=px.pose_covariance(0.1, 0.1))])
    bolts[1] = px.ObjectModel(id="b", class_id="bolt", noise=noise)
    with pytest.raises(ValueError, match="'a' and 'b' are of class 'bolt', but their noise models differ"):
        px.ObjectSlam(CAMERA, bolts)
    bolts[1].class_id = "nut"
    px.ObjectSlam(CAMERA, bolts)


NOT_NUMBERS: dict[str, Any] = {
    "dates": np.array([0, 1, 2], dtype="M8[D]"),
    "complex": np.array([0.0, 1.0, 2.0j]),
    "texts": ["0", "1", "2"],
}


@pytest.mark.parametrize("values", NOT_NUMBERS.values(), ids=NOT_NUMBERS)
def test_what_are_no_numbers_is_refused(values: Any) -> None:
    for take in (px.SO3.exp, lambda x: px.SE3(translation=x)):
        with pytest.raises(TypeError, match="has values of the type .*; expected real numbers"):
            take(values)
    with pytest.raises(TypeError, match="covariance has values of the type"):
        px.ConcentratedGaussian(px.SE3(), np.eye(6).astype(complex))


def test_values_that_are_masked_are_none() -> None:
    hidden = np.ma.array([0.0, 1.0, 2.0], mask=[False, True, False])
    with pytest.raises(ValueError, match="translation has values that are masked; expected numbers"):
        px.SE3(translation=hidden)
    shown = np.ma.array([0.0, 1.0, 2.0], mask=False)
    assert px.SE3(translation=shown).is_approx(px.SE3(translation=[0.0, 1.0, 2.0]), 0.0)


def test_integers_and_numbers_of_python_are_numbers() -> None:
    assert np.array_equal(px.SE3(translation=[Fraction(1, 2), 1, True]).translation, [0.5, 1.0, 1.0])
    assert px.SO3.exp(np.zeros((0, 3), dtype=int)).shape == (0,)
