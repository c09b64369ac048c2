# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""A simulated camera that moves past objects, as a running estimator meets it."""

from __future__ import annotations

from collections.abc import Iterator

import posemix as px
from slam_scene import Scene

from posemix.live_view import LiveFrame


class LiveScene(Scene):
    """The same recording through `StampedSlam`, one object of which is not declared but found on sight.

    Parameters
    ----------
    frames : int
        Number of frames.
    start_s : float
        Time of the first frame [s].
    moves : bool
        Whether the mug may move.
    """

    def __init__(self, frames: int = 20, start_s: float = 0.0, moves: bool = False) -> None:
        super().__init__(frames)
        self.start_s = start_s
        if moves:
            mug = self.models[0]
            self.models[0] = px.ObjectModel(
                id=mug.id, noise=mug.noise, motion=px.MotionModels(models=[px.RandomWalkMotion()])
            )
        self.slam = px.StampedSlam(self.prior, self.models, motion=self.settings.motion)

    def stamp(self, k: int) -> float:
        return self.start_s + float(self.sequence.stamps[k])

    def add(self, k: int) -> None:
        """Takes in the odometry and the detections of a frame."""
        self.slam.add_odometry(self.stamp(k), self.sequence.odometry[k])
        for recorded in self.sequence.objects:
            if px.is_known(recorded.detections)[k]:
                seen = [px.ObservationComponent(recorded.detections[k])]
                self.slam.add(px.Observation(seen, object=recorded.id, stamp_s=self.stamp(k)))

    def steps(self) -> Iterator[px.StampedSlam]:
        """The estimator after every frame."""
        for k in range(len(self.sequence.stamps)):
            self.add(k)
            yield self.slam


def live_frame() -> LiveFrame:
    """The only frame of a recording."""
    scene = LiveScene(1)
    for _ in scene.steps():
        pass
    frame = LiveFrame.of(scene.slam)
    assert frame is not None
    return frame
