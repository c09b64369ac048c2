# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Errors and consistency of a run against ground truth."""

from __future__ import annotations

from posemix import _core
from posemix._core import Metrics, ModeForecast, ObjectMetrics, PoseErrors, Timing, on_right_mode
from posemix.density import ConcentratedGaussian
from posemix.lie import SE3
from posemix.recording import Sequence
from posemix.runs import SlamJob, SlamRun

__all__ = [
    "Metrics", "ModeForecast", "ObjectMetrics", "PoseErrors", "Timing", "evaluate", "on_right_mode",
    "squared_normalized_error", "true_relative_pose", "true_world_pose",
]  # fmt: skip


def evaluate(sequence: Sequence | SlamJob, run: SlamRun) -> Metrics:
    """Errors of a run against the ground truth of its recording; None without ground truth.

    Parameters
    ----------
    sequence : Sequence or SlamJob
        The recording, or the job with it.
    run : SlamRun
        The result of the run.
    """
    recording = sequence.sequence if isinstance(sequence, SlamJob) else sequence
    return _core.evaluate(recording._compiled(), run._handle)


def squared_normalized_error(estimate: ConcentratedGaussian[SE3], truth: SE3) -> float:
    """The NEES e^T P^-1 e, e = Log(X_true X_est^-1); if consistent, chi-square with 6 degrees of freedom.

    Parameters
    ----------
    estimate : ConcentratedGaussian
        Estimate of one pose.
    truth : SE3
        The true pose.
    """
    return float(_core.squared_normalized_error(estimate, truth))


def true_relative_pose(sequence: Sequence, object: int) -> SE3:
    """True T_camera_object of one object, computed from the ground truth that is known.

    Parameters
    ----------
    sequence : Sequence
        The recording.
    object : int
        Index of the object.

    Returns
    -------
    SE3, shape (n,)
        NaN in frames without ground truth.
    """
    rows = _core.true_relative_pose(sequence._compiled(), object)
    return SE3._wrap(rows, (len(rows),))


def true_world_pose(sequence: Sequence, object: int) -> SE3:
    """True T_world_object of one object; arguments and result as for `true_relative_pose`."""
    rows = _core.true_world_pose(sequence._compiled(), object)
    return SE3._wrap(rows, (len(rows),))
