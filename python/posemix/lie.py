# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Rotations and poses, one or an array of them.

An `SO3` or `SE3` holds one element (shape ``()``) or an array of any shape, and every operation works on
all of them at once. A tangent vector is ``[phi, rho]``, rotation (rad) before translation (m); the
perturbation is on the left, ``X = Exp(xi) X0``. ``T_a_b`` maps points of frame b into frame a.
"""

from __future__ import annotations

from typing import TypeVar

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray, as_floats, flat_rows, require_finite
from posemix._elements import Elements

__all__ = ["SE3", "SO3", "interpolate", "weighted_mean"]


class SO3(Elements):
    """Rotations.

    Parameters
    ----------
    quaternion : array_like, shape (..., 4), optional
        Quaternions ``[x, y, z, w]`` of any length but zero; q and -q are the same rotation. The identity
        unless given.

    Raises
    ------
    ValueError
        For a quaternion that is zero or not finite.

    Examples
    --------
    >>> import numpy as np
    >>> from posemix import SO3
    >>> turn = SO3.exp([0, 0, np.pi / 6])
    >>> turn.act([1.0, 0.0, 0.0]).round(3)
    array([0.866, 0.5  , 0.   ])
    >>> SO3.exp(np.zeros((1000, 3))).shape
    (1000,)
    """

    DOF = 3
    _SIZE = 4
    _SIDE = 3
    _PREFIX = "so3_"
    __slots__ = ()

    def __init__(self, quaternion: npt.ArrayLike = (0.0, 0.0, 0.0, 1.0)) -> None:
        values = as_floats(quaternion, (4,), "quaternion")
        rows = _core.so3_normalized(flat_rows(values, 1))
        self._data = rows.reshape(values.shape)

    @property
    def quaternion(self) -> FloatArray:
        """Unit quaternions ``[x, y, z, w]``, shape (..., 4)."""
        return self._data.copy()

    def angle(self) -> FloatArray:
        """Angles of rotation in [0, pi], shape (...) [rad]."""
        norms = np.linalg.norm(self._data[..., :3], axis=-1)
        return np.asarray(2.0 * np.arctan2(norms, np.abs(self._data[..., 3])))


class SE3(Elements):
    """Poses.

    Parameters
    ----------
    rotation : SO3, optional
        Rotations, the identity unless given.
    translation : array_like, shape (..., 3), optional
        Translations [m], zero unless given. Broadcast against the rotations.

    Examples
    --------
    >>> import numpy as np
    >>> from posemix import SE3, SO3
    >>> T_world_camera = SE3(SO3.exp([0, 0, np.pi / 2]), [1.0, 0.0, 0.0])
    >>> T_camera_object = SE3(translation=[0.0, 0.0, 2.0])
    >>> (T_world_camera * T_camera_object).translation.round(9)
    array([1., 0., 2.])
    """

    DOF = 6
    _SIZE = 7
    _SIDE = 4
    _PREFIX = "se3_"
    __slots__ = ()

    def __init__(
        self, rotation: SO3 | None = None, translation: npt.ArrayLike = (0.0, 0.0, 0.0)
    ) -> None:
        turned = SO3() if rotation is None else SO3._checked(rotation, "rotation")
        moved = require_finite(as_floats(translation, (3,), "translation"), "translation")
        shape = np.broadcast_shapes(turned.shape, moved.shape[:-1])
        self._data = np.empty((*shape, 7))
        self._data[..., :3] = moved
        self._data[..., 3:] = turned._data

    @classmethod
    def from_tq(cls, values: npt.ArrayLike) -> SE3:
        """Poses from rows ``[tx, ty, tz, qx, qy, qz, qw]``, shape (..., 7), as in TUM files."""
        rows = as_floats(values, (7,), "values")
        quaternions = np.ascontiguousarray(rows[..., 3:])
        turned = _core.so3_normalized(flat_rows(quaternions, 1))
        require_finite(rows[..., :3], "translation")
        data = rows.copy()
        data[..., 3:] = turned.reshape(quaternions.shape)
        return cls._wrap(data, rows.shape[:-1])

    def to_tq(self) -> FloatArray:
        """Rows ``[tx, ty, tz, qx, qy, qz, qw]``, shape (..., 7)."""
        return self._data.copy()

    @property
    def rotation(self) -> SO3:
        """The rotations."""
        return SO3._wrap(np.ascontiguousarray(self._data[..., 3:]), self.shape)

    @property
    def translation(self) -> FloatArray:
        """The translations, shape (..., 3) [m]."""
        return self._data[..., :3].copy()


G = TypeVar("G", SO3, SE3)


def interpolate(a: G, b: G, t: npt.ArrayLike) -> G:
    """Points of the geodesic from `a` (t = 0) to `b` (t = 1): Exp(t Log(b a^-1)) a.

    Parameters
    ----------
    a, b : SO3 or SE3
        One element each.
    t : array_like, shape (...)
        Parameters.
    """
    at = require_finite(np.asarray(t, dtype=np.float64, order="C"), "t")
    type(Elements._checked(a, "a"))._checked(b, "b")
    data = a._call("interpolate", a._data, b._data, at.reshape(-1))
    return a._wrap(data, at.shape)


def weighted_mean(x: G, weights: npt.ArrayLike | None = None) -> G:
    """The mean of an array of elements: sum w_i Log(X_i mean^-1) = 0.

    Parameters
    ----------
    x : SO3 or SE3, shape (n,)
        Elements.
    weights : array_like, shape (n,), optional
        Weights, not negative; all one unless given.

    Raises
    ------
    ValueError
        For no element, invalid weights, or if the iteration does not converge.

    References
    ----------
    Pennec and Arsigny, Exponential Barycenters of the Canonical Cartan Connection (2012).
    """
    Elements._checked(x, "x")
    w = np.ones(len(x)) if weights is None else as_floats(weights, (len(x),), "weights")
    data, converged = type(x)._call("weighted_mean", x._rows(), w)
    if not converged:
        raise ValueError("the weighted mean did not converge: the elements lie too far apart")
    return x._wrap(data, ())
