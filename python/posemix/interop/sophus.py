# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Sophus (and its Python package sophuspy): tangent vectors with the translation first.

Sophus itself has no convention for the side of a perturbation; the argument `side` is that of the covariance.
"""

from __future__ import annotations

from typing import Any

import numpy.typing as npt

from posemix._arrays import FloatArray
from posemix._peers import peer
from posemix.density import ConcentratedGaussian
from posemix.interop.conventions import Side, density_from, density_to, tangent_from, tangent_to
from posemix.lie import SE3

__all__ = ["from_gaussian", "from_se3", "from_tangent", "to_gaussian", "to_se3", "to_tangent"]


def from_se3(pose: Any) -> SE3:
    """The pose of a sophuspy.SE3; exact."""
    return SE3.from_matrix(pose.matrix())


def to_se3(pose: SE3) -> Any:
    """A sophuspy.SE3 from one pose; exact."""
    return peer("sophuspy", "posemix.interop.sophus", "sophuspy").SE3(pose.matrix())


def from_tangent(vector: npt.ArrayLike) -> FloatArray:
    """Tangent vectors, rotation first, from Sophus' [upsilon, omega], shape (..., 6); exact."""
    return tangent_from(vector, order="translation_first")


def to_tangent(vector: npt.ArrayLike) -> FloatArray:
    """Sophus' [upsilon, omega] from tangent vectors, rotation first, shape (..., 6); exact."""
    return tangent_to(vector, order="translation_first")


def from_gaussian(
    pose: Any, covariance: npt.ArrayLike, *, side: Side
) -> ConcentratedGaussian[SE3]:
    """The density with a pose as mean and a covariance.

    Parameters
    ----------
    pose : sophuspy.SE3
        T_a_b.
    covariance : array_like, shape (6, 6)
        Covariance, translation (m) before rotation (rad).
    side : {"left", "right"}
        Side of the perturbation: X = Exp(xi) X0, or X = X0 Exp(xi).
    """
    return density_from(from_se3(pose), covariance, side=side, order="translation_first")


def to_gaussian(density: ConcentratedGaussian[SE3], *, side: Side) -> tuple[Any, FloatArray]:
    """A sophuspy.SE3 and its covariance, the inverse of `from_gaussian`."""
    mean, covariance = density_to(density, side=side, order="translation_first")
    return to_se3(mean), covariance
