# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Roll, pitch and yaw: R = Rz(yaw) Ry(pitch) Rx(roll), and the Jacobian of their errors."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from posemix._arrays import FloatArray, as_floats
from posemix.interop.conventions import additive_jacobian, inverted
from posemix.lie import SE3, SO3

__all__ = ["from_rpy", "inverse_rpy_jacobian", "rpy_jacobian", "to_rpy"]

# Least cosine of the pitch at which the three angles can be distinguished.
_LEAST_COSINE = 1e-6


def from_rpy(angles: npt.ArrayLike) -> SO3:
    """Rotations of [roll, pitch, yaw], shape (..., 3) [rad]."""
    values = as_floats(angles, (3,), "angles")
    axes = np.eye(3)
    turn = [SO3.exp(values[..., i : i + 1] * axes[i]) for i in range(3)]
    return turn[2] * turn[1] * turn[0]


def to_rpy(rotation: SO3) -> FloatArray:
    """[roll, pitch, yaw] of rotations, shape (..., 3) [rad]; pitch in [-pi/2, pi/2].

    At a pitch of a quarter turn, roll is set to zero.
    """
    m = rotation.matrix()
    cosine = np.hypot(m[..., 0, 0], m[..., 1, 0])
    locked = cosine < _LEAST_COSINE
    roll = np.where(locked, 0.0, np.arctan2(m[..., 2, 1], m[..., 2, 2]))
    yaw = np.where(
        locked,
        np.arctan2(-m[..., 0, 1], m[..., 1, 1]),
        np.arctan2(m[..., 1, 0], m[..., 0, 0]),
    )
    return np.stack([roll, np.arctan2(-m[..., 2, 0], cosine), yaw], axis=-1)


def rpy_jacobian(mean: SE3) -> FloatArray:
    """The Jacobian from errors of [roll, pitch, yaw, x, y, z] to [phi, rho] on the left, shape (..., 6, 6)."""
    _, pitch, yaw = np.moveaxis(to_rpy(mean.rotation), -1, 0)
    zero, one = np.zeros_like(yaw), np.ones_like(yaw)
    rows = [
        [np.cos(yaw) * np.cos(pitch), -np.sin(yaw), zero],
        [np.sin(yaw) * np.cos(pitch), np.cos(yaw), zero],
        [-np.sin(pitch), zero, one],
    ]
    turn = np.moveaxis(np.array(rows), (0, 1), (-2, -1))
    jacobian = additive_jacobian(mean)
    jacobian[..., 3:, :3] = jacobian[..., 3:, :3] @ turn
    jacobian[..., :3, :3] = turn
    return jacobian


def inverse_rpy_jacobian(mean: SE3) -> FloatArray:
    """The inverse of `rpy_jacobian`.

    Raises
    ------
    ValueError
        At a pitch of a quarter turn, where roll and yaw cannot be distinguished.
    """
    pitch = to_rpy(mean.rotation)[..., 1]
    if np.any(np.cos(pitch) < 10.0 * _LEAST_COSINE):
        raise ValueError("pitch is a quarter turn: roll and yaw have no covariance there")
    return inverted(rpy_jacobian(mean))
