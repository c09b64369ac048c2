# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""GTSAM, jaxlie, manif, symforce, pytransform3d, SciPy, navlie: against the packages themselves."""

from __future__ import annotations

import sys
import types
from typing import Any

import numpy as np
import pytest
from .oracle import assert_same, jacobian_of

from posemix import SE3, SO3, ConcentratedGaussian, compose, interop, inverse


def test_gtsam_poses(peer: Any, pose: SE3) -> None:
    gtsam = peer("gtsam", "gtsam")
    theirs = interop.gtsam.to_pose3(pose)
    xi = np.array([0.2, -0.1, 0.4, 1.0, 2.0, -3.0])
    assert interop.gtsam.from_pose3(theirs).is_approx(pose)
    assert interop.gtsam.from_pose3(gtsam.Pose3.Expmap(xi)).is_approx(SE3.exp(xi))
    np.testing.assert_allclose(theirs.AdjointMap(), pose.adjoint(), atol=1e-12)


def test_gtsam_covariance_is_that_of_retract(
    peer: Any, pose: SE3, density: ConcentratedGaussian[SE3]
) -> None:
    peer("gtsam", "gtsam")
    theirs, right = interop.gtsam.to_gaussian(density)
    jacobian = jacobian_of(lambda d: interop.gtsam.from_pose3(theirs.retract(d)), pose)
    assert_same(jacobian @ right @ jacobian.T, density.covariance, 1e-6)
    back = interop.gtsam.from_gaussian(theirs, right)
    assert_same(back.covariance, density.covariance, 1e-12)
    assert back.mean.is_approx(pose)


def test_gtsam_marginal_is_our_composition(
    peer: Any, pose: SE3, covariance: np.ndarray
) -> None:
    gtsam = peer("gtsam", "gtsam")
    first = ConcentratedGaussian(pose, covariance)
    second = ConcentratedGaussian(SE3.exp([0.3, 0.1, -0.5, 1.0, 0.2, 0.4]), 0.5 * covariance)
    graph, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
    prior, step = interop.gtsam.to_gaussian(first), interop.gtsam.to_gaussian(second)
    model = gtsam.noiseModel.Gaussian.Covariance
    graph.add(gtsam.PriorFactorPose3(0, prior[0], model(prior[1])))
    graph.add(gtsam.BetweenFactorPose3(0, 1, step[0], model(step[1])))
    values.insert(0, prior[0])
    values.insert(1, prior[0].compose(step[0]))
    found = gtsam.Marginals(graph, values).marginalCovariance(1)
    theirs = interop.gtsam.from_gaussian(values.atPose3(1), found)
    ours = compose(first, second)
    assert theirs.mean.is_approx(ours.mean)
    assert_same(theirs.covariance, ours.covariance, 1e-9)


def test_jaxlie(peer: Any, poses: SE3, pose: SE3, density: ConcentratedGaussian[SE3]) -> None:
    jaxlie = peer("jaxlie", "jaxlie")
    many = interop.jaxlie.to_se3(poses)
    assert interop.jaxlie.from_se3(many).is_approx(poses, 1e-5)
    np.testing.assert_allclose(many.as_matrix(), poses.matrix(), atol=1e-5)
    xi = np.array([0.2, -0.1, 0.4, 1.0, 2.0, -3.0])
    theirs = jaxlie.SE3.exp(interop.jaxlie.to_tangent(xi))
    assert interop.jaxlie.from_se3(theirs).is_approx(SE3.exp(xi), 1e-5)
    step = np.array([1e-3, -2e-3, 3e-3, 1e-3, 2e-3, -1e-3])
    for side in ("right", "left"):
        mean, covariance = interop.jaxlie.to_gaussian(density, side=side)
        left = interop.conventions.side_jacobian(pose, side) @ interop.jaxlie.from_tangent(step)
        theirs = jaxlie.SE3.exp(step)
        moved = interop.jaxlie.from_se3(theirs @ mean if side == "left" else mean @ theirs)
        if side == "right":
            plus = interop.jaxlie.from_se3(jaxlie.manifold.rplus(mean, step))
            assert plus.is_approx(moved, 1e-5)
        assert moved.is_approx(SE3.exp(left) * pose, 1e-5)
        back = interop.jaxlie.from_gaussian(mean, covariance, side=side)
        assert_same(back.covariance, density.covariance, 1e-5)


def test_manif_has_the_numbers_of_its_headers(
    pose: SE3, density: ConcentratedGaussian[SE3]
) -> None:
    """No package of manif is on PyPI: coefficients and order are checked against its documentation."""
    coeffs, covariance = interop.manif.to_gaussian(density, side="right")
    np.testing.assert_array_equal(coeffs[:3], pose.translation)
    np.testing.assert_array_equal(coeffs[3:], pose.rotation.quaternion)
    order = [3, 4, 5, 0, 1, 2]
    np.testing.assert_allclose(
        covariance, density.body_covariance[np.ix_(order, order)], atol=1e-14
    )
    back = interop.manif.from_gaussian(coeffs, covariance, side="right")
    assert_same(back.covariance, density.covariance, 1e-12)
    xi = np.arange(6.0)
    np.testing.assert_array_equal(interop.manif.from_tangent(interop.manif.to_tangent(xi)), xi)


def test_symforce(peer: Any, pose: SE3, density: ConcentratedGaussian[SE3]) -> None:
    peer("sym", "symforce-sym")
    theirs, covariance = interop.symforce.to_gaussian(density)
    assert interop.symforce.from_pose3(theirs).is_approx(pose)
    np.testing.assert_allclose(theirs.to_homogenous_matrix(), pose.matrix(), atol=1e-12)
    jacobian = jacobian_of(
        lambda d: interop.symforce.from_pose3(theirs.retract(d, epsilon=1e-15)), pose
    )
    assert_same(jacobian @ covariance @ jacobian.T, density.covariance, 1e-6)
    back = interop.symforce.from_gaussian(theirs, covariance)
    assert_same(back.covariance, density.covariance, 1e-12)


def test_pytransform3d(peer: Any, poses: SE3, covariance: np.ndarray) -> None:
    uncertainty = peer("pytransform3d.uncertainty", "pytransform3d")
    transformations = peer("pytransform3d.transformations", "pytransform3d")
    ours = interop.pytransform3d
    xi = np.array([0.2, -0.1, 0.4, 1.0, 2.0, -3.0])
    theirs = transformations.transform_from_exponential_coordinates(
        transformations.exponential_coordinates_from_transform(SE3.exp(xi).matrix())
    )
    assert ours.from_transform(theirs).is_approx(SE3.exp(xi))
    assert ours.from_transform(ours.to_transform(poses)).is_approx(poses)

    T_b_a = ConcentratedGaussian(poses[0], 0.01 * covariance)
    T_c_b = ConcentratedGaussian(poses[1], 0.02 * covariance)
    found = uncertainty.concat_globally_uncertain_transforms(
        *ours.to_gaussian(T_b_a, side="left"), *ours.to_gaussian(T_c_b, side="left")
    )
    expected = compose(T_c_b, T_b_a)
    assert_same(ours.from_gaussian(*found, side="left").covariance, expected.covariance, 1e-3)
    (A2B, covariance_a), (B2C, covariance_b) = (
        ours.to_gaussian(density, side="right") for density in (T_b_a, T_c_b)
    )
    found = uncertainty.concat_locally_uncertain_transforms(A2B, B2C, covariance_a, covariance_b)
    assert_same(ours.from_gaussian(*found, side="right").covariance, expected.covariance, 1e-3)
    found = uncertainty.invert_uncertain_transform(*ours.to_gaussian(T_b_a, side="left"))
    assert_same(ours.from_gaussian(*found, side="left").covariance, inverse(T_b_a).covariance, 1e-9)


def test_scipy(peer: Any, poses: SE3) -> None:
    transform = peer("scipy.spatial.transform", "scipy")
    rotations = interop.scipy.to_rotation(poses.rotation)
    assert interop.scipy.from_rotation(rotations).is_approx(poses.rotation)
    np.testing.assert_allclose(rotations.as_rotvec(), poses.rotation.log(), atol=1e-12)
    one = transform.Rotation.from_euler("ZYX", [0.3, -0.2, 0.9])
    expected = interop.euler.from_rpy([0.9, -0.2, 0.3])
    assert interop.scipy.from_rotation(one).is_approx(expected)
    assert isinstance(interop.scipy.from_rotation(one), SO3)
    if hasattr(transform, "RigidTransform"):
        rigid = interop.scipy.to_rigid_transform(poses)
        assert interop.scipy.from_rigid_transform(rigid).is_approx(poses)
        # SciPy's exponential coordinates are rotation first as well.
        np.testing.assert_allclose(rigid.as_exp_coords(), poses.log(), atol=1e-9)


@pytest.fixture
def groups_of_navlie(monkeypatch: pytest.MonkeyPatch) -> None:
    """navlie imports its matrix groups from what is now pymlg, which PyPI does not have: ours stand in."""

    class Group:
        dof = 6
        Exp = staticmethod(lambda xi: SE3.exp(np.ravel(xi)).matrix())
        Log = staticmethod(lambda matrix: SE3.from_matrix(matrix).log())
        inverse = staticmethod(np.linalg.inv)

    module, base = types.ModuleType("pylie"), types.ModuleType("pylie.numpy.base")
    for name in ("SO2", "SO3", "SE2", "SE3", "SE23", "SL3", "MatrixLieGroup"):
        setattr(module, name, Group)
    base.MatrixLieGroup = Group  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "pylie", module)
    monkeypatch.setitem(sys.modules, "pylie.numpy", types.ModuleType("pylie.numpy"))
    monkeypatch.setitem(sys.modules, "pylie.numpy.base", base)


@pytest.mark.usefixtures("groups_of_navlie")
@pytest.mark.parametrize("direction", ["left", "right"])
def test_navlie(
    peer: Any, pose: SE3, density: ConcentratedGaussian[SE3], direction: Any
) -> None:
    peer("navlie.lib", "navlie")
    found = interop.navlie.to_state(density, direction=direction, stamp=2.5)
    assert (found.state.direction, found.state.stamp) == (direction, 2.5)
    jacobian = jacobian_of(lambda d: SE3.from_matrix(found.state.plus(d).value), pose)
    assert_same(jacobian @ found.covariance @ jacobian.T, density.covariance, 1e-6)
    back = interop.navlie.from_state(found)
    assert back.mean.is_approx(pose)
    assert_same(back.covariance, density.covariance, 1e-12)
