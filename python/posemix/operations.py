# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Operations on densities and mixtures: compose, invert, fuse, move, merge, reduce."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray, as_floats, flat_rows, require_finite
from posemix._core import (
    CompositionRule,
    FuseSettings,
    MergeSettings,
    MomentSettings,
    ProjectedFuseSettings,
    ProjectedMixtureComposeSettings,
    ProjectedMixtureFuseSettings,
    ReductionSettings,
)
from posemix.density import ConcentratedGaussian, ProjectedGaussian
from posemix.lie import SE3, SO3
from posemix.mixture import Mixture, density_of, log_of_weights

__all__ = [
    "BoundedLoss", "FuseResult", "MergeRecord", "MergeResult", "Moments", "Reduction", "ReductionReport",
    "back_project", "between", "between_arrays", "compose", "compose_arrays", "fuse", "fuse_arrays", "inverse",
    "inverse_arrays", "merge", "moments", "recenter", "reduce",
]  # fmt: skip

G = TypeVar("G", SO3, SE3)
D = TypeVar("D", bound="ConcentratedGaussian[Any] | ProjectedGaussian[Any]")
X = TypeVar("X", bound="ConcentratedGaussian[Any] | ProjectedGaussian[Any] | Mixture[Any]")


def _wrapped(handle: Any) -> Any:
    is_mixture = type(handle).__name__.startswith("Mixture")
    return Mixture._of(handle) if is_mixture else density_of(handle)


def _rule(x: Any, settings: CompositionRule | ProjectedMixtureComposeSettings | None) -> list[Any]:
    """The argument that composition of this kind takes."""
    name = type(x._handle).__name__
    if "Projected" not in name:
        if settings is not None:
            raise ValueError("concentrated Gaussians are composed without settings")
        return []
    if name.startswith("Mixture"):
        if isinstance(settings, CompositionRule):
            return [ProjectedMixtureComposeSettings(rule=settings)]
        return [settings or ProjectedMixtureComposeSettings()]
    if isinstance(settings, ProjectedMixtureComposeSettings):
        return [settings.rule]
    return [settings or CompositionRule.cubature]


def compose(
    x: X, y: X, settings: CompositionRule | ProjectedMixtureComposeSettings | None = None
) -> X:
    """The density or mixture of X Y for independent X and Y.

    Concentrated: to first order, mean X0 Y0, covariance P_X + Ad(X0) P_Y Ad(X0)^T (Barfoot and Furgale
    2014). Projected: by `settings`, cubature of degree five unless given (MPG paper, eq. 17 and 21-22).
    Mixtures: all pairs of components.

    Parameters
    ----------
    x, y : ConcentratedGaussian, ProjectedGaussian or Mixture
        Of one kind.
    settings : CompositionRule or ProjectedMixtureComposeSettings, optional
        For projected Gaussians.
    """
    result: X = _wrapped(_core.compose(x._handle, y._handle, *_rule(x, settings)))
    return result


def inverse(
    x: X, settings: CompositionRule | ProjectedMixtureComposeSettings | None = None
) -> X:
    """The density or mixture of X^-1; exact for concentrated Gaussians."""
    result: X = _wrapped(_core.inverse(x._handle, *_rule(x, settings)))
    return result


def between(
    x: X, y: X, settings: CompositionRule | ProjectedMixtureComposeSettings | None = None
) -> X:
    """The density or mixture of X^-1 Y for independent X and Y."""
    result: X = _wrapped(_core.between(x._handle, y._handle, *_rule(x, settings)))
    return result


def _pose_rows(means: SE3, covariances: npt.ArrayLike) -> tuple[FloatArray, FloatArray]:
    matrices = require_finite(as_floats(covariances, (6, 6), "covariances"), "covariances")
    return flat_rows(np.ascontiguousarray(means._data), 1), flat_rows(matrices, 2)


def _pose_arrays(rows: Any, shape: tuple[int, ...]) -> tuple[SE3, FloatArray]:
    means, covariances = rows
    return SE3._wrap(means, shape), covariances.reshape((*shape, 6, 6))


def compose_arrays(
    x: SE3, covariance_x: npt.ArrayLike, y: SE3, covariance_y: npt.ArrayLike
) -> tuple[SE3, FloatArray]:
    """Means and covariances of X_i Y_i, all at once; see `compose`.

    Parameters
    ----------
    x, y : SE3, shape (n,) or ()
        Means; a single one stands for all.
    covariance_x, covariance_y : array_like, shape (n, 6, 6) or (6, 6)
        Covariances of the left perturbations, as many as means. That they are positive definite is not checked.

    Returns
    -------
    mean : SE3, shape (n,)
    covariance : ndarray, shape (n, 6, 6)

    Raises
    ------
    ValueError
        For covariances that are not finite, and numbers of densities that do not fit.
    """
    rows = _core.compose_rows(*_pose_rows(x, covariance_x), *_pose_rows(y, covariance_y))
    return _pose_arrays(rows, x.shape or y.shape)


def between_arrays(
    x: SE3, covariance_x: npt.ArrayLike, y: SE3, covariance_y: npt.ArrayLike
) -> tuple[SE3, FloatArray]:
    """Means and covariances of X_i^-1 Y_i, as `compose_arrays`."""
    rows = _core.between_rows(*_pose_rows(x, covariance_x), *_pose_rows(y, covariance_y))
    return _pose_arrays(rows, x.shape or y.shape)


def inverse_arrays(x: SE3, covariance: npt.ArrayLike) -> tuple[SE3, FloatArray]:
    """Means and covariances of X_i^-1, as `compose_arrays`."""
    return _pose_arrays(_core.inverse_rows(*_pose_rows(x, covariance)), x.shape)


def fuse_arrays(
    x: SE3,
    covariance_x: npt.ArrayLike,
    y: SE3,
    covariance_y: npt.ArrayLike,
    settings: FuseSettings | None = None,
) -> tuple[SE3, FloatArray, npt.NDArray[np.bool_]]:
    """Means and covariances of the products of two densities each; arguments as of `compose_arrays`.

    Returns
    -------
    mean : SE3, shape (n,)
    covariance : ndarray, shape (n, 6, 6)
    converged : ndarray of bool, shape (n,)
        Where it is False mean and covariance are those of the last iteration.
    """
    means, covariances, converged = _core.fuse_rows(
        *_pose_rows(x, covariance_x), *_pose_rows(y, covariance_y), settings or FuseSettings()
    )
    shape = x.shape or y.shape
    mean, covariance = _pose_arrays((means, covariances), shape)
    return mean, covariance, np.asarray(converged, dtype=bool).reshape(shape)


@dataclass(frozen=True)
class FuseResult(Generic[X]):
    """Result of `fuse`.

    Attributes
    ----------
    density : ConcentratedGaussian, ProjectedGaussian or Mixture
        The normalised product.
    log_overlap : float
        Log of the integral of the product over the group [nats].
    converged : bool
        Whether the iteration did, of every pair.
    iterations : int or None
        Of a single pair.
    """

    density: X
    log_overlap: float
    converged: bool
    iterations: int | None = None


def _fuse_settings(p: Any, settings: Any) -> Any:
    name = type(p._handle).__name__
    kind: Any = FuseSettings
    if "Projected" in name:
        kind = ProjectedMixtureFuseSettings if name.startswith("Mixture") else ProjectedFuseSettings
    if settings is None:
        return kind()
    if isinstance(settings, ProjectedFuseSettings) and kind is ProjectedMixtureFuseSettings:
        return kind(pair=settings)
    if not isinstance(settings, kind):
        raise TypeError(f"settings are {type(settings).__name__}; expected {kind.__name__}")
    return settings


def fuse(
    p: X,
    q: X,
    settings: FuseSettings | ProjectedFuseSettings | ProjectedMixtureFuseSettings | None = None,
) -> FuseResult[X]:
    """The normalised product of two densities or mixtures and the log of its integral.

    Concentrated: Gauss-Newton to the mode, Laplace's approximation there. Projected: MPG paper, III-C and
    eq. 19-20, with the overlap itself as weight. Mixtures: all pairs, weighted by their overlaps.

    Raises
    ------
    ValueError
        When no pair overlaps, or for settings out of range.
    """
    handle, log_overlap, converged, *rest = _core.fuse(
        p._handle, q._handle, _fuse_settings(p, settings)
    )
    return FuseResult(_wrapped(handle), log_overlap, converged, rest[0] if rest else None)


def recenter(density: ConcentratedGaussian[G], anchor: G) -> tuple[FloatArray, FloatArray]:
    """Mean and covariance in the tangent space at `anchor` (midway-merge paper, eq. 9-10).

    First order in xi: mean d = Log(X0 anchor^-1), covariance J_l(d)^-1 P J_l(d)^-T.
    """
    mean, covariance = _core.recenter(density._handle, anchor._data)
    return mean, covariance


def back_project(
    anchor: G, mean: npt.ArrayLike, covariance: npt.ArrayLike
) -> ConcentratedGaussian[G]:
    """The density at Exp(mean) anchor with covariance J_l P J_l^T; undoes `recenter`."""
    dof = anchor.DOF
    handle = _core.back_project(
        anchor._data, as_floats(mean, (dof,), "mean"), as_floats(covariance, (dof, dof), "covariance")
    )
    return ConcentratedGaussian._of(handle)


@dataclass(frozen=True)
class Moments(Generic[D]):
    """Mean and covariance of a mixture on its group.

    Attributes
    ----------
    density : ConcentratedGaussian or ProjectedGaussian
        One density with these moments.
    converged : bool
        Whether the mean's iteration did.
    iterations : int
        Updates of the mean.
    residual : float
        Norm of the mean's tangent vector at the end [rad, m].
    """

    density: D
    converged: bool
    iterations: int
    residual: float


def moments(mixture: Mixture[D], settings: MomentSettings | None = None) -> Moments[D]:
    """Mean and covariance of a whole mixture, by cubature."""
    handle, converged, iterations, residual = _core.moments(
        mixture._handle, settings or MomentSettings()
    )
    return Moments(density_of(handle), converged, iterations, residual)


@dataclass(frozen=True)
class MergeResult(Generic[D]):
    """Result of `merge`: one density, its weight's logarithm, whether the mean converged."""

    density: D
    log_weight: float
    converged: bool


def merge(
    densities: Sequence[D],
    weights: npt.ArrayLike,
    settings: MergeSettings | None = None,
) -> MergeResult[D]:
    """Several components as one, by the midway merge unless `settings` say otherwise.

    Parameters
    ----------
    densities : sequence
        Densities of one kind.
    weights : array_like, shape (k,)
        Their weights, not normalised.
    settings : MergeSettings, optional
        The rule, and when the mean's iteration stops.

    References
    ----------
    Midway-merge paper, eq. 12-19.
    """
    log_weight, handle, converged = _core.merge(
        list(log_of_weights(weights)), [d._handle for d in densities], settings or MergeSettings()
    )
    return MergeResult(density_of(handle), log_weight, converged)


@dataclass(frozen=True)
class MergeRecord:
    """One merge: the two weights as fractions of the mixture, and the distance of the means."""

    weight_a: float
    weight_b: float
    distance: float


@dataclass(frozen=True)
class BoundedLoss:
    """What a reduction lost at most.

    Attributes
    ----------
    dropped : float
        Weight of what was dropped.
    merged_kl, merged_symmetric_kl : float
        Bounds on the divergence that merging caused [nats].
    total_variation : float
        Bound on the change of the probability of any set, of the whole reduction.
    kl_from_reduced : float
        Bound on the divergence from the reduced mixture to the full one [nats].
    """

    dropped: float
    merged_kl: float
    merged_symmetric_kl: float
    total_variation: float
    kl_from_reduced: float


@dataclass(frozen=True)
class ReductionReport:
    """What `reduce` did.

    Attributes
    ----------
    components_before, components_pruned, components_after : int
        Numbers of components.
    weight_pruned, weight_moved : float
        Weight dropped; sum over the merges of the smaller of both weights.
    merges : list of MergeRecord
        One per merge.
    destination : list of int or None
        For every component before the one after that holds it.
    bounded_loss : BoundedLoss or None
        Where it was asked for.
    converged : bool
        Whether every merge did.
    """

    components_before: int
    components_pruned: int
    components_after: int
    weight_pruned: float
    weight_moved: float
    merges: list[MergeRecord]
    destination: list[int | None]
    bounded_loss: BoundedLoss | None
    converged: bool


def reduction_report(values: dict[str, Any]) -> ReductionReport:
    """The report of compiled values."""
    loss = values["bounded_loss"]
    return ReductionReport(
        **{
            **values,
            "merges": [MergeRecord(*merge) for merge in values["merges"]],
            "bounded_loss": None if loss is None else BoundedLoss(**loss),
        }
    )


@dataclass(frozen=True)
class Reduction(Generic[D]):
    """Result of `reduce`: the smaller mixture and what was done."""

    mixture: Mixture[D]
    report: ReductionReport


def reduce(mixture: Mixture[D], settings: ReductionSettings | None = None) -> Reduction[D]:
    """A mixture with fewer components: prune, then merge pair after pair.

    Raises
    ------
    ValueError
        For settings out of range.
    """
    handle, report = _core.reduce(mixture._handle, settings or ReductionSettings())
    return Reduction(Mixture._of(handle), reduction_report(report))
