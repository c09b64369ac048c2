# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""BOP: result files and models_info.json, which are in millimetres, and detector noise for symmetric objects.

`posemix.read_bop_rows` and `posemix.read_bop_models` read the files; this module writes them. Poses are
T_camera_object. A symmetry g is a motion of the object's frame after which the object looks the same: a detector cannot
distinguish X and X g.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from posemix._arrays import FloatArray, as_floats
from posemix._files import write_text
from posemix.io import BopModel, BopRows
from posemix.lie import SE3
from posemix.noise import (
    DetectorNoise,
    NoiseComponent,
    NoiseFrame,
    Clutter,
    SymmetryAxis,
    SymmetryGroup,
)

__all__ = ["discretized", "format_models", "format_results", "noise_modes", "write_models", "write_results"]

_MILLIMETRE = 1e-3


def format_results(rows: BopRows, *, time_s: npt.ArrayLike = -1.0) -> str:
    """The text of a result file, with header; numbers are read back up to the rounding of millimetres.

    Parameters
    ----------
    rows : BopRows
        Estimates; T_camera_object [m].
    time_s : array_like, shape (n,) or ()
        Processing time of the row's image [s], -1 if unknown.
    """
    times = np.broadcast_to(np.asarray(time_s, dtype=np.float64), (len(rows),))
    lines = ["scene_id,im_id,obj_id,score,R,t,time"]
    for i, matrix in enumerate(rows.poses.matrix()):
        rotation = " ".join(repr(float(v)) for v in matrix[:3, :3].ravel())
        translation = " ".join(repr(float(v)) for v in matrix[:3, 3] / _MILLIMETRE)
        ids = f"{rows.scene[i]},{rows.image[i]},{rows.object[i]}"
        lines.append(f"{ids},{float(rows.score[i])!r},{rotation},{translation},{float(times[i])!r}")
    return "\n".join(lines) + "\n"


def write_results(path: str | os.PathLike[str], rows: BopRows, *, time_s: npt.ArrayLike = -1.0) -> None:
    """Writes the text of `format_results` to a file, as a whole or not at all."""
    write_text(path, format_results(rows, time_s=time_s))


def _entry(model: BopModel) -> dict[str, Any]:
    entry: dict[str, Any] = {"diameter": model.diameter_m / _MILLIMETRE}
    if model.box is not None:
        for name, values in (("min", model.box.lowest_m), ("size", model.box.size_m)):
            entry.update({f"{name}_{axis}": float(v) / _MILLIMETRE for axis, v in zip("xyz", values, strict=True)})
    matrices = model.symmetries.elements.matrix()[1:]
    matrices[:, :3, 3] /= _MILLIMETRE
    if len(matrices):
        entry["symmetries_discrete"] = matrices.reshape((-1, 16)).tolist()
    if model.symmetries.axes:
        entry["symmetries_continuous"] = [
            {"axis": axis.direction.tolist(), "offset": (axis.point / _MILLIMETRE).tolist()}
            for axis in model.symmetries.axes
        ]
    return entry


def format_models(models: Mapping[int, BopModel]) -> str:
    """The text of a models_info.json: diameters, boxes and symmetries without the identity."""
    return json.dumps({str(key): _entry(model) for key, model in models.items()}, indent=1) + "\n"


def write_models(path: str | os.PathLike[str], models: Mapping[int, BopModel]) -> None:
    """Writes the text of `format_models` to a file, as a whole or not at all."""
    write_text(path, format_models(models))


def _twist(axis: SymmetryAxis) -> FloatArray:
    direction = axis.direction / np.linalg.norm(axis.direction)
    return np.concatenate([direction, np.cross(axis.point, direction)])


def discretized(symmetries: SymmetryGroup, max_step: float) -> SE3:
    """All symmetries as one array, rotations about an axis in steps, as in the BOP toolkit; the identity first.

    Parameters
    ----------
    symmetries : SymmetryGroup
        Symmetries with at most one axis.
    max_step : float
        Largest displacement of a vertex between two steps, as a fraction of the diameter; the BOP toolkit's
        max_sym_disc_step is 0.01.

    Returns
    -------
    SE3, shape (k,)

    Raises
    ------
    ValueError
        For a step that is not positive, and for several axes.
    """
    if not max_step > 0.0:
        raise ValueError(f"max_step is {max_step}; expected a positive number")
    elements, axes = symmetries.elements, symmetries.axes
    if len(axes) > 1:
        raise ValueError(f"the symmetries have {len(axes)} axes; expected at most one")
    if not axes:
        return elements
    count = math.ceil(math.pi / max_step)
    angles = 2.0 * math.pi * np.arange(count) / count
    motions = elements[:, None] * SE3.exp(angles[:, None] * _twist(axes[0]))
    return SE3.from_tq(motions.to_tq().reshape((-1, 7)))


def noise_modes(
    symmetries: SymmetryGroup, covariance: npt.ArrayLike, *, clutter: Clutter | None = None
) -> DetectorNoise:
    """The noise of a detector that cannot distinguish the symmetric poses of an object.

    It has one mode per discrete symmetry, all equally likely. The angle about an axis is unknown: the variance of a
    uniform angle, pi^2 / 3, is added along the twist of the axis, to first order. This is for filters that do not use
    `ObjectModel.symmetries`, such as the Gaussian-sum filter; a filter that uses them needs only the noise of the
    detector.

    Parameters
    ----------
    symmetries : SymmetryGroup
        Symmetries of one object.
    covariance : array_like, shape (6, 6)
        Covariance of the detector's own error along the object's axes, rotation (rad) before translation (m).
    clutter : Clutter, optional
        Clutter; its weight is a probability below one.
    """
    total = as_floats(covariance, (6, 6), "covariance") + symmetries.unobserved_covariance()
    elements = symmetries.elements
    weight = (1.0 - (clutter.weight if clutter is not None else 0.0)) / len(elements)
    components = [
        NoiseComponent(weight=weight, covariance=total, frame=NoiseFrame.object, offset=offset) for offset in elements
    ]
    return DetectorNoise(components, clutter)
