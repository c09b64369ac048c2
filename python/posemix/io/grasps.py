# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Recorded grasps."""

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
    """Trials of several estimators.

    Attributes
    ----------
    grippers : list of str
        Names.
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
    """Every table ``DATASET_ESTIMATOR.csv`` of a folder; ValueError names file and line."""
    return GraspOutcomes(*_core.read_grasp_outcomes(os.fspath(folder)))
