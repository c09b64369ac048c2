# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Logs poses, densities, mixtures and paths to Rerun."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from posemix._arrays import as_floats
from posemix._peers import peer
from posemix.density import ConcentratedGaussian
from posemix.lie import SE3
from posemix.mixture import Mixture
from posemix.plot.space import position_ellipsoids
from posemix.plot.style import AXIS_COLOURS, PALETTE

__all__ = [
    "log_ellipsoid", "log_hypotheses", "log_pose", "log_scalars", "log_trajectory", "log_tracking", "set_time",
]  # fmt: skip

TIMELINE = "time"


def viewer() -> Any:
    """The package rerun."""
    return peer("rerun", "posemix.rerun", "posemix[rerun]")


def rgba(colour: str, alpha: float) -> list[int]:
    """A colour such as "#0072B2" and an opacity from 0 to 1, as bytes."""
    red, green, blue = (int(colour[i : i + 2], 16) for i in (1, 3, 5))
    return [red, green, blue, round(255 * min(max(alpha, 0.0), 1.0))]


def set_time(seconds: float, *, recording: Any = None) -> None:
    """Sets the time at which the next calls log, on the timeline "time" [s]."""
    viewer().set_time(TIMELINE, duration=float(seconds), recording=recording)


def log_pose(path: str, pose: SE3, *, axis_length: float = 0.1, recording: Any = None) -> None:
    """Logs a pose as the transform of an entity, with its axes.

    Parameters
    ----------
    path : str
        Entity; its children are in the frame of the pose.
    pose : SE3
        T_parent_entity.
    axis_length : float
        Length of the axes [m]; 0: none.
    recording : RecordingStream, optional
        Rerun's recording stream; by default the current one.
    """
    rr = viewer()
    tq = pose.to_tq()
    transform = rr.Transform3D(translation=tq[:3], quaternion=tq[3:])
    axes = [rr.TransformAxes3D(axis_length)] if axis_length > 0 else []
    rr.log(path, transform, *axes, recording=recording)


def log_ellipsoid(
    path: str,
    density: ConcentratedGaussian[SE3],
    *,
    sigmas: float = 3.0,
    colour: str = PALETTE[0],
    recording: Any = None,
) -> None:
    """Logs the ellipsoid of a position, to first order in the error of the pose.

    Parameters
    ----------
    path : str
        Entity below that of the density's reference frame.
    density : ConcentratedGaussian
        Density of one pose T_world_x.
    sigmas : float
        Half axes in standard deviations.
    colour : str
        Colour, such as "#0072B2".
    recording : RecordingStream, optional
        Rerun's recording stream; by default the current one.
    """
    rr = viewer()
    centre, sizes, quaternion = position_ellipsoids(density.mean, density.covariance, sigmas)
    ellipsoid = rr.Ellipsoids3D(
        centers=[centre], half_sizes=[sizes], quaternions=[quaternion], colors=[rgba(colour, 0.6)]
    )
    rr.log(path, ellipsoid, recording=recording)


def log_hypotheses(
    path: str,
    mixture: Mixture[ConcentratedGaussian[SE3]],
    *,
    axis_length: float = 0.1,
    sigmas: float = 3.0,
    colour: str = PALETTE[0],
    name: str = "",
    recording: Any = None,
) -> None:
    """Logs the components of a mixture as axes and ellipsoids, whose opacity grows with the weight.

    Axes are logged to PATH/axes: three arrows x, y, z per component, the first one labelled with the weight, in order
    of falling weights. Ellipsoids are logged to PATH/ellipsoids.

    Parameters
    ----------
    path : str
        Entity below that of the poses' reference frame.
    mixture : Mixture
        Mixture of one pose T_world_x.
    axis_length : float
        Length of the arrows [m].
    sigmas : float
        Half axes of the ellipsoids in standard deviations.
    colour : str
        Colour of the ellipsoids, such as "#0072B2".
    name : str
        Name in front of the weight of the heaviest component.
    recording : RecordingStream, optional
        Rerun's recording stream; by default the current one.
    """
    rr = viewer()
    order = np.argsort(-mixture.log_weights, kind="stable")
    weights = mixture.weights[order]
    means: SE3 = mixture.means[order]
    vectors = axis_length * np.swapaxes(means.rotation.matrix(), -1, -2).reshape((-1, 3))
    labels = [text for weight in weights for text in (f"{weight:.3f}", "", "")]
    labels[0] = f"{name} {labels[0]}".lstrip()
    arrows = rr.Arrows3D(
        vectors=vectors,
        origins=np.repeat(means.translation, 3, axis=0),
        colors=[rgba(axis, 0.15 + 0.85 * w) for w in weights for axis in AXIS_COLOURS],
        labels=labels,
    )
    rr.log(f"{path}/axes", arrows, recording=recording)
    centres, sizes, quaternions = position_ellipsoids(means, mixture.covariances[order], sigmas)
    ellipsoids = rr.Ellipsoids3D(
        centers=centres,
        half_sizes=sizes,
        quaternions=quaternions,
        colors=[rgba(colour, 0.05 + 0.6 * w) for w in weights],
    )
    rr.log(f"{path}/ellipsoids", ellipsoids, recording=recording)


def log_trajectory(
    path: str,
    poses: SE3,
    *,
    colour: str = PALETTE[0],
    static: bool = False,
    recording: Any = None,
) -> None:
    """Logs a path of positions as a line.

    Parameters
    ----------
    path : str
        Entity below that of the poses' reference frame.
    poses : SE3, shape (n,)
        T_world_x.
    colour : str
        Colour, such as "#0072B2".
    static : bool
        Whether the line is visible at all times.
    recording : RecordingStream, optional
        Rerun's recording stream; by default the current one.
    """
    rr = viewer()
    strip = rr.LineStrips3D([poses.translation], colors=[rgba(colour, 1.0)])
    rr.log(path, strip, static=static, recording=recording)


def log_scalars(path: str, values: Mapping[str, float], *, recording: Any = None) -> None:
    """Logs numbers over time, each to PATH/NAME.

    Parameters
    ----------
    path : str
        Parent entity of the numbers.
    values : mapping of str to float
        Numbers by name; names should have units, such as "rotation_error_deg". NaN is left out.
    recording : RecordingStream, optional
        Rerun's recording stream; by default the current one.
    """
    rr = viewer()
    for name, value in values.items():
        if not np.isnan(value):
            rr.log(f"{path}/{name}".lstrip("/"), rr.Scalars([float(value)]), recording=recording)


def log_tracking(
    path: str,
    stamps: npt.ArrayLike,
    poses: SE3,
    covariances: npt.ArrayLike,
    *,
    colour: str = PALETTE[0],
    sigmas: float = 3.0,
    trail_s: float | None = None,
    recording: Any = None,
) -> None:
    """Logs an estimate over time: PATH/pose and PATH/ellipsoid at every time, and the path as PATH/way.

    Times without an estimate (NaN) are left out.

    Parameters
    ----------
    path : str
        Entity below that of the world.
    stamps : array_like, shape (n,)
        Times [s].
    poses : SE3, shape (n,)
        T_world_x.
    covariances : array_like, shape (n, 6, 6)
        Covariances of the left perturbation, rotation (rad) before translation (m).
    colour : str
        Colour, such as "#0072B2".
    sigmas : float
        Half axes of the ellipsoids in standard deviations.
    trail_s : float, optional
        The path at every time is that of so many seconds before [s]; by default all of it at all times.
    recording : RecordingStream, optional
        Rerun's recording stream; by default the current one.
    """
    times = as_floats(stamps, (len(poses),), "stamps")
    matrices = as_floats(covariances, (len(poses), 6, 6), "covariances")
    known = ~np.isnan(matrices[:, 0, 0])
    if trail_s is None:
        log_trajectory(f"{path}/way", poses[known], colour=colour, static=True, recording=recording)
    for i in np.flatnonzero(known).tolist():
        set_time(float(times[i]), recording=recording)
        log_pose(f"{path}/pose", poses[i], recording=recording)
        density = ConcentratedGaussian(poses[i], matrices[i])
        log_ellipsoid(
            f"{path}/ellipsoid", density, sigmas=sigmas, colour=colour, recording=recording
        )
        if trail_s is not None:
            near = known[: i + 1] & (times[: i + 1] >= times[i] - trail_s)
            way = poses[: i + 1][near]
            log_trajectory(f"{path}/way", way, colour=colour, recording=recording)
