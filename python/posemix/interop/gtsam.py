# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""GTSAM: gtsam.Pose3 with a covariance on the right, rotation first.

Noise models and marginals of GTSAM are in the chart of Pose3.retract, X = X0 Retract(xi). To first order that is the
right perturbation, with every chart that GTSAM can be built with.
"""

from __future__ import annotations

from typing import Any

import numpy.typing as npt

from posemix._arrays import FloatArray
from posemix._peers import peer
from posemix.density import ConcentratedGaussian
from posemix.interop.conventions import density_from, density_to
from posemix.lie import SE3

__all__ = ["from_gaussian", "from_pose3", "to_gaussian", "to_pose3"]


def from_pose3(pose: Any) -> SE3:
    """The pose of a gtsam.Pose3; exact."""
    return SE3.from_matrix(pose.matrix())


def to_pose3(pose: SE3) -> Any:
    """A gtsam.Pose3 of one pose; exact."""
    return peer("gtsam", "posemix.interop.gtsam", "gtsam").Pose3(pose.matrix())


def from_gaussian(pose: Any, covariance: npt.ArrayLike) -> ConcentratedGaussian[SE3]:
    """The density with a pose as mean and a covariance from Marginals.marginalCovariance.

    Parameters
    ----------
    pose : gtsam.Pose3
        T_a_b.
    covariance : array_like, shape (6, 6)
        Covariance of the right perturbation (frame b), rotation (rad) before translation (m).
    """
    return density_from(from_pose3(pose), covariance, side="right", order="rotation_first")


def to_gaussian(density: ConcentratedGaussian[SE3]) -> tuple[Any, FloatArray]:
    """A gtsam.Pose3 and a covariance for gtsam.noiseModel.Gaussian.Covariance, the inverse of `from_gaussian`."""
    mean, covariance = density_to(density, side="right", order="rotation_first")
    return to_pose3(mean), covariance
