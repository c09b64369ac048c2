# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""jaxlie: parameters qw qx qy qz x y z, tangent vectors with the translation first.

jaxlie's rplus and rminus are on the right, lplus and lminus on the left; the argument `side` selects one. Arrays of
poses are those of jaxlie, with leading axes of the parameters.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from posemix._arrays import FloatArray
from posemix._peers import peer
from posemix.density import ConcentratedGaussian
from posemix.interop.conventions import Side, density_from, density_to, tangent_from, tangent_to
from posemix.lie import SE3, SO3

__all__ = ["from_gaussian", "from_se3", "from_tangent", "to_gaussian", "to_se3", "to_tangent"]


def from_se3(pose: Any) -> SE3:
    """Poses of a jaxlie.SE3 with any leading axes, in its own precision."""
    values = np.asarray(pose.wxyz_xyz, dtype=np.float64)
    return SE3(SO3(values[..., [1, 2, 3, 0]]), values[..., 4:])


def to_se3(pose: SE3) -> Any:
    """A jaxlie.SE3; single precision unless jax_enable_x64 is set."""
    tq = pose.to_tq()
    jaxlie = peer("jaxlie", "posemix.interop.jaxlie", "jaxlie")
    return jaxlie.SE3(np.concatenate([tq[..., [6, 3, 4, 5]], tq[..., :3]], axis=-1))


def from_tangent(vector: npt.ArrayLike) -> FloatArray:
    """Tangent vectors, rotation first, from jaxlie's [v, omega], shape (..., 6); exact."""
    return tangent_from(vector, order="translation_first")


def to_tangent(vector: npt.ArrayLike) -> FloatArray:
    """jaxlie's [v, omega] from tangent vectors, rotation first, shape (..., 6); exact."""
    return tangent_to(vector, order="translation_first")


def from_gaussian(
    pose: Any, covariance: npt.ArrayLike, *, side: Side
) -> ConcentratedGaussian[SE3]:
    """The density with one jaxlie.SE3 as mean and a covariance.

    Parameters
    ----------
    pose : jaxlie.SE3
        T_a_b.
    covariance : array_like, shape (6, 6)
        Covariance, translation (m) before rotation (rad).
    side : {"left", "right"}
        "right" for rplus and rminus, "left" for lplus and lminus.
    """
    return density_from(from_se3(pose), covariance, side=side, order="translation_first")


def to_gaussian(density: ConcentratedGaussian[SE3], *, side: Side) -> tuple[Any, FloatArray]:
    """A jaxlie.SE3 and its covariance, the inverse of `from_gaussian`."""
    mean, covariance = density_to(density, side=side, order="translation_first")
    return to_se3(mean), covariance
