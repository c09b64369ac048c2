# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Scores of predicted probabilities of success, and their calibration.

`probabilities` are predictions in [0, 1], shape (n,), and `successes` their outcomes, bool of the same shape.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray, as_floats, flat_rows, require_finite
from posemix._core import LogisticSettings

__all__ = [
    "LogisticModel", "LogisticSettings", "PlattCalibration", "ReliabilityBin", "accuracy", "auc_within_groups",
    "brier_score", "calibration_error", "fit_logistic", "fit_platt", "log_loss", "reliability",
]  # fmt: skip


def _probabilities(values: npt.ArrayLike) -> FloatArray:
    array = require_finite(np.ascontiguousarray(values, dtype=np.float64), "probabilities")
    for i, value in enumerate(array.reshape(-1)):
        if not 0.0 <= value <= 1.0:
            raise ValueError(f"probability {i} is {value}; expected a number in [0, 1]")
    return array.reshape(-1)


def _arguments(
    probabilities: npt.ArrayLike, successes: npt.ArrayLike
) -> tuple[FloatArray, list[bool]]:
    outcomes: list[bool] = np.asarray(successes, dtype=bool).reshape(-1).tolist()
    return _probabilities(probabilities), outcomes


def brier_score(probabilities: npt.ArrayLike, successes: npt.ArrayLike) -> float:
    """Mean squared difference of probability and outcome.

    Examples
    --------
    >>> from posemix import brier_score
    >>> round(brier_score([0.9, 0.2], [True, False]), 3)
    0.025
    """
    return float(_core.brier_score(*_arguments(probabilities, successes), []))


def log_loss(probabilities: npt.ArrayLike, successes: npt.ArrayLike) -> float:
    """Mean of -log of the probability given to the outcome, which is taken as at least 1e-9 [nats]."""
    return float(_core.log_loss(*_arguments(probabilities, successes), []))


def accuracy(probabilities: npt.ArrayLike, successes: npt.ArrayLike) -> float:
    """Fraction of predictions on the right side of one half (one half predicts success)."""
    return float(_core.accuracy(*_arguments(probabilities, successes), []))


def auc_within_groups(
    probabilities: npt.ArrayLike, successes: npt.ArrayLike, groups: npt.ArrayLike | None = None
) -> float:
    """Probability that a success got a larger probability than a failure of the same group.

    Parameters
    ----------
    probabilities, successes : array_like, shape (n,)
        Predictions and outcomes.
    groups : array_like of int, shape (n,), optional
        Groups of the predictions; only predictions of the same group are compared. A single group unless given.

    Returns
    -------
    float
        The probability, in which ties count half; NaN if no group has both outcomes.
    """
    members: list[Any] = [] if groups is None else np.asarray(groups, dtype=np.intp).tolist()
    return float(_core.auc_within_groups(*_arguments(probabilities, successes), members))


@dataclass(frozen=True)
class ReliabilityBin:
    """Predictions in one bin of a reliability diagram; the means of an empty bin are NaN.

    Attributes
    ----------
    count : int
        Number of predictions.
    mean_probability, success_rate : float
        Mean of the predictions, and fraction of successes.
    """

    count: int
    mean_probability: float
    success_rate: float


def reliability(
    probabilities: npt.ArrayLike, successes: npt.ArrayLike, bins: int = 10
) -> list[ReliabilityBin]:
    """The bins of a reliability diagram, of equal width over [0, 1]."""
    found = _core.reliability(*_arguments(probabilities, successes), bins)
    return [ReliabilityBin(*values) for values in found]


def calibration_error(
    probabilities: npt.ArrayLike, successes: npt.ArrayLike, bins: int = 10
) -> float:
    """Mean over the predictions of the difference of success rate and mean probability in their bin."""
    return float(_core.calibration_error(*_arguments(probabilities, successes), bins))


@dataclass(frozen=True)
class PlattCalibration:
    """Platt's calibration: logit of the calibrated probability = slope * logit of the raw one + bias.

    Raw probabilities are clipped to [0.001, 0.999].

    Attributes
    ----------
    slope, bias : float
        With slope one and bias zero, probabilities are not changed.
    """

    slope: float = 1.0
    bias: float = 0.0

    def __call__(self, probabilities: npt.ArrayLike) -> FloatArray:
        """The calibrated probabilities, in the shape of `probabilities`."""
        shape = np.shape(probabilities)
        values: FloatArray = _core.platt(self.slope, self.bias, _probabilities(probabilities))
        return values.reshape(shape)


def fit_platt(probabilities: npt.ArrayLike, successes: npt.ArrayLike) -> PlattCalibration:
    """The maximum a posteriori calibration, with normal priors about slope 1 and bias 0."""
    return PlattCalibration(*_core.fit_platt(*_arguments(probabilities, successes), []))


@dataclass(frozen=True, eq=False)
class LogisticModel:
    """A logistic model, P(success) = s(bias + weights . x) with the logistic function s.

    Attributes
    ----------
    weights : ndarray, shape (features,)
        One weight per feature.
    bias : float
        Log odds if all features are zero.
    """

    weights: FloatArray
    bias: float

    def probability(self, features: npt.ArrayLike) -> FloatArray:
        """Probabilities for features of shape (..., features), shape (...)."""
        rows = as_floats(features, (len(self.weights),), "features")
        values: FloatArray = _core.logistic_probability(self.weights, self.bias, flat_rows(rows, 1))
        return values.reshape(rows.shape[:-1])


def fit_logistic(
    features: npt.ArrayLike, successes: npt.ArrayLike, settings: LogisticSettings | None = None
) -> LogisticModel:
    """The maximum a posteriori logistic model of outcomes.

    Parameters
    ----------
    features : array_like, shape (n, features)
        Features; row i belongs to outcome i.
    successes : array_like of bool, shape (n,)
        Outcomes.
    settings : LogisticSettings, optional
        The prior.

    Raises
    ------
    ValueError
        When sizes differ.
    """
    rows = require_finite(np.ascontiguousarray(features, dtype=np.float64), "features")
    if rows.ndim != 2:
        raise ValueError(f"features have shape {rows.shape}; expected (n, features)")
    outcomes: list[bool] = np.asarray(successes, dtype=bool).reshape(-1).tolist()
    return LogisticModel(*_core.fit_logistic(rows, outcomes, settings or LogisticSettings()))
