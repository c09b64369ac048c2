# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Object SLAM over whole recordings, and its results as arrays."""

from __future__ import annotations

import collections.abc
import html
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, overload

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray
from posemix._core import (
    CandidateReport,
    FrameEstimate,
    FrameReport,
    HypothesisSnapshot,
    ObjectAlternative,
    ObjectEstimate,
    ObjectModel,
    ObjectSlamSettings,
    ParticleFilterSettings,
    SlamMethod,
    SmoothingSettings,
)
from posemix.density import ConcentratedGaussian, standard_deviations
from posemix.filter import ObjectHypothesis
from posemix.lie import SE3
from posemix.mixture import Mixture
from posemix.recording import Sequence, is_known

__all__ = [
    "CandidateReport", "FrameEstimate", "FrameReport", "HypothesisSnapshot", "ObjectAlternative", "ObjectEstimate",
    "ParticleFilterSettings", "PoseTrack", "SlamJob", "SlamRun", "run", "run_smoothed",
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


class SlamRun:
    """The result of `run`. ``run[i]`` is the `FrameEstimate` of frame i.

    A run that a progress callback stopped is shorter than the recording.
    """

    __slots__ = ("_handle", "_ids", "_stamps")

    def __init__(self, handle: _core.SlamRun, stamps: FloatArray, ids: list[str]) -> None:
        self._handle = handle
        self._stamps = stamps[: len(handle)]
        self._ids = ids

    def __len__(self) -> int:
        return len(self._handle)

    def __getitem__(self, frame: int) -> FrameEstimate:
        at = frame + len(self) if frame < 0 else frame
        if not 0 <= at < len(self):
            raise IndexError(f"there is no frame {frame} of {len(self)}")
        return self._handle.frame(at)

    def __iter__(self) -> Iterator[FrameEstimate]:
        return (self[i] for i in range(len(self)))

    @property
    def frames(self) -> list[FrameEstimate]:
        """The estimates of all frames; `camera`, `object` and `relative` are faster."""
        return list(self)

    @property
    def stamps(self) -> FloatArray:
        """Times of the frames, shape (n,) [s]."""
        return self._stamps

    @property
    def ids(self) -> list[str]:
        """Ids of the objects."""
        return list(self._ids)

    def _index(self, object: int | str) -> int:
        if isinstance(object, str):
            if object not in self._ids:
                names = ", ".join(self._ids)
                raise ValueError(f"no object is called '{object}'; expected one of {names}")
            return self._ids.index(object)
        if not 0 <= object < len(self._ids):
            raise ValueError(f"there is no object {object}; expected less than {len(self._ids)}")
        return object

    def _track(self, values: Any) -> PoseTrack:
        means, covariances = values
        return PoseTrack(SE3._wrap(means, (len(self),)), covariances)

    @property
    def camera(self) -> PoseTrack:
        """T_world_camera over the frames."""
        return self._track(self._handle.camera())

    def object(self, object: int | str) -> PoseTrack:
        """T_world_object over the frames, of an object by index or id."""
        return self._track(self._handle.object(self._index(object)))

    def relative(self, object: int | str) -> PoseTrack:
        """T_camera_object over the frames, including the cross-covariance of camera and object."""
        return self._track(self._handle.relative(self._index(object)))

    def mode_probabilities(self, object: int | str) -> FloatArray:
        """Probability that the estimate is on the right mode, shape (n,); NaN if unknown."""
        return self._handle.mode_probabilities(self._index(object))

    @property
    def seconds(self) -> FloatArray:
        """Time taken per frame, shape (n,) [s]."""
        return self._handle.seconds()

    @property
    def posterior(self) -> Mixture[ConcentratedGaussian[SE3]]:
        """The joint posterior of the last frame."""
        return Mixture._of(self._handle.posterior())

    @property
    def pose_indices(self) -> list[int | None]:
        """Index of every object's pose in the posterior."""
        return self._handle.pose_indices()

    @property
    def alternatives(self) -> list[list[ObjectHypothesis]]:
        """Hypotheses of every object at the last frame, with the multi-object filter."""
        return self._handle.alternatives()

    def __copy__(self) -> SlamRun:
        return self

    def __deepcopy__(self, memo: dict[int, Any]) -> SlamRun:
        return self

    def __repr__(self) -> str:
        return f"<SlamRun of {len(self)} frames, objects {', '.join(self._ids) or 'none'}>"

    def _repr_html_(self) -> str:
        """A table of the last frame's estimates, for notebooks."""
        last = self[-1]
        named: list[tuple[str, Any, Any]] = [("camera", last.camera, None)]
        probabilities = last.mode_probabilities
        named += [(id, density, probabilities.get(id)) for id, density in last.objects.items()]
        rows = "".join(_row(*values) for values in named)
        head = "<tr><th>pose</th><th>mean (world)</th><th>standard deviations</th><th>mode</th></tr>"
        title = html.escape(f"{len(self)} frames; the last one")
        return f"<table><caption>{title}</caption><thead>{head}</thead><tbody>{rows}</tbody></table>"


def _row(name: str, density: ConcentratedGaussian[SE3] | None, probability: float | None) -> str:
    cells = ["not seen", "", ""]
    if density is not None:
        sure = "" if probability is None else f"{probability:.3f}"
        cells = [repr(density.mean), standard_deviations(density.covariance), sure]
    return "<tr>" + "".join(f"<td>{html.escape(c)}</td>" for c in [name, *cells]) + "</tr>"


@dataclass(frozen=True, eq=False)
class SlamJob:
    """The input of one run of object SLAM; `posemix.io.read_slam_job` reads it from a file.

    Attributes
    ----------
    name, method : str
        Display names of recording and method.
    sequence : Sequence
        The recording.
    camera_prior : ConcentratedGaussian
        Prior of T_world_camera at the first frame.
    models : list of ObjectModel
        One per object of the sequence.
    settings : ObjectSlamSettings
        Tracker and motion model.
    smoothing : SmoothingSettings, optional
        Smoothing, for the multi-object filter only.
    trace_hypotheses : int
        Number of hypotheses per frame in trace.json.
    """

    name: str
    method: str
    sequence: Sequence
    camera_prior: ConcentratedGaussian[SE3]
    models: list[ObjectModel]
    settings: ObjectSlamSettings
    smoothing: SmoothingSettings | None = None
    trace_hypotheses: int = 12

    def _compiled(self) -> _core.SlamJob:
        return _core.SlamJob(
            self.name, self.method, self.sequence._compiled(), self.camera_prior._handle,
            self.models, self.settings, self.smoothing, self.trace_hypotheses,
        )  # fmt: skip

    @classmethod
    def _of(cls, handle: _core.SlamJob) -> SlamJob:
        name, method, sequence, prior, *rest = handle.values()
        return cls(name, method, Sequence._of(sequence), ConcentratedGaussian._of(prior), *rest)

    def using(self, method: str | SlamMethod) -> SlamJob:
        """The job with another method of `slam_methods`: its tracker, smoothing, and noise of the object models.

        Raises
        ------
        ValueError
            For an unknown name.
        """
        handle = self._compiled()
        handle.use(method if isinstance(method, str) else method.name)
        return SlamJob._of(handle)

    def __repr__(self) -> str:
        return f"<SlamJob '{self.name}' by {self.method}: {self.sequence!r}>"


def _ids(sequence: Sequence) -> list[str]:
    return [recording.id for recording in sequence.objects]


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
        handle = _core.run_job(job._compiled(), traced, progress)
        return SlamRun(handle, job.sequence.stamps, _ids(job.sequence))
    handle = _core.run(
        sequence._compiled(), camera_prior._handle, list(models), settings or ObjectSlamSettings(),
        bool(record_hypotheses), progress,
    )  # fmt: skip
    return SlamRun(handle, sequence.stamps, _ids(sequence))


def run_smoothed(
    sequence: Sequence,
    camera_prior: ConcentratedGaussian[SE3],
    models: collections.abc.Sequence[ObjectModel],
    smoothing: SmoothingSettings | None = None,
    settings: ObjectSlamSettings | None = None,
    *,
    record_hypotheses: bool = False,
    progress: Progress | None = None,
) -> SlamRun:
    """Runs object SLAM with smoothed estimates, which use later frames too.

    Parameters
    ----------
    sequence, camera_prior, models, settings, record_hypotheses, progress
        As for `run`.
    smoothing : SmoothingSettings, optional
        Number of frames that the smoother looks ahead; to the end unless given.

    Raises
    ------
    ValueError
        As for `run` and `FixedLagSmoother`.
    """
    handle = _core.run_smoothed(
        sequence._compiled(), camera_prior._handle, list(models), settings or ObjectSlamSettings(),
        smoothing or SmoothingSettings(), record_hypotheses, progress,
    )  # fmt: skip
    return SlamRun(handle, sequence.stamps, _ids(sequence))
