# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""A simulated recording for tests of object SLAM."""

from __future__ import annotations

import numpy as np
import posemix as px


def config(frames: int = 80) -> px.SimulationConfig:
    mug = px.SimulationObject(id="mug", position_m=[0.1, 0, 0], noise=[noise(0.7), noise(0.3, 12.0)])
    box = px.SimulationObject(
        id="box", position_m=[-0.2, 0.1, 0], misses=px.SimulationRuns(fraction=0.3, mean_run_s=0.5)
    )
    return px.SimulationConfig(path=px.SimulationPath(frames=frames), objects=[mug, box])


def noise(weight: float, degrees: float = 4.0) -> px.SimulationNoise:
    sd = px.SimulationSd(rotation_rad=np.full(3, np.radians(degrees)), translation_m=[0.005] * 3)
    return px.SimulationNoise(weight=weight, sd=sd)


class Scene:
    """A simulated recording and what the filter is told."""

    def __init__(self, frames: int = 80, **settings: object) -> None:
        c = config(frames)
        self.simulated = px.simulate(c, seed=3)
        self.sequence = self.simulated.sequence
        self.models = [px.object_model(o) for o in c.objects]
        self.prior = px.camera_prior(c, self.simulated)
        self.settings = px.ObjectSlamSettings(motion=px.motion_settings(c), **settings)

    def run(self, **options: object) -> px.SlamRun:
        return px.run(self.sequence, self.prior, self.models, self.settings, **options)


def frame_input(sequence: px.Sequence, k: int, seen: object) -> px.FrameInput:
    """The frame as a live caller gives it; nothing moves before the first one."""
    if k == 0:
        return px.FrameInput(detections=seen)
    motion = sequence.odometry[k - 1].inverse() * sequence.odometry[k]
    return px.FrameInput(sequence.stamps[k] - sequence.stamps[k - 1], motion, seen)
