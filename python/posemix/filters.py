# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Filters, one call per prediction or update."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray, as_floats
from posemix._core import (
    DetectorNoise,
    GaussianSumSettings,
    MultiObjectSettings,
    NoiseUse,
    ObjectSensor,
    RobustLoss,
    Summary,
    UpdateRule,
)
from posemix.density import ConcentratedGaussian
from posemix.lie import SE3
from posemix.mixture import Mixture
from posemix.operations import ReductionReport, reduction_report

__all__ = [
    "Detection", "GaussianSumSettings", "GaussianSumFilter", "MultiObjectFilter", "MultiObjectSettings", "NoiseUse",
    "ObjectHypothesis", "ObjectUpdateReport", "RobustLoss", "Summary", "UpdateReport", "UpdateRule",
]  # fmt: skip


@dataclass(frozen=True)
class ObjectHypothesis:
    """One alternative for the pose of one object, X = Exp(xi) X0 in the world frame.

    Attributes
    ----------
    pose : SE3
        T_world_object.
    covariance, cross_covariance : ndarray, shape (6, 6)
        Of xi of the object, and with that of the camera (rows of the object).
    log_weight : float
        Among the hypotheses of the object and its absence; counts every detection as independent.
    probability : float
        The same with dependent detections counted once.
    score : float
        Recent log evidence over that of clutter [nats].
    id : int
        Kept over time; a merge keeps that of the heavier.
    detections : int
        Processed since it began.
    """

    pose: SE3
    covariance: FloatArray
    cross_covariance: FloatArray
    log_weight: float
    probability: float
    score: float
    id: int
    detections: int


@dataclass(frozen=True)
class ObjectUpdateReport:
    """What became of a detection in `MultiObjectFilter.update`.

    Attributes
    ----------
    started : bool
        It began a hypothesis.
    changed_leader : bool
        Another hypothesis leads than before.
    log_evidence : float
        Of the detection given all before [nats].
    merges : int
        Hypotheses that became one with another.
    inlier_probability, clutter_probability : float
        Probabilities that the leading hypothesis' first noise component, and that nothing of it, explains the
        detection.
    residual : ndarray, shape (6,)
        From the leading hypothesis, white under that component.
    """

    started: bool
    changed_leader: bool
    log_evidence: float
    merges: int
    inlier_probability: float
    clutter_probability: float
    residual: FloatArray


def _square(values: npt.ArrayLike, name: str) -> FloatArray:
    return as_floats(values, (6, 6), name)


class MultiObjectFilter:
    """Object SLAM with many hypotheses for every object and none for their product.

    The hypotheses of different objects are independent given the camera. A detection that no hypothesis explains
    starts one. Cost: linear in hypotheses; in objects quadratic per detection, cubic while modes compete.

    Parameters
    ----------
    camera : ConcentratedGaussian
        Prior of T_world_camera.
    objects : sequence of ObjectSensor
        How every object is seen.
    settings : MultiObjectSettings, optional
        Hypotheses, merging, what is learned.

    Raises
    ------
    ValueError
        When a setting is out of range; predictions and updates also, and change nothing, when an argument is not
        finite or a variance or a time step negative.

    Examples
    --------
    >>> from posemix import (SE3, ConcentratedGaussian, MultiObjectFilter, ObjectSensor,
    ...                      default_detector_noise, pose_covariance)
    >>> camera = ConcentratedGaussian(SE3(), pose_covariance(0.001, 0.002))
    >>> tracker = MultiObjectFilter(camera, [ObjectSensor(noise=default_detector_noise())])
    >>> tracker.update(0, SE3(translation=[0, 0, 0.8])).started
    True
    >>> tracker.predict_with_odometry(SE3(translation=[0.01, 0, 0]), pose_covariance(0.001, 0.001), dt=0.1)
    >>> tracker.relative(0, tracker.leading(0)).mean.translation.round(2)
    array([-0.01,  0.  ,  0.8 ])
    """

    __slots__ = ("_handle",)

    def __init__(
        self,
        camera: ConcentratedGaussian[SE3],
        objects: Sequence[ObjectSensor],
        settings: MultiObjectSettings | None = None,
    ) -> None:
        self._handle = _core.MultiObjectFilter(
            camera._handle, list(objects), settings or MultiObjectSettings()
        )

    @classmethod
    def _of(cls, handle: _core.MultiObjectFilter) -> MultiObjectFilter:
        tracker = cls.__new__(cls)
        tracker._handle = handle
        return tracker

    def predict_with_odometry(self, motion: SE3, q: npt.ArrayLike, dt: float) -> None:
        """T_C <- T_C motion over `dt` seconds.

        Parameters
        ----------
        motion : SE3
            T_camera(k-1)_camera(k).
        q : array_like, shape (6, 6)
            Noise of the step, right perturbation, camera frame.
        dt : float
            Time step [s].
        """
        self._handle.predict_with_odometry(motion, _square(q, "q"), dt)

    def predict_random_walk(self, q: npt.ArrayLike, dt: float) -> None:
        """A frame that the odometry lacks: the mean stays, `q` counts in full."""
        self._handle.predict_random_walk(_square(q, "q"), dt)

    def predict_constant_velocity(
        self,
        periods: float,
        q: npt.ArrayLike,
        q_motion: npt.ArrayLike,
        at_rest: npt.ArrayLike,
        dt: float,
    ) -> None:
        """Constant velocity: the camera's motion per period becomes part of the state.

        Parameters
        ----------
        periods : float
            The step in reference periods.
        q, q_motion : array_like, shape (6, 6)
            Noise of the pose and of the motion per period, of the step.
        at_rest : array_like, shape (6, 6)
            Covariance of the motion at the first call.
        dt : float
            Time step [s].
        """
        self._handle.predict_constant_velocity(
            periods, _square(q, "q"), _square(q_motion, "q_motion"), _square(at_rest, "at_rest"), dt
        )

    def update(self, object: int, camera_object: SE3) -> ObjectUpdateReport:
        """One detection T_camera_object of the object at index `object`."""
        return ObjectUpdateReport(**self._handle.update(object, camera_object))

    def forget(self, object: int) -> None:
        """The object is as if never seen; what it said about the camera and others stays."""
        self._handle.forget(object)

    @property
    def objects(self) -> int:
        """Number of objects."""
        return self._handle.objects()

    @property
    def settings(self) -> MultiObjectSettings:
        """A copy of the settings."""
        return self._handle.settings()

    @property
    def correlation_length(self) -> float:
        """Detections of an object that count as one, over all objects."""
        return self._handle.correlation_length()

    def noise_scale(self, object: int) -> FloatArray:
        """Factors of the standard deviations of an object's noise, learned; shape (6,)."""
        return self._handle.noise_scale(object)

    @property
    def camera(self) -> ConcentratedGaussian[SE3]:
        """T_world_camera, with the covariance of the true error."""
        return ConcentratedGaussian._of(self._handle.camera())

    def hypotheses(self, object: int) -> list[ObjectHypothesis]:
        """The hypotheses of an object; none until it was seen."""
        return [ObjectHypothesis(**h) for h in self._handle.hypotheses(object)]

    def leading(self, object: int) -> int | None:
        """Index of the hypothesis that leads."""
        return self._handle.leading(object)

    def mode_probability(self, object: int) -> float:
        """Probability that the leading hypothesis is the right one."""
        return self._handle.mode_probability(object)

    def log_absent(self, object: int) -> float:
        """Log probability that nothing seen so far was the object."""
        return self._handle.log_absent(object)

    def relative(self, object: int, hypothesis: int) -> ConcentratedGaussian[SE3]:
        """T_camera_object of one hypothesis, with the cross-covariance."""
        return ConcentratedGaussian._of(self._handle.relative(object, hypothesis))

    def joint(self) -> ConcentratedGaussian[SE3]:
        """Camera, then the leading hypotheses in the order in which they began, jointly."""
        return ConcentratedGaussian._of(self._handle.joint())

    def pose_index(self, object: int) -> int | None:
        """Index of the object's pose in the joint Gaussian."""
        return self._handle.pose_index(object)

    def __copy__(self) -> MultiObjectFilter:
        return MultiObjectFilter._of(self._handle.copy())

    def __deepcopy__(self, memo: dict[int, Any]) -> MultiObjectFilter:
        return self.__copy__()

    def __repr__(self) -> str:
        counts = [len(self._handle.hypotheses(j)) for j in range(self.objects)]
        return f"<MultiObjectFilter of {self.objects} objects, hypotheses {counts}>"


@dataclass(frozen=True)
class Detection:
    """One detection for `GaussianSumFilter.update`.

    Attributes
    ----------
    object : int
        Index of the object's pose in the posterior.
    camera_object : SE3
        T_camera_object as detected.
    noise : DetectorNoise
        How the detector errs.
    """

    object: int
    camera_object: SE3
    noise: DetectorNoise


@dataclass(frozen=True)
class UpdateReport:
    """What an update did with every detection, in the order given.

    Attributes
    ----------
    gated, failed : list of bool
        Left out by the gate, or because an innovation covariance was not positive definite.
    log_evidence : float
        Log of the summed likelihood of the detections used [nats].
    reductions : list of ReductionReport
        One for joint use, one per used detection otherwise.
    update_seconds, reduce_seconds : float
        Time taken [s].
    """

    gated: list[bool]
    failed: list[bool]
    log_evidence: float
    reductions: list[ReductionReport]
    update_seconds: float
    reduce_seconds: float


def update_report(values: dict[str, Any]) -> UpdateReport:
    """The report of compiled values."""
    reductions = [reduction_report(r) for r in values["reductions"]]
    return UpdateReport(**{**values, "reductions": reductions})


class GaussianSumFilter:
    """The Gaussian-sum invariant EKF: predict, update (with a reduction), summarise.

    Every hypothesis holds the same poses in the same order; pose 0 is the camera.

    Parameters
    ----------
    prior : Mixture or ConcentratedGaussian
        Over T_world_camera alone, or over the camera and objects jointly.
    settings : GaussianSumSettings, optional
        How detections are used, and how hypotheses are reduced.

    Raises
    ------
    ValueError
        When a setting is out of range.

    References
    ----------
    Midway-merge paper, Algorithm 1.
    """

    __slots__ = ("_handle",)

    def __init__(
        self,
        prior: Mixture[ConcentratedGaussian[SE3]] | ConcentratedGaussian[SE3],
        settings: GaussianSumSettings | None = None,
    ) -> None:
        mixture = Mixture([prior]) if isinstance(prior, ConcentratedGaussian) else prior
        if not mixture[0].mean.shape:
            joint = [ConcentratedGaussian(p.mean._wrap(p.mean._data, (1,)), p.covariance) for p in mixture]
            mixture = Mixture(joint, log_weights=mixture.log_weights)
        self._handle = _core.GaussianSumFilter(mixture._handle, settings or GaussianSumSettings())

    def predict(
        self, motion: Callable[[ConcentratedGaussian[SE3]], ConcentratedGaussian[SE3]]
    ) -> None:
        """Moves every hypothesis by a function of its own."""
        self._handle.predict(lambda h: motion(ConcentratedGaussian._of(h))._handle)

    def predict_with_odometry(self, motion: SE3, q: npt.ArrayLike) -> None:
        """T_R <- T_R motion (midway-merge paper, eq. 31).

        Parameters
        ----------
        motion : SE3
            T_camera(k-1)_camera(k).
        q : array_like, shape (6, 6)
            Noise of the step, right perturbation, camera frame.
        """
        self._handle.predict_with_odometry(motion, _square(q, "q"))

    def predict_random_walk(self, q: npt.ArrayLike) -> None:
        """The mean stays."""
        self._handle.predict_random_walk(_square(q, "q"))

    def predict_constant_velocity(
        self, periods: float, q: npt.ArrayLike, q_motion: npt.ArrayLike
    ) -> None:
        """Constant velocity; pose 1 is the camera's motion per reference period."""
        self._handle.predict_constant_velocity(
            periods, _square(q, "q"), _square(q_motion, "q_motion")
        )

    def update(self, detections: Sequence[Detection]) -> UpdateReport:
        """Every hypothesis gets a child per noise component, is updated, and all are reduced.

        Raises
        ------
        ValueError
            For a detection of the camera, of a pose that does not exist or of one named twice, and when joint use
            finds detectors whose components differ in number or weight.
        """
        poses = SE3.identity((len(detections),))
        for row, detection in zip(poses._data, detections, strict=True):
            row[:] = detection.camera_object._data
        objects = [detection.object for detection in detections]
        noise = [detection.noise for detection in detections]
        return update_report(self._handle.update(objects, poses, noise))

    def add_object(self, camera_object: SE3, noise: DetectorNoise) -> int:
        """A new object with its full cross-covariance; the index of its pose."""
        return self._handle.add_object(camera_object, noise)

    def add_independent_object(self, camera_object: SE3, covariance: npt.ArrayLike) -> int:
        """A new object with an error independent of all others (world frame); its index."""
        return self._handle.add_independent_object(
            camera_object, _square(covariance, "covariance")
        )

    @property
    def posterior(self) -> Mixture[ConcentratedGaussian[SE3]]:
        """The joint mixture over the camera and all objects."""
        return Mixture._of(self._handle.posterior())

    @property
    def settings(self) -> GaussianSumSettings:
        """A copy of the settings."""
        return self._handle.settings()

    def summarise(self) -> ConcentratedGaussian[SE3]:
        """One Gaussian in place of the posterior."""
        return ConcentratedGaussian._of(self._handle.summarise())

    def __reduce__(self) -> tuple[Any, tuple[Any, ...]]:
        return GaussianSumFilter, (self.posterior, self.settings)

    def __repr__(self) -> str:
        posterior = self.posterior
        return f"<GaussianSumFilter of {len(posterior)} hypotheses over {len(posterior[0].mean)} poses>"
