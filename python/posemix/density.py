# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Densities of one component: `ConcentratedGaussian` and `ProjectedGaussian`.

Densities are with respect to the Haar measure, in nats. Covariances are rotation (rad) before translation
(m).
"""

from __future__ import annotations

import math
from typing import Any, Generic, TypeVar

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray, as_floats, real_numbers
from posemix._elements import Elements
from posemix.lie import SE3, SO3
from posemix.random import RandomStream, stream_of

__all__ = ["ConcentratedGaussian", "ProjectedGaussian"]

G = TypeVar("G", SO3, SE3)

_CONCENTRATED: dict[type, Any] = {SO3: _core.ConcentratedSO3, SE3: _core.ConcentratedSE3}
_PROJECTED: dict[type, Any] = {SO3: _core.ProjectedSO3, SE3: _core.ProjectedSE3}
_ON_SO3 = (_core.ConcentratedSO3, _core.ProjectedSO3)


def rows_of(points: SO3 | SE3) -> FloatArray:
    """The elements as rows of numbers, shape (n, 4) or (n, 7)."""
    return Elements._checked(points, "points")._rows()


def standard_deviations(covariance: FloatArray) -> str:
    """The standard deviations of a covariance as text, in degrees and millimetres."""
    sds = np.sqrt(np.diagonal(covariance))
    text = "sd " + ", ".join(f"{math.degrees(v):.3g}" for v in sds[:3]) + " deg"
    if len(sds) == 6:
        text += "; " + ", ".join(f"{1000 * v:.3g}" for v in sds[3:]) + " mm"
    return text if len(sds) <= 6 else f"covariance {covariance.shape[0]} x {covariance.shape[0]}"


class _Density(Generic[G]):
    """What both kinds of density have in common: the compiled part and the group that it is on."""

    __slots__ = ("_group", "_handle")
    _group: type[G]
    _handle: Any
    __hash__ = None  # type: ignore[assignment]

    @classmethod
    def _of(cls, handle: Any) -> Any:
        density = cls.__new__(cls)
        density._handle = handle
        density._group = SO3 if isinstance(handle, _ON_SO3) else SE3  # type: ignore[assignment]
        return density

    def _parts(self) -> tuple[Any, ...]:
        """What the density is made from."""
        raise NotImplementedError

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]:
        return type(self), self._parts()

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        pairs = zip(self._parts(), other._parts(), strict=True)
        return all(np.array_equal(getattr(a, "_data", a), getattr(b, "_data", b)) for a, b in pairs)


class ConcentratedGaussian(_Density[G]):
    """A Gaussian on a Lie group around one element: X = Exp(xi) mean, xi ~ N(0, covariance).

    The perturbation is on the left: for a pose T_a_b, xi is stated in frame a. With a mean of shape (n,) it is a
    joint density on SE(3)^n, in which every pose has its own perturbation.

    Parameters
    ----------
    mean : SO3 or SE3
        One element, or an array of n poses.
    covariance : array_like, shape (dof, dof) or (6 n, 6 n)
        Covariance of xi [rad, m], symmetric positive definite.

    Raises
    ------
    ValueError
        For a covariance of the wrong size, not finite, not symmetric or not positive definite.

    References
    ----------
    Midway-merge paper, eq. 4-5.

    Examples
    --------
    >>> import numpy as np
    >>> from posemix import ConcentratedGaussian, SE3
    >>> pose = ConcentratedGaussian(SE3(), np.diag([0.01] * 3 + [1e-4] * 3))
    >>> pose.sample(1000, seed=1).shape
    (1000,)
    >>> round(pose.log_density(SE3()).item(), 2)
    15.21
    """

    __slots__ = ()

    def __init__(self, mean: G, covariance: npt.ArrayLike) -> None:
        matrix = real_numbers(covariance, "covariance", "C")
        if not isinstance(mean, (SO3, SE3)):
            raise TypeError(f"mean is a {type(mean).__name__}; expected SO3 or SE3")
        dof = mean.DOF * math.prod(mean.shape)
        if matrix.shape != (dof, dof):
            raise ValueError(f"covariance has shape {matrix.shape}; expected ({dof}, {dof})")
        self._group = type(mean)
        if not mean.shape:
            self._handle = _CONCENTRATED[type(mean)](mean._data, matrix)
        elif len(mean.shape) == 1 and isinstance(mean, SE3):
            self._handle = _core.ConcentratedStack(mean._data, matrix)
        else:
            raise ValueError(f"mean has shape {mean.shape}; expected one element, or (n,) poses")

    @property
    def mean(self) -> G:
        """The mean X0."""
        data = self._handle.mean
        return self._group._wrap(data, data.shape[:-1])

    @property
    def covariance(self) -> FloatArray:
        """Covariance of xi in X = Exp(xi) X0 (left perturbation, reference frame)."""
        matrix: FloatArray = self._handle.covariance
        return matrix

    @property
    def body_covariance(self) -> FloatArray:
        """Covariance of delta in X = X0 Exp(delta) (right perturbation, body frame)."""
        matrix: FloatArray = self._handle.body_covariance
        return matrix

    def log_density(self, points: G) -> FloatArray:
        """Log of the density with respect to the Haar measure [nats].

        Parameters
        ----------
        points : SO3 or SE3, shape (...)
            Elements; shape (..., n) for a joint density.

        Returns
        -------
        ndarray, shape (...)
        """
        Elements._checked(points, "points")
        shape = points.shape if not self.mean.shape else self._stack_shape(points)
        result: FloatArray = self._handle.log_density(rows_of(points))
        return result.reshape(shape)

    def _stack_shape(self, points: G) -> tuple[int, ...]:
        n = self.mean.shape[0]
        if not points.shape or points.shape[-1] != n:
            raise ValueError(f"points have shape {points.shape}; expected (..., {n})")
        return points.shape[:-1]

    def sample(self, count: int, seed: int | RandomStream) -> G:
        """Draws, shape (count,), or (count, n) from a joint density.

        Parameters
        ----------
        count : int
            Number of draws.
        seed : int or RandomStream
            A seed, or a stream, which is advanced.
        """
        data = self._handle.sample(count, stream_of(seed))
        return self._group._wrap(data, data.shape[:-1])

    def marginal(self, index: int) -> ConcentratedGaussian[SE3]:
        """The marginal density of one pose of a joint density."""
        density: ConcentratedGaussian[SE3] = self._joint().marginal(index)
        return density

    def conditional(self, indices: list[int], values: SE3) -> ConcentratedGaussian[SE3]:
        """The joint density of the other poses given the poses at `indices`, to first order."""
        density: ConcentratedGaussian[SE3] = self._joint().conditional(indices, rows_of(values))
        return density

    def relative_pose(self, from_index: int, to_index: int) -> ConcentratedGaussian[SE3]:
        """The density of ``T_from^-1 T_to``, including the cross-covariance of the two poses."""
        density: ConcentratedGaussian[SE3] = self._joint().relative_pose(from_index, to_index)
        return density

    def _joint(self) -> Any:
        if not self.mean.shape:
            raise ValueError("this is the density of one element; expected a joint density")
        return self._handle

    def _parts(self) -> tuple[Any, ...]:
        return self.mean, self.covariance

    def __repr__(self) -> str:
        return f"ConcentratedGaussian({self.mean!r}, {standard_deviations(self.covariance)})"


class ProjectedGaussian(_Density[G]):
    """A Gaussian in the tangent space of the unit quaternions, projected (MPG paper, III-B).

    y = [u, t] ~ N(tangent_mean, covariance), q = q0 (1, u) / sqrt(1 + u.u). u = axis tan(angle / 2), without unit,
    is a perturbation on the right, in the body frame; t is the translation itself [m], in the reference frame.

    Parameters
    ----------
    tangent_point : SO3
        The rotation q0.
    tangent_mean : array_like, shape (3,) or (6,)
        Mean of y: ``[u]`` for a rotation, ``[u, t]`` for a pose.
    covariance : array_like, shape (3, 3) or (6, 6)
        Covariance of y, symmetric positive definite.

    Raises
    ------
    ValueError
        For numbers that are not finite, and a covariance that is not symmetric positive definite.
    """

    __slots__ = ()

    def __init__(
        self, tangent_point: SO3, tangent_mean: npt.ArrayLike, covariance: npt.ArrayLike
    ) -> None:
        mean = real_numbers(tangent_mean, "tangent_mean", "C")
        if mean.shape not in ((3,), (6,)):
            raise ValueError(f"tangent_mean has shape {mean.shape}; expected (3,) or (6,)")
        matrix = as_floats(covariance, (len(mean), len(mean)), "covariance")
        group: Any = SO3 if len(mean) == 3 else SE3
        self._group = group
        point = SO3._checked(tangent_point, "tangent_point")
        self._handle = _PROJECTED[group](point._data, mean, matrix)

    @classmethod
    def at_mean(cls, mean: G, covariance: npt.ArrayLike) -> ProjectedGaussian[G]:
        """The density whose tangent point is its mode (PG_0).

        Parameters
        ----------
        mean : SO3 or SE3
            The mode.
        covariance : array_like
            Covariance of y.
        """
        if isinstance(mean, SE3):
            return cls(mean.rotation, np.r_[np.zeros(3), mean.translation], covariance)
        return cls(mean, np.zeros(3), covariance)

    @property
    def tangent_point(self) -> SO3:
        """The rotation q0."""
        return SO3._wrap(self._handle.tangent_point, ())

    @property
    def tangent_mean(self) -> FloatArray:
        """Mean of y."""
        values: FloatArray = self._handle.tangent_mean
        return values

    @property
    def covariance(self) -> FloatArray:
        """Covariance of y."""
        matrix: FloatArray = self._handle.covariance
        return matrix

    @property
    def mean(self) -> G:
        """The element at y = mean, which is the mode."""
        return self._group._wrap(self._handle.mean, ())

    def log_density(self, points: G) -> FloatArray:
        """Log of the density with respect to the Haar measure [nats], shape of `points`."""
        result: FloatArray = self._handle.log_density(rows_of(points))
        return result.reshape(points.shape)

    def sample(self, count: int, seed: int | RandomStream) -> G:
        """Draws from the density, shape (count,)."""
        return self._group._wrap(self._handle.sample(count, stream_of(seed)), (count,))

    def sample_by_projection(self, count: int, seed: int | RandomStream) -> G:
        """Draws of y, projected (MPG paper, IV); for a wide density their distribution differs from it."""
        data = self._handle.sample_by_projection(count, stream_of(seed))
        return self._group._wrap(data, (count,))

    def change_chart(self, tangent_point: SO3) -> ProjectedGaussian[G]:
        """The density in the chart at another tangent point, first order in u (eq. 15-16)."""
        density: ProjectedGaussian[G] = self._handle.change_chart(
            SO3._checked(tangent_point, "tangent_point")._data
        )
        return density

    def _parts(self) -> tuple[Any, ...]:
        return self.tangent_point, self.tangent_mean, self.covariance

    def __repr__(self) -> str:
        sds = np.sqrt(np.diagonal(self.covariance))
        return f"ProjectedGaussian(mode {self.mean!r}, sd of y {np.array2string(sds, precision=4)})"
