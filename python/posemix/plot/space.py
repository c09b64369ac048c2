# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Poses and positions in space."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from posemix._arrays import FloatArray, as_floats
from posemix.density import ConcentratedGaussian, ProjectedGaussian
from posemix.interop.conventions import skew
from posemix.lie import SE3
from posemix.mixture import Mixture
from posemix.plot.style import (
    Axes,
    Plane,
    art3d,
    colour_of,
    filled,
    is_3d,
    label_space,
    matplotlib,
    plane_indices,
    quads,
)

__all__ = ["ellipsoid", "flags", "position_contours", "position_covariance", "position_ellipsoids"]

PoseDistribution: TypeAlias = ConcentratedGaussian[SE3] | ProjectedGaussian[SE3] | Mixture[Any]


def position_covariance(
    mean: SE3, covariance: npt.ArrayLike, point: npt.ArrayLike = (0.0, 0.0, 0.0)
) -> FloatArray:
    """Covariances of the position of a point of the body, to first order, shape (..., 3, 3) [m^2].

    Parameters
    ----------
    mean : SE3, shape (...)
        Poses T_a_b.
    covariance : array_like, shape (..., 6, 6)
        Covariances of the left perturbation, rotation (rad) before translation (m).
    point : array_like, shape (3,)
        The point in frame b [m].
    """
    at = mean.act(as_floats(point, (3,), "point"))
    jacobian = np.concatenate([-skew(at), np.broadcast_to(np.eye(3), (*at.shape, 3))], axis=-1)
    matrix = as_floats(covariance, (6, 6), "covariance")
    return np.asarray(jacobian @ matrix @ np.swapaxes(jacobian, -1, -2))


def position_ellipsoids(
    means: SE3, covariances: npt.ArrayLike, sigmas: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Centres [m], half axes [m] and quaternions x, y, z, w of the ellipsoids of positions, to first order.

    Parameters
    ----------
    means : SE3, shape (...)
        Poses T_a_b.
    covariances : array_like, shape (..., 6, 6)
        Covariances of the left perturbation, rotation (rad) before translation (m).
    sigmas : float
        Half axes in standard deviations.

    Returns
    -------
    centres, half_axes : ndarray, shape (..., 3)
    quaternions : ndarray, shape (..., 4)
    """
    values, vectors = np.linalg.eigh(position_covariance(means, covariances))
    turned = vectors * np.where(np.linalg.det(vectors) < 0.0, -1.0, 1.0)[..., None, None]
    homogeneous = np.zeros((*means.shape, 4, 4))
    homogeneous[..., :3, :3] = turned
    homogeneous[..., 3, 3] = 1.0
    quaternions = SE3.from_matrix(homogeneous).rotation.quaternion
    return means.translation, sigmas * np.sqrt(np.maximum(values, 0.0)), quaternions


def root_of(covariance: FloatArray) -> FloatArray:
    """The symmetric A with A A = covariance, which may be singular."""
    values, vectors = np.linalg.eigh(covariance)
    scaled = vectors * np.sqrt(np.maximum(values, 0.0))[..., None, :]
    return np.asarray(scaled @ np.swapaxes(vectors, -1, -2))


def _many(poses: SE3) -> SE3:
    return poses if poses.shape else SE3.from_tq(poses.to_tq()[None])


def flags(
    ax: Axes,
    poses: SE3,
    *,
    length: float = 0.03,
    plane: Plane = "xy",
    colour: str | None = None,
    label: str | None = None,
) -> tuple[Any, Any]:
    """Poses as flags: the foot is the position, the pole the z axis, the pennant points along x.

    Parameters
    ----------
    ax : Axes
        Two-dimensional axes, or axes with the projection "3d".
    poses : SE3, shape (n,) or ()
        Poses to draw.
    length : float
        Length of a pole [m].
    plane : str
        Plane of two-dimensional axes.
    colour, label : str, optional
        Colour and label of all flags.

    Returns
    -------
    poles, pennants : LineCollection, PolyCollection (or Line3DCollection, Poly3DCollection)

    References
    ----------
    MPG paper, section VI.
    """
    if not length > 0.0:
        raise ValueError(f"length is {length}; expected a positive number")
    many = _many(poses)
    foot, turn = many.translation, many.rotation.matrix()
    x, z = length * turn[..., 0], length * turn[..., 2]
    poles = np.stack([foot, foot + z], axis=1)
    pennants = np.stack([foot + z, foot + 0.6 * z, foot + 0.8 * z + 0.6 * x], axis=1)
    shade = colour or colour_of(0)
    line = {"colors": shade, "linewidths": 1.0, "alpha": 0.5}
    face = {"facecolors": shade, "alpha": 0.35, "label": label}
    if is_3d(ax):
        first = art3d().Line3DCollection(poles, **line)
        second = art3d().Poly3DCollection(pennants, **face)
        ax.add_collection3d(first, autolim=False)
        ax.add_collection3d(second, autolim=False)
        if len(many):
            corners = np.concatenate([poles, pennants], axis=1).reshape((-1, 3))
            ax.auto_scale_xyz(*corners.T)
    else:
        flat = plane_indices(plane)
        first = matplotlib("collections").LineCollection(poles[..., flat], **line)
        second = matplotlib("collections").PolyCollection(pennants[..., flat], **face)
        ax.add_collection(first)
        ax.add_collection(second)
        ax.autoscale_view()
    label_space(ax, plane)
    return first, second


def ellipsoid(
    ax: Axes,
    density: ConcentratedGaussian[SE3],
    *,
    sigmas: float = 3.0,
    plane: Plane = "xy",
    colour: str | None = None,
    label: str | None = None,
    alpha: float = 0.25,
) -> Any:
    """The ellipsoid of a position, to first order in the error of the pose.

    Parameters
    ----------
    ax : Axes
        Two-dimensional axes, or axes with the projection "3d".
    density : ConcentratedGaussian
        Density of one pose.
    sigmas : float
        Half axes in standard deviations.
    plane : str
        Plane of two-dimensional axes, in which the projection of the ellipsoid is drawn.
    colour, label, alpha
        Properties of the artist.

    Returns
    -------
    Polygon, or Poly3DCollection
    """
    centre = density.mean.translation
    covariance = position_covariance(density.mean, density.covariance)
    shade = colour or colour_of(0)
    if is_3d(ax):
        surface = _sphere() @ (sigmas * root_of(covariance)).T + centre
        artist = filled(ax, surface, shade, alpha=alpha, label=label)
    else:
        flat = plane_indices(plane)
        root = root_of(covariance[np.ix_(flat, flat)])
        angles = np.linspace(0.0, 2.0 * np.pi, 73)
        circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        outline = sigmas * circle @ root.T + centre[flat]
        artist = filled(ax, outline, shade, edgecolor=shade, alpha=alpha, label=label)
    label_space(ax, plane)
    return artist


def _sphere(rings: int = 12, sectors: int = 24) -> FloatArray:
    """Faces of the unit sphere, shape (n, 4, 3)."""
    down = np.linspace(0.0, np.pi, rings + 1)[:, None]
    around = np.linspace(0.0, 2.0 * np.pi, sectors + 1)[None, :]
    grid = np.stack(
        [
            np.sin(down) * np.cos(around),
            np.sin(down) * np.sin(around),
            np.cos(down) + 0.0 * around,
        ],
        axis=-1,
    )
    return quads(grid)


def position_contours(
    ax: Axes,
    distribution: PoseDistribution,
    *,
    point: npt.ArrayLike = (0.0, 0.0, 0.0),
    plane: Plane = "xy",
    levels: Sequence[float] = (0.5, 0.9, 0.99),
    samples: int = 50_000,
    bins: int = 160,
    seed: int = 0,
    colour: str | None = None,
) -> Any:
    """Contours of the density of a position, banana-shaped for an uncertain rotation, by sampling.

    The contours enclose the regions of highest density of a smoothed histogram that contain the probabilities `levels`.

    Parameters
    ----------
    ax : Axes
        Two-dimensional axes.
    distribution : ConcentratedGaussian, ProjectedGaussian or Mixture
        Distribution of one pose.
    point : array_like, shape (3,)
        The point of the body, in its frame [m].
    plane : str
        The two coordinates.
    levels : sequence of float
        Probabilities between 0 and 1.
    samples, bins, seed : int
        Number of draws, cells along a side, seed of the draws.
    colour : str, optional
        Colour of the lines.

    Returns
    -------
    QuadContourSet
        The contours; their levels are densities [1/m^2], in order of falling probabilities.
    """
    wanted = sorted(levels, reverse=True)
    if not wanted or not all(0.0 < level < 1.0 for level in wanted):
        raise ValueError(f"levels are {tuple(levels)}; expected numbers between 0 and 1")
    flat = plane_indices(plane)
    positions = distribution.sample(samples, seed).act(as_floats(point, (3,), "point"))[:, flat]
    low, high = positions.min(axis=0), positions.max(axis=0)
    margin = np.maximum(0.1 * (high - low), 1e-9)
    sides = [np.linspace(low[i] - margin[i], high[i] + margin[i], bins + 1) for i in range(2)]
    counts, *_ = np.histogram2d(positions[:, 0], positions[:, 1], bins=sides)
    density = _smoothed(counts)
    cell = (sides[0][1] - sides[0][0]) * (sides[1][1] - sides[1][0])
    density /= density.sum() * cell
    # Heights from the draws themselves, so that the regions have their probabilities for any width of the cells.
    cells = [np.searchsorted(sides[i], positions[:, i]) - 1 for i in range(2)]
    heights = np.quantile(density[cells[0], cells[1]], [1.0 - level for level in wanted])
    x, y = (0.5 * (side[1:] + side[:-1]) for side in sides)
    shade = colour or colour_of(0)
    artist = ax.contour(x, y, density.T, levels=np.unique(heights), colors=shade)
    label_space(ax, plane)
    return artist


def _smoothed(counts: FloatArray) -> FloatArray:
    """Counts smoothed by a Gaussian with a standard deviation of one and a half cells."""
    steps = np.arange(-5, 6)
    kernel = np.exp(-0.5 * (steps / 1.5) ** 2)
    kernel /= kernel.sum()
    rows = np.apply_along_axis(np.convolve, 0, counts, kernel, mode="same")
    return np.apply_along_axis(np.convolve, 1, rows, kernel, mode="same")
