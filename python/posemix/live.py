# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Live object SLAM: one call per frame."""

from __future__ import annotations

import collections.abc
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray
from posemix._core import (
    AssociationSettings,
    CandidateStatus,
    DetectionStatus,
    FrameEstimate,
    MotionModel,
    MotionSettings,
    MultiObjectSlamSettings,
    NoiseComponent,
    NoisePer,
    ObjectModel,
    ObjectSlamSettings,
    ProcessNoise,
    SlamMethod,
    SmoothingSettings,
    SymmetryGroup,
    find_slam_method,
    slam_methods,
)
from posemix.density import ConcentratedGaussian
from posemix.filter import MultiObjectFilter
from posemix.lie import SE3
from posemix.mixture import Mixture
from posemix.recording import Candidate, candidate_rows, with_misses

__all__ = [
    "Association", "AssociationSettings", "CandidateStatus", "DetectionStatus", "FixedLagSmoother",
    "FrameInput", "MotionModel", "MotionSettings", "MultiObjectSlamSettings", "NoisePer", "ObjectModel", "ObjectSlam",
    "ObjectSlamSettings", "ProcessNoise", "SlamMethod", "SmoothingSettings", "associate", "find_slam_method",
    "least_cost_assignment", "slam_methods",
]  # fmt: skip

Detections = collections.abc.Sequence[SE3 | None] | Mapping[str, SE3] | SE3


@dataclass(frozen=True)
class FrameInput:
    """Input of one frame. In the first frame `dt` and `motion` are ignored.

    Attributes
    ----------
    dt : float
        Time since the last frame, positive [s].
    motion : SE3, optional
        T_camera(k-1)_camera(k), from odometry.
    detections : sequence of SE3 and None, mapping from ids, or SE3 of shape (objects,)
        T_camera_object, one entry per object model; a mapping has only those that were detected.
    candidates : sequence of Candidate
        Detections that name a class, for the multi-object filter.
    """

    dt: float = 0.0
    motion: SE3 | None = None
    detections: Detections = field(default_factory=dict)
    candidates: collections.abc.Sequence[Candidate] = ()


def _detection_rows(detections: Detections, ids: list[str]) -> FloatArray:
    if isinstance(detections, Mapping):
        for id in detections:
            if id not in ids:
                raise ValueError(f"no object is called '{id}'; expected one of {', '.join(ids)}")
        detections = [detections.get(id) for id in ids]
    return with_misses(detections)._data


class ObjectSlam:
    """Live estimation of camera and objects.

    A step predicts, updates, reduces and summarises; objects seen for the first time are added after the update.
    Frames without detections or without odometry are valid.

    Parameters
    ----------
    camera : ConcentratedGaussian
        Prior of T_world_camera at the first frame.
    objects : sequence of ObjectModel
        Models of the objects that may be detected.
    settings : ObjectSlamSettings, optional
        Filter and motion model.

    Raises
    ------
    ValueError
        When a setting is out of range or models of one class differ.

    Examples
    --------
    >>> from posemix import SE3, ConcentratedGaussian, FrameInput, ObjectModel, ObjectSlam, pose_covariance
    >>> camera = ConcentratedGaussian(SE3(), pose_covariance(0.001, 0.002))
    >>> slam = ObjectSlam(camera, [ObjectModel(id="mug"), ObjectModel(id="box")])
    >>> estimate = slam.step(FrameInput(detections={"mug": SE3(translation=[0, 0, 0.8])}))
    >>> estimate
    <FrameEstimate of 2 objects, seen: mug>
    >>> estimate.report.statuses
    [DetectionStatus.started, DetectionStatus.none]
    >>> moved = SE3(translation=[0.01, 0, 0])
    >>> estimate = slam.step(FrameInput(0.1, moved, {"mug": SE3(translation=[-0.01, 0, 0.8])}))
    >>> estimate.object("mug").status
    DetectionStatus.used
    >>> float(estimate.objects["mug"].mean.translation[2].round(3))
    0.8
    """

    __slots__ = ("_handle", "_ids")

    def __init__(
        self,
        camera: ConcentratedGaussian[SE3],
        objects: collections.abc.Sequence[ObjectModel],
        settings: ObjectSlamSettings | None = None,
    ) -> None:
        self._handle = _core.ObjectSlam(
            camera._handle, list(objects), settings or ObjectSlamSettings()
        )
        self._ids = self._handle.ids()

    @classmethod
    def _of(cls, handle: _core.ObjectSlam) -> ObjectSlam:
        slam = cls.__new__(cls)
        slam._handle = handle
        slam._ids = handle.ids()
        return slam

    def step(self, input: FrameInput) -> FrameEstimate:
        """Processes the next frame; the first one is not predicted.

        Raises
        ------
        ValueError
            When the numbers of detections and object models differ, dt is not positive after the first frame, or
            there are candidates for a filter other than the multi-object filter.
        """
        rows = _detection_rows(input.detections, self._ids)
        return self._handle.step(input.dt, input.motion, rows, candidate_rows(input.candidates))

    @property
    def ids(self) -> list[str]:
        """Ids of the object models, in their order."""
        return list(self._ids)

    @property
    def objects(self) -> list[ObjectModel]:
        """Copies of the object models."""
        return self._handle.objects()

    @property
    def posterior(self) -> Mixture[ConcentratedGaussian[SE3]]:
        """The joint posterior; for the multi-object filter that of camera and leading hypotheses."""
        return Mixture._of(self._handle.posterior())

    @property
    def estimate(self) -> ConcentratedGaussian[SE3]:
        """One Gaussian over all poses; pose 0 is the camera, see `pose_index`."""
        return ConcentratedGaussian._of(self._handle.estimate())

    def pose_index(self, object: int) -> int | None:
        """Index of the object's pose in the estimate; None before its first detection."""
        return self._handle.pose_index(object)

    def detections(self, object: int) -> int:
        """Number of detections that have updated the object, candidates included."""
        return self._handle.detections(object)

    @property
    def multi_object(self) -> MultiObjectFilter | None:
        """A copy of the multi-object filter; None for another tracker."""
        return self._handle.multi_object()

    def __copy__(self) -> ObjectSlam:
        return ObjectSlam._of(self._handle.copy())

    def __deepcopy__(self, memo: dict[int, Any]) -> ObjectSlam:
        return self.__copy__()

    def __repr__(self) -> str:
        seen = [id for j, id in enumerate(self._ids) if self.pose_index(j) is not None]
        return f"<ObjectSlam of {len(self._ids)} objects, seen: {', '.join(seen) or 'none'}>"


class FixedLagSmoother:
    """Object SLAM with smoothed estimates, each reported some frames later.

    Parameters
    ----------
    camera, objects, settings
        As for `ObjectSlam`; the filter must be the multi-object filter.
    smoothing : SmoothingSettings
        Number of frames that the smoother looks ahead.
    record_hypotheses : bool
        Whether estimates have the alternatives of every object.

    Raises
    ------
    ValueError
        As for `ObjectSlam`, when a setting is out of range, when the filter is not the multi-object filter, and when
        it only considers the camera.
    """

    __slots__ = ("_handle", "_ids")

    def __init__(
        self,
        camera: ConcentratedGaussian[SE3],
        objects: collections.abc.Sequence[ObjectModel],
        smoothing: SmoothingSettings,
        settings: ObjectSlamSettings | None = None,
        record_hypotheses: bool = False,
    ) -> None:
        self._handle = _core.FixedLagSmoother(
            camera._handle,
            list(objects),
            settings or ObjectSlamSettings(),
            smoothing,
            record_hypotheses,
        )
        self._ids = [model.id for model in objects]

    def step(self, input: FrameInput) -> FrameEstimate | None:
        """Processes the next frame; returns the estimate of the frame `lag_frames` earlier, if there is one.

        Raises
        ------
        ValueError
            As for `ObjectSlam.step`, and for candidates.
        """
        rows = _detection_rows(input.detections, self._ids)
        return self._handle.step(input.dt, input.motion, rows, candidate_rows(input.candidates))

    def finish(self) -> list[FrameEstimate]:
        """The estimates of the frames that have not been reported, after the last step."""
        return self._handle.finish()

    @property
    def slam(self) -> ObjectSlam:
        """A copy of the filter, which is at the last frame processed."""
        return ObjectSlam._of(self._handle.slam())

    def __copy__(self) -> FixedLagSmoother:
        smoother = FixedLagSmoother.__new__(FixedLagSmoother)
        smoother._handle = self._handle.copy()
        smoother._ids = self._ids
        return smoother

    def __deepcopy__(self, memo: dict[int, Any]) -> FixedLagSmoother:
        return self.__copy__()

    @property
    def joint(self) -> ConcentratedGaussian[SE3] | None:
        """Joint density at the last frame reported: camera, its motion under constant velocity, objects."""
        handle = self._handle.joint()
        return None if handle is None else ConcentratedGaussian._of(handle)


@dataclass(frozen=True)
class Association:
    """The association of a candidate.

    Attributes
    ----------
    status : CandidateStatus
        Whether it is assigned to an instance, fresh, or rejected.
    instance : int
        If assigned: index among the instances.
    camera_object : SE3
        If assigned: the equivalent pose nearest to the instance; otherwise the pose as detected.
    cost : float
        If assigned: its part of the total cost.
    """

    status: CandidateStatus
    instance: int
    camera_object: SE3
    cost: float


def associate(
    instances: collections.abc.Sequence[ConcentratedGaussian[SE3]],
    candidates: collections.abc.Sequence[Candidate],
    noise: NoiseComponent,
    symmetries: SymmetryGroup | None = None,
    settings: AssociationSettings | None = None,
) -> list[Association]:
    """The one-to-one assignment of candidates to instances of their class with the least cost.

    Parameters
    ----------
    instances : sequence of ConcentratedGaussian
        Predicted T_camera_object of the instances.
    candidates : sequence of Candidate
        Candidates of one class in one frame.
    noise : NoiseComponent
        Noise of the detector for this class.
    symmetries : SymmetryGroup, optional
        Symmetries of the class.
    settings : AssociationSettings, optional
        Gate, and criterion for a new instance.

    Raises
    ------
    ValueError
        When a probability is not in (0, 1).
    """
    found = _core.associate(
        [density._handle for density in instances],
        candidate_rows(candidates),
        noise,
        symmetries or SymmetryGroup(),
        settings or AssociationSettings(),
    )
    return [Association(*values) for values in found]


def least_cost_assignment(cost: npt.ArrayLike) -> list[int]:
    """A different column for each row of a cost matrix such that the sum of the entries is least.

    Parameters
    ----------
    cost : array_like, shape (rows, columns)
        Costs, finite, with at least as many columns as rows.

    Examples
    --------
    >>> from posemix import least_cost_assignment
    >>> least_cost_assignment([[1, 2], [1, 4]])
    [1, 0]
    """
    return _core.least_cost_assignment(np.ascontiguousarray(cost, dtype=np.float64))
