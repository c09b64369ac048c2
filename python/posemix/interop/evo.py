# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""evo: PoseTrajectory3D and PosePath3D. Conversions are exact; evo has no covariances."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from posemix._arrays import FloatArray, as_floats
from posemix._peers import peer
from posemix.lie import SE3, SO3

__all__ = ["from_path", "from_trajectory", "to_path", "to_trajectory"]


def from_path(path: Any) -> SE3:
    """Poses of an evo PosePath3D or PoseTrajectory3D, shape (n,)."""
    wxyz = np.asarray(path.orientations_quat_wxyz, dtype=np.float64)
    return SE3(SO3(wxyz[:, [1, 2, 3, 0]]), path.positions_xyz)


def to_path(poses: SE3) -> Any:
    """An evo PosePath3D of poses, shape (n,)."""
    trajectory = peer("evo.core.trajectory", "posemix.interop.evo", "evo")
    tq = poses.to_tq()
    return trajectory.PosePath3D(tq[:, :3], tq[:, [6, 3, 4, 5]])


def from_trajectory(trajectory: Any) -> tuple[FloatArray, SE3]:
    """Stamps, shape (n,) [s], and poses, shape (n,), of an evo PoseTrajectory3D."""
    return np.array(trajectory.timestamps, dtype=np.float64), from_path(trajectory)


def to_trajectory(stamps: npt.ArrayLike, poses: SE3) -> Any:
    """An evo PoseTrajectory3D of stamps, shape (n,) [s], and poses, shape (n,)."""
    trajectory = peer("evo.core.trajectory", "posemix.interop.evo", "evo")
    tq = poses.to_tq()
    times = as_floats(stamps, (len(poses),), "stamps")
    return trajectory.PoseTrajectory3D(tq[:, :3], tq[:, [6, 3, 4, 5]], times)
