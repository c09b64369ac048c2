# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Error mixtures of pose estimators, and the fusion of several estimates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray, as_floats, flat_rows, require_finite
from posemix._core import ConsensusSettings, ErrorMixtureSettings, SymmetryGroup, ToleranceRegion
from posemix.lie import SE3
from posemix.mixture import log_of_weights
from posemix.random import RandomStream, stream_of

__all__ = [
    "ConsensusSettings", "ErrorMixture", "ErrorMixtureFit", "ErrorMixtureSettings", "PoseConsensus",
    "fit_error_gaussian", "fit_error_mixture", "fuse_estimates", "sight_error", "trimmed_errors", "truth_with_error",
]  # fmt: skip


def _broadcast(x: SE3, y: SE3) -> tuple[SE3, SE3]:
    shape = np.broadcast_shapes(x.shape, y.shape)
    a, b = (np.ascontiguousarray(np.broadcast_to(p._data, (*shape, 7))) for p in (x, y))
    return SE3._wrap(a, shape), SE3._wrap(b, shape)


def sight_error(estimate: SE3, truth: SE3) -> FloatArray:
    """Errors of estimates T_camera_object in the frame of their lines of sight.

    Parameters
    ----------
    estimate, truth : SE3, shape (...)
        T_camera_object.

    Returns
    -------
    ndarray, shape (..., 6)
        The rotation vector of R_estimate R_truth^-1 [rad] and t_estimate - t_truth [m], both along the axes of the
        camera after the smallest rotation that makes z point to the estimate: depth is the last entry.
    """
    a, b = _broadcast(estimate, truth)
    rows: FloatArray = _core.sight_error(a, b)
    return rows.reshape((*a.shape, 6))


def truth_with_error(estimate: SE3, error: npt.ArrayLike) -> SE3:
    """The true poses with respect to which the estimates have these errors, shape (...).

    Parameters
    ----------
    estimate : SE3, shape (...) or ()
        T_camera_object.
    error : array_like, shape (..., 6)
        Errors in the form of `sight_error`.
    """
    errors = as_floats(error, (6,), "error")
    shape = np.broadcast_shapes(estimate.shape, errors.shape[:-1])
    poses = np.ascontiguousarray(np.broadcast_to(estimate._data, (*shape, 7)))
    rows = flat_rows(np.ascontiguousarray(np.broadcast_to(errors, (*shape, 6))), 1)
    return _core.truth_with_error(SE3._wrap(poses, shape), rows)


class ErrorMixture:
    """A mixture of Gaussians over errors in the form of `sight_error`.

    Parameters
    ----------
    weights : array_like, shape (k,)
        Weights, not negative; they are normalised.
    means : array_like, shape (k, 6)
        Means: rotation vector [rad], displacement [m].
    covariances : array_like, shape (k, 6, 6)
        Covariances, symmetric positive definite.

    Raises
    ------
    ValueError
        For weights that are negative or all zero, numbers of weights, means and covariances that differ, and matrices
        that are not positive definite.
    """

    __slots__ = ("_handle",)

    def __init__(
        self, weights: npt.ArrayLike, means: npt.ArrayLike, covariances: npt.ArrayLike
    ) -> None:
        self._set(log_of_weights(weights), means, covariances)

    def _set(self, logs: FloatArray, means: npt.ArrayLike, covariances: npt.ArrayLike) -> None:
        centres = require_finite(as_floats(means, (6,), "means"), "means")
        matrices = as_floats(covariances, (6, 6), "covariances")
        self._handle = _core.ErrorMixture(
            list(logs), flat_rows(centres, 1), flat_rows(matrices, 2)
        )

    @classmethod
    def _of(cls, handle: _core.ErrorMixture) -> ErrorMixture:
        errors = cls.__new__(cls)
        errors._handle = handle
        return errors

    @property
    def weights(self) -> FloatArray:
        """Weights of the components, shape (k,)."""
        logs: FloatArray = self._handle.parts()[0]
        return np.exp(logs)

    @property
    def means(self) -> FloatArray:
        """Means of the components, shape (k, 6) [rad, m]."""
        means: FloatArray = self._handle.parts()[1]
        return means

    @property
    def covariances(self) -> FloatArray:
        """Covariances of the components, shape (k, 6, 6)."""
        covariances: FloatArray = self._handle.parts()[2]
        return covariances

    def __len__(self) -> int:
        return len(self.weights)

    def log_density(self, errors: npt.ArrayLike) -> FloatArray:
        """Log of the density in the six coordinates [nats].

        Parameters
        ----------
        errors : array_like, shape (..., 6)
            Errors.

        Returns
        -------
        ndarray, shape (...)
        """
        rows = as_floats(errors, (6,), "errors")
        return self._handle.log_density(flat_rows(rows, 1)).reshape(rows.shape[:-1])

    def log_pose_density(self, errors: npt.ArrayLike) -> FloatArray:
        """Log of the density of the true pose, with respect to the Haar measure, shape (...) [nats]."""
        rows = as_floats(errors, (6,), "errors")
        return self._handle.log_pose_density(flat_rows(rows, 1)).reshape(rows.shape[:-1])

    def sample(self, count: int, seed: int | RandomStream) -> FloatArray:
        """Draws, shape (count, 6)."""
        return self._handle.sample(count, stream_of(seed))

    def __getstate__(self) -> Any:
        return self._handle.parts()

    def __setstate__(self, state: Any) -> None:
        self._set(*state)

    def __repr__(self) -> str:
        return f"ErrorMixture of {len(self)}, weights {self.weights.round(4).tolist()}"


@dataclass(frozen=True)
class ErrorMixtureFit:
    """A fitted mixture.

    Attributes
    ----------
    errors : ErrorMixture
        The mixture; its last component is that of outliers.
    components : int
        Number of components without that of outliers.
    log_likelihood : float
        Log-likelihood of the errors [nats].
    bic : float
        The BIC, which is the smallest of all numbers of components that were tried.
    history : list of float
        Log posterior after every iteration of the run that was kept.
    """

    errors: ErrorMixture
    components: int
    log_likelihood: float
    bic: float
    history: list[float]


def _error_rows(errors: npt.ArrayLike) -> FloatArray:
    return flat_rows(require_finite(as_floats(errors, (6,), "errors"), "errors"), 1)


def fit_error_mixture(
    errors: npt.ArrayLike,
    seed: int | RandomStream,
    settings: ErrorMixtureSettings | None = None,
) -> ErrorMixtureFit:
    """Fits mixtures of 1, 2, ... components and a wide one for outliers, and returns the one with the least BIC.

    Parameters
    ----------
    errors : array_like, shape (n, 6)
        Errors in the form of `sight_error`, at least 8.
    seed : int or RandomStream
        Seed of the starts.
    settings : ErrorMixtureSettings, optional
        Priors, width of the outliers, stopping criteria.

    Raises
    ------
    ValueError
        For fewer than 8 errors, and errors that are not finite.
    """
    handle, *rest = _core.fit_error_mixture(
        _error_rows(errors), settings or ErrorMixtureSettings(), stream_of(seed)
    )
    return ErrorMixtureFit(ErrorMixture._of(handle), *rest)


def fit_error_gaussian(errors: npt.ArrayLike) -> ErrorMixture:
    """One Gaussian with the mean and covariance of at least 8 errors, shape (n, 6)."""
    return ErrorMixture._of(_core.fit_error_gaussian(_error_rows(errors)))


def trimmed_errors(errors: npt.ArrayLike, trim: float = 5.0) -> FloatArray:
    """The errors within `trim` robust standard deviations of the median on every axis.

    Parameters
    ----------
    errors : array_like, shape (n, 6)
        Errors.
    trim : float
        Robust standard deviations, 1.4826 times the median distance from the median.

    Returns
    -------
    ndarray, shape (m, 6)
        All errors if fewer than 8 are within.
    """
    rows: FloatArray = _core.trimmed_errors(_error_rows(errors), trim)
    return rows


@dataclass(frozen=True)
class PoseConsensus:
    """Weighted draws of the true pose.

    Attributes
    ----------
    truths : SE3, shape (n,)
        Draws of T_camera_object.
    weights : ndarray, shape (n,)
        Weights of the draws; they sum to one.
    """

    truths: SE3
    weights: FloatArray

    @property
    def effective_draws(self) -> float:
        """The effective number of draws, 1 / sum of the squared weights."""
        return float(1.0 / np.square(self.weights).sum())

    def resampled(self, count: int) -> PoseConsensus:
        """`count` draws of equal weight, by systematic resampling."""
        return PoseConsensus(*_core.resample_consensus(self.truths, self.weights, count))

    def success_probability(
        self,
        estimate: SE3,
        regions: ToleranceRegion | Sequence[ToleranceRegion],
        symmetry: SymmetryGroup | None = None,
    ) -> FloatArray:
        """Probabilities that grasps planned with the estimates succeed, shape of `estimate`.

        Parameters
        ----------
        estimate : SE3, shape (...)
            T_camera_object for which a grasp is planned.
        regions : ToleranceRegion or sequence of them
            Tolerance of the grasp; for several regions the mean probability is taken.
        symmetry : SymmetryGroup, optional
            Symmetries of the object.

        Raises
        ------
        ValueError
            Without a region, and for a region whose widths or probabilities are out of range.
        """
        all_regions = [regions] if isinstance(regions, ToleranceRegion) else list(regions)
        found: FloatArray = _core.consensus_success(
            self.truths, self.weights, estimate, all_regions, symmetry or SymmetryGroup()
        )
        return found


def fuse_estimates(
    estimates: SE3,
    errors: ErrorMixture | Sequence[ErrorMixture],
    seed: int | RandomStream,
    settings: ConsensusSettings | None = None,
) -> PoseConsensus:
    """The normalised product of several estimators' densities of the true pose, by importance sampling.

    Parameters
    ----------
    estimates : SE3, shape (n,)
        T_camera_object by every estimator.
    errors : ErrorMixture or sequence of n
        Error mixtures of the estimators; a single one is used for all.
    seed : int or RandomStream
        Seed of the draws.
    settings : ConsensusSettings, optional
        Number of draws, and correlation of the estimators' errors.

    Raises
    ------
    ValueError
        Without estimates or draws, for numbers of estimates and error mixtures that differ, and for a correlation
        outside [0, 1].
    """
    members = estimates if estimates.shape else SE3._wrap(estimates._data, (1,))
    mixtures = [errors] * len(members) if isinstance(errors, ErrorMixture) else list(errors)
    found = _core.fuse_estimates(
        members, [m._handle for m in mixtures], settings or ConsensusSettings(), stream_of(seed)
    )
    return PoseConsensus(*found)
