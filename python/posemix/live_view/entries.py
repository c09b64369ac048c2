# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""A frame of a recording as an entry of its file."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from posemix._arrays import FloatArray
from posemix._core import DetectionStatus, FrameEstimate, ObjectEstimate, ObjectHypothesis
from posemix.density import ConcentratedGaussian
from posemix.lie import SE3
from posemix.live_view.frames import LiveFrame
from posemix.plot.space import position_covariance

__all__ = ["HEADER", "UPPER", "density_of", "entry_of", "numbers"]

HEADER = {"type": "posemix.live", "schema": 1}
# The upper triangle of a covariance, row by row.
UPPER = np.triu_indices(6)
_UPPER_3 = np.triu_indices(3)
_DIGITS, _FEW_DIGITS = 9, 7


def numbers(values: npt.ArrayLike, digits: int = _FEW_DIGITS) -> list[float]:
    """Numbers with so many digits, as in trace.json."""
    return [float(f"{value:.{digits}g}") for value in np.ravel(values).tolist()]


def _number(value: float | None) -> float | None:
    return None if value is None else float(f"{value:.{_FEW_DIGITS}g}")


def density_of(density: ConcentratedGaussian[SE3] | None) -> dict[str, list[float]] | None:
    """Mean, standard deviations and covariances of a pose, by the keys of trace.json."""
    if density is None:
        return None
    mean, covariance = density.mean, density.covariance
    return {
        "pose": numbers(mean.to_tq(), _DIGITS),
        "sd": numbers(np.sqrt(np.maximum(np.diag(covariance), 0.0))),
        "position_covariance": numbers(position_covariance(mean, covariance)[_UPPER_3]),
        "covariance": numbers(covariance[UPPER], _DIGITS),
    }


def _alternative(hypothesis: ObjectHypothesis) -> dict[str, Any]:
    return {
        "id": hypothesis.id,
        "probability": _number(hypothesis.probability),
        "pose": numbers(hypothesis.pose.to_tq()),
    }


def _nis_of(name: str, estimate: FrameEstimate) -> float | None:
    """Of a detection that was used; the others are no innovations of a consistent filter."""
    of_all = estimate.report.nis
    index = list(estimate.objects).index(name)
    is_used = index < len(of_all) and estimate.object(name).status == DetectionStatus.used
    return _number(of_all[index]) if is_used else None


def _object_entry(name: str, of_object: ObjectEstimate, frame: LiveFrame) -> dict[str, Any]:
    hypotheses = sorted(frame.hypotheses[name], key=lambda h: -h.probability)
    entry: dict[str, Any] = {
        "world": density_of(of_object.world),
        "relative": density_of(of_object.relative),
        "status": of_object.status.name,
        "mode_probability": _number(of_object.mode_probability),
        "existence": _number(of_object.existence),
        "health": of_object.health.name,
        "register_again": of_object.register_again,
        "alternatives": [_alternative(h) for h in hypotheses],
    }
    nis = _nis_of(name, frame.estimate)
    if nis is not None:
        entry["nis"] = nis
    if name in frame.detections:
        entry["detection"] = numbers(frame.detections[name].to_tq(), _DIGITS)
    if of_object.twist is not None:
        variances: FloatArray = np.diag(of_object.twist.covariance)
        entry["models"] = numbers(of_object.motion_models)
        entry["twist"] = numbers(of_object.twist.mean)
        entry["twist_sd"] = numbers(np.sqrt(np.maximum(variances, 0.0)))
    return entry


def entry_of(frame: LiveFrame) -> dict[str, Any]:
    """A frame as JSON: stamp, camera, and the objects that there are."""
    estimate = frame.estimate
    return {
        "stamp_s": frame.stamp_s,
        "seconds": _number(estimate.report.seconds),
        "merges": estimate.report.merges,
        "camera": density_of(estimate.camera),
        "objects": {name: _object_entry(name, estimate.object(name), frame) for name in frame.names},
    }
