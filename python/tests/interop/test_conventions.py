# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
from __future__ import annotations

import numpy as np
import pytest
from .oracle import assert_same, jacobian_of, sampled_covariance

from posemix import SE3, SO3
from posemix.interop import conventions as c
from posemix.interop import euler, mrpt


def test_jacobians_are_numeric_derivatives(pose: SE3) -> None:
    r, t = pose.rotation, pose.translation
    cases = {
        "right": (c.side_jacobian(pose, "right"), lambda d: pose * SE3.exp(d)),
        "additive": (
            c.additive_jacobian(pose), lambda d: SE3(SO3.exp(d[:3]) * r, t + d[3:])
        ),
        "product": (
            c.product_jacobian(pose), lambda d: SE3(r * SO3.exp(d[:3]), t + d[3:])
        ),
        "rpy": (
            euler.rpy_jacobian(pose),
            lambda d: SE3(euler.from_rpy(euler.to_rpy(r) + d[:3]), t + d[3:]),
        ),
        "mrpt": (mrpt.jacobian(pose), lambda d: mrpt.from_pose3d(mrpt.to_pose3d(pose) + d)),
    }  # fmt: skip
    for name, (jacobian, moved) in cases.items():
        np.testing.assert_allclose(jacobian, jacobian_of(moved, pose), atol=1e-8, err_msg=name)


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("order", ["rotation_first", "translation_first"])
def test_density_and_back(pose: SE3, covariance: np.ndarray, side: str, order: str) -> None:
    density = c.density_from(pose, covariance, side=side, order=order)
    mean, back = c.density_to(density, side=side, order=order)
    assert mean.is_approx(pose)
    np.testing.assert_allclose(back, covariance, rtol=0, atol=1e-14)


def test_numbers_of_the_conventions_page() -> None:
    camera = SE3(translation=[10.0, 0.0, 0.0])
    body = np.zeros((6, 6))
    body[2, 2] = np.radians(1.0) ** 2
    left = c.covariance_from(camera, body, side="right", order="rotation_first")
    assert left[2, 2] == pytest.approx(3.046174e-4, rel=1e-6)
    assert left[4, 4] == pytest.approx(3.046174e-2, rel=1e-6)
    assert left[2, 4] == pytest.approx(-3.046174e-3, rel=1e-6)


def test_arrays_are_those_of_single_ones(poses: SE3, covariance: np.ndarray) -> None:
    many = c.covariance_from(poses, covariance, side="right", order="translation_first")
    one = c.covariance_from(poses[3], covariance, side="right", order="translation_first")
    np.testing.assert_array_equal(many[3], one)


def test_tangent_order() -> None:
    vector = np.arange(12.0).reshape((2, 6))
    turned = c.tangent_from(vector, order="translation_first")
    np.testing.assert_array_equal(turned[0], [3, 4, 5, 0, 1, 2])
    np.testing.assert_array_equal(c.tangent_to(turned, order="translation_first"), vector)


@pytest.mark.parametrize("word", ["", "Left", "rotation"])
def test_unknown_words_are_refused(pose: SE3, covariance: np.ndarray, word: str) -> None:
    with pytest.raises(ValueError, match="expected 'left' or 'right'"):
        c.covariance_from(pose, covariance, side=word, order="rotation_first")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="expected 'rotation_first'"):
        c.covariance_to(pose, covariance, side="left", order=word)  # type: ignore[arg-type]


def test_side_and_order_have_no_defaults(pose: SE3, covariance: np.ndarray) -> None:
    with pytest.raises(TypeError, match="side"):
        c.density_from(pose, covariance, order="rotation_first")  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="order"):
        c.density_from(pose, covariance, side="left")  # type: ignore[call-arg]


def test_mrpt_samples_have_the_converted_covariance(pose: SE3, covariance: np.ndarray) -> None:
    values = mrpt.to_pose3d(pose)
    density = mrpt.from_gaussian(values, covariance)
    drawn = sampled_covariance(lambda d: mrpt.from_pose3d(values + d), pose, covariance)
    assert_same(density.covariance, drawn, 0.05)
    mean, back = mrpt.to_gaussian(density)
    np.testing.assert_allclose(mean, values, atol=1e-12)
    np.testing.assert_allclose(back, covariance, atol=1e-14)


def test_reordering_alone_is_not_mrpt(pose: SE3, covariance: np.ndarray) -> None:
    density = mrpt.from_gaussian(mrpt.to_pose3d(pose), covariance)
    places = [5, 4, 3, 0, 1, 2]
    with pytest.raises(AssertionError):
        assert_same(density.covariance, covariance[np.ix_(places, places)], 0.05)


def test_mrpt_at_a_pitch_of_a_quarter_turn(covariance: np.ndarray) -> None:
    from posemix import ConcentratedGaussian

    upright = SE3(euler.from_rpy([0.0, np.pi / 2, 0.4]))
    assert euler.from_rpy(euler.to_rpy(upright.rotation)).is_approx(upright.rotation, 1e-6)
    with pytest.raises(ValueError, match="quarter turn"):
        mrpt.to_gaussian(ConcentratedGaussian(upright, covariance))
