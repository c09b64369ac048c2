# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Noise of detectors, and symmetries of objects."""

from posemix._core import (
    Clutter, DependentFrames, DetectorNoise, GivenCovariance, NoiseComponent, NoiseCorrelation, NoiseCriterion,
    NoiseDependence, NoiseEmFit, NoiseFit, NoiseFitSettings, NoiseFrame, NoiseMode, NoiseModeSettings,
    NoiseValidation, ObjectSensor, OdometryNoise, OdometryNoiseSettings, OdometryWindow, SlowError, SlowErrorDecay,
    SlowErrorFit, SlowErrorModel, SymmetricPoseError, SymmetryAxis, SymmetryGroup, SymmetryTolerance, along_camera,
    default_detector_noise, fit_noise, fit_odometry_noise, max_symmetric_surface_distance, pose_covariance,
    symmetric_pose_error,
)  # fmt: skip

__all__ = [
    "Clutter", "DependentFrames", "DetectorNoise", "GivenCovariance", "NoiseComponent", "NoiseCorrelation",
    "NoiseCriterion", "NoiseDependence", "NoiseEmFit", "NoiseFit", "NoiseFitSettings", "NoiseFrame",
    "NoiseMode", "NoiseModeSettings", "NoiseValidation", "ObjectSensor", "OdometryNoise",
    "OdometryNoiseSettings", "OdometryWindow", "SlowError", "SlowErrorDecay", "SlowErrorFit",
    "SlowErrorModel", "SymmetricPoseError", "SymmetryAxis", "SymmetryGroup", "SymmetryTolerance",
    "along_camera", "default_detector_noise", "fit_noise", "fit_odometry_noise",
    "max_symmetric_surface_distance", "pose_covariance", "symmetric_pose_error",
]  # fmt: skip
