# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Object SLAM over whole recordings, and its results as arrays."""

from __future__ import annotations

import collections.abc
import html
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, overload

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray
from posemix._core import (
    CandidateReport, FrameEstimate, FrameReport, HypothesisSnapshot, ObjectAlternative, ObjectEstimate, ObjectModel,
    ObjectSlamSettings, ObjectTwist, ParticleFilterSettings, Sequence, SlamJob, SlamRun, run_smoothed,
)  # fmt: skip
from posemix.density import ConcentratedGaussian, standard_deviations
from posemix.lie import SE3
from posemix.recording import is_known

__all__ = [
    "CandidateReport", "FrameEstimate", "FrameReport", "HypothesisSnapshot", "ObjectAlternative", "ObjectEstimate",
    "ObjectTwist", "ParticleFilterSettings", "PoseTrack", "SlamJob", "SlamRun", "run", "run_smoothed",
]  # fmt: skip

Progress = Callable[[int, int], bool | None]


@dataclass(frozen=True, eq=False)
class PoseTrack:
    """One pose over the frames of a run.

    Attributes
    ----------
    poses : SE3, shape (n,)
        Means; NaN in frames without an estimate.
    covariances : ndarray, shape (n, 6, 6)
        Covariances of the left perturbation; NaN in frames without an estimate.
    """

    poses: SE3
    covariances: FloatArray

    @property
    def known(self) -> npt.NDArray[np.bool_]:
        """Whether each frame has an estimate, shape (n,)."""
        return is_known(self.poses)

    def __len__(self) -> int:
        return len(self.poses)

    def __repr__(self) -> str:
        return f"<PoseTrack of {len(self)} frames, {int(self.known.sum())} with an estimate>"


def run_html(run: SlamRun) -> str:
    """A table of the last frame's estimates, for notebooks."""
    last = run[-1]
    named: list[tuple[str, Any, Any]] = [("camera", last.camera, None)]
    probabilities = last.mode_probabilities
    named += [(id, density, probabilities.get(id)) for id, density in last.objects.items()]
    rows = "".join(_row(*values) for values in named)
    head = "<tr><th>pose</th><th>mean (world)</th><th>standard deviations</th><th>mode</th></tr>"
    title = html.escape(f"{len(run)} frames; the last one")
    return f"<table><caption>{title}</caption><thead>{head}</thead><tbody>{rows}</tbody></table>"


def _row(name: str, density: ConcentratedGaussian[SE3] | None, probability: float | None) -> str:
    cells = ["not seen", "", ""]
    if density is not None:
        sure = "" if probability is None else f"{probability:.3f}"
        cells = [repr(density.mean), standard_deviations(density.covariance), sure]
    return "<tr>" + "".join(f"<td>{html.escape(c)}</td>" for c in [name, *cells]) + "</tr>"


@overload
def run(
    job: SlamJob, /, *, record_hypotheses: bool | None = None, progress: Progress | None = None
) -> SlamRun: ...
@overload
def run(
    sequence: Sequence,
    camera_prior: ConcentratedGaussian[SE3],
    models: collections.abc.Sequence[ObjectModel],
    settings: ObjectSlamSettings | None = None,
    *,
    record_hypotheses: bool | None = None,
    progress: Progress | None = None,
) -> SlamRun: ...
def run(
    sequence: Sequence | SlamJob,
    camera_prior: Any = None,
    models: Any = None,
    settings: ObjectSlamSettings | None = None,
    *,
    record_hypotheses: bool | None = None,
    progress: Progress | None = None,
) -> SlamRun:
    """Runs object SLAM over a recording, or runs a job with its method.

    The interpreter's lock is released; Ctrl-C stops the run.

    Parameters
    ----------
    sequence : Sequence or SlamJob
        The recording, or a job, which needs no other arguments.
    camera_prior : ConcentratedGaussian
        Prior of T_world_camera at the first frame.
    models : sequence of ObjectModel
        One per object of the recording, in the same order.
    settings : ObjectSlamSettings, optional
        Filter and motion model.
    record_hypotheses : bool, optional
        Whether frames have hypotheses; by default only if a job traces them.
    progress : callable, optional
        Called with (frames done, frames in all) after every frame. If it returns False, the run stops and the frames
        done so far are returned.

    Raises
    ------
    ValueError
        When the models do not fit the sequence or a setting is out of range.
    """
    if isinstance(sequence, SlamJob):
        job = sequence
        traced = job.trace_hypotheses > 0 if record_hypotheses is None else record_hypotheses
        return _core.run_job(job, traced, progress)
    return _core.run(sequence, camera_prior, models, settings, bool(record_hypotheses), progress)
