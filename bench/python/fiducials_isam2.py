#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Fiducial SLAM by GTSAM's iSAM2 with a robust kernel, from the best pose of every sighting.

Reads a folder of `posemix fiducials`: observations.csv[.gz] (of a sighting the row of the largest weight, with its
covariance), cameras.csv, odometry.tum if it is there and, with --priors, tag_priors.csv. The state is a pose of the rig
per stamp with observations and a pose per tag. Factors are

- a tag in the rig's frame, Y = X Exp(n), n of the observation's covariance, with the kernel on |n| over its deviation;
- the motion between two stamps: that of the odometry with the deviations --odometry-noise, per square root of a second;
  where there is none, or the odometry has a gap, a random walk with --walk-noise;
- a prior of the first rig pose (no odometry: the origin), or those of the known tags.

A new tag begins at its most certain sighting of the frame; the rig where the odometry predicts it, and without odometry
where the known tag of the most certain sighting has it. After each frame are written, as it stood then (no smoothing):

- camera.tum: T_world_rig; camera_final.tum is the same at the end, after smoothing;
- sightings.csv: T_camera_tag of each seen tag; tags.csv: T_world_tag at the end.

With --reference the result is scored by fiducials_score.py.

example: bench/python/fiducials_isam2.py out/tags out/isam2 --kernel cauchy --reference reference_rig.tum.gz
"""

from __future__ import annotations

import argparse
import math
import re
import time
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import gtsam
import numpy as np
from fiducials_files import (
    POSE_COLUMNS,
    Array,
    Sightings,
    Trajectory,
    inverse,
    observations_path,
    read_named_poses,
    read_priors,
    read_sightings,
    read_tum,
)
from fiducials_score import print_scores, score_folder
from gtsam.symbol_shorthand import L, X

# Widths of the kernels in deviations: of |n| over six degrees of freedom, whose median is 2.3 and 95 % quantile 3.5.
KERNELS = {
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


def frames_of(sightings: Sightings, cameras: Collection[str], least_weight: float = 0.0) -> Iterator[Frame]:
    """The frames of a recording: stamps that are equal to a microsecond.

    Left out are sightings of a smaller weight and those of cameras whose pose on the rig is not known.
    """
    best = sightings.best()
    best = best.rows((best.weights >= least_weight) & np.isin(best.cameras, list(cameras)))
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
        """Takes a frame; returns T_world_rig and T_world_tag of the tags that it sees."""
        new, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
        rig = X(len(self.stamps))
        certain = np.argsort([np.linalg.slogdet(c)[1] for c in frame.sightings.covariances])
        seen = [
            (str(frame.sightings.ids[i]), self.cameras[frame.sightings.cameras[i]] @ frame.sightings.poses[i], i)
            for i in certain
        ]
        self.poses[rig] = self.add_motion(frame.stamp, rig, seen, new)
        values.insert(rig, self.poses[rig])
        for name, rig_tag, i in seen:
            if name not in self.tags:
                self.add_tag(name, self.poses[rig].compose(gtsam.Pose3(rig_tag)), new, values)
            noise = gtsam.noiseModel.Gaussian.Covariance(frame.sightings.covariances[i])
            if self.kernel is not None:
                noise = gtsam.noiseModel.Robust.Create(self.kernel, noise)
            new.add(gtsam.BetweenFactorPose3(rig, self.tags[name], gtsam.Pose3(rig_tag), noise))
        self.stamps.append(frame.stamp)
        self.update(new, values, rig)
        for key in [rig, *{self.tags[name] for name, _, _ in seen}]:
            self.poses[key] = self.isam.calculateEstimatePose3(key)
        return self.poses[rig].matrix(), {name: self.poses[self.tags[name]].matrix() for name, _, _ in seen}

    def add_motion(
        self, stamp: float, rig: int, seen: list[tuple[str, Array, int]], new: gtsam.NonlinearFactorGraph
    ) -> gtsam.Pose3:
        """Adds the factor of the motion from the last stamp, or the first pose's prior; returns the rig's first guess."""
        now = None
        if self.odometry is not None:
            poses, valid = self.odometry.at(np.array([stamp]))
            now = poses[0] if valid[0] else None
        before, self.last_odometry = self.last_odometry, now
        by_tags = self.rig_by_tags(seen)
        if not self.stamps:
            guess = gtsam.Pose3() if by_tags is None else by_tags
            noise = WIDE if self.priors else self.settings.first_noise
            new.add(gtsam.PriorFactorPose3(rig, guess, diagonal(noise)))
            return guess
        seconds, last = stamp - self.stamps[-1], X(len(self.stamps) - 1)
        if now is None or before is None:
            noise = diagonal(self.settings.walk_noise, min(seconds, LONGEST_WALK_S))
            new.add(gtsam.BetweenFactorPose3(last, rig, gtsam.Pose3(), noise))
            return self.poses[last] if by_tags is None else by_tags
        motion = gtsam.Pose3(inverse(before) @ now)
        new.add(gtsam.BetweenFactorPose3(last, rig, motion, diagonal(self.settings.odometry_noise, seconds)))
        return self.poses[last].compose(motion)

    def rig_by_tags(self, seen: list[tuple[str, Array, int]]) -> gtsam.Pose3 | None:
        """T_world_rig by the most certain sighting of a tag that has a pose or a prior."""
        for name, rig_tag, _ in seen:
            if name in self.tags or name in self.priors:
                tag = self.poses[self.tags[name]] if name in self.tags else gtsam.Pose3(self.priors[name][0])
                return tag.compose(gtsam.Pose3(rig_tag).inverse())
        return None

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
        """Updates iSAM2; where its linear system is indeterminate, begins again by QR, then with a wide prior of the rig.

        Cholesky finds systems indeterminate that are only badly conditioned, as after gaps without odometry. An update
        that fails leaves iSAM2 half changed, so that it cannot be continued.
        """
        self.factors.push_back(new)
        try:
            self.isam.update(new, values)
            for _ in range(self.settings.updates - 1):
                self.isam.update()
        except RuntimeError as error:
            if not re.search("[Ii]ndeterminant|[Ii]ndeterminate", str(error)):
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


def pose_numbers(pose: Array) -> list[str]:
    """tx ty tz qx qy qz qw."""
    q = gtsam.Rot3(pose[:3, :3]).toQuaternion()
    return [f"{x:.12g}" for x in (*pose[:3, 3], q.x(), q.y(), q.z(), q.w())]


def write_tum(path: Path, trajectory: Trajectory) -> None:
    """Lines "stamp tx ty tz qx qy qz qw"."""
    lines = zip(trajectory.stamps, trajectory.poses, strict=True)
    path.write_text("".join(f"{stamp:.9f} {' '.join(pose_numbers(pose))}\n" for stamp, pose in lines))


def run(folder: Path, out: Path, settings: Settings, with_priors: bool = False) -> dict[str, float]:
    """Runs iSAM2 on a folder of `posemix fiducials` and writes the result; returns times and counts.

    The time of a frame is that of `step`, with what Python costs to build the factors, without reading and writing. It
    is the processor's, so that other programs do not count.
    """
    odometry = read_tum(folder / "odometry.tum") if (folder / "odometry.tum").exists() else None
    if odometry is not None:
        odometry.poses = odometry.poses @ inverse(settings.rig_odometry)
    cameras = read_named_poses(folder / "cameras.csv", "camera")
    slam = Isam2Slam(
        cameras,
        odometry,
        read_priors(folder / "tag_priors.csv") if with_priors else {},
        settings,
    )
    out.mkdir(parents=True, exist_ok=True)
    times, rigs = [], []
    with open(out / "sightings.csv", "w") as table:
        table.write(",".join(["stamp_s", "camera", "id", *POSE_COLUMNS]) + "\n")
        for frame in frames_of(read_sightings(observations_path(folder)), cameras, settings.least_weight):
            begin = time.process_time()
            rig, tags = slam.step(frame)
            times.append(time.process_time() - begin)
            rigs.append(rig)
            for camera, name in zip(frame.sightings.cameras, frame.sightings.ids, strict=True):
                pose = inverse(rig @ cameras[camera]) @ tags[name]
                table.write(",".join([f"{frame.stamp:.9f}", camera, name, *pose_numbers(pose)]) + "\n")
    write_tum(out / "camera.tum", Trajectory(np.array(slam.stamps), np.array(rigs)))
    path, tags = slam.smoothed()
    write_tum(out / "camera_final.tum", path)
    rows = [",".join([name, *pose_numbers(pose)]) + "\n" for name, pose in tags.items()]
    (out / "tags.csv").write_text("".join([",".join(["id", *POSE_COLUMNS]) + "\n", *rows]))
    return {
        "frames": len(times),
        "tags": len(tags),
        "restarts": slam.restarts,
        "mean_ms": 1e3 * float(np.mean(times)),
        "worst_ms": 1e3 * max(times),
        "times_real_time": (slam.stamps[-1] - slam.stamps[0]) / sum(times),
    }


def main() -> None:
    """The program."""
    settings = Settings()
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("folder", type=Path, metavar="FOLDER", help="what `posemix fiducials` wrote")
    add("out", type=Path, metavar="OUT", help="folder for the result")
    add("--kernel", choices=list(KERNELS), default=settings.kernel, help="of the tags' factors (default: cauchy)")
    widths = ", ".join(f"{name} {width}" for name, (_, width) in KERNELS.items() if width)
    add("--kernel-width", type=float, help=f"in deviations; of DCS in their squares (defaults: {widths})")
    for name, meaning in (("odometry", "of the odometry"), ("walk", "of the random walk"), ("first", "of the first pose")):
        rotation, translation = getattr(settings, name + "_noise")
        text = f"deviations {meaning} [rad] [m], per sqrt(s) for motions (default: {rotation:.4g} {translation:.4g})"
        add(f"--{name}-noise", type=float, nargs=2, default=(rotation, translation), metavar=("ROT", "TRANS"), help=text)
    add("--least-weight", type=float, default=0.0, help="leave out sightings whose best row weighs less (default: 0)")
    add("--relinearize-threshold", type=float, default=settings.relinearize_threshold, help="(default: 0.01)")
    add("--relinearize-skip", type=int, default=settings.relinearize_skip, help="frames (default: 1)")
    add("--factorization", choices=["CHOLESKY", "QR"], default=settings.factorization, help="(default: CHOLESKY)")
    add("--updates", type=int, default=settings.updates, help="of iSAM2 per frame (default: 1)")
    add("--priors", action="store_true", help="use tag_priors.csv (default: the map is the frame of the first rig pose)")
    text = "pose of the odometry's frame on the rig, as T_body_odom of tagslam.yaml: three metres, rotation vector"
    add("--odometry-frame", default="0 0 0 0 0 0", metavar="'X Y Z A B C'", help=text + " (default: the rig)")
    add("--prior-noise", type=float, nargs=2, metavar=("ROT", "TRANS"), help="in place of that of tag_priors.csv")
    add("--reference", type=Path, help="T_map_rig (TUM): score the result")
    arguments = vars(parser.parse_args())
    folder, out, reference, priors = (arguments.pop(name) for name in ("folder", "out", "reference", "priors"))
    frame = [float(number) for number in arguments.pop("odometry_frame").split()]
    arguments["rig_odometry"] = gtsam.Pose3(gtsam.Rot3.Expmap(np.array(frame[3:])), np.array(frame[:3])).matrix()
    report = run(folder, out, Settings(**arguments), priors)
    print_scores(report)
    if reference is not None:
        print_scores(score_folder(folder, out, read_tum(reference)))


if __name__ == "__main__":
    main()
