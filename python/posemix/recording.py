# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Recordings as arrays. In an array of poses, a frame without a pose is a row of NaN."""

from __future__ import annotations

import collections.abc
import numpy as np
import numpy.typing as npt

from posemix._core import Candidate, ObjectRecording, Sequence
from posemix._poses import pose_rows
from posemix.lie import SE3

__all__ = ["Candidate", "ObjectRecording", "Sequence", "is_known", "with_misses"]


def is_known(poses: SE3) -> npt.NDArray[np.bool_]:
    """Whether each entry of an array of poses is known, shape (...); unknown poses are rows of NaN."""
    return np.asarray(~np.isnan(SE3._checked(poses, "poses")._data).all(axis=-1))


def with_misses(
    poses: SE3 | npt.ArrayLike | collections.abc.Sequence[SE3 | None],
    known: npt.ArrayLike | None = None,
) -> SE3:
    """An array of poses in which frames without a pose are NaN.

    Parameters
    ----------
    poses : SE3, shape (n,), or array_like, shape (n, 7) or (n, 4, 4), or sequence of SE3 and None
        Poses or matrices; rows are ``[tx, ty, tz, qx, qy, qz, qw]``, or NaN for a frame without a pose.
    known : array_like of bool, shape (n,), optional
        False for a frame without a pose; its row of `poses` is ignored.

    Raises
    ------
    ValueError
        For another shape, a row that is only partly finite, and a quaternion of zero.

    Examples
    --------
    >>> from posemix import SE3, is_known, with_misses
    >>> detections = with_misses([SE3(), None, SE3(translation=[0, 0, 1.0])])
    >>> is_known(detections)
    array([ True, False,  True])
    """
    rows = pose_rows(poses)
    missing = np.isnan(rows).all(axis=1)
    if known is not None:
        mask = np.asarray(known, dtype=bool)
        if mask.shape != (len(rows),):
            raise ValueError(f"known has shape {mask.shape}; expected ({len(rows)},)")
        missing |= ~mask
    result = np.full((len(rows), 7), np.nan)
    result[~missing] = SE3.from_tq(rows[~missing]).to_tq()
    return SE3._wrap(result, (len(rows),))
