# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Poses of square tags (AprilTag, ArUco) from their corners: both that fit, with weights and covariances.

The frame of a tag is that of TagSLAM and of OpenCV's ``SOLVEPNP_IPPE_SQUARE``: x right and y up on the printed tag, z
out of it towards the viewer. Covariances are those of n in ``T_camera_tag Exp(n)``, rotation [rad] before translation
[m].
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray
from posemix._core import (
    CameraCornerNoise, CameraModel, CornerNoise, CornerNoiseFit, CornerNoiseSource, CornerOrder, CornerSighting,
    DistortionModel, FiducialSettings, RigCamera, StatedPose, TagMap, TagMinimum, fit_corner_noise, read_cameras,
    read_corners, read_tag_map, tag_minima, write_fiducials,
)  # fmt: skip
from posemix.lie import SE3

__all__ = [
    "CameraCornerNoise", "CameraModel", "CornerNoise", "CornerNoiseFit", "CornerNoiseSource", "CornerOrder",
    "CornerSighting", "DistortionModel", "FiducialSettings", "Fiducials", "RigCamera", "StatedPose", "TagMap",
    "TagMinimum", "TagPoses", "fit_corner_noise", "observe_fiducials", "read_cameras", "read_corners", "read_tag_map",
    "tag_minima", "tag_poses", "write_fiducials",
]  # fmt: skip


@dataclass(frozen=True, eq=False)
class TagPoses:
    """The poses of a tag that are possible, the most probable one first.

    Attributes
    ----------
    weights : ndarray, shape (n,)
        Probabilities, which sum to one.
    poses : SE3, shape (n,)
        T_camera_tag.
    covariances : ndarray, shape (n, 6, 6)
        Covariances of n in T_camera_tag Exp(n) [rad, m].
    """

    weights: FloatArray
    poses: SE3
    covariances: FloatArray

    def __len__(self) -> int:
        return len(self.weights)


def tag_poses(
    corners: npt.ArrayLike,
    size: float,
    camera: CameraModel,
    noise: CornerNoise,
    *,
    order: CornerOrder = CornerOrder.apriltag,
    least_weight: float = 1e-6,
    bearing_sd_px: float = 0.3,
) -> TagPoses:
    """The posterior of a tag's pose under a flat prior.

    The weight of a minimum is its mass in the normal approximation, the height of the peak times its width, and with
    heavy tails its integral over the variance of the sighting too.

    Parameters
    ----------
    corners : array_like, shape (4, 2)
        Distorted pixels.
    size : float
        Edge of the tag [m].
    camera : CameraModel
        Intrinsics and distortion.
    noise : CornerNoise
        Noise of the corners, as from `fit_corner_noise`.
    order : CornerOrder
        Order of the corners.
    least_weight : float
        Poses with less are left out.
    bearing_sd_px : float
        Standard deviation of an error that all corners of a sighting share, as of calibrations [px].

    Returns
    -------
    TagPoses
        Two poses for most views; none where the corners are no image of the front of a square.

    Raises
    ------
    ValueError
        As `tag_minima`, and for a noise that is not positive.

    Examples
    --------
    >>> from posemix import CameraModel, CornerNoise, tag_poses
    >>> camera = CameraModel([600.0, 600.0, 640.0, 512.0])
    >>> corners = [[500.2, 300.1], [531.5, 301.9], [532.3, 270.4], [500.9, 268.8]]
    >>> tag_poses(corners, 0.15, camera, CornerNoise(0.3)).weights.round(2)
    array([0.84, 0.16])
    """
    minima = tag_minima(corners, size, camera, order)
    if not 0.0 <= least_weight < 0.5:
        raise ValueError(f"least_weight is {least_weight}; expected a number in [0, 0.5)")
    if not 0.0 <= bearing_sd_px < math.inf:
        raise ValueError(f"bearing_sd_px is {bearing_sd_px}; expected a number that is not negative")
    return TagPoses(*_core.tag_components(minima, noise, least_weight, camera, bearing_sd_px))


@dataclass(frozen=True, eq=False)
class Fiducials:
    """The observations of a recording, as arrays over their components.

    Attributes
    ----------
    sighting : ndarray of int, shape (n,)
        Index of the observation of each component; the components of one follow each other.
    weights : ndarray, shape (n,)
        Probabilities, which sum to one per observation.
    poses : SE3, shape (n,)
        T_camera_tag.
    covariances : ndarray, shape (n, 6, 6)
        Covariances of n in T_camera_tag Exp(n) [rad, m].
    stamps : ndarray, shape (m,)
        Times of the observations [s].
    cameras : list of str
        Names of the cameras of the observations.
    tags : ndarray of int, shape (m,)
        Ids of the tags of the observations.
    noise : list of CameraCornerNoise
        Noise of the corners by camera.
    sightings, ignored, without_size, without_pose : int
        Number of sightings, and of those that are no observation: of tags to ignore, of tags of unknown size, and
        with corners that are no image of a tag's front.
    """

    sighting: npt.NDArray[np.int64]
    weights: FloatArray
    poses: SE3
    covariances: FloatArray
    stamps: FloatArray
    cameras: list[str]
    tags: npt.NDArray[np.int64]
    noise: list[CameraCornerNoise]
    sightings: int
    ignored: int
    without_size: int
    without_pose: int

    def __len__(self) -> int:
        return len(self.stamps)


def observe_fiducials(
    sightings: Sequence[CornerSighting],
    cameras: Sequence[RigCamera],
    tags: TagMap,
    settings: FiducialSettings | None = None,
) -> Fiducials:
    """Both poses of every sighting, with the noise of the corners learned per camera.

    Parameters
    ----------
    sightings : sequence of CornerSighting
        Corners of the tags, as from `read_corners`.
    cameras : sequence of RigCamera
        Cameras, which the sightings name by topic or name.
    tags : TagMap
        Sizes of the tags, as from `read_tag_map`.
    settings : FiducialSettings, optional
        Order of the corners, noise.

    Raises
    ------
    ValueError
        For a sighting of an unknown camera, without sightings or cameras.

    Warns
    -----
    UserWarning
        Where the noise of the corners, the size of a tag or the order of the corners is hardly true.
    """
    stamps, names, ids, sighting, components, noise, sighted, ignored, without_size, without_pose, doubts = (
        _core.observe_fiducials(list(sightings), list(cameras), tags, settings or FiducialSettings())
    )
    for doubt in doubts:
        warnings.warn(doubt, stacklevel=2)
    weights, poses, covariances = components
    return Fiducials(
        sighting=np.array(sighting, dtype=np.int64), weights=weights, poses=poses, covariances=covariances,
        stamps=np.array(stamps), cameras=names, tags=np.array(ids, dtype=np.int64), noise=noise, sightings=sighted,
        ignored=ignored, without_size=without_size, without_pose=without_pose,
    )  # fmt: skip
