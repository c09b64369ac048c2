#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Fiducial SLAM by GTSAM's iSAM2 with a robust kernel, from the best pose of every sighting.

Reads a folder of `posemix fiducials`: observations.csv[.gz] (of a sighting the row of the largest weight, with its
covariance), cameras.csv, odometry.tum if it is there and, with --priors, tag_priors.csv. The state is a pose of the rig
per stamp with observations and a pose per tag. Factors are

- a tag in the rig's frame, Y = X Exp(n), n of the observation's covariance, with the kernel on |n| over its deviation;
- the motion between two stamps: that of the odometry with the deviations --odometry-noise, per square root of a second;
  where there is none, or the odometry has a gap, a random walk with --walk-noise; with --sequence-noise both are those
  that sequence.toml states for the filter;
- a prior of the first rig pose (no odometry: the origin), or those of the known tags.

A new tag begins at its most certain sighting of the frame; the rig where the odometry predicts it, and without odometry
where that sighting of a known tag has it that agrees best with the others. After each frame are written, as the
estimate stood then (no smoothing):

- camera.tum: T_world_rig; camera_final.tum is the same at the end, after smoothing;
- sightings.csv: T_camera_tag of each seen tag; tags.csv: T_world_tag at the end;
- times.csv: the processor's time of the frames.

With --reference the result is scored by fiducials_score.py. As a peer of `posemix study fiducials` it is scored beside
the filter, from the same folders in one run.

examples:
  bench/python/fiducials_isam2.py out/tags out/isam2 --kernel cauchy --reference reference_rig.tum.gz
  posemix study fiducials --out out/study \\
    --set 'peers.isam2="python3 bench/python/fiducials_isam2.py --kernel huber --priors --sequence-noise"'
"""

from __future__ import annotations

import argparse
import math
import time
from pathlib import Path
from typing import Any

import gtsam
import numpy as np
from fiducials_files import (
    POSE_COLUMNS,
    Array,
    Trajectory,
    inverse,
    observations_path,
    pose_numbers,
    read_named_poses,
    read_priors,
    read_sightings,
    read_tum,
    write_named_poses,
    write_tum,
)
from fiducials_score import calibrated_cameras, print_scores, score_folder
from isam2_slam import KERNELS, Isam2Slam, Settings, frames_of


def run(
    folder: Path, out: Path, settings: Settings, cameras: dict[str, Array] | None = None, with_priors: bool = False
) -> dict[str, float]:
    """Runs iSAM2 on a folder of `posemix fiducials` and writes the result; returns times and counts.

    The time of a frame is that of `step`, with what Python costs to build the factors, without reading and writing. It
    is the processor's, so that other programs do not count. `cameras` are used in place of those of the folder.
    """
    out.mkdir(parents=True, exist_ok=True)
    odometry = read_tum(folder / "odometry.tum") if (folder / "odometry.tum").exists() else None
    if odometry is not None:
        odometry.poses = odometry.poses @ inverse(settings.rig_odometry)
    if cameras is None:
        cameras = read_named_poses(folder / "cameras.csv", "camera")
    write_named_poses(out / "cameras.csv", "camera", cameras)
    known = with_priors and (folder / "tag_priors.csv").exists()
    priors = read_priors(folder / "tag_priors.csv") if known else {}
    slam, times, rigs = Isam2Slam(cameras, odometry, priors, settings), [], []
    with open(out / "sightings.csv", "w") as table:
        table.write(",".join(["stamp_s", "camera", "id", *POSE_COLUMNS]) + "\n")
        for frame in frames_of(read_sightings(observations_path(folder)), cameras):
            begin = time.process_time()
            rig, tags = slam.step(frame)
            times.append(time.process_time() - begin)
            rigs.append(rig)
            for camera, name in zip(frame.sightings.cameras, frame.sightings.ids, strict=True):
                if name not in tags:
                    continue
                pose = inverse(rig @ cameras[camera]) @ tags[name]
                table.write(",".join([f"{frame.stamp:.9f}", camera, name, *pose_numbers(pose)]) + "\n")
    write_tum(out / "camera.tum", Trajectory(np.array(slam.stamps), np.array(rigs)))
    (out / "times.csv").write_text(f"frames,processor_s,worst_s\n{len(times)},{sum(times):.6f},{max(times):.6f}\n")
    path, tags = slam.smoothed()
    write_tum(out / "camera_final.tum", path)
    write_named_poses(out / "tags.csv", "id", tags)
    return {
        "frames": len(times),
        "tags": len(tags),
        "restarts": slam.restarts,
        "mean_ms": 1e3 * float(np.mean(times)),
        "worst_ms": 1e3 * max(times),
        "times_real_time": (slam.stamps[-1] - slam.stamps[0]) / sum(times),
    }


def sequence_noise(folder: Path) -> dict[str, tuple[float, float]]:
    """The noise of the motion in sequence.toml, by the name of its setting [rad, m, per square root of a second]."""
    import tomllib  # from Python 3.11 on

    motion = tomllib.loads((folder / "sequence.toml").read_text())["motion"]
    noise = motion["noise"]
    if noise["per"] != "second":
        raise ValueError(f"noise of the motion per {noise['per']}, expected per second")
    name = "odometry_noise" if motion["model"] == "odometry" else "walk_noise"
    return {name: (math.radians(noise["rotation_sd_deg"]), noise["translation_sd_m"])}


def arguments_of(parser: argparse.ArgumentParser) -> dict[str, Any]:
    """The options, those of the settings by the names of the fields."""
    settings, add = Settings(), parser.add_argument
    add("folder", type=Path, metavar="FOLDER", help="what `posemix fiducials` wrote")
    add("out", type=Path, metavar="OUT", help="folder for the result")
    add("--kernel", choices=list(KERNELS), default=settings.kernel, help="of the tags' factors (default: cauchy)")
    widths = ", ".join(f"{name} {width}" for name, (_, width) in KERNELS.items() if width)
    add("--kernel-width", type=float, help=f"in deviations; of DCS in their squares (defaults: {widths})")
    pair: dict[str, Any] = {"type": float, "nargs": 2, "metavar": ("ROT", "TRANS")}
    for name, noun in (("odometry", "the odometry"), ("walk", "the random walk"), ("first", "the first pose")):
        pair["default"] = getattr(settings, name + "_noise")
        text = "{}: deviations [rad] [m], of motions per sqrt(s) (default: {:.3g} {:.3g})"
        add(f"--{name}-noise", help=text.format(noun, *pair["default"]), **pair)
    add("--least-weight", type=float, default=0.0, help="of a sighting that is used (default: 0)")
    add("--relinearize-threshold", type=float, default=settings.relinearize_threshold, help="(default: 0.01)")
    add("--relinearize-skip", type=int, default=settings.relinearize_skip, help="frames (default: 1)")
    add("--factorization", choices=["CHOLESKY", "QR"], default=settings.factorization, help="(default: CHOLESKY)")
    add("--updates", type=int, default=settings.updates, help="of iSAM2 per frame (default: 1)")
    text = "pose of the odometry's frame on the rig, as T_body_odom of tagslam.yaml: three metres, rotation vector"
    add("--odometry-frame", default="0 0 0 0 0 0", metavar="'X Y Z A B C'", help=text + " (default: the rig)")
    text = "of the motion as sequence.toml in FOLDER states it for the filter"
    add("--sequence-noise", action="store_true", help=text)
    text = "use tag_priors.csv where it is (default: the map begins at the first rig pose)"
    add("--priors", action="store_true", help=text)
    add("--prior-noise", help="in place of that of tag_priors.csv", **(pair | {"default": None}))
    add("--reference", type=Path, help="T_map_rig (TUM): score the result")
    text = "take the poses of cameras that are not in cameras.csv from the reference (default: leave them out)"
    add("--calibrate", action="store_true", help=text)
    return vars(parser.parse_args())


def main() -> None:
    """The program."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options = arguments_of(parser)
    names = ("folder", "out", "reference", "priors", "calibrate", "odometry_frame", "sequence_noise")
    folder, out, path, priors, calibrate, frame, as_sequence = (options.pop(name) for name in names)
    if as_sequence:
        options |= sequence_noise(folder)
    if calibrate and path is None:
        parser.error("--calibrate needs --reference")
    numbers = np.array([float(number) for number in frame.split()])
    if len(numbers) != 6:
        parser.error(f"--odometry-frame has {len(numbers)} numbers, expected 6")
    options["rig_odometry"] = gtsam.Pose3(gtsam.Rot3.Expmap(numbers[3:]), numbers[:3]).matrix()
    reference = None if path is None else read_tum(path)
    cameras = read_named_poses(folder / "cameras.csv", "camera")
    if calibrate and reference is not None:
        cameras = calibrated_cameras(read_sightings(observations_path(folder)), cameras, reference)
    print_scores(run(folder, out, Settings(**options), cameras, priors))
    if reference is not None:
        print_scores(score_folder(folder, out, reference))


if __name__ == "__main__":
    main()
