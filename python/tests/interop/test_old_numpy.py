# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Sophus (sophuspy) and g2o (g2o-python): their wheels are built for NumPy 1 and crash with NumPy 2."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from .oracle import assert_same, jacobian_of

from posemix import SE3, ConcentratedGaussian, interop
from posemix.interop import g2o

needs_old_numpy = pytest.mark.skipif(
    int(np.__version__.split(".")[0]) >= 2, reason="the package crashes with NumPy 2"
)


def test_tangent_order() -> None:
    xi = np.arange(12.0).reshape((2, 6))
    np.testing.assert_array_equal(interop.sophus.to_tangent(xi)[0], [3, 4, 5, 0, 1, 2])
    np.testing.assert_array_equal(interop.sophus.from_tangent(interop.sophus.to_tangent(xi)), xi)


@needs_old_numpy
def test_sophus(peer: Any, pose: SE3, density: ConcentratedGaussian[SE3]) -> None:
    sophus = peer("sophuspy", "sophuspy")
    xi = np.array([0.2, -0.1, 0.4, 1.0, 2.0, -3.0])
    theirs = sophus.SE3.exp(interop.sophus.to_tangent(xi))
    assert interop.sophus.from_se3(theirs).is_approx(SE3.exp(xi))
    logarithm = interop.sophus.from_tangent(theirs.log().ravel())
    np.testing.assert_allclose(logarithm, SE3.exp(xi).log(), atol=1e-12)
    for side in ("left", "right"):
        mean, covariance = interop.sophus.to_gaussian(density, side=side)

        def moved(d: np.ndarray) -> SE3:
            step = sophus.SE3.exp(d)
            return interop.sophus.from_se3(step * mean if side == "left" else mean * step)  # noqa: B023

        jacobian = jacobian_of(moved, pose)
        assert_same(jacobian @ covariance @ jacobian.T, density.covariance, 1e-6)
        back = interop.sophus.from_gaussian(mean, covariance, side=side)
        assert_same(back.covariance, density.covariance, 1e-12)


@needs_old_numpy
def test_g2o_as_g2o_weighs_it(peer: Any, pose: SE3, covariance: np.ndarray) -> None:
    """chi2 of g2o's own edge at a small error is that of the density."""
    library = peer("g2o", "g2o-python")
    density = ConcentratedGaussian(pose, covariance)
    mean, triangle = g2o.to_information(density, rotation="quaternion_vector")
    error = np.array([1e-4, -2e-4, 3e-4, 2e-4, 1e-4, -3e-4])
    edge = library.EdgeSE3()
    vertices = []  # the edge does not own them
    for i, vertex_pose in enumerate((SE3(), SE3.exp(error) * pose)):
        vertex = library.VertexSE3()
        vertices.append(vertex)
        vertex.set_id(i)
        vertex.set_estimate(library.Isometry3d(vertex_pose.matrix()))
        edge.set_vertex(i, vertex)
    edge.set_measurement(library.Isometry3d(mean.matrix()))
    information = np.zeros((6, 6))
    information[np.triu_indices(6)] = triangle
    edge.set_information(information + np.triu(information, 1).T)
    edge.compute_error()
    expected = float(error @ np.linalg.solve(covariance, error))
    assert edge.chi2() == pytest.approx(expected, rel=1e-3)
    back = g2o.from_information(mean, triangle, rotation="quaternion_vector")
    assert_same(back.covariance, covariance, 1e-9)
