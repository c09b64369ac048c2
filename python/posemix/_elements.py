# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""What rotations and poses have in common: arrays of elements of a group."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar, TypeVar

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray, as_floats, as_vectors, flat_rows, require_finite, thread_count, whole_numbers

Self = TypeVar("Self", bound="Elements")


class Elements:
    """Base class of rotations and poses."""

    DOF: ClassVar[int]
    _SIZE: ClassVar[int]
    _SIDE: ClassVar[int]
    _PREFIX: ClassVar[str]

    __slots__ = ("_data",)
    _data: FloatArray

    @classmethod
    def _checked(cls: type[Self], value: Any, name: str) -> Self:
        """The value itself; raises TypeError naming the argument where it is none of this class."""
        if not isinstance(value, cls):
            kinds = cls.__name__ if cls is not Elements else "SO3 or SE3"
            raise TypeError(f"{name} is a {type(value).__name__}; expected {kinds}")
        return value

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
        if self._data.ndim == 1:
            return self._data[None]
        return flat_rows(np.ascontiguousarray(self._data), 1)

    @classmethod
    def identity(cls: type[Self], shape: int | tuple[int, ...] = ()) -> Self:
        """The identity, or an array of identities.

        Parameters
        ----------
        shape : int or tuple of int
            Shape of the array.

        Raises
        ------
        TypeError
            For lengths that are no whole numbers.
        """
        data = np.zeros((*whole_numbers(shape, "shape"), cls._SIZE))
        data[..., -1] = 1.0
        return cls._wrap(data, data.shape[:-1])

    @classmethod
    def exp(cls: type[Self], xi: npt.ArrayLike, *, threads: int = 1) -> Self:
        """The elements with the given logarithms.

        Parameters
        ----------
        xi : array_like, shape (..., dof)
            Tangent vectors, rotation (rad) before translation (m).
        threads : int
            Number of threads, 0 for one per core. The result has the same bits for any number.
        """
        rows, shape = as_vectors(xi, cls.DOF, "xi")
        return cls._wrap(cls._call("exp", rows, thread_count(threads)), shape)

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
        # The numbers of an element are no entries; an ellipsis comes once.
        rest = () if any(each is Ellipsis for each in key) else (Ellipsis,)
        part = self._data[(*key, *rest, slice(None))]
        return self._wrap(np.ascontiguousarray(part), part.shape[:-1])

    def __iter__(self: Self) -> Iterator[Self]:
        return (self[i] for i in range(len(self)))

    def log(self, *, threads: int = 1) -> FloatArray:
        """Tangent vectors [rad, m], shape (..., dof); the norm of the rotation vector is at most pi.

        Parameters
        ----------
        threads : int
            As for `exp`.
        """
        rows = self._call("log", self._rows(), thread_count(threads))
        return rows.reshape((*self.shape, self.DOF))

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
        if self.shape == other.shape or not other.shape:
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
        if self._data.ndim == other._data.ndim == 1:
            return self._wrap(self._call("multiply", self._rows(), other._rows()), ())
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
        values = require_finite(as_floats(points, (3,), "points"), "points")
        shape = np.broadcast_shapes(self.shape, values.shape[:-1])
        a = self._rows()
        if self.shape and self.shape != shape:
            a = flat_rows(np.ascontiguousarray(np.broadcast_to(self._data, (*shape, self._SIZE))), 1)
        if values.ndim > 1 and values.shape[:-1] != shape:
            values = np.ascontiguousarray(np.broadcast_to(values, (*shape, 3)))
        return self._call("act", a, flat_rows(values, 1)).reshape((*shape, 3))

    @classmethod
    def _jacobian(cls, name: str, xi: npt.ArrayLike, sign: int, threads: int) -> FloatArray:
        rows, shape = as_vectors(xi, cls.DOF, "xi")
        matrices = cls._call(name, rows if sign > 0 else -rows, thread_count(threads))
        return matrices.reshape((*shape, cls.DOF, cls.DOF))

    @classmethod
    def left_jacobian(cls, xi: npt.ArrayLike, *, threads: int = 1) -> FloatArray:
        """J_l(xi), shape (..., dof, dof): Exp(xi + d) = Exp(J_l(xi) d) Exp(xi) to first order.

        Parameters
        ----------
        xi, threads
            As for `exp`.
        """
        return cls._jacobian("left_jacobian", xi, 1, threads)

    @classmethod
    def left_jacobian_inverse(cls, xi: npt.ArrayLike, *, threads: int = 1) -> FloatArray:
        """J_l(xi)^-1, shape (..., dof, dof); singular at angles 2 pi, 4 pi, ...

        Parameters
        ----------
        xi, threads
            As for `exp`.
        """
        return cls._jacobian("left_jacobian_inverse", xi, 1, threads)

    @classmethod
    def right_jacobian(cls, xi: npt.ArrayLike, *, threads: int = 1) -> FloatArray:
        """J_r(xi) = J_l(-xi), shape (..., dof, dof).

        Parameters
        ----------
        xi, threads
            As for `exp`.
        """
        return cls._jacobian("left_jacobian", xi, -1, threads)

    @classmethod
    def right_jacobian_inverse(cls, xi: npt.ArrayLike, *, threads: int = 1) -> FloatArray:
        """J_r(xi)^-1, shape (..., dof, dof).

        Parameters
        ----------
        xi, threads
            As for `exp`.
        """
        return cls._jacobian("left_jacobian_inverse", xi, -1, threads)

    @classmethod
    def ad(cls, xi: npt.ArrayLike) -> FloatArray:
        """ad(xi), shape (..., dof, dof): ad(a) b = [a, b]."""
        rows, shape = as_vectors(xi, cls.DOF, "xi")
        return cls._call("ad", rows).reshape((*shape, cls.DOF, cls.DOF))

    def is_approx(self: Self, other: Self, tolerance: float = 1e-9) -> bool:
        """Whether all logarithms of ``other^-1 self`` have norms of at most `tolerance`."""
        if not tolerance >= 0.0:
            raise ValueError(f"tolerance is {tolerance}; expected a number that is not negative")
        differences = (type(self)._checked(other, "other").inverse() * self).log()
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
