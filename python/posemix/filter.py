# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Filters over the poses of a camera and of objects, one call per prediction or update.

See `posemix.slam` for whole recordings.
"""

from posemix._core import (
    AttachedMotion, ConstantVelocityMotion, Detection, GaussianSumFilter, GaussianSumSettings, KnownCamera,
    KnownFrame, MotionFrame, MotionModels, MovingObjectEstimate, MovingObjectFilter, MovingObjectHypothesis,
    MovingObjectReport, MovingObjectSettings, MovingObjectSmoother, MovingObjectSmoothing, MovingObjectStep,
    MultiObjectFilter, MultiObjectSettings, NoiseUse, ObjectHypothesis, ObjectUpdateReport, ObservationSource,
    PutDownMotion, RandomWalkMotion, RobustLoss, StaticMotion, Summary, UpdateReport, UpdateRule,
    calm_and_agile, camera_on_arm, exact_camera, smooth_moving_object, still_camera,
)  # fmt: skip
from posemix.noise import *

__all__ = [
    "AttachedMotion", "Clutter", "ConstantVelocityMotion", "DependentFrames", "Detection", "DetectorNoise",
    "GaussianSumFilter", "GaussianSumSettings", "GivenCovariance", "KnownCamera", "KnownFrame", "MotionFrame",
    "MotionModels", "MovingObjectEstimate", "MovingObjectFilter", "MovingObjectHypothesis",
    "MovingObjectReport", "MovingObjectSettings", "MovingObjectSmoother", "MovingObjectSmoothing",
    "MovingObjectStep", "MultiObjectFilter", "MultiObjectSettings", "NoiseComponent", "NoiseCorrelation",
    "NoiseCriterion", "NoiseDependence", "NoiseEmFit", "NoiseFit", "NoiseFitSettings", "NoiseFrame",
    "NoiseMode", "NoiseModeSettings", "NoiseUse", "NoiseValidation", "ObjectHypothesis", "ObjectSensor",
    "ObjectUpdateReport", "ObservationSource", "OdometryNoise", "OdometryNoiseSettings", "OdometryWindow",
    "PutDownMotion", "RandomWalkMotion", "RobustLoss", "SlowError", "SlowErrorDecay", "SlowErrorFit",
    "SlowErrorModel", "StaticMotion", "Summary", "SymmetricPoseError", "SymmetryAxis", "SymmetryGroup",
    "SymmetryTolerance", "UpdateReport", "UpdateRule", "along_camera", "calm_and_agile", "camera_on_arm",
    "default_detector_noise", "exact_camera", "fit_noise", "fit_odometry_noise",
    "max_symmetric_surface_distance", "pose_covariance", "smooth_moving_object", "still_camera",
    "symmetric_pose_error",
]  # fmt: skip
