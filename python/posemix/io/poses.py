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
    """Poses with time stamps.

    Attributes
    ----------
    stamps : ndarray, shape (n,)
        Times, strictly increasing [s].
    poses : SE3, shape (n,)
        T_a_b for the two frames of the file; NaN for a frame without a pose, see `is_known`.
    """

    stamps: FloatArray
    poses: SE3

    def __len__(self) -> int:
        return len(self.stamps)


def read_tum(
    path: Path, allow_misses: bool = False, zero_translation_is_miss: bool = False
) -> StampedPoses:
    """Reads a trajectory in the TUM format: lines ``stamp tx ty tz qx qy qz qw``.

    Parameters
    ----------
    path : path
        The file.
    allow_misses : bool
        Whether a line of seven zeros is a frame without a pose; otherwise it is an error.
    zero_translation_is_miss : bool
        Whether a pose with zero translation is a frame without a pose too.

    Raises
    ------
    ValueError
        With file and line.
    """
    stamps, rows = _core.read_tum(os.fspath(path), allow_misses, zero_translation_is_miss)
    return StampedPoses(stamps, SE3._wrap(rows, (len(rows),)))


def write_tum(
    path: Path, stamps: npt.ArrayLike, poses: SE3, misses_as_zeros: bool = False
) -> None:
    """Writes a trajectory in the TUM format, with 12 significant digits.

    Parameters
    ----------
    path : path
        The file.
    stamps : array_like, shape (n,)
        Times [s].
    poses : SE3, shape (n,)
        Poses; NaN for a frame without a pose.
    misses_as_zeros : bool
        Whether frames without a pose become lines of zeros; otherwise they are left out.
    """
    times = np.ascontiguousarray(stamps, dtype=np.float64)
    _core.write_tum(os.fspath(path), times, optional_rows(poses), misses_as_zeros)


@dataclass(frozen=True, eq=False)
class PoseSamples:
    """Poses with weights.

    Attributes
    ----------
    poses : SE3, shape (n,)
        The poses.
    weights : ndarray, shape (n,), or None
        Weights; None if all are equal.
    """

    poses: SE3
    weights: FloatArray | None


def read_pose_samples(
    path: Path, residuals: Side | None = None, weights: str | None = None
) -> PoseSamples:
    """Reads the poses of a .csv, .npy, .tum or .txt file.

    Parameters
    ----------
    path : path
        The file.
    residuals : Side, optional
        Side of residuals of estimates ``est_tx`` ... with respect to truths ``gt_tx`` ... of a CSV file, which are read
        instead of poses.
    weights : str, optional
        Column of the weights of a CSV file; by default ``weight``, if there is such a column.

    Raises
    ------
    ValueError
        With file and line.
    """
    poses, counts = _core.read_pose_samples(os.fspath(path), residuals, weights)
    return PoseSamples(poses, np.array(counts) if counts else None)
