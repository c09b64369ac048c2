# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Tables of recorded grasps."""

from __future__ import annotations

import os
from dataclasses import dataclass

from posemix import _core
from posemix._core import GraspTrial
from posemix.io.paths import Path
from posemix.lie import SE3

__all__ = ["GraspOutcomes", "GraspTrial", "read_grasp_outcomes"]

@dataclass(frozen=True, eq=False)
class GraspOutcomes:
    """Grasp trials with the estimates of several estimators.

    Attributes
    ----------
    grippers : list of str
        Names of the grippers.
    trials : list of GraspTrial
        Rows of the tables.
    estimates, truths : SE3, shape (n,)
        T_camera_object of every trial.
    """

    grippers: list[str]
    trials: list[GraspTrial]
    estimates: SE3
    truths: SE3


def read_grasp_outcomes(folder: Path) -> GraspOutcomes:
    """Reads all tables ``DATASET_ESTIMATOR.csv`` of a folder; raises ValueError with file and line."""
    return GraspOutcomes(*_core.read_grasp_outcomes(os.fspath(folder)))
