# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Paths, and tubes of uncertainty around them."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from posemix._arrays import FloatArray, as_floats
from posemix.lie import SE3
from posemix.plot.space import position_covariance, root_of
from posemix.plot.style import (
    Axes,
    Plane,
    art3d,
    colour_of,
    is_3d,
    label_space,
    matplotlib,
    plane_indices,
)

__all__ = ["trajectory"]


def trajectory(
    ax: Axes,
    poses: SE3,
    covariances: npt.ArrayLike | None = None,
    *,
    sigmas: float = 3.0,
    plane: Plane = "xy",
    colour: str | None = None,
    label: str | None = None,
) -> tuple[Any, Any]:
    """A path of positions and a tube around it, whose width is the uncertainty across the path.

    Parameters
    ----------
    ax : Axes
        Two-dimensional axes, or axes with the projection "3d".
    poses : SE3, shape (n,)
        T_world_x over time.
    covariances : array_like, shape (n, 6, 6), optional
        Covariances of the left perturbation, rotation (rad) before translation (m).
    sigmas : float
        Half width of the tube in standard deviations.
    plane : str
        Plane of two-dimensional axes.
    colour, label : str, optional
        Colour and label of path and tube.

    Returns
    -------
    line : Line2D or Line3D
    tube : Polygon or Poly3DCollection or None
        None without covariances, or for fewer than two poses.
    """
    path = poses.translation
    flat = [0, 1, 2] if is_3d(ax) else plane_indices(plane)
    shade = colour or colour_of(0)
    (line,) = ax.plot(*path[:, flat].T, color=shade, label=label)
    tube = None
    if covariances is not None and len(poses) > 1:
        matrices = as_floats(covariances, (6, 6), "covariances")
        if len(matrices) != len(poses):
            raise ValueError(f"covariances are {len(matrices)}; expected {len(poses)}")
        spread = position_covariance(poses, matrices)
        spread = spread[:, flat][:, :, flat]
        style = {"alpha": 0.2, "linewidth": 0.0}
        if is_3d(ax):
            rings = _rings(path, spread, sigmas)
            faces = np.stack([rings[:-1, :-1], rings[1:, :-1], rings[1:, 1:], rings[:-1, 1:]], axis=2)
            tube = art3d().Poly3DCollection(faces.reshape((-1, 4, 3)), facecolors=shade, **style)
            ax.add_collection3d(tube, autolim=False)
            ax.auto_scale_xyz(*rings.reshape((-1, 3)).T)
        else:
            left, right = _banks(path[:, flat], spread, sigmas)
            outline = np.vstack([left, right[::-1]])
            tube = matplotlib("patches").Polygon(outline, facecolor=shade, **style)
            ax.add_patch(tube)
            ax.autoscale_view()
    label_space(ax, plane)
    return line, tube


def _directions(path: FloatArray) -> FloatArray:
    """Unit tangents of a path; the previous one where the path does not move."""
    steps = np.gradient(path, axis=0)
    lengths = np.linalg.norm(steps, axis=1)
    moving = np.flatnonzero(lengths > 1e-12)
    if len(moving) == 0:
        return np.tile(np.eye(path.shape[1])[0], (len(path), 1))
    last = np.maximum.accumulate(np.where(lengths > 1e-12, np.arange(len(path)), -1))
    index = np.where(last < 0, moving[0], last)
    return np.asarray(steps[index] / lengths[index, None])


def _banks(path: FloatArray, spread: FloatArray, sigmas: float) -> tuple[FloatArray, FloatArray]:
    along = _directions(path)
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    width = sigmas * np.sqrt(np.einsum("ni,nij,nj->n", across, spread, across))
    return path + width[:, None] * across, path - width[:, None] * across


def _carried(along: FloatArray) -> FloatArray:
    """Unit vectors across the path without rotation about it, shape (n, 3)."""
    across = np.empty_like(along)
    last = np.eye(3)[np.argmin(np.abs(along[0]))]
    for i, direction in enumerate(along):
        last = last - (last @ direction) * direction
        if np.linalg.norm(last) < 1e-6:  # a quarter turn from one pose to the next
            last = np.cross(direction, np.eye(3)[np.argmin(np.abs(direction))])
        last = last / np.linalg.norm(last)
        across[i] = last
    return across


def _rings(path: FloatArray, spread: FloatArray, sigmas: float, sectors: int = 16) -> FloatArray:
    """Outlines of the spread in the planes across the path, shape (n, sectors + 1, 3)."""
    along = _directions(path)
    first = _carried(along)
    plane = np.stack([first, np.cross(along, first)], axis=2)
    roots = root_of(np.swapaxes(plane, 1, 2) @ spread @ plane)
    angles = np.linspace(0.0, 2.0 * np.pi, sectors + 1)
    circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    flat = sigmas * np.einsum("nij,kj->nki", roots, circle)
    return np.asarray(path[:, None] + np.einsum("nij,nkj->nki", plane, flat))
