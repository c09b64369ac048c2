# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Sides, orders and charts of a pose's error, and the Jacobians between them.

All Jacobians J map the error in the other convention to the left perturbation of posemix, rotation (rad) before
translation (m), in X = Exp(xi) X0. Covariances follow to first order, P = J P_other J^T.
"""

from __future__ import annotations

from typing import Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from posemix._arrays import FloatArray, as_floats
from posemix.density import ConcentratedGaussian
from posemix.lie import SE3

__all__ = [
    "Order", "Side", "additive_jacobian", "covariance_from", "covariance_to", "density_from",
    "density_to", "from_tangent", "inverse_additive_jacobian", "inverted", "product_jacobian",
    "require_word", "side_jacobian", "skew", "tangent_from", "tangent_to", "to_tangent", "transformed",
]  # fmt: skip

Side: TypeAlias = Literal["left", "right"]
Order: TypeAlias = Literal["rotation_first", "translation_first"]


def require_word(value: str, allowed: tuple[str, ...], name: str) -> None:
    """Raises ValueError unless the value of the argument `name` is allowed."""
    if value not in allowed:
        expected = " or ".join(repr(word) for word in allowed)
        raise ValueError(f"{name} is {value!r}; expected {expected}")


def skew(v: npt.ArrayLike) -> FloatArray:
    """The matrix [v]x, shape (..., 3, 3), for which [v]x w is the cross product of v and w."""
    values = as_floats(v, (3,), "v")
    found = np.zeros((*values.shape[:-1], 3, 3))
    x, y, z = values[..., 0], values[..., 1], values[..., 2]
    found[..., 0, 1], found[..., 0, 2] = -z, y
    found[..., 1, 0], found[..., 1, 2] = z, -x
    found[..., 2, 0], found[..., 2, 1] = -y, x
    return found


def _swapped(values: FloatArray, axes: tuple[int, ...], order: Order) -> FloatArray:
    require_word(order, ("rotation_first", "translation_first"), "order")
    return values if order == "rotation_first" else np.roll(values, 3, axis=axes)


def tangent_from(vector: npt.ArrayLike, *, order: Order) -> FloatArray:
    """Tangent vectors with the rotation first, shape (..., 6).

    Parameters
    ----------
    vector : array_like, shape (..., 6)
        Tangent vectors [rad, m].
    order : {"rotation_first", "translation_first"}
        Order of the halves of `vector`.
    """
    return _swapped(as_floats(vector, (6,), "vector"), (-1,), order)


def tangent_to(vector: npt.ArrayLike, *, order: Order) -> FloatArray:
    """Tangent vectors in another order, the inverse of `tangent_from`."""
    return _swapped(as_floats(vector, (6,), "vector"), (-1,), order)


def from_tangent(vector: npt.ArrayLike) -> FloatArray:
    """Tangent vectors, rotation first, of a package's with the translation first, shape (..., 6); exact."""
    return tangent_from(vector, order="translation_first")


def to_tangent(vector: npt.ArrayLike) -> FloatArray:
    """A package's tangent vectors, translation first, of those with the rotation first, shape (..., 6); exact."""
    return tangent_to(vector, order="translation_first")


def side_jacobian(mean: SE3, side: Side) -> FloatArray:
    """The exact Jacobian from errors on a side to errors on the left: the identity or Ad(mean).

    Parameters
    ----------
    mean : SE3, shape (...)
        Poses.
    side : {"left", "right"}
        "left": X = Exp(xi) X0. "right": X = X0 Exp(xi), along the body's axes.

    Returns
    -------
    ndarray, shape (..., 6, 6)
    """
    require_word(side, ("left", "right"), "side")
    if side == "left":
        return np.broadcast_to(np.eye(6), (*mean.shape, 6, 6))
    return mean.adjoint()


def additive_jacobian(mean: SE3) -> FloatArray:
    """The Jacobian from [theta, dt], R = Exp(theta) R0 and t = t0 + dt, both along the axes of the reference frame.

    To first order, rho = dt + [t0]x theta.
    """
    jacobian = np.zeros((*mean.shape, 6, 6))
    jacobian[...] = np.eye(6)
    jacobian[..., 3:, :3] = skew(mean.translation)
    return jacobian


def inverse_additive_jacobian(mean: SE3) -> FloatArray:
    """The exact inverse of `additive_jacobian`."""
    jacobian = additive_jacobian(mean)
    jacobian[..., 3:, :3] *= -1.0
    return jacobian


def product_jacobian(mean: SE3) -> FloatArray:
    """The Jacobian from [theta, dt], R = R0 Exp(theta) in the body frame and t = t0 + dt in the reference frame."""
    jacobian = additive_jacobian(mean)
    turned = mean.rotation.matrix()
    jacobian[..., :3, :3] = turned
    jacobian[..., 3:, :3] = skew(mean.translation) @ turned
    return jacobian


def inverted(jacobian: FloatArray) -> FloatArray:
    """The inverses of Jacobians, shape (..., 6, 6)."""
    return np.asarray(np.linalg.inv(jacobian), dtype=np.float64)


def transformed(covariance: npt.ArrayLike, jacobian: FloatArray) -> FloatArray:
    """J P J^T, exactly symmetric, shape (..., 6, 6)."""
    product = jacobian @ as_floats(covariance, (6, 6), "covariance") @ np.swapaxes(jacobian, -1, -2)
    return np.asarray(0.5 * (product + np.swapaxes(product, -1, -2)))


def covariance_from(
    mean: SE3, covariance: npt.ArrayLike, *, side: Side, order: Order
) -> FloatArray:
    """Covariances of the left perturbation, rotation first, from another side and order.

    Parameters
    ----------
    mean : SE3, shape (...)
        Poses T_a_b.
    covariance : array_like, shape (..., 6, 6)
        Covariances of these poses [rad, m].
    side : {"left", "right"}
        Side of the perturbation: left in frame a (X = Exp(xi) X0), or right in frame b (X = X0 Exp(xi)).
    order : {"rotation_first", "translation_first"}
        Order of the halves.

    Returns
    -------
    ndarray, shape (..., 6, 6)
    """
    matrix = _swapped(as_floats(covariance, (6, 6), "covariance"), (-2, -1), order)
    return transformed(matrix, side_jacobian(mean, side))


def covariance_to(
    mean: SE3, covariance: npt.ArrayLike, *, side: Side, order: Order
) -> FloatArray:
    """Covariances on another side and in another order, the inverse of `covariance_from`."""
    require_word(side, ("left", "right"), "side")
    back = side_jacobian(mean.inverse(), side)
    return _swapped(transformed(covariance, back), (-2, -1), order)


def density_from(
    mean: SE3, covariance: npt.ArrayLike, *, side: Side, order: Order
) -> ConcentratedGaussian[SE3]:
    """The density with a pose as mean and a covariance of any side and order; see `covariance_from`."""
    return ConcentratedGaussian(mean, covariance_from(mean, covariance, side=side, order=order))


def density_to(
    density: ConcentratedGaussian[SE3], *, side: Side, order: Order
) -> tuple[SE3, FloatArray]:
    """Mean and covariance of a density, on any side and in any order; the inverse of `density_from`."""
    mean = density.mean
    return mean, covariance_to(mean, density.covariance, side=side, order=order)
