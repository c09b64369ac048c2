# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Operations on densities and mixtures: compose, invert, fuse, recenter, merge, reduce."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray, as_floats, flat_rows, require_finite, thread_count
from posemix._core import (
    BoundedLoss, CompositionRule, FuseResult, FuseSettings, MergeRecord, MergeResult, MergeSettings, Moments,
    MomentSettings, ProductMode, ProjectedFuseSettings, ProjectedMixtureComposeSettings, ProjectedMixtureFuseSettings,
    Reduction, ReductionReport, ReductionSettings,
)  # fmt: skip
from posemix.density import ConcentratedGaussian, ProjectedGaussian
from posemix._elements import Elements
from posemix.lie import SE3, SO3
from posemix.mixture import Mixture, log_of_weights, overloaded

__all__ = [
    "BoundedLoss", "FuseResult", "MergeRecord", "MergeResult", "Moments", "ProductMode", "Reduction", "ReductionReport",
    "back_project", "between", "between_arrays", "compose", "compose_arrays", "fuse", "fuse_arrays", "inverse",
    "inverse_arrays", "merge", "moments", "recenter", "reduce",
]  # fmt: skip

G = TypeVar("G", SO3, SE3)
D = TypeVar("D", bound="ConcentratedGaussian[Any] | ProjectedGaussian[Any]")
X = TypeVar("X", bound="ConcentratedGaussian[Any] | ProjectedGaussian[Any] | Mixture[Any]")


def compose(
    x: X, y: X, settings: CompositionRule | ProjectedMixtureComposeSettings | None = None
) -> X:
    """The density or mixture of X Y for independent X and Y.

    For concentrated Gaussians to first order: mean X0 Y0, covariance P_X + Ad(X0) P_Y Ad(X0)^T (Barfoot and
    Furgale 2014). For projected Gaussians by the rule in `settings`, cubature of degree five unless given (MPG
    paper, eq. 17 and 21-22). A mixture has one component for every pair of components.

    Parameters
    ----------
    x, y : ConcentratedGaussian, ProjectedGaussian or Mixture
        Densities or mixtures of one kind.
    settings : CompositionRule or ProjectedMixtureComposeSettings, optional
        Rule for projected Gaussians.
    """
    result: X = overloaded.compose(x, y, settings)
    return result


def inverse(
    x: X, settings: CompositionRule | ProjectedMixtureComposeSettings | None = None
) -> X:
    """The density or mixture of X^-1; exact for concentrated Gaussians."""
    result: X = overloaded.inverse(x, settings)
    return result


def between(
    x: X, y: X, settings: CompositionRule | ProjectedMixtureComposeSettings | None = None
) -> X:
    """The density or mixture of X^-1 Y for independent X and Y."""
    result: X = overloaded.between(x, y, settings)
    return result


def _pose_rows(means: SE3, covariances: npt.ArrayLike) -> tuple[FloatArray, FloatArray]:
    matrices = require_finite(as_floats(covariances, (6, 6), "covariances"), "covariances")
    rows = SE3._checked(means, "means")._rows(), flat_rows(matrices, 2)
    if matrices.shape[:-2] != means.shape and not len(rows[0]) == len(rows[1]) == 1:
        raise ValueError(
            f"means of shape {means.shape} and covariances of shape {matrices.shape}; expected {(*means.shape, 6, 6)}"
        )
    return rows


def _common_shape(x: SE3, y: SE3) -> tuple[int, ...]:
    """The shape of what is made of both, of which one may be single."""
    if SE3._checked(x, "x").shape == SE3._checked(y, "y").shape:
        return x.shape
    single = [math.prod(shape) == 1 for shape in (x.shape, y.shape)]
    if not any(single):
        raise ValueError(f"means of shapes {x.shape} and {y.shape}; expected the same, or a single one of either")
    if all(single):
        return max(x.shape, y.shape, key=len)
    return y.shape if single[0] else x.shape


def _pose_arrays(rows: Any, shape: tuple[int, ...]) -> tuple[SE3, FloatArray]:
    means, covariances = rows
    return SE3._wrap(means, shape), covariances.reshape((*shape, 6, 6))


def compose_arrays(
    x: SE3,
    covariance_x: npt.ArrayLike,
    y: SE3,
    covariance_y: npt.ArrayLike,
    *,
    threads: int = 1,
) -> tuple[SE3, FloatArray]:
    """Means and covariances of many products X_i Y_i; see `compose`.

    Parameters
    ----------
    x, y : SE3, shape (n,) or ()
        Means of any one shape; a single one is used for all.
    covariance_x, covariance_y : array_like, shape (n, 6, 6) or (6, 6)
        Covariances of the left perturbations, as many as means. They must be positive definite, which is not checked.
    threads : int
        Number of threads, 0 for one per core. The result has the same bits for any number.

    Returns
    -------
    mean : SE3, shape (n,)
    covariance : ndarray, shape (n, 6, 6)

    Raises
    ------
    ValueError
        For covariances that are not finite, and numbers of densities that differ.
    """
    shape = _common_shape(x, y)
    rows = _core.compose_rows(
        *_pose_rows(x, covariance_x), *_pose_rows(y, covariance_y), thread_count(threads)
    )
    return _pose_arrays(rows, shape)


def between_arrays(
    x: SE3,
    covariance_x: npt.ArrayLike,
    y: SE3,
    covariance_y: npt.ArrayLike,
    *,
    threads: int = 1,
) -> tuple[SE3, FloatArray]:
    """Means and covariances of X_i^-1 Y_i; arguments as for `compose_arrays`."""
    shape = _common_shape(x, y)
    rows = _core.between_rows(
        *_pose_rows(x, covariance_x), *_pose_rows(y, covariance_y), thread_count(threads)
    )
    return _pose_arrays(rows, shape)


def inverse_arrays(
    x: SE3, covariance: npt.ArrayLike, *, threads: int = 1
) -> tuple[SE3, FloatArray]:
    """Means and covariances of X_i^-1; arguments as for `compose_arrays`."""
    rows = _core.inverse_rows(*_pose_rows(x, covariance), thread_count(threads))
    return _pose_arrays(rows, x.shape)


def fuse_arrays(
    x: SE3,
    covariance_x: npt.ArrayLike,
    y: SE3,
    covariance_y: npt.ArrayLike,
    settings: FuseSettings | None = None,
) -> tuple[SE3, FloatArray, npt.NDArray[np.bool_]]:
    """Means and covariances of the fused densities of X_i and Y_i, on one thread; see `fuse`.

    Parameters
    ----------
    x, y : SE3, shape (n,) or ()
        Means, as for `compose_arrays`.
    covariance_x, covariance_y : array_like, shape (n, 6, 6) or (6, 6)
        Covariances, as for `compose_arrays`.
    settings : FuseSettings, optional
        Stopping criteria of the iteration.

    Returns
    -------
    mean : SE3, shape (n,)
    covariance : ndarray, shape (n, 6, 6)
    converged : ndarray of bool, shape (n,)
        If False, mean and covariance are those of the last iteration.
    """
    shape = _common_shape(x, y)
    means, covariances, converged = _core.fuse_rows(
        *_pose_rows(x, covariance_x), *_pose_rows(y, covariance_y), settings or FuseSettings()
    )
    mean, covariance = _pose_arrays((means, covariances), shape)
    return mean, covariance, np.asarray(converged, dtype=bool).reshape(shape)


def fuse(
    p: X,
    q: X,
    settings: FuseSettings | ProjectedFuseSettings | ProjectedMixtureFuseSettings | None = None,
) -> FuseResult[X]:
    """The normalised product of two densities or mixtures and the log of its integral.

    For concentrated Gaussians, Gauss-Newton finds the mode, with Laplace's approximation there; where the means are
    more than 45 degrees apart it starts from other poses too, and takes the largest overlap (of densities of 10 to 60
    degrees, one in a hundred has a higher mode still). For projected
    Gaussians see the MPG paper, III-C and eq. 19-20, with the overlap itself as weight. A mixture has one component
    for every pair of components, weighted by the overlap of the pair.

    Raises
    ------
    ValueError
        When no pair overlaps, or for settings out of range.
    """
    result: FuseResult[X] = overloaded.fuse(p, q, settings)
    return result


def recenter(density: ConcentratedGaussian[G], anchor: G) -> tuple[FloatArray, FloatArray]:
    """Mean and covariance in the tangent space at `anchor` (midway-merge paper, eq. 9-10).

    First order in xi: mean d = Log(X0 anchor^-1), covariance J_l(d)^-1 P J_l(d)^-T.
    """
    mean, covariance = _core.recenter(density, Elements._checked(anchor, "anchor")._data)
    return mean, covariance


def back_project(
    anchor: G, mean: npt.ArrayLike, covariance: npt.ArrayLike
) -> ConcentratedGaussian[G]:
    """The density at Exp(mean) anchor with covariance J_l P J_l^T, the inverse of `recenter`.

    Raises
    ------
    ValueError
        For a covariance that is not symmetric or not positive definite, and values that are not finite.
    """
    dof = Elements._checked(anchor, "anchor").DOF
    density: ConcentratedGaussian[G] = overloaded.back_project(
        anchor._data,
        require_finite(as_floats(mean, (dof,), "mean"), "mean"),
        require_finite(as_floats(covariance, (dof, dof), "covariance"), "covariance"),
    )
    return density


def moments(mixture: Mixture[D], settings: MomentSettings | None = None) -> Moments[D]:
    """Mean and covariance of a whole mixture, by cubature."""
    result: Moments[D] = overloaded.moments(mixture, settings)
    return result


def merge(
    densities: Sequence[D],
    weights: npt.ArrayLike,
    settings: MergeSettings | None = None,
) -> MergeResult[D]:
    """Merges several components into one, by the midway rule unless `settings` has another.

    Parameters
    ----------
    densities : sequence
        Densities of one kind.
    weights : array_like, shape (k,)
        Weights of the densities; they need not sum to one.
    settings : MergeSettings, optional
        The rule, and stopping criteria for the iteration of the mean.

    References
    ----------
    Midway-merge paper, eq. 12-19.
    """
    result: MergeResult[D] = overloaded.merge(
        list(log_of_weights(weights)), list(densities), settings or MergeSettings()
    )
    return result


def reduce(mixture: Mixture[D], settings: ReductionSettings | None = None) -> Reduction[D]:
    """A mixture with fewer components: light ones are pruned, then pairs are merged one after another.

    Raises
    ------
    ValueError
        For settings out of range.
    """
    result: Reduction[D] = overloaded.reduce(mixture, settings or ReductionSettings())
    return result
