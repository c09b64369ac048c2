# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""What is shown of a running estimator at one time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from posemix._core import FrameEstimate, ObjectHypothesis, StampedSlam
from posemix.density import ConcentratedGaussian
from posemix.lie import SE3
from posemix.mixture import Mixture

__all__ = ["Frustum", "LiveFrame", "mixture_of"]

PoseMixture: TypeAlias = Mixture[ConcentratedGaussian[SE3]]


def mixture_of(hypotheses: Sequence[ObjectHypothesis]) -> PoseMixture:
    """The hypotheses of an object as a density; the probability that none of them is right is left out."""
    densities = [ConcentratedGaussian(h.pose, h.covariance) for h in hypotheses]
    return Mixture(densities, [h.probability for h in hypotheses])


@dataclass(frozen=True)
class Frustum:
    """What a camera sees, for its pyramid: a pinhole that looks along its z axis, with x to the right and y down.

    Attributes
    ----------
    width, height : int
        Size of the image [px].
    fx, fy, cx, cy : float
        Focal lengths and the principal point [px].
    depth_m : float
        Distance of the pyramid's base [m].
    """

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    depth_m: float = 0.2

    def __post_init__(self) -> None:
        for name in ("width", "height", "fx", "fy", "depth_m"):
            value = getattr(self, name)
            if not 0 < value < float("inf"):
                raise ValueError(f"{name} is {value}; expected a positive number")

    def corners(self) -> list[tuple[float, float, float]]:
        """The corners of the base in the camera, from the upper left one clockwise [m]."""
        z = self.depth_m
        ends = ((0, 0), (self.width, 0), (self.width, self.height), (0, self.height))
        return [((u - self.cx) / self.fx * z, (v - self.cy) / self.fy * z, z) for u, v in ends]


@dataclass(frozen=True)
class LiveFrame:
    """The estimate of camera and objects at one time, with all hypotheses.

    Attributes
    ----------
    stamp_s : float
        Time of the estimate [s].
    estimate : FrameEstimate
        Camera and objects in the world.
    hypotheses : mapping of str to sequence of ObjectHypothesis
        Those of the objects that were seen, T_world_object.
    detections : mapping of str to SE3
        T_camera_object as detected at that time, where known.
    """

    stamp_s: float
    estimate: FrameEstimate
    hypotheses: Mapping[str, Sequence[ObjectHypothesis]]
    detections: Mapping[str, SE3] = field(default_factory=dict)

    @classmethod
    def of(cls, slam: StampedSlam) -> LiveFrame | None:
        """The present estimate; None before the first. Observations that wait for odometry still wait."""
        if not isinstance(slam, StampedSlam):
            raise TypeError(
                f"got a {type(slam).__name__}, expected a StampedSlam; what others estimate is shown by "
                "view.show(LiveFrame(stamp_s, estimate, hypotheses))"
            )
        found = slam.estimate()
        if found is None:
            return None
        seen = [name for name, world in found.estimate.objects.items() if world is not None]
        return cls(found.stamp_s, found.estimate, {name: slam.hypotheses(name) for name in seen})

    @property
    def names(self) -> list[str]:
        """Ids of the objects that there are at that time."""
        worlds = self.estimate.objects
        return [name for name, found in self.hypotheses.items() if found and worlds.get(name) is not None]

    def mixture(self, name: str) -> PoseMixture:
        """The hypotheses of an object as a density."""
        return mixture_of(self.hypotheses[name])
