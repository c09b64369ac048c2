# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Checks of array arguments."""

from __future__ import annotations

import operator
from typing import Any, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

FloatArray: TypeAlias = npt.NDArray[np.float64]


def real_numbers(values: npt.ArrayLike, name: str, order: Literal["K", "C"] = "K") -> FloatArray:
    """Values as doubles, which are not copied if they are some.

    Raises TypeError for dates, texts and complex numbers, and ValueError for values that are masked.
    """
    if isinstance(values, np.ma.MaskedArray) and np.ma.is_masked(values):
        raise ValueError(f"{name} has values that are masked; expected numbers")
    array = np.asarray(values)
    if array.size > 0 and array.dtype.kind not in "biufO":
        raise TypeError(f"{name} has values of the type {array.dtype}; expected real numbers")
    return np.asarray(array, dtype=np.float64, order=order)


def as_floats(values: npt.ArrayLike, trailing: tuple[int, ...], name: str) -> FloatArray:
    """Values as a C-contiguous array of doubles whose last axes are `trailing`.

    An array that already has this form is not copied.
    """
    array = real_numbers(values, name, "C")
    if array.shape[array.ndim - len(trailing) :] != trailing or array.ndim < len(trailing):
        expected = ", ".join(["...", *map(str, trailing)])
        raise ValueError(f"{name} has shape {array.shape}; expected ({expected})")
    return array


def as_vectors(values: npt.ArrayLike, size: int, name: str) -> tuple[FloatArray, tuple[int, ...]]:
    """Vectors of `size` numbers as rows of a matrix, and the shape of their array.

    Doubles are copied only if the numbers of a vector are not next to each other, or if the vectors are not
    evenly apart.
    """
    array = real_numbers(values, name)
    row = array.strides[0] if array.ndim == 2 else -1
    if array.shape[-1:] != (size,) or array.strides[-1] != 8 or row < 0 or row % 8 or not array.flags.aligned:
        array = as_floats(array, (size,), name)
    return flat_rows(array, 1), array.shape[:-1]


def whole_numbers(values: Any, name: str) -> tuple[int, ...]:
    """One or more whole numbers as a tuple; raises TypeError where there are others."""
    try:
        return tuple(operator.index(value) for value in (values if np.ndim(values) else (values,)))
    except TypeError:
        raise TypeError(f"{name} is {values!r}; expected a whole number or a tuple of them") from None


def thread_count(threads: int) -> int:
    """The number of threads; raises ValueError where it is negative."""
    if threads < 0:
        raise ValueError(f"threads is {threads}; expected 1 or more, or 0 for one per core")
    return threads


def flat_rows(array: FloatArray, trailing: int) -> FloatArray:
    """The array with all axes but the last `trailing` joined to one."""
    return array.reshape((-1, *array.shape[array.ndim - trailing :]))


def require_finite(array: FloatArray, name: str) -> FloatArray:
    """The array itself; raises ValueError naming the first entry that is not finite."""
    if not np.isfinite(array).all():
        index = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise ValueError(f"{name} holds {array[index]} at index {index}; expected finite numbers")
    return array
