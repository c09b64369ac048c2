# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""symforce: sym.Pose3 as the product SO(3) x R^3.

Pose3.retract perturbs the rotation on the right, R = R0 Exp(theta), and adds the translation along the axes of the
reference frame, t = t0 + dt; tangent vectors and covariances have the rotation first.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from posemix._arrays import FloatArray
from posemix._peers import peer
from posemix.density import ConcentratedGaussian
from posemix.interop.conventions import inverted, product_jacobian, transformed
from posemix.lie import SE3, SO3

__all__ = ["from_gaussian", "from_pose3", "to_gaussian", "to_pose3"]


def from_pose3(pose: Any) -> SE3:
    """The pose of a sym.Pose3; exact."""
    storage = np.asarray(pose.to_storage(), dtype=np.float64)
    return SE3(SO3(storage[:4]), storage[4:])


def to_pose3(pose: SE3) -> Any:
    """A sym.Pose3 from one pose; exact."""
    tq = pose.to_tq()
    sym = peer("sym", "posemix.interop.symforce", "symforce-sym")
    return sym.Pose3.from_storage([*tq[3:].tolist(), *tq[:3].tolist()])


def from_gaussian(pose: Any, covariance: npt.ArrayLike) -> ConcentratedGaussian[SE3]:
    """The density with a pose as mean and a covariance, to first order in the error.

    Parameters
    ----------
    pose : sym.Pose3
        T_a_b.
    covariance : array_like, shape (6, 6)
        Covariance of [theta, dt], theta (rad) in frame b, dt (m) in frame a.
    """
    mean = from_pose3(pose)
    return ConcentratedGaussian(mean, transformed(covariance, product_jacobian(mean)))


def to_gaussian(density: ConcentratedGaussian[SE3]) -> tuple[Any, FloatArray]:
    """A sym.Pose3 and its covariance, the inverse of `from_gaussian`."""
    mean = density.mean
    inverse = inverted(product_jacobian(mean))
    return to_pose3(mean), transformed(density.covariance, inverse)
