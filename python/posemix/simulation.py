# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Simulated recordings: a camera around a table of objects, odometry that drifts, a detector that errs."""

from __future__ import annotations

from posemix import _core
from posemix._core import (
    MotionSettings,
    Clutter,
    ObjectModel,
    SimulationConfig,
    SimulationFlips,
    SimulationNoise,
    SimulationObject,
    SimulationOutliers,
    SimulationPath,
    SimulationRuns,
    SimulationSd,
    SimulationSwing,
)
from posemix.density import ConcentratedGaussian
from posemix.lie import SE3
from posemix.recording import Sequence

__all__ = [
    "SimulatedSequence", "SimulationConfig", "SimulationFlips", "SimulationNoise", "SimulationObject",
    "SimulationOutliers", "SimulationPath", "SimulationRuns", "SimulationSd", "SimulationSwing", "camera_prior",
    "claimed_noise", "claimed_clutter", "motion_settings", "object_model", "simulate",
]  # fmt: skip


class SimulatedSequence:
    """A simulated recording; `simulate` makes it."""

    __slots__ = ("_handle", "_sequence")

    def __init__(self, handle: _core.SimulatedSequence) -> None:
        self._handle = handle
        self._sequence = Sequence._of(handle.sequence())

    @property
    def sequence(self) -> Sequence:
        """The recording as object SLAM takes it, with its truth."""
        return self._sequence

    @property
    def camera_start(self) -> SE3:
        """T_world_camera of the first frame as the filter is told."""
        return self._handle.camera_start()

    def __repr__(self) -> str:
        return f"<SimulatedSequence: {self._sequence!r}>"


def simulate(config: SimulationConfig, seed: int) -> SimulatedSequence:
    """A recording; the same configuration and seed give the same one on any machine.

    Parameters
    ----------
    config : SimulationConfig
        Path, objects, errors.
    seed : int
        Of the errors.

    Raises
    ------
    ValueError
        Naming the setting that is out of range.

    Examples
    --------
    >>> from posemix import SimulationConfig, SimulationObject, SimulationPath, simulate
    >>> config = SimulationConfig(path=SimulationPath(frames=50), objects=[SimulationObject(id="mug")])
    >>> simulate(config, seed=1).sequence
    <Sequence of 50 frames over 4.9 s, objects mug>
    """
    return SimulatedSequence(_core.simulate(config, seed))


def claimed_noise(object: SimulationObject) -> list[SimulationNoise]:
    """The noise components that the filter is told for an object."""
    return _core.claimed_noise(object)


def claimed_clutter(object: SimulationObject) -> Clutter:
    """The clutter that the filter is told: the fraction of outliers."""
    return _core.claimed_clutter(object)


def object_model(object: SimulationObject) -> ObjectModel:
    """What the filter is told of an object."""
    return _core.object_model(object)


def motion_settings(config: SimulationConfig) -> MotionSettings:
    """Motion model with the claimed odometry error."""
    return _core.motion_settings(config)


def camera_prior(
    config: SimulationConfig, simulated: SimulatedSequence
) -> ConcentratedGaussian[SE3]:
    """T_world_camera of the first frame as the filter is told."""
    return ConcentratedGaussian._of(_core.camera_prior(config, simulated._handle))
