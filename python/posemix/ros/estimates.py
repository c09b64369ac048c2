# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Estimates after images, and what became of the images."""

from __future__ import annotations

from dataclasses import dataclass

from posemix._core import FrameEstimate, ObjectHypothesis
from posemix.bags.track_messages import PoseMixture
from posemix.lie import SE3
from posemix.live_view.frames import mixture_of

__all__ = ["EngineCounts", "LiveEstimate"]


@dataclass
class EngineCounts:
    """What became of the images, by numbers.

    Attributes
    ----------
    images, observations : int
        Images that were taken in, and observations in them.
    late, too_late : int
        Observations that came out of order and were taken in at their stamps, and those older than the history, with
        images that show nothing.
    ignored : int
        Detections of classes that no model has, or one object's second in an image.
    without_odometry : int
        Images for whose stamp there was no odometry in time.
    dropped : int
        Images that were left out: more than may wait, or without the transform from their camera.
    refused : int
        Images that were not valid, or whose stamps had jumped.
    resets : int
        Times at which all was forgotten.
    """

    images: int = 0
    observations: int = 0
    late: int = 0
    too_late: int = 0
    ignored: int = 0
    without_odometry: int = 0
    dropped: int = 0
    refused: int = 0
    resets: int = 0


@dataclass(frozen=True)
class LiveEstimate:
    """The estimate after an image.

    Attributes
    ----------
    stamp_ns : int
        Time of the estimate [ns].
    arrival_s : float
        Time at which the image came, by the clock that images have [s].
    frame : FrameEstimate
        Camera and objects, in the world.
    odometry : SE3 or None
        T_odom_body at the stamp.
    body : str
        Frame of the body.
    hypotheses : dict of str to list of ObjectHypothesis
        Those of the objects that were seen, T_world_object, the most probable first.
    classes : dict of str to str
        Classes of the same objects.
    """

    stamp_ns: int
    arrival_s: float
    frame: FrameEstimate
    odometry: SE3 | None
    body: str
    hypotheses: dict[str, list[ObjectHypothesis]]
    classes: dict[str, str]

    def mixture(self, name: str) -> PoseMixture:
        """The hypotheses of an object as a density."""
        return mixture_of(self.hypotheses[name])
