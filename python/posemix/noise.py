# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Noise of detectors, and symmetries of objects."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray, as_floats, flat_rows
from posemix._core import (
    Clutter,
    DependentFrames,
    DetectorNoise,
    NoiseComponent,
    NoiseCorrelation,
    NoiseCriterion,
    NoiseDependence,
    NoiseEmFit,
    NoiseFit,
    NoiseFitSettings,
    NoiseFrame,
    NoiseMode,
    NoiseModeSettings,
    NoiseValidation,
    ObjectSensor,
    OdometryNoise,
    OdometryNoiseSettings,
    OdometryWindow,
    SymmetryAxis,
    SymmetryGroup,
    SymmetryTolerance,
)
from posemix.lie import SE3
from posemix.random import RandomStream, stream_of
from posemix.recording import Sequence

__all__ = [
    "Clutter", "DependentFrames", "DetectorNoise", "NoiseComponent", "NoiseCorrelation", "NoiseCriterion",
    "NoiseDependence", "NoiseEmFit", "NoiseFit", "NoiseFitSettings", "NoiseFrame", "NoiseMode", "NoiseModeSettings",
    "NoiseValidation", "ObjectSensor", "OdometryNoise", "OdometryNoiseSettings", "OdometryWindow", "SymmetricPoseError",
    "SymmetryAxis", "SymmetryGroup", "SymmetryTolerance", "along_camera", "default_detector_noise", "fit_noise",
    "fit_odometry_noise", "max_symmetric_surface_distance", "pose_covariance", "symmetric_pose_error",
]  # fmt: skip


def pose_covariance(rotation_sd_rad: npt.ArrayLike, translation_sd_m: npt.ArrayLike) -> FloatArray:
    """Diagonal covariance from standard deviations about and along x, y, z.

    Parameters
    ----------
    rotation_sd_rad, translation_sd_m : array_like, shape (3,) or ()
        Standard deviations [rad, m]; a single one is used for all axes.

    Returns
    -------
    ndarray, shape (6, 6)

    Examples
    --------
    >>> from posemix import pose_covariance
    >>> pose_covariance(0.1, [0.02, 0.02, 0.5]).diagonal().round(4)
    array([0.01  , 0.01  , 0.01  , 0.0004, 0.0004, 0.25  ])
    """
    sds = [
        np.array(np.broadcast_to(np.asarray(sd, dtype=np.float64), (3,)))
        for sd in (rotation_sd_rad, translation_sd_m)
    ]
    return np.ascontiguousarray(_core.pose_covariance(*sds))


def default_detector_noise() -> DetectorNoise:
    """The default noise of detectors that use single images.

    Rotation about the camera's axes 7.5 deg and about the viewing ray 2 deg, translation 0.7 % of the range across
    the ray and 4.5 % along it; a second component 2.7 times as wide; and clutter.
    """
    return _core.default_detector_noise()


def along_camera(noise: NoiseComponent, camera_object: SE3) -> NoiseComponent:
    """The component with covariances along the camera's axes [rad, m], for an object at `camera_object`.

    Parameters
    ----------
    noise : NoiseComponent
        Component of any frame; only one of NoiseFrame.ray is changed.
    camera_object : SE3
        T_camera_object.
    """
    return _core.along_camera(noise, camera_object)


def fit_noise(
    truth: SE3,
    detected: SE3,
    *,
    recording: npt.ArrayLike | None = None,
    settings: NoiseFitSettings | None = None,
    seed: int | RandomStream = 1,
) -> NoiseFit:
    """Learns the noise of a detector from detections of one class of objects with ground truth.

    Mixtures of 1, 2, ... components with clutter are fitted by EM; the criterion chooses one of them and the frame of
    its covariances. Wrong poses that recur become modes, and the correlation of the errors in time is estimated.

    Parameters
    ----------
    truth, detected : SE3, shape (n,)
        T_camera_object by ground truth and by the detector, one per frame in the order of time; NaN in frames
        without ground truth or without a detection (`with_misses`).
    recording : array_like, shape (n,), optional
        Name or number of the recording of every frame; a single recording if None.
    settings : NoiseFitSettings, optional
        Models that are tried, and the criterion that chooses one.
    seed : int or RandomStream
        Seed of the starts.

    Returns
    -------
    NoiseFit
        The result, with the model in ``noise`` and its text in ``to_toml()``.

    Raises
    ------
    ValueError
        For numbers of poses that differ, fewer than two detections, and settings that contradict each other.

    Examples
    --------
    >>> import numpy as np
    >>> from posemix import SE3, NoiseFitSettings, NoiseFrame, fit_noise
    >>> rng = np.random.default_rng(1)
    >>> truth = SE3(translation=np.tile([0.0, 0.0, 1.0], (500, 1)))
    >>> detected = truth * SE3.exp(rng.normal(size=(500, 6)) * [0.05, 0.05, 0.02, 0.01, 0.01, 0.03])
    >>> fit = fit_noise(truth, detected, settings=NoiseFitSettings(max_components=2, frame=NoiseFrame.object))
    >>> len(fit.noise.components)
    1
    >>> sd = np.sqrt(fit.noise.components[0].covariance.diagonal())
    >>> bool(np.allclose(sd, [0.05, 0.05, 0.02, 0.01, 0.01, 0.03], rtol=0.1))
    True
    >>> fit.to_toml("cup").splitlines()[0]
    '[noise.cup]'
    """
    index = np.zeros(len(truth), dtype=int)
    if recording is not None:
        _, index = np.unique(np.asarray(recording), return_inverse=True)
    return _core.fit_noise(
        truth, detected, index.ravel().tolist(), settings or NoiseFitSettings(), stream_of(seed)
    )


def fit_odometry_noise(
    recordings: Sequence | Iterable[Sequence], settings: OdometryNoiseSettings | None = None
) -> OdometryNoise:
    """Learns the random walk of the odometry and the jitter of the ground truth from the growth of the error with time.

    Parameters
    ----------
    recordings : Sequence or iterable of Sequence
        Recordings; those without `odometry` or `camera_truth` are left out.
    settings : OdometryNoiseSettings, optional
        Lengths of the windows, number of samples for the standard errors.

    Raises
    ------
    ValueError
        If no recording has a window with odometry and ground truth at both ends.
    """
    all_of_them = [recordings] if isinstance(recordings, Sequence) else list(recordings)
    rows = [
        (np.asarray(r.stamps, dtype=np.float64), r.odometry._rows(), r.camera_truth._rows())
        for r in all_of_them
        if r.odometry is not None and r.camera_truth is not None
    ]
    return _core.fit_odometry_noise(rows, settings or OdometryNoiseSettings())


@dataclass(frozen=True)
class SymmetricPoseError:
    """Difference of two poses of an object with symmetries.

    Attributes
    ----------
    rotation_rad : float
        Angle between the rotations [rad].
    translation_m : float
        Distance of the positions [m].
    """

    rotation_rad: float
    translation_m: float


def symmetric_pose_error(
    estimate: SE3, truth: SE3, symmetries: SymmetryGroup, length_m: float = 0.1
) -> SymmetricPoseError:
    """The error of an estimate against the nearest of the equivalent true poses.

    Parameters
    ----------
    estimate, truth : SE3
        One pose each.
    symmetries : SymmetryGroup
        Symmetries of the object.
    length_m : float
        Length in rotation^2 + (translation / length_m)^2, which the nearest pose minimises [m].
    """
    return SymmetricPoseError(*_core.symmetric_pose_error(estimate, truth, symmetries, length_m))


def max_symmetric_surface_distance(
    estimate: SE3, truth: SE3, points: npt.ArrayLike, symmetries: SymmetryGroup
) -> float:
    """The maximum symmetry-aware surface distance of the BOP benchmark [m].

    Parameters
    ----------
    estimate, truth : SE3
        One pose each.
    points : array_like, shape (n, 3)
        Points of the object's surface, in the object's frame [m].
    symmetries : SymmetryGroup
        Symmetries of the object.

    Raises
    ------
    ValueError
        Without points.

    References
    ----------
    Hodan et al., BOP Challenge 2020, eq. 2.
    """
    rows = flat_rows(as_floats(points, (3,), "points"), 1)
    return float(_core.max_symmetric_surface_distance(estimate, truth, rows, symmetries))
