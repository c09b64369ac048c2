# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""How good predicted probabilities of success are, and their calibration.

`probabilities` are predictions in [0, 1], shape (n,), `successes` what came of them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray, require_finite

__all__ = [
    "PlattCalibration", "ReliabilityBin", "accuracy", "auc_within_groups", "brier_score", "calibration_error",
    "fit_platt", "log_loss", "reliability",
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
    """Mean of -log of the probability that the outcome was given, at least 1e-9 [nats]."""
    return float(_core.log_loss(*_arguments(probabilities, successes), []))


def accuracy(probabilities: npt.ArrayLike, successes: npt.ArrayLike) -> float:
    """Share of predictions on the right side of one half (one half predicts success)."""
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
        Only predictions of one group are compared; all are one group unless given.

    Returns
    -------
    float
        Ties count half; NaN where no group holds both outcomes.
    """
    members: list[Any] = [] if groups is None else np.asarray(groups, dtype=np.intp).tolist()
    return float(_core.auc_within_groups(*_arguments(probabilities, successes), members))


@dataclass(frozen=True)
class ReliabilityBin:
    """Predictions in one bin of a reliability diagram; means are NaN in an empty one.

    Attributes
    ----------
    count : int
        Number of predictions.
    mean_probability, success_rate : float
        What was predicted, and what came of it.
    """

    count: int
    mean_probability: float
    success_rate: float


def reliability(
    probabilities: npt.ArrayLike, successes: npt.ArrayLike, bins: int = 10
) -> list[ReliabilityBin]:
    """Bins of equal width over [0, 1]."""
    found = _core.reliability(*_arguments(probabilities, successes), bins)
    return [ReliabilityBin(*values) for values in found]


def calibration_error(
    probabilities: npt.ArrayLike, successes: npt.ArrayLike, bins: int = 10
) -> float:
    """Mean over the predictions of their bin's distance of success rate and mean probability."""
    return float(_core.calibration_error(*_arguments(probabilities, successes), bins))


@dataclass(frozen=True)
class PlattCalibration:
    """Platt's calibration: logit of the calibrated probability = slope * logit of the raw + bias.

    Raw probabilities are taken to lie within [0.001, 0.999].

    Attributes
    ----------
    slope, bias : float
        One and zero: as it is.
    """

    slope: float = 1.0
    bias: float = 0.0

    def __call__(self, probabilities: npt.ArrayLike) -> FloatArray:
        """Calibrated probabilities, of the same shape."""
        shape = np.shape(probabilities)
        values: FloatArray = _core.platt(self.slope, self.bias, _probabilities(probabilities))
        return values.reshape(shape)


def fit_platt(probabilities: npt.ArrayLike, successes: npt.ArrayLike) -> PlattCalibration:
    """The most probable calibration, with normal priors about slope 1 and bias 0."""
    return PlattCalibration(*_core.fit_platt(*_arguments(probabilities, successes), []))
