# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Trajectories, poses of objects and lists of poses."""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray
from posemix._core import Side, read_object_poses, write_object_poses, write_poses
from posemix.io.paths import Path
from posemix.lie import SE3
from posemix.recording import optional_rows

__all__ = [
    "PoseSamples",
    "StampedPoses",
    "read_object_poses",
    "read_pose_samples",
    "read_tum",
    "write_object_poses",
    "write_poses",
    "write_tum",
]

@dataclass(frozen=True, eq=False)
class StampedPoses:
    """Poses at times.

    Attributes
    ----------
    stamps : ndarray, shape (n,)
        Strictly increasing [s].
    poses : SE3, shape (n,)
        T_a_b of the file's two frames; NaN for a miss, see `is_known`.
    """

    stamps: FloatArray
    poses: SE3

    def __len__(self) -> int:
        return len(self.stamps)


def read_tum(
    path: Path, allow_misses: bool = False, zero_translation_is_miss: bool = False
) -> StampedPoses:
    """A trajectory in TUM's format: lines ``stamp tx ty tz qx qy qz qw``.

    Parameters
    ----------
    path : path
        The file.
    allow_misses : bool
        A line of seven zeros is a frame without a pose; else an error.
    zero_translation_is_miss : bool
        A pose with zero translation is one too.

    Raises
    ------
    ValueError
        Naming file and line.
    """
    stamps, rows = _core.read_tum(os.fspath(path), allow_misses, zero_translation_is_miss)
    return StampedPoses(stamps, SE3._wrap(rows, (len(rows),)))


def write_tum(
    path: Path, stamps: npt.ArrayLike, poses: SE3, misses_as_zeros: bool = False
) -> None:
    """A trajectory in TUM's format, 12 significant digits.

    Parameters
    ----------
    path : path
        The file.
    stamps : array_like, shape (n,)
        Times [s].
    poses : SE3, shape (n,)
        NaN for a miss.
    misses_as_zeros : bool
        Misses become lines of zeros; else they are left out.
    """
    times = np.ascontiguousarray(stamps, dtype=np.float64)
    _core.write_tum(os.fspath(path), times, optional_rows(poses), misses_as_zeros)


@dataclass(frozen=True, eq=False)
class PoseSamples:
    """Poses with weights.

    Attributes
    ----------
    poses : SE3, shape (n,)
        Samples.
    weights : ndarray, shape (n,), or None
        None: all count the same.
    """

    poses: SE3
    weights: FloatArray | None


def read_pose_samples(
    path: Path, residuals: Side | None = None, weights: str | None = None
) -> PoseSamples:
    """Poses of a .csv, .npy, .tum or .txt file.

    Parameters
    ----------
    path : path
        The file.
    residuals : Side, optional
        Residuals of estimates ``est_tx`` ... to truths ``gt_tx`` ... of a CSV file, in place of poses.
    weights : str, optional
        Column of the weights of a CSV file; ``weight`` where there is such a column.

    Raises
    ------
    ValueError
        Naming file and line.
    """
    poses, counts = _core.read_pose_samples(os.fspath(path), residuals, weights)
    return PoseSamples(poses, np.array(counts) if counts else None)
