# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Object SLAM: camera and objects from detections, live (`ObjectSlam`) or over a recording (`run`), also simulated."""

from posemix._core import (
    AgreedObject, Alignment, Association, AssociationSettings, AxisConsistency, BetaDistribution, BodyCamera,
    CandidateStatus, Consistency, ConsistencyReport, ConsistencyVerdict, Coverage, DetectionStatus, ErrorAxes,
    ErrorDirection, EstimateAtStamp, Existence, ExistenceSettings, FixedLagSmoother, FrameConsistency, FrameInput,
    FusedInstance, FuseViewsSettings, HealthSettings, InstanceCounts, Interval, Metrics, ModeForecast, MotionModel,
    MotionSettings, MultiObjectSlamSettings, NeesSummary, NoisePer, ObjectMetrics, ObjectModel, ObjectPrior,
    ObjectSlam, ObjectSlamSettings, Observation, ObservationComponent, PairedErrors, PoseErrors, PoseMedians,
    ProcessNoise, Relocalisation, RelocaliseOutcome, RelocaliseSettings, RelocatedObject, Sighting, SimulatedSequence,
    SimulationClutter, SimulationConfig, SimulationConveyor, SimulationFlips, SimulationFrame, SimulationHandHeld,
    SimulationHeld, SimulationMoves, SimulationNoise, SimulationObject, SimulationOutliers, SimulationPath,
    SimulationPickAndPlace, SimulationPlace, SimulationPutDown, SimulationRuns, SimulationSd, SimulationSetUp,
    SimulationSlowError, SimulationSwing, SimulationView, SimulationWaypoint, SlamMethod, SmoothingSettings,
    StampAdmission, StampCounts, StampedSlam, StampedSlamSettings, StampJump, StateInfo, Timing, TrackHealth, View,
    ViewClass, ViewSupport, associate, camera_prior, claimed_clutter, claimed_mode_time_s, claimed_noise,
    claimed_slow_error, consistency, evaluate, find_slam_method, fit_existence, fuse_views, least_cost_assignment,
    models_with_priors, motion_settings, object_model, object_models, on_right_mode, relocalise, simulate,
    slam_methods, squared_normalized_error, state_info, true_relative_pose, true_world_pose,
)  # fmt: skip
from posemix.recording import *
from posemix.runs import *

__all__ = [
    "AgreedObject", "Alignment", "Association", "AssociationSettings", "AxisConsistency", "BetaDistribution",
    "BodyCamera", "Candidate", "CandidateReport", "CandidateStatus", "Consistency", "ConsistencyReport",
    "ConsistencyVerdict", "Coverage", "DetectionStatus", "ErrorAxes", "ErrorDirection", "EstimateAtStamp",
    "Existence", "ExistenceSettings", "FixedLagSmoother", "FrameConsistency", "FrameEstimate", "FrameInput",
    "FrameReport", "FusedInstance", "FuseViewsSettings", "HealthSettings", "HypothesisSnapshot", "InstanceCounts",
    "Interval", "Metrics", "ModeForecast", "MotionModel", "MotionSettings", "MultiObjectSlamSettings", "NeesSummary",
    "NoisePer", "ObjectAlternative", "ObjectEstimate", "ObjectMetrics", "ObjectModel", "ObjectPrior",
    "ObjectRecording", "ObjectSlam", "ObjectSlamSettings", "ObjectTwist", "Observation", "ObservationComponent",
    "PairedErrors", "ParticleFilterSettings", "PoseErrors", "PoseMedians", "PoseTrack", "ProcessNoise",
    "Relocalisation", "RelocaliseOutcome", "RelocaliseSettings", "RelocatedObject", "Sequence", "Sighting",
    "SimulatedSequence", "SimulationClutter", "SimulationConfig", "SimulationConveyor", "SimulationFlips",
    "SimulationFrame", "SimulationHandHeld", "SimulationHeld", "SimulationMoves", "SimulationNoise",
    "SimulationObject", "SimulationOutliers", "SimulationPath", "SimulationPickAndPlace", "SimulationPlace",
    "SimulationPutDown", "SimulationRuns", "SimulationSd", "SimulationSetUp", "SimulationSlowError",
    "SimulationSwing", "SimulationView", "SimulationWaypoint", "SlamJob", "SlamMethod", "SlamRun",
    "SmoothingSettings", "StampAdmission", "StampCounts", "StampedSlam", "StampedSlamSettings", "StampJump",
    "StateInfo", "Timing", "TrackHealth", "View", "ViewClass", "ViewSupport", "associate", "camera_prior",
    "claimed_clutter", "claimed_mode_time_s", "claimed_noise", "claimed_slow_error", "consistency", "evaluate",
    "find_slam_method", "fit_existence", "fuse_views", "is_known", "least_cost_assignment", "models_with_priors",
    "motion_settings", "object_model", "object_models", "on_right_mode", "relocalise", "run", "run_smoothed",
    "simulate", "slam_methods", "squared_normalized_error", "state_info", "true_relative_pose", "true_world_pose",
    "with_misses",
]  # fmt: skip
