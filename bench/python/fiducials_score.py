#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Scores of fiducial SLAM: the rig's path and the modes of the tags against a reference path.

The result is any folder with

- camera.tum: T_world_rig, one line "stamp tx ty tz qx qy qz qw" per stamp;
- sightings.csv: stamp_s,camera,id,tx_m,ty_m,tz_m,qx,qy,qz,qw, T_camera_tag of every tag that was seen in a frame, as
  the estimate stood after that frame. A sighting of a tag without an estimate has no row;
- tags.csv, if there is one: id,tx_m,ty_m,tz_m,qx,qy,qz,qw, T_world_tag at the end;
- cameras.csv, if there is one: camera,tx_m,...,qw, T_rig_camera that were used in place of those of FOLDER.

FOLDER is what `posemix fiducials` wrote and what the result was estimated from. The reference is a path T_map_rig, as
of TagSLAM; no frame of the result needs to be that of the reference.

example: bench/python/fiducials_score.py out/tags out/isam2 --reference reference_rig.tum.gz
"""

from __future__ import annotations

import argparse
from collections import defaultdict
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from fiducials_files import (
    Array,
    Sightings,
    Trajectory,
    angles_deg,
    inverse,
    mean_rotation,
    observations_path,
    read_named_poses,
    read_sightings,
    read_tum,
)


@dataclass
class PathScore:
    """Distances of positions to the reference after alignment [m], and T_reference_estimate (4, 4)."""

    rms_m: float
    max_m: float
    stamps: int
    alignment: Array


def align(points: Array, reference: Array) -> Array:
    """The rigid motion (4, 4), without scale, that takes points (N, 3) nearest to the reference (Umeyama, 1991)."""
    mean, target = points.mean(axis=0), reference.mean(axis=0)
    u, _, v = np.linalg.svd((reference - target).T @ (points - mean))
    pose = np.eye(4)
    pose[:3, :3] = u @ np.diag([1, 1, np.linalg.det(u @ v)]) @ v
    pose[:3, 3] = target - pose[:3, :3] @ mean
    return pose


def score_path(
    path: Trajectory, reference: Trajectory, stamps: Array | None = None, longest_gap_s: float = 0.2
) -> PathScore:
    """Positions of a path against those of the reference, after a rigid alignment of all of them.

    `stamps` restricts the comparison, so that two paths are scored at the same times (default: those of the path). The
    reference, and with `stamps` the path, is interpolated; stamps in their gaps are left out.
    """
    stamps = path.stamps if stamps is None else stamps
    (own, valid), (truth, known) = path.at(stamps, longest_gap_s), reference.at(stamps, longest_gap_s)
    own, truth = own[valid & known], truth[valid & known]
    if len(own) < 3:
        raise ValueError(f"{len(own)} stamps with path and reference, expected at least 3")
    pose = align(own[:, :3, 3], truth[:, :3, 3])
    distances = np.linalg.norm(own[:, :3, 3] @ pose[:3, :3].T + pose[:3, 3] - truth[:, :3, 3], axis=1)
    return PathScore(float(np.sqrt(np.mean(distances**2))), float(distances.max()), len(own), pose)


@dataclass
class ReferenceTag:
    """T_map_tag (4, 4) of one tag, and the share of its sightings with a component near it, and near a rival pose."""

    pose: Array
    sightings: int
    share: float
    rival_share: float


def most_supported(
    poses: Array, sighting: Array, near_deg: float = 15, near_m: float = 0.5, candidates: int = 400
) -> ReferenceTag:
    """The pose that most sightings have a component near; `poses` (N, 4, 4) are the components of `sighting` (N,).

    Weights do not count. A component counts by exp(-(angle / 5 deg)^2 / 2), so that of two poses with as many
    components the one that stays at its place as the camera moves wins, as the true one does. Up to `candidates`
    components are tried, and the best is refined by the median of the components near it. `rival_share` is that of the
    best pose more than twice `near_deg` away; where it is as large as `share`, the choice depends on the spread alone.
    """
    sighting = np.unique(sighting, return_inverse=True)[1]

    def support(pose: Array) -> tuple[float, Array]:
        angle = angles_deg(poses, pose)
        near = (angle < near_deg) & (np.linalg.norm(poses[:, :3, 3] - pose[:3, 3], axis=1) < near_m)
        votes = np.zeros(sighting.max() + 1)
        np.maximum.at(votes, sighting, near * np.exp(-0.5 * (angle / 5) ** 2))
        return votes.sum(), near

    def share(pose: Array) -> float:
        return len(np.unique(sighting[support(pose)[1]])) / (int(sighting.max()) + 1)

    tried = poses[np.unique(np.linspace(0, len(poses) - 1, candidates).astype(int))]
    votes = np.array([support(pose)[0] for pose in tried])
    pose = tried[np.argmax(votes)].copy()
    for _ in range(5):
        near = support(pose)[1]
        pose[:3, :3], pose[:3, 3] = mean_rotation(poses[near, :3, :3]), np.median(poses[near, :3, 3], axis=0)
    far = angles_deg(tried, pose) > 2 * near_deg
    rival = share(tried[far][np.argmax(votes[far])]) if far.any() else 0.0
    return ReferenceTag(pose, int(sighting.max()) + 1, share(pose), rival)


def reference_tags(
    observations: Sightings, cameras: dict[str, Array], reference: Trajectory
) -> dict[str, ReferenceTag]:
    """The poses of the tags: of all components of all sightings, put into the map by the reference path."""
    truth, valid = reference.at(observations.stamps)
    known = valid & np.isin(observations.cameras, list(cameras))
    mounting = np.array([cameras.get(name, np.eye(4)) for name in observations.cameras])
    in_map, tags = truth @ mounting @ observations.poses, {}
    for name in np.unique(observations.ids[known]):
        chosen = known & (observations.ids == name)
        tags[str(name)] = most_supported(in_map[chosen], observations.sighting[chosen])
    return tags


def calibrated_cameras(observations: Sightings, cameras: dict[str, Array], reference: Trajectory) -> dict[str, Array]:
    """T_rig_camera of all cameras: those given, and for others the pose that most sightings of reference tags have.

    The tags' poses are those of the cameras that are given, so that the cameras need to see the same tags.
    """
    tags = reference_tags(observations, cameras, reference)
    truth, valid = reference.at(observations.stamps)
    result = dict(cameras)
    for name in sorted(set(map(str, observations.cameras)) - set(cameras)):
        chosen = valid & (observations.cameras == name) & np.isin(observations.ids, list(tags))
        seen = np.array([tags[tag].pose for tag in observations.ids[chosen]])
        poses = inverse(truth[chosen]) @ seen @ inverse(observations.poses[chosen])
        result[name] = most_supported(poses, observations.sighting[chosen]).pose
    return result


@dataclass
class ModeScore:
    """Sightings whose rotation is wrong: of all, of frames with at least one, per tag (all, wrong), each tag's last."""

    sightings: int
    wrong: int
    frames: int
    wrong_frames: int
    by_tag: dict[str, tuple[int, int]]
    wrong_at_last: list[str]

    @property
    def share(self) -> float:
        """Part of the sightings that are wrong."""
        return self.wrong / max(self.sightings, 1)

    @property
    def frame_share(self) -> float:
        """Part of the frames with a wrong sighting."""
        return self.wrong_frames / max(self.frames, 1)


def wrong_modes(
    sightings: Sightings,
    cameras: dict[str, Array],
    tags: dict[str, ReferenceTag],
    reference: Trajectory,
    limit_deg: float = 15,
) -> ModeScore:
    """Sightings with a wrong leading mode: T_camera_tag is turned by more than `limit_deg` against the reference's.

    The reference is that of the rig at the stamp, the mounting of the camera and the reference pose of the tag. One row
    is one sighting: of an estimate, or of the detector itself with `observations.best()`. Sightings of tags without a
    reference, and at stamps without one, are left out.
    """
    truth, valid = reference.at(sightings.stamps)
    chosen = valid & np.isin(sightings.ids, list(tags)) & np.isin(sightings.cameras, list(cameras))
    rows, truth = sightings.rows(chosen), truth[chosen]
    if len(rows.ids) == 0:
        return ModeScore(0, 0, 0, 0, {}, [])
    mounting = np.array([cameras[name] for name in rows.cameras])
    expected = inverse(truth @ mounting) @ np.array([tags[name].pose for name in rows.ids])
    wrong = angles_deg(rows.poses, expected) > limit_deg
    counts: defaultdict[str, list[int]] = defaultdict(lambda: [0, 0])
    last = {str(rows.ids[i]): bool(wrong[i]) for i in np.argsort(rows.stamps, kind="stable")}
    for name, is_wrong in zip(rows.ids, wrong, strict=True):
        counts[str(name)][0] += 1
        counts[str(name)][1] += int(is_wrong)
    return ModeScore(
        len(wrong),
        int(wrong.sum()),
        len(np.unique(rows.stamps)),
        len(np.unique(rows.stamps[wrong])),
        {name: (n, bad) for name, (n, bad) in counts.items()},
        [name for name, is_wrong in last.items() if is_wrong],
    )


def wrong_tags(
    poses: dict[str, Array], alignment: Array, tags: dict[str, ReferenceTag], limit_deg: float = 15
) -> list[str]:
    """Tags whose T_world_tag, put into the map by `alignment`, is turned by more than `limit_deg` to the reference.

    This needs a map that is right as a whole; `ModeScore.wrong_at_last` does not.
    """
    shared = [name for name in poses if name in tags]
    return [name for name in shared if angles_deg(alignment @ poses[name], tags[name].pose) > limit_deg]


def score_folder(folder: Path, result: Path, reference: Trajectory) -> dict[str, float]:
    """All scores of a result, of the detector itself and, where the folder has one, of the odometry alone.

    Raises ValueError where path and reference have fewer than three stamps in common.
    """
    observations = read_sightings(observations_path(folder))
    own_cameras = (result / "cameras.csv").exists()
    cameras = read_named_poses((result if own_cameras else folder) / "cameras.csv", "camera")
    tags = reference_tags(observations, cameras, reference)
    path = read_tum(result / "camera.tum")
    own = score_path(path, reference)
    modes = wrong_modes(read_sightings(result / "sightings.csv"), cameras, tags, reference)
    detector = wrong_modes(observations.best(), cameras, tags, reference)
    scores: dict[str, float] = {"rms_m": own.rms_m, "max_m": own.max_m, "stamps": own.stamps}
    if (folder / "odometry.tum").exists():
        odometry = score_path(read_tum(folder / "odometry.tum"), reference, path.stamps)
        scores |= {"odometry_rms_m": odometry.rms_m, "odometry_max_m": odometry.max_m}
    for name, mode in (("", modes), ("detector_", detector)):
        scores |= {name + "sightings": mode.sightings, name + "wrong_share": mode.share}
        scores |= {name + "frames": mode.frames, name + "wrong_frame_share": mode.frame_share}
        scores[name + "wrong_at_last_sighting"] = len(mode.wrong_at_last)
    scores["reference_tags"] = len(tags)
    if (result / "tags.csv").exists():
        scores["wrong_tags"] = len(wrong_tags(read_named_poses(result / "tags.csv", "id"), own.alignment, tags))
    return scores


def print_scores(scores: dict[str, float]) -> None:
    """One line per score."""
    for name, value in scores.items():
        print(f"  {name + ':':28}{value:.5g}")


def main() -> None:
    """The program."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="what `posemix fiducials` wrote")
    parser.add_argument("result", type=Path, metavar="RESULT", help="folder with camera.tum and sightings.csv")
    parser.add_argument("--reference", type=Path, required=True, help="T_map_rig (TUM), compressed or not")
    arguments = parser.parse_args()
    print_scores(score_folder(arguments.folder, arguments.result, read_tum(arguments.reference)))


if __name__ == "__main__":
    main()
