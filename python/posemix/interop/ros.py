# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""ROS: geometry_msgs/PoseWithCovariance, 36 numbers row by row, translation first.

By definition of the message the covariance is about fixed axes, x, y, z of the parent frame (header.frame_id). The
definition does not determine the numbers of the orientation, so the caller has to state them:

reading : {"rotation_vector", "rpy"}
    "rotation_vector": R = Exp(theta) R0, as in tf2. "rpy": errors of the pose's own roll, pitch and yaw,
    R = Rz(yaw) Ry(pitch) Rx(roll), as in the bridge to MRPT. Both agree to first order for a pose without rotation.
frame : {"parent", "child"}
    "parent": along the axes of the parent frame, as the message defines it. "child": along the axes of the pose itself,
    as published by many nodes (such as the marginal of a factor graph); only with the reading "rotation_vector".

With "parent" the error of the translation is added, t = t0 + dt, so it is neither the left nor the right perturbation.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from posemix._arrays import FloatArray, as_floats
from posemix.density import ConcentratedGaussian
from posemix.interop.conventions import (
    additive_jacobian,
    inverse_additive_jacobian,
    require_word,
    transformed,
    side_jacobian,
)
from posemix.interop.euler import inverse_rpy_jacobian, rpy_jacobian
from posemix.lie import SE3

__all__ = [
    "Frame", "Reading", "covariance_from_ros", "covariance_to_ros", "from_pose", "from_pose_with_covariance",
    "to_pose", "to_pose_with_covariance",
]  # fmt: skip

# Places of the numbers of a covariance with the halves in the other order.
_SWAPPED = np.roll(np.arange(36).reshape((6, 6)), 3, axis=(0, 1)).ravel()

Reading: TypeAlias = Literal["rotation_vector", "rpy"]
Frame: TypeAlias = Literal["parent", "child"]


def _jacobian(mean: SE3, reading: Reading, frame: Frame, inverse: bool) -> FloatArray:
    require_word(reading, ("rotation_vector", "rpy"), "reading")
    require_word(frame, ("parent", "child"), "frame")
    if reading == "rpy":
        if frame == "child":
            raise ValueError("reading 'rpy' is of the frame 'parent'; got frame 'child'")
        return inverse_rpy_jacobian(mean) if inverse else rpy_jacobian(mean)
    if frame == "child":
        return side_jacobian(mean.inverse() if inverse else mean, "right")
    return inverse_additive_jacobian(mean) if inverse else additive_jacobian(mean)


def covariance_from_ros(
    mean: SE3, values: npt.ArrayLike, *, reading: Reading, frame: Frame
) -> FloatArray:
    """Covariances of the left perturbation, rotation first, from those of messages; to first order.

    Parameters
    ----------
    mean : SE3, shape (...)
        Poses.
    values : array_like, shape (..., 36)
        Fields `covariance` of the messages.
    reading, frame
        Conventions of the fields; see the module.

    Returns
    -------
    ndarray, shape (..., 6, 6)
    """
    rows = as_floats(values, (36,), "values")
    matrix = rows[..., _SWAPPED].reshape((*rows.shape[:-1], 6, 6))
    return transformed(matrix, _jacobian(mean, reading, frame, inverse=False))


def covariance_to_ros(
    mean: SE3, covariance: npt.ArrayLike, *, reading: Reading, frame: Frame
) -> FloatArray:
    """Fields `covariance` of messages, shape (..., 36), the inverse of `covariance_from_ros`.

    Raises
    ------
    ValueError
        With the reading "rpy" at a pitch of a quarter turn.
    """
    matrix = transformed(covariance, _jacobian(mean, reading, frame, inverse=True))
    return matrix.reshape((*matrix.shape[:-2], 36))[..., _SWAPPED]


def from_pose(message: Any) -> SE3:
    """The pose of a geometry_msgs/Pose or Transform; exact."""
    position = message.position if hasattr(message, "position") else message.translation
    q = message.orientation if hasattr(message, "orientation") else message.rotation
    return SE3.from_tq([position.x, position.y, position.z, q.x, q.y, q.z, q.w])


def to_pose(pose: SE3, *, types: Mapping[str, Any]) -> Any:
    """A geometry_msgs/Pose from one pose; exact.

    Parameters
    ----------
    pose : SE3
        The pose in its parent frame.
    types : mapping of str to type
        Message classes by name, such as "geometry_msgs/msg/Pose": the `types` of a typestore of rosbags, or a dict of
        ROS's own classes.
    """
    x, y, z, *q = (float(v) for v in pose.to_tq())
    return types["geometry_msgs/msg/Pose"](
        position=types["geometry_msgs/msg/Point"](x=x, y=y, z=z),
        orientation=types["geometry_msgs/msg/Quaternion"](x=q[0], y=q[1], z=q[2], w=q[3]),
    )


def from_pose_with_covariance(
    message: Any, *, reading: Reading, frame: Frame
) -> ConcentratedGaussian[SE3]:
    """The density of a geometry_msgs/PoseWithCovariance.

    Raises
    ------
    ValueError
        If the covariance is not positive definite, such as the zeros that mean an unknown covariance.
    """
    mean = from_pose(message.pose)
    covariance = covariance_from_ros(mean, message.covariance, reading=reading, frame=frame)
    return ConcentratedGaussian(mean, covariance)


def to_pose_with_covariance(
    density: ConcentratedGaussian[SE3],
    *,
    reading: Reading,
    frame: Frame,
    types: Mapping[str, Any],
) -> Any:
    """A geometry_msgs/PoseWithCovariance, the inverse of `from_pose_with_covariance`; `types` as for `to_pose`."""
    values = covariance_to_ros(density.mean, density.covariance, reading=reading, frame=frame)
    return types["geometry_msgs/msg/PoseWithCovariance"](
        pose=to_pose(density.mean, types=types), covariance=values
    )
