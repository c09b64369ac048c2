# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""manif: coefficients x y z qx qy qz qw, tangent vectors with the translation first.

manif's operators plus and minus are on the right, lplus and lminus on the left; the argument `side` selects one.
"""

from __future__ import annotations

import numpy.typing as npt

from posemix._arrays import FloatArray
from posemix.density import ConcentratedGaussian
from posemix.interop.conventions import Side, density_from, density_to, tangent_from, tangent_to
from posemix.lie import SE3

__all__ = ["from_coeffs", "from_gaussian", "from_tangent", "to_coeffs", "to_gaussian", "to_tangent"]


def from_coeffs(coeffs: npt.ArrayLike) -> SE3:
    """Poses from SE3d.coeffs(), shape (..., 7); exact."""
    return SE3.from_tq(coeffs)


def to_coeffs(pose: SE3) -> FloatArray:
    """SE3d.coeffs() of poses, shape (..., 7); exact."""
    return pose.to_tq()


def from_tangent(vector: npt.ArrayLike) -> FloatArray:
    """Tangent vectors, rotation first, from SE3Tangentd.coeffs(), shape (..., 6); exact."""
    return tangent_from(vector, order="translation_first")


def to_tangent(vector: npt.ArrayLike) -> FloatArray:
    """SE3Tangentd.coeffs() from tangent vectors, rotation first, shape (..., 6); exact."""
    return tangent_to(vector, order="translation_first")


def from_gaussian(
    coeffs: npt.ArrayLike, covariance: npt.ArrayLike, *, side: Side
) -> ConcentratedGaussian[SE3]:
    """The density with the pose of coefficients as mean and a covariance.

    Parameters
    ----------
    coeffs : array_like, shape (7,)
        Coefficients of T_a_b.
    covariance : array_like, shape (6, 6)
        Covariance, translation (m) before rotation (rad).
    side : {"left", "right"}
        "right" for plus and minus, "left" for lplus and lminus.
    """
    return density_from(from_coeffs(coeffs), covariance, side=side, order="translation_first")


def to_gaussian(density: ConcentratedGaussian[SE3], *, side: Side) -> tuple[FloatArray, FloatArray]:
    """Coefficients and covariance of a density, the inverse of `from_gaussian`."""
    mean, covariance = density_to(density, side=side, order="translation_first")
    return to_coeffs(mean), covariance
