# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Frame by frame SLAM with tags by GTSAM's iSAM2; `fiducials_isam2.py` describes the factors."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, field
from typing import Any

import gtsam
import numpy as np
from fiducials_files import Array, Sightings, Trajectory, inverse
from gtsam.symbol_shorthand import L, X

# Widths of the kernels in deviations: of |n| over six degrees of freedom, whose median is 2.3 and 95 % quantile 3.5.
KERNELS: dict[str, tuple[Callable[[float], Any], float]] = {
    "none": (lambda width: None, 0.0),
    "huber": (gtsam.noiseModel.mEstimator.Huber.Create, 3.5),
    "cauchy": (gtsam.noiseModel.mEstimator.Cauchy.Create, 3.5),
    "dcs": (gtsam.noiseModel.mEstimator.DCS.Create, 12.6),
}
LONGEST_WALK_S = 10.0  # a random walk of rotations is no wider after longer gaps
WIDE = (1.0, 10.0)  # a prior that says next to nothing [rad, m]


@dataclass
class Settings:
    """Of the estimator; noises are deviations of rotation [rad] and translation [m] per square root of a second."""

    kernel: str = "cauchy"
    kernel_width: float | None = None
    odometry_noise: tuple[float, float] = (0.005, 0.02)
    walk_noise: tuple[float, float] = (math.radians(30), 0.3)
    first_noise: tuple[float, float] = (1e-3, 1e-3)
    prior_noise: tuple[float, float] | None = None
    rig_odometry: Array = field(default_factory=lambda: np.eye(4))
    least_weight: float = 0.0
    relinearize_threshold: float = 0.01
    relinearize_skip: int = 1
    factorization: str = "CHOLESKY"
    updates: int = 1


@dataclass
class Frame:
    """The best sightings of one stamp."""

    stamp: float
    sightings: Sightings


def frames_of(sightings: Sightings, cameras: Collection[str]) -> Iterator[Frame]:
    """The frames of a recording, stamps that are equal to a microsecond, without cameras of unknown pose on the rig."""
    best = sightings.best()
    best = best.rows(np.isin(best.cameras, list(cameras)))
    starts = np.flatnonzero(np.diff(best.stamps, prepend=-np.inf) > 1e-6)
    for chosen in np.split(np.arange(len(best.stamps)), starts[1:]):
        if len(chosen):
            yield Frame(float(best.stamps[chosen[0]]), best.rows(chosen))


def diagonal(noise: tuple[float, float], seconds: float = 1.0) -> gtsam.noiseModel.Base:
    """A noise model of deviations of rotation and translation that grow with the square root of time."""
    return gtsam.noiseModel.Diagonal.Sigmas(np.repeat(noise, 3) * math.sqrt(seconds))


@dataclass
class Isam2Slam:
    """The filter: `step` takes one frame after the other; poses are as after the last one."""

    cameras: dict[str, Array]
    odometry: Trajectory | None = None
    priors: dict[str, tuple[Array, Array]] = field(default_factory=dict)
    settings: Settings = field(default_factory=Settings)
    restarts: int = 0

    def __post_init__(self) -> None:
        self.factorization = self.settings.factorization
        self.isam = self.new_isam()
        self.factors = gtsam.NonlinearFactorGraph()  # all of them, for a restart
        self.tags: dict[str, int] = {}
        self.poses: dict[int, gtsam.Pose3] = {}  # the latest known by key
        self.stamps: list[float] = []
        self.last_odometry: Array | None = None
        create, width = KERNELS[self.settings.kernel]
        self.kernel = create(width if self.settings.kernel_width is None else self.settings.kernel_width)

    def new_isam(self) -> gtsam.ISAM2:
        """An empty estimator."""
        parameters = gtsam.ISAM2Params()
        parameters.setRelinearizeThreshold(self.settings.relinearize_threshold)
        parameters.relinearizeSkip = self.settings.relinearize_skip
        parameters.setFactorization(self.factorization)
        return gtsam.ISAM2(parameters)

    def step(self, frame: Frame) -> tuple[Array, dict[str, Array]]:
        """Takes a frame; returns T_world_rig and T_world_tag of the tags that it sees and that have an estimate."""
        new, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        rig = X(len(self.stamps))
        certain = np.argsort([np.linalg.slogdet(c)[1] for c in frame.sightings.covariances])
        seen = [
            (str(frame.sightings.ids[i]), self.cameras[frame.sightings.cameras[i]] @ frame.sightings.poses[i], i)
            for i in certain
            if frame.sightings.weights[i] >= self.settings.least_weight
        ]
        self.poses[rig] = self.add_motion(frame.stamp, rig, seen, frame.sightings.covariances, new)
        values.insert(rig, self.poses[rig])
        for name, rig_tag, i in seen:
            if name not in self.tags:
                self.add_tag(name, self.poses[rig].compose(gtsam.Pose3(rig_tag)), new, values)
            noise: Any = gtsam.noiseModel.Gaussian.Covariance(frame.sightings.covariances[i])
            if self.kernel is not None:
                noise = gtsam.noiseModel.Robust.Create(self.kernel, noise)
            new.add(gtsam.BetweenFactorPose3(rig, self.tags[name], gtsam.Pose3(rig_tag), noise))
        self.stamps.append(frame.stamp)
        self.update(new, values, rig)
        seen_tags = {name: self.tags[name] for name in map(str, frame.sightings.ids) if name in self.tags}
        for key in [rig, *seen_tags.values()]:
            self.poses[key] = self.isam.calculateEstimatePose3(key)
        return self.poses[rig].matrix(), {name: self.poses[key].matrix() for name, key in seen_tags.items()}

    def add_motion(
        self,
        stamp: float,
        rig: int,
        seen: list[tuple[str, Array, int]],
        covariances: Array,
        new: gtsam.NonlinearFactorGraph,
    ) -> gtsam.Pose3:
        """Adds the factor of the motion, or the prior of the first pose; returns the rig's first guess."""
        now = None
        if self.odometry is not None:
            poses, valid = self.odometry.at(np.array([stamp]))
            now = poses[0] if valid[0] else None
        before, self.last_odometry = self.last_odometry, now
        need_tags = not self.stamps or now is None or before is None
        by_tags = self.rig_by_tags(seen, covariances) if need_tags else None
        if not self.stamps:
            guess = gtsam.Pose3() if by_tags is None else by_tags
            first = diagonal(WIDE if self.priors else self.settings.first_noise)
            new.add(gtsam.PriorFactorPose3(rig, guess, first))
            return guess
        seconds, last = stamp - self.stamps[-1], X(len(self.stamps) - 1)
        if now is None or before is None:
            noise = diagonal(self.settings.walk_noise, min(seconds, LONGEST_WALK_S))
            new.add(gtsam.BetweenFactorPose3(last, rig, gtsam.Pose3(), noise))
            return self.poses[last] if by_tags is None else by_tags
        motion = gtsam.Pose3(inverse(before) @ now)
        new.add(gtsam.BetweenFactorPose3(last, rig, motion, diagonal(self.settings.odometry_noise, seconds)))
        return self.poses[last].compose(motion)

    def rig_by_tags(self, seen: list[tuple[str, Array, int]], covariances: Array) -> gtsam.Pose3 | None:
        """T_world_rig by the sighting of a known tag that agrees best with the others, in Cauchy's loss."""
        known = [
            (self.poses[self.tags[name]] if name in self.tags else gtsam.Pose3(self.priors[name][0]), rig_tag, i)
            for name, rig_tag, i in seen
            if name in self.tags or name in self.priors
        ]
        best, least = None, math.inf
        whitening = [np.linalg.cholesky(np.linalg.inv(covariances[i])).T for _, _, i in known]
        for tag, rig_tag, _ in known:
            rig, loss = tag.compose(gtsam.Pose3(rig_tag).inverse()), 0.0
            for (other, seen_as, _), root in zip(known, whitening, strict=True):
                error = root @ gtsam.Pose3.Logmap(gtsam.Pose3(seen_as).between(rig.between(other)))
                loss += math.log1p(error @ error / 3.5**2)
            if loss < least:
                best, least = rig, loss
        return best

    def add_tag(self, name: str, guess: gtsam.Pose3, new: gtsam.NonlinearFactorGraph, values: gtsam.Values) -> None:
        """Begins a tag where it was seen, or at its prior."""
        key = self.tags.setdefault(name, L(len(self.tags)))
        if name in self.priors:
            guess, noise = gtsam.Pose3(self.priors[name][0]), self.settings.prior_noise
            stated = gtsam.noiseModel.Gaussian.Covariance(self.priors[name][1])
            new.add(gtsam.PriorFactorPose3(key, guess, stated if noise is None else diagonal(noise)))
        self.poses[key] = guess
        values.insert(key, guess)

    def update(self, new: gtsam.NonlinearFactorGraph, values: gtsam.Values, rig: int) -> None:
        """Updates iSAM2; where its system is indeterminate, begins again by QR, then with a wide prior of the rig.

        Cholesky finds systems indeterminate that are only badly conditioned, as after gaps without odometry. An update
        that fails leaves iSAM2 half changed, so that it cannot be continued.
        """
        self.factors.push_back(new)
        try:
            self.isam.update(new, values)
            for _ in range(self.settings.updates - 1):
                self.isam.update()
        except RuntimeError as error:
            if not re.search("[Ii]ndetermina[nt]", str(error)):
                raise
            self.restarts += 1
            if self.factorization == "QR":
                self.factors.add(gtsam.PriorFactorPose3(rig, self.poses[rig], diagonal(WIDE)))
            self.factorization = "QR"
            start = gtsam.Values()
            for key, pose in self.poses.items():
                start.insert(key, pose)
            self.isam = self.new_isam()
            self.isam.update(self.factors, start)

    def smoothed(self) -> tuple[Trajectory, dict[str, Array]]:
        """T_world_rig at all stamps and T_world_tag, from all frames so far."""
        values = self.isam.calculateEstimate()
        rigs = np.array([values.atPose3(X(i)).matrix() for i in range(len(self.stamps))])
        return Trajectory(np.array(self.stamps), rigs), {n: values.atPose3(k).matrix() for n, k in self.tags.items()}
