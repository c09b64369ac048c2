# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""scipy.spatial.transform: Rotation, and RigidTransform from SciPy 1.16 on. Conversions are exact."""

from __future__ import annotations

from typing import Any

import numpy as np

from posemix._peers import peer
from posemix.lie import SE3, SO3

__all__ = ["from_rigid_transform", "from_rotation", "to_rigid_transform", "to_rotation"]


def from_rotation(rotation: Any) -> SO3:
    """Rotations of a scipy Rotation, one or an array of them."""
    return SO3(np.asarray(rotation.as_quat(), dtype=np.float64))


def to_rotation(rotation: SO3) -> Any:
    """A scipy Rotation of rotations of shape () or (n,)."""
    transform = peer("scipy.spatial.transform", "posemix.interop.scipy", "scipy")
    return transform.Rotation.from_quat(rotation.quaternion)


def from_rigid_transform(transform: Any) -> SE3:
    """Poses of a scipy RigidTransform, one or an array of them."""
    return SE3(from_rotation(transform.rotation), transform.translation)


def to_rigid_transform(pose: SE3) -> Any:
    """A scipy RigidTransform of poses of shape () or (n,)."""
    transform = peer("scipy.spatial.transform", "posemix.interop.scipy", "scipy>=1.16")
    if not hasattr(transform, "RigidTransform"):
        raise ImportError("posemix.interop.scipy needs RigidTransform: pip install scipy>=1.16")
    return transform.RigidTransform.from_components(pose.translation, to_rotation(pose.rotation))
