# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Object SLAM: camera and objects from detections, live (`ObjectSlam`) or over a recording (`run`), also simulated."""

from posemix._core import (
    Association, AssociationSettings, CandidateStatus, DetectionStatus, FixedLagSmoother, FrameInput, Metrics,
    ModeForecast, MotionModel, MotionSettings, MultiObjectSlamSettings, NoisePer, ObjectMetrics, ObjectModel,
    ObjectSlam, ObjectSlamSettings, PoseErrors, ProcessNoise, SimulatedSequence, SimulationConfig, SimulationFlips,
    SimulationNoise, SimulationObject, SimulationOutliers, SimulationPath, SimulationRuns, SimulationSd,
    SimulationSwing, SlamMethod, SmoothingSettings, Timing, associate, camera_prior, claimed_clutter, claimed_noise,
    evaluate, find_slam_method, least_cost_assignment, motion_settings, object_model, on_right_mode, simulate,
    slam_methods, squared_normalized_error, true_relative_pose, true_world_pose,
)  # fmt: skip
from posemix.recording import *
from posemix.runs import *

__all__ = [
    "Association", "AssociationSettings", "Candidate", "CandidateReport", "CandidateStatus", "DetectionStatus",
    "FixedLagSmoother", "FrameEstimate", "FrameInput", "FrameReport", "HypothesisSnapshot", "Metrics", "ModeForecast",
    "MotionModel", "MotionSettings", "MultiObjectSlamSettings", "NoisePer", "ObjectAlternative", "ObjectEstimate",
    "ObjectMetrics", "ObjectModel", "ObjectRecording", "ObjectSlam", "ObjectSlamSettings", "ParticleFilterSettings",
    "PoseErrors", "PoseTrack", "ProcessNoise", "Sequence", "SimulatedSequence", "SimulationConfig", "SimulationFlips",
    "SimulationNoise", "SimulationObject", "SimulationOutliers", "SimulationPath", "SimulationRuns", "SimulationSd",
    "SimulationSwing", "SlamJob", "SlamMethod", "SlamRun", "SmoothingSettings", "Timing", "associate", "camera_prior",
    "claimed_clutter", "claimed_noise", "evaluate", "find_slam_method", "is_known", "least_cost_assignment",
    "motion_settings", "object_model", "on_right_mode", "run", "run_smoothed", "simulate", "slam_methods",
    "squared_normalized_error", "true_relative_pose", "true_world_pose", "with_misses",
]  # fmt: skip
