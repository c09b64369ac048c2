# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""MRPT: CPose3DPDFGaussian, mean and covariance of x, y, z, yaw, pitch, roll.

The covariance is that of the six numbers, not of a tangent vector, so it is converted by the Jacobian of the angles, to
first order in the error. R = Rz(yaw) Ry(pitch) Rx(roll).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from posemix._arrays import FloatArray, as_floats
from posemix.density import ConcentratedGaussian
from posemix.interop.conventions import transformed
from posemix.interop.euler import from_rpy, inverse_rpy_jacobian, rpy_jacobian, to_rpy
from posemix.lie import SE3

__all__ = ["from_gaussian", "from_pose3d", "jacobian", "to_gaussian", "to_pose3d"]

# Indices of roll, pitch, yaw, x, y, z among x, y, z, yaw, pitch, roll.
_PLACES = [5, 4, 3, 0, 1, 2]


def from_pose3d(values: npt.ArrayLike) -> SE3:
    """Poses from [x, y, z, yaw, pitch, roll], shape (..., 6) [m, rad]; exact."""
    numbers = as_floats(values, (6,), "values")
    return SE3(from_rpy(numbers[..., [5, 4, 3]]), numbers[..., :3])


def to_pose3d(pose: SE3) -> FloatArray:
    """[x, y, z, yaw, pitch, roll] of poses, shape (..., 6) [m, rad]; exact."""
    return np.concatenate([pose.translation, to_rpy(pose.rotation)[..., ::-1]], axis=-1)


def jacobian(mean: SE3) -> FloatArray:
    """The Jacobian from errors of [x, y, z, yaw, pitch, roll] to [phi, rho] on the left, shape (..., 6, 6)."""
    result = np.empty((*mean.shape, 6, 6))
    result[..., _PLACES] = rpy_jacobian(mean)
    return result


def from_gaussian(
    values: npt.ArrayLike, covariance: npt.ArrayLike
) -> ConcentratedGaussian[SE3]:
    """The density with the mean and the covariance of a CPose3DPDFGaussian.

    Parameters
    ----------
    values : array_like, shape (6,)
        Mean of x, y, z [m], yaw, pitch, roll [rad].
    covariance : array_like, shape (6, 6)
        Covariance of these numbers.
    """
    mean = from_pose3d(values)
    return ConcentratedGaussian(mean, transformed(covariance, jacobian(mean)))


def to_gaussian(density: ConcentratedGaussian[SE3]) -> tuple[FloatArray, FloatArray]:
    """Mean and covariance of x, y, z, yaw, pitch, roll, the inverse of `from_gaussian`.

    Raises
    ------
    ValueError
        At a pitch of a quarter turn, where the angles have no covariance.
    """
    mean = density.mean
    back = np.empty((6, 6))
    back[_PLACES] = inverse_rpy_jacobian(mean)
    return to_pose3d(mean), transformed(density.covariance, back)
