# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Files: sequence files and results of object SLAM, mixtures, trajectories, BOP. docs/formats.md describes them.

Readers raise ValueError ``file:line: got ..., expected ...``; writers write a file or a folder as a whole or not at
all, and raise OSError if the system refuses.
"""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray
from posemix._core import (
    AngleUnit, BopModel, GraspOutcomes, GraspTrial, LengthUnit, MixtureConvention, MixtureFile, NamedPose, ObjectBox,
    PoseKind, PoseSamples, PosteriorFile, Side, SimulationFile, StampedPoses, TangentOrder, read_bop_model,
    read_bop_models, read_grasp_outcomes, read_mixture, read_object_poses, read_observations, read_pose_samples,
    read_posterior, read_simulation, read_slam_job, read_symmetry_file, read_tum, write_comparison, write_mixture,
    write_object_poses, write_observations, write_poses, write_posterior, write_report, write_results, write_simulation,
    write_tum,
)  # fmt: skip
from posemix.lie import SE3

__all__ = [
    "AngleUnit", "BopModel", "BopRows", "GraspOutcomes", "GraspTrial", "LengthUnit", "MixtureConvention", "MixtureFile",
    "NamedPose", "ObjectBox", "PoseKind", "PoseSamples", "PosteriorFile", "Side", "SimulationFile", "StampedPoses",
    "TangentOrder", "read_bop_model", "read_bop_models", "read_bop_rows", "read_grasp_outcomes", "read_mixture",
    "read_object_poses", "read_observations", "read_pose_samples", "read_posterior", "read_simulation",
    "read_slam_job", "read_symmetry_file", "read_tum", "write_comparison", "write_mixture", "write_object_poses",
    "write_observations", "write_poses", "write_posterior", "write_report", "write_results", "write_simulation",
    "write_tum",
]  # fmt: skip


@dataclass(frozen=True, eq=False)
class BopRows:
    """The rows of a BOP results file.

    Attributes
    ----------
    scene, image, object : ndarray of int, shape (n,)
        Ids of scene, image and object.
    score : ndarray, shape (n,)
        Confidence of the estimator; larger is more certain.
    poses : SE3, shape (n,)
        T_camera_object [m].
    """

    scene: npt.NDArray[np.int64]
    image: npt.NDArray[np.int64]
    object: npt.NDArray[np.int64]
    score: FloatArray
    poses: SE3

    def __len__(self) -> int:
        return len(self.score)


def read_bop_rows(path: str | os.PathLike[str]) -> BopRows:
    """Reads a BOP results file, CSV ``scene_id,im_id,obj_id,score,R,t,time``; lengths are converted to metres.

    Raises
    ------
    ValueError
        With file and line.
    """
    ids, scores, poses = _core.read_bop_rows(path)
    scene, image, object = np.array(ids, dtype=np.int64)
    return BopRows(scene, image, object, scores, poses)
