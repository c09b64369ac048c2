# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Arguments that are poses: an SE3, or what can be converted to one without a doubt."""

from __future__ import annotations

import collections.abc
from typing import Any

import numpy as np

from posemix._arrays import FloatArray, as_floats
from posemix.lie import SE3

_EXPECTED = "an SE3 or a matrix of shape (4, 4)"


def _from_matrices(matrices: Any, name: str) -> SE3:
    try:
        return SE3.from_matrix(matrices)
    except ValueError as error:
        raise ValueError(f"{name} is no pose: {error}") from None


def one_pose(value: Any, name: str) -> SE3:
    """One pose; the error names the argument `name` and says what was expected."""
    if isinstance(value, SE3):
        if value.shape:
            raise ValueError(f"{name} is an array of poses of shape {value.shape}; expected one pose")
        if not np.isfinite(value._data).all():
            raise ValueError(f"{name} is not finite, as a frame without a pose; expected a pose, or None where allowed")
        return value
    if isinstance(value, (np.ndarray, list, tuple)):
        if np.shape(value) != (4, 4):
            raise ValueError(f"{name} has shape {np.shape(value)}; expected {_EXPECTED}")
        return _from_matrices(value, name)
    raise TypeError(f"{name} is of type {type(value).__name__}; expected {_EXPECTED}")


def pose_rows(poses: Any, name: str = "poses") -> FloatArray:
    """Poses as rows of seven numbers, of NaN for a miss."""
    if isinstance(poses, SE3):
        rows = poses._data
    elif isinstance(poses, collections.abc.Sequence) and any(
        pose is None or isinstance(pose, SE3) or np.shape(pose) == (4, 4) for pose in poses
    ):
        rows = np.full((len(poses), 7), np.nan)
        for i, pose in enumerate(poses):
            if isinstance(pose, SE3) and pose._data.shape == (7,):
                rows[i] = pose._data
            elif pose is not None:
                rows[i] = one_pose(pose, f"{name}[{i}]")._data
    elif np.ndim(poses) == 3:
        rows = _from_matrices(as_floats(poses, (4, 4), name), name)._data
    else:
        rows = as_floats(poses, (7,), name) if np.size(poses) else np.empty((0, 7))
    if rows.ndim != 2:
        raise ValueError(f"{name} have shape {rows.shape[:-1]}; expected (n,)")
    return rows
