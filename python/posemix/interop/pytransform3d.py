# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""pytransform3d: 4x4 matrices A2B, exponential coordinates with the rotation first.

A2B maps points of frame A into frame B: it is T_b_a. Globally uncertain transforms are perturbed on the left, locally
uncertain ones on the right; pytransform3d has functions for both, and the argument `side` selects one.
"""

from __future__ import annotations

import numpy.typing as npt

from posemix._arrays import FloatArray
from posemix.density import ConcentratedGaussian
from posemix.interop.conventions import Side, density_from, density_to
from posemix.lie import SE3

__all__ = ["from_gaussian", "from_transform", "to_gaussian", "to_transform"]


def from_transform(A2B: npt.ArrayLike) -> SE3:  # noqa: N803
    """T_b_a from matrices A2B, shape (..., 4, 4), with the nearest rotations."""
    return SE3.from_matrix(A2B)


def to_transform(T_b_a: SE3) -> FloatArray:  # noqa: N803
    """Matrices A2B from T_b_a, shape (..., 4, 4); exact."""
    return T_b_a.matrix()


def from_gaussian(
    A2B: npt.ArrayLike, covariance: npt.ArrayLike, *, side: Side  # noqa: N803
) -> ConcentratedGaussian[SE3]:
    """The density of T_b_a.

    Parameters
    ----------
    A2B : array_like, shape (4, 4)
        Mean of the transform.
    covariance : array_like, shape (6, 6)
        Covariance, rotation (rad) before translation (m).
    side : {"left", "right"}
        "left" for globally uncertain transforms (frame B), "right" for locally uncertain ones.
    """
    return density_from(from_transform(A2B), covariance, side=side, order="rotation_first")


def to_gaussian(density: ConcentratedGaussian[SE3], *, side: Side) -> tuple[FloatArray, FloatArray]:
    """Mean A2B and covariance of a density, the inverse of `from_gaussian`."""
    mean, covariance = density_to(density, side=side, order="rotation_first")
    return to_transform(mean), covariance
