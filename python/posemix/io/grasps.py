# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Recorded grasps."""

from __future__ import annotations

import os
from dataclasses import dataclass

from posemix import _core
from posemix.io.paths import Path
from posemix.lie import SE3

__all__ = ["GraspOutcomes", "GraspTrial", "read_grasp_outcomes"]

@dataclass(frozen=True)
class GraspTrial:
    """One estimate of an object in one image, and what became of the grasps planned with it.

    Attributes
    ----------
    dataset, estimator : str
        Whose.
    scene, image, object : int
        Ids.
    score : float
        The estimator's own confidence.
    outcomes : list of bool or None
        Success of the grasp, one entry per gripper; None where it was not tried.
    """

    dataset: str
    estimator: str
    scene: int
    image: int
    object: int
    score: float
    outcomes: list[bool | None]


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
    grippers, trials, estimates, truths = _core.read_grasp_outcomes(os.fspath(folder))
    return GraspOutcomes(grippers, [GraspTrial(*t) for t in trials], estimates, truths)
