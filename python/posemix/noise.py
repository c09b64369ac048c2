# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""How detectors err, and which poses of an object look the same."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray, as_floats, flat_rows
from posemix._core import (
    DetectorNoise,
    NoiseComponent,
    NoiseDependence,
    NoiseFrame,
    Clutter,
    ObjectSensor,
    SymmetryAxis,
    SymmetryGroup,
    SymmetryTolerance,
)
from posemix.lie import SE3

__all__ = [
    "DetectorNoise", "NoiseComponent", "NoiseDependence", "NoiseFrame", "Clutter", "ObjectSensor",
    "SymmetricPoseError", "SymmetryAxis", "SymmetryGroup", "SymmetryTolerance", "along_camera",
    "default_detector_noise", "max_symmetric_surface_distance", "pose_covariance", "symmetric_pose_error",
]  # fmt: skip


def pose_covariance(rotation_sd_rad: npt.ArrayLike, translation_sd_m: npt.ArrayLike) -> FloatArray:
    """Diagonal covariance from standard deviations about and along x, y, z.

    Parameters
    ----------
    rotation_sd_rad, translation_sd_m : array_like, shape (3,) or ()
        Standard deviations [rad, m]; a single one stands for all axes.

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
    """The error of detectors of single images, where nothing better is known.

    Rotation about the camera's axes 7.5 deg and about the viewing ray 2 deg, translation 0.7 % of the range across
    the ray and 4.5 % along it; a second component 2.7 times as wide; and clutter.
    """
    return _core.default_detector_noise()


def along_camera(noise: NoiseComponent, camera_object: SE3) -> NoiseComponent:
    """The component with covariances along the camera's axes in metres, for an object there.

    Parameters
    ----------
    noise : NoiseComponent
        Of NoiseFrame.ray or any other, which stays as it is.
    camera_object : SE3
        T_camera_object.
    """
    return _core.along_camera(noise, camera_object)


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
    """The error against the equivalent truth that is nearest.

    Parameters
    ----------
    estimate, truth : SE3
        One pose each.
    symmetries : SymmetryGroup
        Of the object.
    length_m : float
        Nearest in terms of rotation^2 + (translation / length_m)^2.
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
        Of the object's surface, object frame [m].
    symmetries : SymmetryGroup
        Of the object.

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
