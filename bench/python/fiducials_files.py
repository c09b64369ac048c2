# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Poses as arrays, and the files of `posemix fiducials` and of results, for the studies of fiducial SLAM."""

from __future__ import annotations

import csv
import gzip
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import numpy as np

Array = np.ndarray[Any, Any]

POSE_COLUMNS = ["tx_m", "ty_m", "tz_m", "qx", "qy", "qz", "qw"]
UPPER = np.triu_indices(6)
COVARIANCE_COLUMNS = [f"c{i}{j}" for i, j in zip(*UPPER, strict=True)]


# Poses are arrays (..., 4, 4).


def to_poses(numbers: Array) -> Array:
    """Poses (N, 4, 4) of rows tx ty tz qx qy qz qw (N, 7); quaternions are normalised."""
    numbers = np.atleast_2d(np.asarray(numbers, dtype=float))
    x, y, z, w = (numbers[:, 3:] / np.linalg.norm(numbers[:, 3:], axis=1, keepdims=True)).T
    poses = np.tile(np.eye(4), (len(numbers), 1, 1))
    poses[:, 0, :3] = np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], 1)
    poses[:, 1, :3] = np.stack([2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)], 1)
    poses[:, 2, :3] = np.stack([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], 1)
    poses[:, :3, 3] = numbers[:, :3]
    return poses


def pose_numbers(pose: Array) -> list[str]:
    """tx ty tz qx qy qz qw of a pose (4, 4), in twelve digits; qw is not negative."""
    r = pose[:3, :3]
    k = np.diag([0.0, 0, 0, np.trace(r)])
    k[:3, :3] = r + r.T - np.trace(r) * np.eye(3)
    k[:3, 3] = k[3, :3] = r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]
    q = np.linalg.eigh(k)[1][:, 3]  # Bar-Itzhack, 2000
    return [f"{x:.12g}" for x in (*pose[:3, 3], *(q if q[3] >= 0 else -q))]


def inverse(poses: Array) -> Array:
    """The inverses of poses (..., 4, 4)."""
    result = np.zeros_like(poses)
    result[..., :3, :3] = np.swapaxes(poses[..., :3, :3], -1, -2)
    result[..., :3, 3] = -np.einsum("...ij,...j->...i", result[..., :3, :3], poses[..., :3, 3])
    result[..., 3, 3] = 1
    return result


def angles_deg(a: Array, b: Array) -> Array:
    """Angles between rotations of poses (..., 4, 4) [deg]."""
    chord = np.linalg.norm(a[..., :3, :3] - b[..., :3, :3], axis=(-2, -1)) / np.sqrt(8)
    return np.asarray(np.degrees(2 * np.arcsin(np.minimum(chord, 1))))


def mean_rotation(rotations: Array) -> Array:
    """The rotation matrix nearest to the median of matrices (N, 3, 3), element by element."""
    u, _, v = np.linalg.svd(np.median(rotations, axis=0))
    return np.asarray(u @ np.diag([1, 1, np.linalg.det(u @ v)]) @ v)


# Files.


def open_text(path: Path) -> IO[str]:
    """A text file, compressed by gzip or not."""
    return gzip.open(path, "rt") if path.suffix == ".gz" else open(path)


@dataclass
class Trajectory:
    """Poses (N, 4, 4) at ascending stamps (N,) [s]."""

    stamps: Array
    poses: Array

    def at(self, stamps: Array, longest_gap_s: float = 0.2) -> tuple[Array, Array]:
        """Interpolated poses (M, 4, 4) at other stamps, and which of them are valid (M,).

        Translations are linear, rotations at a constant rate. Valid are stamps of the trajectory, to a microsecond, and
        those between two stamps that are at most `longest_gap_s` apart.
        """
        after = np.clip(np.searchsorted(self.stamps, stamps), 1, len(self.stamps) - 1)
        gap = self.stamps[after] - self.stamps[after - 1]
        part = (stamps - self.stamps[after - 1]) / gap
        on_stamp = np.minimum(abs(part), abs(1 - part)) * gap < 1e-6
        inside = (part >= 0) & (part <= 1) & (gap <= longest_gap_s)
        part = np.clip(part, 0, 1)
        a, b = self.poses[after - 1], self.poses[after]
        poses = a.copy()
        poses[:, :3, 3] += part[:, None] * (b - a)[:, :3, 3]
        for i in np.flatnonzero(part > 0):
            poses[i, :3, :3] = a[i, :3, :3] @ turned_by_part(a[i, :3, :3].T @ b[i, :3, :3], part[i])
        return poses, on_stamp | inside


def turned_by_part(rotation: Array, part: float) -> Array:
    """The rotation (3, 3) about the same axis by a part of the angle."""
    axis = np.array([rotation[2, 1] - rotation[1, 2], rotation[0, 2] - rotation[2, 0], rotation[1, 0] - rotation[0, 1]])
    length = np.linalg.norm(axis)
    if length < 1e-12:
        return np.eye(3)
    x, y, z = axis / length
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = part * np.arctan2(length, np.trace(rotation) - 1)
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)


def read_tum(path: Path) -> Trajectory:
    """Reads lines "stamp tx ty tz qx qy qz qw"; lines that begin with # are skipped."""
    with open_text(path) as file:
        rows = np.loadtxt(file, ndmin=2)
    rows = rows[np.unique(rows[:, 0], return_index=True)[1]]
    return Trajectory(rows[:, 0], to_poses(rows[:, 1:8]))


@dataclass
class Sightings:
    """Rows of a table with poses T_camera_tag: of observations (several rows per sighting), or of a result."""

    stamps: Array
    cameras: Array
    ids: Array
    poses: Array
    sighting: Array
    weights: Array
    covariances: Array

    def rows(self, choice: Array) -> Sightings:
        """Some of the rows."""
        return Sightings(**{name: column[choice] for name, column in vars(self).items()})

    def best(self) -> Sightings:
        """The row of the largest weight of every sighting, in the order of stamps."""
        order = np.lexsort([-self.weights, self.sighting])
        first = order[np.unique(self.sighting[order], return_index=True)[1]]
        return self.rows(first[np.argsort(self.stamps[first], kind="stable")])


def read_sightings(path: Path) -> Sightings:
    """Reads observations.csv[.gz] or sightings.csv; columns that are not there are one row per sighting and NaN."""
    with open_text(path) as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))

    def numbers(names: list[str], default: float = np.nan) -> Array:
        there = bool(rows) and all(rows[0].get(name) for name in names)
        filled = [[float(row[name] or "nan") for name in names] for row in rows] if there else default
        return np.broadcast_to(np.array(filled), (len(rows), len(names)))

    covariances = np.zeros((len(rows), 6, 6))
    covariances[:, UPPER[0], UPPER[1]] = covariances[:, UPPER[1], UPPER[0]] = numbers(COVARIANCE_COLUMNS)
    has_sighting = bool(rows) and "sighting" in rows[0]
    return Sightings(
        stamps=numbers(["stamp_s"])[:, 0],
        cameras=np.array([row.get("camera", "") for row in rows]),
        ids=np.array([row["id"] for row in rows]),
        poses=to_poses(numbers(POSE_COLUMNS)),
        sighting=numbers(["sighting"])[:, 0].astype(int) if has_sighting else np.arange(len(rows)),
        weights=numbers(["weight"], 1.0)[:, 0],
        covariances=covariances,
    )


def read_named_poses(path: Path, name: str) -> dict[str, Array]:
    """Poses by the column `name`, as of cameras.csv ("camera": T_rig_camera) and tags.csv ("id")."""
    with open_text(path) as file:
        return {row[name]: to_poses(np.array([float(row[c]) for c in POSE_COLUMNS]))[0] for row in csv.DictReader(file)}


def write_tum(path: Path, trajectory: Trajectory) -> None:
    """Lines "stamp tx ty tz qx qy qz qw"."""
    lines = zip(trajectory.stamps, trajectory.poses, strict=True)
    path.write_text("".join(f"{stamp:.9f} {' '.join(pose_numbers(pose))}\n" for stamp, pose in lines))


def write_named_poses(path: Path, name: str, poses: dict[str, Array]) -> None:
    """The inverse of `read_named_poses`."""
    rows = [",".join([key, *pose_numbers(pose)]) + "\n" for key, pose in poses.items()]
    path.write_text("".join([",".join([name, *POSE_COLUMNS]) + "\n", *rows]))


def observations_path(folder: Path) -> Path:
    """The observations in a folder of `posemix fiducials`."""
    plain = folder / "observations.csv"
    return plain if plain.exists() else folder / "observations.csv.gz"


def read_priors(path: Path) -> dict[str, tuple[Array, Array]]:
    """tag_priors.csv: per id T_map_tag (4, 4) and the covariance (6, 6) of n in T_map_tag Exp(n), rotation first."""
    table = read_sightings(path)
    return {str(name): (table.poses[i], table.covariances[i]) for i, name in enumerate(table.ids)}
