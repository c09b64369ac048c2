# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Poses, alone and uncertain: SciPy and pytransform3d."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

FUSED = 128  # so many are enough for packages that take milliseconds
Array = np.ndarray[Any, Any]
Job = tuple[Callable[[], Any], Callable[[Any], Array], int]  # the work, its results as numbers, the number of items


def numbers(folder: Path, name: str, *shape: int) -> Array:
    return np.fromfile(folder / f"{name}.f64").reshape(shape)


def adjoint(pose: Array) -> Array:
    """Of a 4x4 pose, rotation first."""
    r, (x, y, z) = pose[:3, :3], pose[:3, 3]
    return np.block([[r, np.zeros((3, 3))], [np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]) @ r, r]])


def pairs(found: list[Any]) -> Array:
    """Poses and covariances, one after another."""
    return np.concatenate([np.concatenate([np.ravel(mean), np.ravel(covariance)]) for mean, covariance in found])


def scipy_jobs(folder: Path) -> dict[str, Job]:
    from scipy.spatial.transform import RigidTransform, Rotation

    xi = numbers(folder, "tangents", -1, 6)
    matrices = numbers(folder, "poses", -1, 4, 4)
    poses, back = RigidTransform.from_matrix(matrices), RigidTransform.from_matrix(matrices[::-1])
    rotations = Rotation.from_matrix(matrices[:, :3, :3])
    count = len(xi)
    return {
        "so3_exp": (lambda: Rotation.from_rotvec(xi[:, :3]), lambda found: found.as_matrix(), count),
        "so3_log": (rotations.as_rotvec, np.asarray, count),
        "se3_exp": (lambda: RigidTransform.from_exp_coords(xi), lambda found: found.as_matrix(), count),
        "se3_log": (poses.as_exp_coords, np.asarray, count),
        "se3_compose": (lambda: poses * back, lambda found: found.as_matrix(), count),
    }


def pytransform3d_jobs(folder: Path) -> dict[str, Job]:
    from pytransform3d import trajectories, transformations, uncertainty

    xi = numbers(folder, "tangents", -1, 6)
    poses = numbers(folder, "poses", -1, 4, 4)
    others = numbers(folder, "other_poses", -1, 4, 4)
    p = numbers(folder, "covariances", -1, 6, 6)
    count = len(xi)
    # Its composition states errors on the right: P of a pose T is Ad(T) P_right Ad(T)^T.
    ad = np.array([adjoint(pose) for pose in poses])
    inverse = np.linalg.inv(ad)
    right = inverse @ p @ inverse.transpose(0, 2, 1)

    def inverses() -> list[Array]:
        return [transformations.left_jacobian_SE3_inv(x) for x in xi]

    def composed() -> list[Any]:
        concatenate = uncertainty.concat_locally_uncertain_transforms
        return [concatenate(poses[-1 - i], poses[i], right[-1 - i], right[i]) for i in range(count)]

    def on_the_left(found: list[Any]) -> Array:
        return pairs([(mean, adjoint(mean) @ cov @ adjoint(mean).T) for mean, cov in found])

    def fused() -> list[Any]:
        return [uncertainty.pose_fusion([poses[i], others[i]], [p[i], p[-1 - i]])[:2] for i in range(FUSED)]

    return {
        "se3_exp": (lambda: trajectories.transforms_from_exponential_coordinates(xi), np.asarray, count),
        "se3_log": (lambda: trajectories.exponential_coordinates_from_transforms(poses), np.asarray, count),
        "se3_compose": (lambda: trajectories.concat_many_to_many(poses[::-1], poses), np.asarray, count),
        "se3_left_jacobian_inverse": (inverses, np.array, count),
        "compose_covariances": (composed, on_the_left, count),
        "fuse": (fused, pairs, FUSED),
    }
