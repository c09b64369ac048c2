# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Filters over the poses of a camera and of objects, one call per prediction or update.

See `posemix.slam` for whole recordings.
"""

from posemix._core import (
    Detection, GaussianSumFilter, GaussianSumSettings, MultiObjectFilter, MultiObjectSettings, NoiseUse,
    ObjectHypothesis, ObjectUpdateReport, ObservationSource, RobustLoss, Summary, UpdateReport, UpdateRule,
)  # fmt: skip
from posemix.noise import *

__all__ = [
    "Clutter", "DependentFrames", "Detection", "DetectorNoise", "GaussianSumFilter", "GaussianSumSettings",
    "GivenCovariance",
    "MultiObjectFilter", "MultiObjectSettings", "NoiseComponent", "NoiseCorrelation", "NoiseCriterion",
    "NoiseDependence", "NoiseEmFit", "NoiseFit", "NoiseFitSettings", "NoiseFrame", "NoiseMode",
    "NoiseModeSettings", "NoiseUse", "NoiseValidation", "ObjectHypothesis", "ObjectSensor",
    "ObjectUpdateReport", "ObservationSource", "OdometryNoise", "OdometryNoiseSettings", "OdometryWindow",
    "RobustLoss", "SlowError", "SlowErrorDecay", "SlowErrorFit", "SlowErrorModel", "Summary",
    "SymmetricPoseError", "SymmetryAxis", "SymmetryGroup", "SymmetryTolerance", "UpdateReport", "UpdateRule",
    "along_camera", "default_detector_noise", "fit_noise", "fit_odometry_noise",
    "max_symmetric_surface_distance", "pose_covariance", "symmetric_pose_error",
]  # fmt: skip
