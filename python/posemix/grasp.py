# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Grasps under pose uncertainty: probabilities of success, error mixtures of estimators, scores of predictions.

Errors of estimates are poses, or rows ``[rotation vector (rad), displacement (m)]`` in the frame of the line of
sight (`sight_error`). `probabilities` are predictions in [0, 1], shape (n,), and `successes` their outcomes, bool of
the same shape.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray, as_floats, flat_rows, require_finite
from posemix._core import (
    BestGrasp, BestGraspSettings, ConsensusSettings, ErrorMixture, ErrorMixtureFit, ErrorMixtureSettings,
    GraspCandidate, LogisticModel, LogisticSettings, PlattCalibration, PoseConsensus, RegionFit, RegionFitSettings,
    RegionPriors, ReliabilityBin, SuccessEstimate, SuccessSettings, ToleranceBox, ToleranceRegion, accuracy,
    auc_within_groups, best_grasp, bootstrap_regions, brier_score, calibration_error, fit_error_gaussian,
    fit_error_mixture, fit_logistic, fit_platt, fit_tolerance_region, fuse_estimates, log_loss, nearest_equivalent,
    reduced_error, reliability, success_probability, trimmed_errors,
)  # fmt: skip
from posemix.lie import SE3

__all__ = [
    "BestGrasp", "BestGraspSettings", "ConsensusSettings", "ErrorMixture", "ErrorMixtureFit", "ErrorMixtureSettings",
    "GraspCandidate", "LogisticModel", "LogisticSettings", "PlattCalibration", "PoseConsensus", "RegionFit",
    "RegionFitSettings", "RegionPriors", "ReliabilityBin", "SuccessEstimate", "SuccessSettings", "ToleranceBox",
    "ToleranceRegion", "accuracy", "auc_within_groups", "best_grasp", "bootstrap_regions", "brier_score",
    "calibration_error", "fit_error_gaussian", "fit_error_mixture", "fit_logistic", "fit_platt", "fit_tolerance_region",
    "fuse_estimates", "log_loss", "nearest_equivalent", "reduced_error", "reliability", "sight_error",
    "success_probability", "trimmed_errors", "truth_with_error",
]  # fmt: skip


def _broadcast(x: SE3, y: SE3) -> tuple[SE3, SE3]:
    shape = np.broadcast_shapes(SE3._checked(x, "estimate").shape, SE3._checked(y, "truth").shape)
    a, b = (np.ascontiguousarray(np.broadcast_to(p._data, (*shape, 7))) for p in (x, y))
    return SE3._wrap(a, shape), SE3._wrap(b, shape)


def sight_error(estimate: SE3, truth: SE3) -> FloatArray:
    """Errors of estimates T_camera_object in the frame of their lines of sight.

    Parameters
    ----------
    estimate, truth : SE3, shape (...)
        T_camera_object.

    Returns
    -------
    ndarray, shape (..., 6)
        The rotation vector of R_estimate R_truth^-1 [rad] and t_estimate - t_truth [m], both along the axes of the
        camera after the smallest rotation that makes z point to the estimate: depth is the last entry.
    """
    a, b = _broadcast(estimate, truth)
    rows: FloatArray = _core.sight_error(a, b)
    return rows.reshape((*a.shape, 6))


def truth_with_error(estimate: SE3, error: npt.ArrayLike) -> SE3:
    """The true poses with respect to which the estimates have these errors, shape (...).

    Parameters
    ----------
    estimate : SE3, shape (...) or ()
        T_camera_object.
    error : array_like, shape (..., 6)
        Errors in the form of `sight_error`.
    """
    errors = require_finite(as_floats(error, (6,), "error"), "error")
    shape = np.broadcast_shapes(SE3._checked(estimate, "estimate").shape, errors.shape[:-1])
    poses = np.ascontiguousarray(np.broadcast_to(estimate._data, (*shape, 7)))
    rows = flat_rows(np.ascontiguousarray(np.broadcast_to(errors, (*shape, 6))), 1)
    return _core.truth_with_error(SE3._wrap(poses, shape), rows)
