# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Rotations and poses, one or an array of them.

An `SO3` or `SE3` holds one element (shape ``()``) or an array of any shape, and every operation works on
all of them at once. A tangent vector is ``[phi, rho]``, rotation (rad) before translation (m); the
perturbation is on the left, ``X = Exp(xi) X0``. ``T_a_b`` maps points of frame b into frame a.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar, TypeVar

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray, as_floats, flat_rows, require_finite

__all__ = ["SE3", "SO3", "interpolate", "weighted_mean"]

Self = TypeVar("Self", bound="_Elements")


class _Elements:
    """Base class of rotations and poses."""

    DOF: ClassVar[int]
    _SIZE: ClassVar[int]
    _SIDE: ClassVar[int]
    _PREFIX: ClassVar[str]

    __slots__ = ("_data",)
    _data: FloatArray

    @classmethod
    def _call(cls, name: str, *arguments: Any) -> FloatArray:
        result: FloatArray = getattr(_core, cls._PREFIX + name)(*arguments)
        return result

    @classmethod
    def _wrap(cls: type[Self], data: FloatArray, shape: tuple[int, ...]) -> Self:
        element = cls.__new__(cls)
        element._data = data.reshape((*shape, cls._SIZE))
        return element

    def _rows(self) -> FloatArray:
        return flat_rows(np.ascontiguousarray(self._data), 1)

    @classmethod
    def identity(cls: type[Self], shape: int | tuple[int, ...] = ()) -> Self:
        """The identity, or an array of identities.

        Parameters
        ----------
        shape : int or tuple of int
            Shape of the array.
        """
        data = np.zeros((*np.atleast_1d(np.asarray(shape, dtype=int)), cls._SIZE))
        data[..., -1] = 1.0
        return cls._wrap(data, data.shape[:-1])

    @classmethod
    def exp(cls: type[Self], xi: npt.ArrayLike) -> Self:
        """The elements with the given logarithms.

        Parameters
        ----------
        xi : array_like, shape (..., dof)
            Tangent vectors, rotation (rad) before translation (m).
        """
        values = as_floats(xi, (cls.DOF,), "xi")
        return cls._wrap(cls._call("exp", flat_rows(values, 1)), values.shape[:-1])

    @classmethod
    def from_matrix(cls: type[Self], matrix: npt.ArrayLike, tolerance: float = 1e-6) -> Self:
        """Elements from rotation matrices, shape (..., 3, 3), or homogeneous matrices, shape (..., 4, 4).

        Parameters
        ----------
        matrix : array_like
            Matrices; the rotation is the nearest one.
        tolerance : float
            Largest deviation from a rotation.

        Raises
        ------
        ValueError
            If a matrix deviates by more, is a reflection, or is not finite.
        """
        values = as_floats(matrix, (cls._SIDE, cls._SIDE), "matrix")
        data = cls._call("from_matrix", flat_rows(values, 2), tolerance)
        return cls._wrap(data, values.shape[:-2])

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the array; ``()`` for one element."""
        return self._data.shape[:-1]

    def __len__(self) -> int:
        if not self.shape:
            raise TypeError(f"one {type(self).__name__} has no length")
        return self.shape[0]

    def __getitem__(self: Self, index: Any) -> Self:
        if not self.shape:
            raise TypeError(f"one {type(self).__name__} has no entries")
        key = index if isinstance(index, tuple) else (index,)
        part = self._data[(*key, Ellipsis, slice(None))]
        return self._wrap(np.ascontiguousarray(part), part.shape[:-1])

    def __iter__(self: Self) -> Iterator[Self]:
        return (self[i] for i in range(len(self)))

    def log(self) -> FloatArray:
        """Tangent vectors [rad, m], shape (..., dof); the norm of the rotation vector is at most pi."""
        return self._call("log", self._rows()).reshape((*self.shape, self.DOF))

    def inverse(self: Self) -> Self:
        """The inverse elements."""
        return self._wrap(self._call("inverse", self._rows()), self.shape)

    def matrix(self) -> FloatArray:
        """Matrices, shape (..., 3, 3) for rotations, (..., 4, 4) for poses."""
        side = self._SIDE
        return self._call("matrix", self._rows()).reshape((*self.shape, side, side))

    def adjoint(self) -> FloatArray:
        """Ad(X), shape (..., dof, dof): Exp(Ad(X) xi) = X Exp(xi) X^-1."""
        return self._square(self._call("adjoint", self._rows()))

    def _square(self, rows: FloatArray) -> FloatArray:
        return rows.reshape((*self.shape, self.DOF, self.DOF))

    def _broadcast(self: Self, other: Self) -> tuple[FloatArray, FloatArray, tuple[int, ...]]:
        if self.shape == other.shape:
            return self._rows(), other._rows(), self.shape
        if not other.shape:
            return self._rows(), other._rows(), self.shape
        if not self.shape:
            return self._rows(), other._rows(), other.shape
        shape = np.broadcast_shapes(self.shape, other.shape)
        full = (*shape, self._SIZE)
        a = np.ascontiguousarray(np.broadcast_to(self._data, full))
        b = np.ascontiguousarray(np.broadcast_to(other._data, full))
        return flat_rows(a, 1), flat_rows(b, 1), shape

    def __mul__(self: Self, other: Self) -> Self:
        """The product, first `other` then `self`; arrays are broadcast."""
        if not isinstance(other, type(self)):
            return NotImplemented
        a, b, shape = self._broadcast(other)
        return self._wrap(self._call("multiply", a, b), shape)

    __matmul__ = __mul__

    def act(self, points: npt.ArrayLike) -> FloatArray:
        """Transformed points, ``p_a = T_a_b p_b``.

        Parameters
        ----------
        points : array_like, shape (..., 3)
            Points, broadcast against the elements [m].

        Returns
        -------
        ndarray, shape (..., 3)
        """
        values = as_floats(points, (3,), "points")
        shape = np.broadcast_shapes(self.shape, values.shape[:-1])
        a = self._rows()
        if self.shape and self.shape != shape:
            a = flat_rows(np.ascontiguousarray(np.broadcast_to(self._data, (*shape, self._SIZE))), 1)
        if values.ndim > 1 and values.shape[:-1] != shape:
            values = np.ascontiguousarray(np.broadcast_to(values, (*shape, 3)))
        return self._call("act", a, flat_rows(values, 1)).reshape((*shape, 3))

    @classmethod
    def _jacobian(cls, name: str, xi: npt.ArrayLike) -> FloatArray:
        values = as_floats(xi, (cls.DOF,), "xi")
        rows = cls._call(name, flat_rows(values, 1))
        return rows.reshape((*values.shape[:-1], cls.DOF, cls.DOF))

    @classmethod
    def left_jacobian(cls, xi: npt.ArrayLike) -> FloatArray:
        """J_l(xi), shape (..., dof, dof): Exp(xi + d) = Exp(J_l(xi) d) Exp(xi) to first order."""
        return cls._jacobian("left_jacobian", xi)

    @classmethod
    def left_jacobian_inverse(cls, xi: npt.ArrayLike) -> FloatArray:
        """J_l(xi)^-1, shape (..., dof, dof); singular at angles 2 pi, 4 pi, ..."""
        return cls._jacobian("left_jacobian_inverse", xi)

    @classmethod
    def right_jacobian(cls, xi: npt.ArrayLike) -> FloatArray:
        """J_r(xi) = J_l(-xi), shape (..., dof, dof)."""
        return cls._jacobian("right_jacobian", xi)

    @classmethod
    def right_jacobian_inverse(cls, xi: npt.ArrayLike) -> FloatArray:
        """J_r(xi)^-1, shape (..., dof, dof)."""
        return cls._jacobian("right_jacobian_inverse", xi)

    @classmethod
    def ad(cls, xi: npt.ArrayLike) -> FloatArray:
        """ad(xi), shape (..., dof, dof): ad(a) b = [a, b]."""
        return cls._jacobian("ad", xi)

    def is_approx(self: Self, other: Self, tolerance: float = 1e-9) -> bool:
        """Whether all logarithms of ``other^-1 self`` have norms of at most `tolerance`."""
        differences = (other.inverse() * self).log()
        return bool((np.linalg.norm(differences, axis=-1) <= tolerance).all())

    def __reduce__(self: Self) -> tuple[Any, tuple[Any, ...]]:
        return _restored, (type(self), self._data)

    def __repr__(self) -> str:
        name = type(self).__name__
        if self.shape:
            return f"<{name} array of shape {self.shape}>"
        numbers = np.array2string(self._data, precision=6, suppress_small=True, separator=", ")
        return f"{name}({numbers})"


def _restored(cls: type[Self], data: FloatArray) -> Self:
    return cls._wrap(data, data.shape[:-1])


class SO3(_Elements):
    """Rotations.

    Parameters
    ----------
    quaternion : array_like, shape (..., 4), optional
        Quaternions ``[x, y, z, w]`` of any length but zero; q and -q are the same rotation. The identity
        unless given.

    Raises
    ------
    ValueError
        For a quaternion that is zero or not finite.

    Examples
    --------
    >>> import numpy as np
    >>> from posemix import SO3
    >>> quarter = SO3.exp([0, 0, np.pi / 2])
    >>> quarter.act([1.0, 0.0, 0.0]).round(9)
    array([0., 1., 0.])
    >>> SO3.exp(np.zeros((1000, 3))).shape
    (1000,)
    """

    DOF = 3
    _SIZE = 4
    _SIDE = 3
    _PREFIX = "so3_"
    __slots__ = ()

    def __init__(self, quaternion: npt.ArrayLike = (0.0, 0.0, 0.0, 1.0)) -> None:
        values = as_floats(quaternion, (4,), "quaternion")
        rows = _core.so3_normalized(flat_rows(values, 1))
        self._data = rows.reshape(values.shape)

    @property
    def quaternion(self) -> FloatArray:
        """Unit quaternions ``[x, y, z, w]``, shape (..., 4)."""
        return self._data.copy()

    def angle(self) -> FloatArray:
        """Angles of rotation in [0, pi], shape (...) [rad]."""
        norms = np.linalg.norm(self._data[..., :3], axis=-1)
        return np.asarray(2.0 * np.arctan2(norms, np.abs(self._data[..., 3])))


class SE3(_Elements):
    """Poses.

    Parameters
    ----------
    rotation : SO3, optional
        Rotations, the identity unless given.
    translation : array_like, shape (..., 3), optional
        Translations [m], zero unless given. Broadcast against the rotations.

    Examples
    --------
    >>> import numpy as np
    >>> from posemix import SE3, SO3
    >>> T_world_camera = SE3(SO3.exp([0, 0, np.pi / 2]), [1.0, 0.0, 0.0])
    >>> T_camera_object = SE3(translation=[0.0, 0.0, 2.0])
    >>> (T_world_camera * T_camera_object).translation.round(9)
    array([1., 0., 2.])
    """

    DOF = 6
    _SIZE = 7
    _SIDE = 4
    _PREFIX = "se3_"
    __slots__ = ()

    def __init__(
        self, rotation: SO3 | None = None, translation: npt.ArrayLike = (0.0, 0.0, 0.0)
    ) -> None:
        turned = SO3() if rotation is None else rotation
        moved = require_finite(as_floats(translation, (3,), "translation"), "translation")
        shape = np.broadcast_shapes(turned.shape, moved.shape[:-1])
        self._data = np.empty((*shape, 7))
        self._data[..., :3] = moved
        self._data[..., 3:] = turned._data

    @classmethod
    def from_tq(cls, values: npt.ArrayLike) -> SE3:
        """Poses from rows ``[tx, ty, tz, qx, qy, qz, qw]``, shape (..., 7), as in TUM files."""
        rows = as_floats(values, (7,), "values")
        return cls(SO3(rows[..., 3:]), rows[..., :3])

    def to_tq(self) -> FloatArray:
        """Rows ``[tx, ty, tz, qx, qy, qz, qw]``, shape (..., 7)."""
        return self._data.copy()

    @property
    def rotation(self) -> SO3:
        """The rotations."""
        return SO3._wrap(np.ascontiguousarray(self._data[..., 3:]), self.shape)

    @property
    def translation(self) -> FloatArray:
        """The translations, shape (..., 3) [m]."""
        return self._data[..., :3].copy()


G = TypeVar("G", SO3, SE3)


def interpolate(a: G, b: G, t: npt.ArrayLike) -> G:
    """Points of the geodesic from `a` (t = 0) to `b` (t = 1): Exp(t Log(b a^-1)) a.

    Parameters
    ----------
    a, b : SO3 or SE3
        One element each.
    t : array_like, shape (...)
        Parameters.
    """
    at = np.ascontiguousarray(t, dtype=np.float64)
    data = a._call("interpolate", a._data, b._data, at.reshape(-1))
    return a._wrap(data, at.shape)


def weighted_mean(x: G, weights: npt.ArrayLike | None = None) -> G:
    """The mean of an array of elements: sum w_i Log(X_i mean^-1) = 0.

    Parameters
    ----------
    x : SO3 or SE3, shape (n,)
        Elements.
    weights : array_like, shape (n,), optional
        Weights, not negative; all one unless given.

    Raises
    ------
    ValueError
        For no element, invalid weights, or if the iteration does not converge.

    References
    ----------
    Pennec and Arsigny, Exponential Barycenters of the Canonical Cartan Connection (2012).
    """
    w = np.ones(len(x)) if weights is None else as_floats(weights, (len(x),), "weights")
    data, converged = type(x)._call("weighted_mean", x._rows(), w)
    if not converged:
        raise ValueError("the weighted mean did not converge: the elements lie too far apart")
    return x._wrap(data, ())
