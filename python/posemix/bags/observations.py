# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Detections of vision_msgs as observations: all their results of one class, with weights and covariances."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from posemix._arrays import FloatArray, as_floats
from posemix._core import Observation, ObservationComponent
from posemix.interop.conventions import transformed
from posemix.interop.ros import from_pose
from posemix.lie import SE3

__all__ = ["components_of", "is_placeholder_covariance", "weights_of_scores"]

# Of asymmetries up to rounding, relative to the largest number; that of observations.
_ASYMMETRY = 1e-6


def is_placeholder_covariance(values: npt.ArrayLike) -> npt.NDArray[np.bool_]:
    """Whether numbers stand where there is no covariance.

    Detectors that know none fill the field: with zeros, with the identity matrix, or with -1 as its first number, which
    is the convention of ROS. Files of observations are read by the same rule.

    Parameters
    ----------
    values : array_like, shape (..., 36)
        Covariances, row by row, in any order of rotation and translation.

    Returns
    -------
    ndarray of bool, shape (...)

    Examples
    --------
    >>> import numpy as np
    >>> from posemix.bags import is_placeholder_covariance
    >>> is_placeholder_covariance([np.zeros(36), np.eye(6).ravel(), 0.01 * np.eye(6).ravel()])
    array([ True,  True, False])
    """
    rows = as_floats(values, (36,), "values")
    zeros, identity = (rows == 0).all(axis=-1), (rows == np.eye(6).ravel()).all(axis=-1)
    return np.asarray(zeros | identity | (rows[..., 0] == -1))


def weights_of_scores(scores: npt.ArrayLike) -> FloatArray:
    """Weights of poses that exclude each other, from a detector's scores of them.

    Scores are divided by their sum. Where one of them is negative or not finite, or all are zero, they are no
    probabilities up to a factor, and all weights are equal.

    Parameters
    ----------
    scores : array_like, shape (n,)
        Scores of the poses.

    Returns
    -------
    ndarray, shape (n,)
        Weights, which sum to one.

    Examples
    --------
    >>> from posemix.bags import weights_of_scores
    >>> weights_of_scores([3.0, 1.0]), weights_of_scores([-2.0, -7.0])
    (array([0.75, 0.25]), array([0.5, 0.5]))
    """
    values = np.asarray(scores, dtype=np.float64)
    if not np.isfinite(values).all() or (values < 0).any() or not values.any():
        values = np.ones_like(values)
    shares = values / values.max()
    return np.asarray(shares / shares.sum())


def score_of(result: Any) -> float:
    """The score of a vision_msgs/ObjectHypothesisWithPose of any version."""
    return float(result.hypothesis.score if hasattr(result, "hypothesis") else result.score)


def class_of(result: Any) -> str:
    """The class of a vision_msgs/ObjectHypothesisWithPose of any version."""
    return str(result.hypothesis.class_id if hasattr(result, "hypothesis") else result.id)


def components_of(
    detection: Any, best: Any, best_pose: SE3, pose: Literal["result", "bbox"]
) -> list[ObservationComponent]:
    """The results of a detection that are of the class of the best one; of its box the one pose that it has.

    `best_pose` is the pose of the best one, or of the box.

    Raises
    ------
    ValueError
        For a covariance that is not symmetric positive definite, and a pose that is not finite; it names the result.
    """
    if pose == "bbox":
        return [ObservationComponent(best_pose)]
    numbers, weights = [0], [1.0]
    if len(detection.results) > 1:
        name = class_of(best)
        numbers = [i for i, r in enumerate(detection.results) if class_of(r) == name]
    if len(numbers) > 1:
        weights = weights_of_scores([score_of(detection.results[i]) for i in numbers]).tolist()
    components = []
    for number, weight in zip(numbers, weights, strict=True):
        if weight == 0:
            continue
        shaped = detection.results[number].pose
        try:
            mean = best_pose if detection.results[number] is best else from_pose(shaped.pose)
            covariance = _covariance(mean, np.array(shaped.covariance, dtype=np.float64))
        except ValueError as error:
            raise ValueError(f"result {number}: {error}") from None
        components.append(ObservationComponent(mean, weight=weight, covariance=covariance))
    return components


def _covariance(mean: SE3, values: FloatArray) -> FloatArray | None:
    """The covariance along the object's axes, rotation first; None where the message gives none."""
    if not values.any() or is_placeholder_covariance(values):
        return None
    if not np.isfinite(values).all():
        raise ValueError("got a covariance that is not finite, expected finite numbers")
    matrix = values.reshape((6, 6))
    if np.abs(matrix - matrix.T).max() > _ASYMMETRY * np.abs(matrix).max():
        raise ValueError("got a covariance that is not symmetric, expected a symmetric one")
    matrix = 0.5 * (matrix + matrix.T)
    least = np.linalg.eigvalsh(matrix)[0]
    if least <= 0:
        raise ValueError(
            f"got a covariance with the eigenvalue {least:.3g}, expected a positive definite one, or zeros, the "
            "identity or -1 as its first number where there is none"
        )
    # Errors about and along the axes of the camera at the object: turned, they are along the object's.
    turn = np.zeros((6, 6))
    turn[:3, :3] = turn[3:, 3:] = mean.rotation.matrix().T
    return transformed(np.roll(matrix, 3, axis=(0, 1)), turn)


def moved(components: Sequence[ObservationComponent], by: SE3) -> list[ObservationComponent]:
    """The components as seen from another frame; covariances along the object's axes stay as they are."""
    return [
        ObservationComponent(by * c.pose, weight=c.weight, covariance=c.covariance)
        for c in components
    ]


def named(observation: Observation, object_id: str, class_id: str) -> Observation:
    """The observation of another object or class."""
    o = observation
    return Observation(
        o.components, object=object_id, class_id=class_id, clutter=o.clutter, camera=o.camera, detector=o.detector,
        stamp_s=o.stamp_s, score=o.score,
    )  # fmt: skip
