# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Symmetries in BOP's models_info.json; part of `posemix.interop.bop`."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from posemix._arrays import FloatArray, as_floats
from posemix._files import read_text
from posemix.interop.conventions import restated
from posemix.lie import SE3

__all__ = [
    "Model", "NoiseMode", "SymmetryAxis", "discretized", "format_models", "noise_modes", "parse_models",
    "read_models",
]  # fmt: skip

_MILLIMETRE = 1e-3


@dataclass(frozen=True)
class SymmetryAxis:
    """The object looks the same turned by any angle about this line.

    Attributes
    ----------
    direction : ndarray, shape (3,)
        Object frame, length one.
    point : ndarray, shape (3,)
        On the line, object frame [m].
    """

    direction: FloatArray
    point: FloatArray

    def turned(self, angles: npt.ArrayLike) -> SE3:
        """Motions about the axis by angles, shape (...) [rad]."""
        twist = np.concatenate([self.direction, np.cross(self.point, self.direction)])
        return SE3.exp(np.asarray(angles, dtype=np.float64)[..., None] * twist)


@dataclass(frozen=True)
class Model:
    """What models_info.json says of an object.

    Attributes
    ----------
    diameter : float
        Largest distance of two vertices [m].
    elements : SE3, shape (k,)
        Discrete symmetries, the identity first.
    axes : tuple of SymmetryAxis
        Continuous ones. Any turn about an axis after any element is a symmetry.
    """

    diameter: float
    elements: SE3
    axes: tuple[SymmetryAxis, ...]


def _vector(value: Any, count: int, where: str) -> FloatArray:
    try:
        vector = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        vector = np.empty(0)
    if vector.shape != (count,) or not np.isfinite(vector).all():
        raise ValueError(f"{where}: got {value!r}, expected {count} numbers")
    return vector


def _element(value: Any, where: str) -> FloatArray:
    matrix = _vector(value, 16, where).reshape((4, 4))
    matrix[:3, 3] *= _MILLIMETRE
    try:
        return SE3.from_matrix(matrix, tolerance=1e-3).to_tq()
    except ValueError as error:
        raise ValueError(f"{where}: {error}") from None


def _axis(value: Any, where: str) -> SymmetryAxis:
    if not isinstance(value, dict) or "axis" not in value or "offset" not in value:
        raise ValueError(f"{where}: expected an object with the keys axis and offset")
    direction = _vector(value["axis"], 3, f"{where}: axis")
    length = float(np.linalg.norm(direction))
    if length == 0.0:
        raise ValueError(f"{where}: axis: got zeros, expected a direction")
    point = _MILLIMETRE * _vector(value["offset"], 3, f"{where}: offset")
    return SymmetryAxis(direction / length, point)


def _model(entry: Any, where: str) -> Model:
    if not isinstance(entry, dict) or "diameter" not in entry:
        raise ValueError(f"{where}: expected an object with the key diameter")
    diameter = float(_vector([entry["diameter"]], 1, f"{where}: diameter")[0])
    if diameter <= 0.0:
        raise ValueError(f"{where}: diameter: got {diameter:g}, expected a positive number")
    place = f"{where}: symmetries_discrete"
    elements = [SE3().to_tq()]
    for i, value in enumerate(entry.get("symmetries_discrete", [])):
        element = _element(value, f"{place}[{i}]")
        if not any(SE3.from_tq(element).is_approx(SE3.from_tq(e), 1e-6) for e in elements):
            elements.append(element)
    place = f"{where}: symmetries_continuous"
    axes = [
        _axis(value, f"{place}[{i}]")
        for i, value in enumerate(entry.get("symmetries_continuous", []))
    ]
    return Model(_MILLIMETRE * diameter, SE3.from_tq(np.array(elements)), tuple(axes))


def parse_models(text: str, name: str = "text") -> dict[int, Model]:
    """The models of a models_info.json by object id; other keys of an entry are ignored.

    Raises
    ------
    ValueError
        Naming object and key.
    """
    try:
        root = json.loads(text)
    except json.JSONDecodeError as error:
        raise ValueError(f"{name}: is not JSON: {error}") from None
    if not isinstance(root, dict):
        raise ValueError(f"{name}: expected an object with one entry per object id")
    models = {}
    for key, entry in root.items():
        if not key.isdecimal():
            raise ValueError(f"{name}: got the key '{key}', expected an object id")
        models[int(key)] = _model(entry, f"{name}: {key}")
    return models


def read_models(path: str | os.PathLike[str]) -> dict[int, Model]:
    """As `parse_models`, of a file."""
    return parse_models(read_text(path), os.fspath(path))


def format_models(models: Mapping[int, Model]) -> str:
    """The text of a models_info.json with diameters and symmetries, the identity left out."""
    root = {}
    for key, model in models.items():
        entry: dict[str, Any] = {"diameter": model.diameter / _MILLIMETRE}
        matrices = model.elements.matrix()[1:]
        matrices[:, :3, 3] /= _MILLIMETRE
        if len(matrices):
            entry["symmetries_discrete"] = matrices.reshape((-1, 16)).tolist()
        if model.axes:
            entry["symmetries_continuous"] = [
                {"axis": axis.direction.tolist(), "offset": (axis.point / _MILLIMETRE).tolist()}
                for axis in model.axes
            ]
        root[str(key)] = entry
    return json.dumps(root, indent=1) + "\n"


def discretized(model: Model, max_step: float) -> SE3:
    """All symmetries as one array, turns about axes in steps; the identity first.

    Parameters
    ----------
    model : Model
        Of one object.
    max_step : float
        Largest way of a vertex between two steps, as a fraction of the diameter; the BOP toolkit's
        max_sym_disc_step is 0.01.
    """
    if not max_step > 0.0:
        raise ValueError(f"max_step is {max_step}; expected a positive number")
    count = math.ceil(math.pi / max_step)
    angles = 2.0 * math.pi * np.arange(count) / count
    motions = model.elements
    for axis in model.axes:
        turned = motions[:, None] * axis.turned(angles)
        motions = SE3.from_tq(turned.to_tq().reshape((-1, 7)))
    return motions


@dataclass(frozen=True)
class NoiseMode:
    """One mode of a detection: Y = T_camera_object offset Exp(n), n ~ N(0, covariance).

    Attributes
    ----------
    weight : float
        Probability of the mode.
    offset : SE3
        In the object's frame.
    covariance : ndarray, shape (6, 6)
        Of n along the mode's own axes, rotation (rad) before translation (m).
    """

    weight: float
    offset: SE3
    covariance: FloatArray


def noise_modes(model: Model, covariance: npt.ArrayLike) -> list[NoiseMode]:
    """The modes of a detector that cannot tell the symmetries of an object, equally weighted.

    One mode per discrete symmetry. About each axis the angle is unknown: its variance of pi^2 / 3, that of a
    uniform angle, is added along the twist [d; p x d] of the axis, to first order.

    Parameters
    ----------
    model : Model
        Of one object.
    covariance : array_like, shape (6, 6)
        Of the detector's own error along the object's axes.
    """
    total = as_floats(covariance, (6, 6), "covariance").copy()
    for axis in model.axes:
        twist = np.concatenate([axis.direction, np.cross(axis.point, axis.direction)])
        total += math.pi**2 / 3.0 * np.outer(twist, twist)
    count = len(model.elements)
    offsets = [model.elements[i] for i in range(count)]
    return [NoiseMode(1.0 / count, offset, restated(total, np.eye(6))) for offset in offsets]
