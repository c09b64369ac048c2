# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Simulated recordings: a camera around a table of objects, odometry with drift, a detector with errors."""

from __future__ import annotations

from posemix._core import (
    SimulatedSequence,
    SimulationConfig,
    SimulationFlips,
    SimulationNoise,
    SimulationObject,
    SimulationOutliers,
    SimulationPath,
    SimulationRuns,
    SimulationSd,
    SimulationSwing,
    camera_prior,
    claimed_clutter,
    claimed_noise,
    motion_settings,
    object_model,
    simulate,
)

__all__ = [
    "SimulatedSequence", "SimulationConfig", "SimulationFlips", "SimulationNoise", "SimulationObject",
    "SimulationOutliers", "SimulationPath", "SimulationRuns", "SimulationSd", "SimulationSwing", "camera_prior",
    "claimed_noise", "claimed_clutter", "motion_settings", "object_model", "simulate",
]  # fmt: skip
