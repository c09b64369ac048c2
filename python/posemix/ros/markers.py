# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Markers for RViz and Foxglove: axes and ellipsoids of the objects, alternatives as ghosts."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from posemix.bags.track_messages import PoseMixture
from posemix.interop.ros import to_pose
from posemix.lie import SE3
from posemix.plot.space import position_covariance
from posemix.ros.estimates import LiveEstimate
from posemix.ros.outputs import Outputs

__all__ = ["markers"]

_AXES = ((0.84, 0.37, 0.0), (0.0, 0.62, 0.45), (0.0, 0.45, 0.70))
_AXIS_M = 0.1
_ARROW, _SPHERE, _TEXT, _DELETE_ALL = 0, 2, 9, 3


def markers(estimate: LiveEstimate | None, make: Outputs, sigmas: float, world_frame: str) -> Any:
    """The MarkerArray: of every hypothesis three axes and the ellipsoid of its position, as opaque as it is probable.

    Namespaces are the objects' names with /axes, /ellipsoids and /name. Without an estimate all are deleted.
    """
    header = make.header(0 if estimate is None else estimate.stamp_ns, world_frame)
    marker = make.types["visualization_msgs/msg/Marker"]
    found = [marker(header=header, action=_DELETE_ALL)]
    if estimate is not None:
        for name in estimate.hypotheses:
            for item in _of_object(name, estimate.mixture(name), make, sigmas):
                item.header = header
                found.append(item)
    return make.types["visualization_msgs/msg/MarkerArray"](markers=found)


def _of_object(name: str, mixture: PoseMixture, make: Outputs, sigmas: float) -> Iterator[Any]:
    order = np.argsort(-mixture.log_weights, kind="stable")
    for number, k in enumerate(order.tolist()):
        weight, density = float(mixture.weights[k]), mixture[k]
        rotation = density.mean.rotation.matrix()
        for axis in range(3):
            yield _arrow(make, f"{name}/axes", 3 * number + axis, density.mean, rotation[:, axis], axis, weight)
        yield _ellipsoid(make, f"{name}/ellipsoids", number, density.mean, density.covariance, sigmas, weight)
    yield _label(make, name, mixture[int(order[0])].mean)


def _colour(make: Outputs, rgb: tuple[float, float, float], alpha: float) -> Any:
    red, green, blue = rgb
    return make.types["std_msgs/msg/ColorRGBA"](r=red, g=green, b=blue, a=alpha)


def _vector(make: Outputs, values: Any) -> Any:
    x, y, z = (float(v) for v in values)
    return make.types["geometry_msgs/msg/Vector3"](x=x, y=y, z=z)


def _arrow(
    make: Outputs, namespace: str, number: int, pose: SE3, direction: Any, axis: int, weight: float
) -> Any:
    point = make.types["geometry_msgs/msg/Point"]
    ends = [pose.translation, pose.translation + _AXIS_M * direction]
    return make.types["visualization_msgs/msg/Marker"](
        ns=namespace, id=number, type=_ARROW, scale=_vector(make, (0.006, 0.012, 0.0)),
        color=_colour(make, _AXES[axis], 0.15 + 0.85 * weight),
        points=[point(x=float(e[0]), y=float(e[1]), z=float(e[2])) for e in ends],
    )  # fmt: skip


def _ellipsoid(
    make: Outputs, namespace: str, number: int, mean: SE3, covariance: Any, sigmas: float, weight: float
) -> Any:
    values, vectors = np.linalg.eigh(position_covariance(mean, covariance))
    if np.linalg.det(vectors) < 0:
        vectors = -vectors
    homogeneous = np.eye(4)
    homogeneous[:3, :3], homogeneous[:3, 3] = vectors, mean.translation
    return make.types["visualization_msgs/msg/Marker"](
        ns=namespace, id=number, type=_SPHERE, pose=to_pose(SE3.from_matrix(homogeneous), types=make.types),
        scale=_vector(make, 2.0 * sigmas * np.sqrt(np.maximum(values, 0.0))),
        color=_colour(make, (0.0, 0.45, 0.70), 0.05 + 0.5 * weight),
    )  # fmt: skip


def _label(make: Outputs, name: str, pose: SE3) -> Any:
    above = SE3(translation=pose.translation + [0.0, 0.0, 1.2 * _AXIS_M])
    return make.types["visualization_msgs/msg/Marker"](
        ns=f"{name}/name", id=0, type=_TEXT, text=name, pose=to_pose(above, types=make.types),
        scale=_vector(make, (0.0, 0.0, 0.04)), color=_colour(make, (0.5, 0.5, 0.5), 1.0),
    )  # fmt: skip
