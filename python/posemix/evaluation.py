# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Errors and consistency of a run against ground truth."""

from __future__ import annotations

import html
from dataclasses import dataclass
from typing import Any

from posemix import _core
from posemix.density import ConcentratedGaussian
from posemix.lie import SE3
from posemix.recording import Sequence
from posemix.runs import SlamJob, SlamRun

__all__ = [
    "Metrics", "ModeForecast", "ObjectMetrics", "PoseErrors", "Timing", "evaluate", "on_right_mode",
    "squared_normalized_error", "true_relative_pose", "true_world_pose",
]  # fmt: skip


@dataclass(frozen=True)
class PoseErrors:
    """Root mean square errors over the frames with estimate and truth; None without any.

    Attributes
    ----------
    position_rmse_m : float or None
        Euclidean distance of the positions [m].
    rotation_rmse_deg : float or None
        Angle of the rotation between estimate and truth [deg].
    position_log_rmse_m : float or None
        Translation part of Log(T_est T_true^-1), the midway paper's number [m].
    """

    position_rmse_m: float | None
    rotation_rmse_deg: float | None
    position_log_rmse_m: float | None


@dataclass(frozen=True)
class ModeForecast:
    """The probability that an estimate is on the right mode, and whether it was."""

    probability: float
    right: bool


@dataclass(frozen=True)
class ObjectMetrics:
    """Metrics of one object.

    Attributes
    ----------
    id : str
        Its name.
    world, relative, detection_relative : PoseErrors
        Of T_world_object; of T_camera_object as filtered and as detected.
    detections, gated : int
        Frames with a detection, and those left out by the gate.
    right_mode_frames : int
        Frames within 20 deg and 10 cm of the truth.
    right_mode_share : float or None
        Their share of the frames with estimate and truth.
    right_mode_anees : float or None
        As `relative_anees`, over these frames.
    mode_probability : float or None
        Of the mode at the last frame.
    forecasts : list of ModeForecast
        Per frame.
    relative_anees : float or None
        Mean of e^T P^-1 e / 6 with e = Log(T_true T_est^-1) of T_camera_object; 1 when consistent.
    """

    id: str
    world: PoseErrors
    relative: PoseErrors
    detection_relative: PoseErrors
    detections: int
    gated: int
    right_mode_frames: int
    right_mode_share: float | None
    right_mode_anees: float | None
    mode_probability: float | None
    forecasts: list[ModeForecast]
    relative_anees: float | None


@dataclass(frozen=True)
class Timing:
    """Medians over the frames after the first, and means.

    Attributes
    ----------
    frame_median_us, update_median_us, reduce_median_us : float
        Time taken [microseconds].
    merges_per_frame : float
        Mean.
    """

    frame_median_us: float
    update_median_us: float
    reduce_median_us: float
    merges_per_frame: float


@dataclass(frozen=True)
class Metrics:
    """Errors, consistency and timing of a run.

    Attributes
    ----------
    frames : int
        Frames of the run.
    camera, odometry : PoseErrors
        Of T_world_camera as filtered, and by the odometry alone.
    objects : list of ObjectMetrics
        One per object.
    timing : Timing
        Cost of a frame.
    """

    frames: int
    camera: PoseErrors
    odometry: PoseErrors
    objects: list[ObjectMetrics]
    timing: Timing

    def __repr__(self) -> str:
        lines = [f"Metrics of {self.frames} frames:"]
        lines += [f"  {name}: {_errors_text(errors)}" for name, errors in self._named()]
        return "\n".join(lines)

    def _named(self) -> list[tuple[str, PoseErrors]]:
        named = [("camera", self.camera), ("odometry", self.odometry)]
        for metrics in self.objects:
            named.append((f"{metrics.id} from the camera", metrics.relative))
            named.append((f"{metrics.id} as detected", metrics.detection_relative))
            named.append((f"{metrics.id} in the world", metrics.world))
        return named

    def _repr_html_(self) -> str:
        """Tables of errors, for notebooks."""
        rows = "".join(
            f"<tr><td>{html.escape(name)}</td><td>{_number(errors.position_rmse_m, 1000)}</td>"
            f"<td>{_number(errors.rotation_rmse_deg, 1)}</td></tr>"
            for name, errors in self._named()
        )
        head = "<tr><th>pose</th><th>position RMSE [mm]</th><th>rotation RMSE [deg]</th></tr>"
        caption = f"{self.frames} frames, {self.timing.frame_median_us:.0f} us each"
        return f"<table><caption>{caption}</caption><thead>{head}</thead><tbody>{rows}</tbody></table>"


def _number(value: float | None, factor: float) -> str:
    return "-" if value is None else f"{factor * value:.4g}"


def _errors_text(errors: PoseErrors) -> str:
    if errors.position_rmse_m is None:
        return "not known"
    position = _number(errors.position_rmse_m, 1000)
    return f"{position} mm, {_number(errors.rotation_rmse_deg, 1)} deg"


def _object_metrics(values: dict[str, Any]) -> ObjectMetrics:
    changed: dict[str, Any] = {
        name: PoseErrors(*values[name]) for name in ("world", "relative", "detection_relative")
    }
    changed["forecasts"] = [ModeForecast(*forecast) for forecast in values["forecasts"]]
    return ObjectMetrics(**{**values, **changed})


def evaluate(sequence: Sequence | SlamJob, run: SlamRun) -> Metrics:
    """Errors of a run against the ground truth of its recording; None where there is none.

    Parameters
    ----------
    sequence : Sequence or SlamJob
        What was run.
    run : SlamRun
        Its result.
    """
    recording = sequence.sequence if isinstance(sequence, SlamJob) else sequence
    found = _core.evaluate(recording._compiled(), run._handle).values()
    frames, camera, odometry, objects, timing = found
    return Metrics(
        frames,
        PoseErrors(*camera),
        PoseErrors(*odometry),
        [_object_metrics(values) for values in objects],
        Timing(*timing),
    )


def squared_normalized_error(estimate: ConcentratedGaussian[SE3], truth: SE3) -> float:
    """e^T P^-1 e with e = Log(X_true X_est^-1): chi-square with 6 degrees when consistent.

    Parameters
    ----------
    estimate : ConcentratedGaussian
        Of one pose.
    truth : SE3
        One pose.
    """
    return float(_core.squared_normalized_error(estimate._handle, truth))


def on_right_mode(estimate: SE3, truth: SE3) -> bool:
    """Whether a pose is within 20 deg and 10 cm of the truth."""
    return bool(_core.on_right_mode(estimate, truth))


def true_relative_pose(sequence: Sequence, object: int) -> SE3:
    """True T_camera_object of one object, from whichever truth is known.

    Parameters
    ----------
    sequence : Sequence
        The recording.
    object : int
        Index of the object.

    Returns
    -------
    SE3, shape (n,)
        NaN in frames where it is unknown.
    """
    rows = _core.true_relative_pose(sequence._compiled(), object)
    return SE3._wrap(rows, (len(rows),))


def true_world_pose(sequence: Sequence, object: int) -> SE3:
    """True T_world_object of one object, as `true_relative_pose`."""
    rows = _core.true_world_pose(sequence._compiled(), object)
    return SE3._wrap(rows, (len(rows),))
