# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""BOP: result files (CSV) and the symmetries of models_info.json. Files in millimetres, arrays in metres.

Poses are T_camera_object. A symmetry g is a motion of the object's frame after which the object looks the same: X
and X g are one pose to a detector.
"""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from posemix._arrays import FloatArray
from posemix._files import numbered_lines, numbers, read_text, write_text
from posemix.interop.bop_models import (
    Model,
    NoiseMode,
    SymmetryAxis,
    discretized,
    format_models,
    noise_modes,
    parse_models,
    read_models,
)
from posemix.interop.bop_objects import detector_noise, symmetry_group
from posemix.lie import SE3

__all__ = [
    "Model", "NoiseMode", "Results", "SymmetryAxis", "detector_noise", "discretized", "format_models", "format_results",
    "noise_modes", "parse_models", "parse_results", "read_models", "read_results", "symmetry_group", "write_results",
]  # fmt: skip

_MILLIMETRE = 1e-3
_HEADER = "scene_id,im_id,obj_id,score,R,t,time"


@dataclass(frozen=True)
class Results:
    """Rows of a result file.

    Attributes
    ----------
    scene_id, im_id, obj_id : ndarray of int, shape (n,)
        What was seen where.
    score : ndarray, shape (n,)
        Confidence of the detector, larger is surer.
    poses : SE3, shape (n,)
        T_camera_object [m].
    time : ndarray, shape (n,)
        Time of the row's image [s], -1 where unknown.
    """

    scene_id: npt.NDArray[np.int64]
    im_id: npt.NDArray[np.int64]
    obj_id: npt.NDArray[np.int64]
    score: FloatArray
    poses: SE3
    time: FloatArray


def _result_row(line: str, where: str) -> tuple[list[int], list[float], FloatArray]:
    fields = line.split(",")
    if len(fields) != 7:
        raise ValueError(f"{where}: got {len(fields)} columns, expected 7: {_HEADER}")
    try:
        ids = [int(field) for field in fields[:3]]
    except ValueError:
        raise ValueError(f"{where}: got '{','.join(fields[:3])}', expected three integers") from None
    matrix = np.eye(4)
    matrix[:3, :3] = np.reshape(numbers(fields[4].split(), 9, f"{where}: R"), (3, 3))
    matrix[:3, 3] = np.multiply(numbers(fields[5].split(), 3, f"{where}: t"), _MILLIMETRE)
    score, time = numbers([fields[3], fields[6]], 2, where)
    return ids, [score, time], matrix


def parse_results(text: str, name: str = "text") -> Results:
    """The rows of a result file; the header line is optional.

    Raises
    ------
    ValueError
        Naming the line, also for an R that is no rotation to 1e-3.
    """
    ids, scores, poses = [], [], []
    for number, line in numbered_lines(text):
        if line.replace(" ", "") == _HEADER:
            continue
        where = f"{name}:{number}"
        row = _result_row(line, where)
        ids.append(row[0])
        scores.append(row[1])
        try:
            poses.append(SE3.from_matrix(row[2], tolerance=1e-3).to_tq())
        except ValueError as error:
            raise ValueError(f"{where}: R: {error}") from None
    scene, image, objects = np.array(ids, dtype=np.int64).reshape((-1, 3)).T
    score, time = np.array(scores).reshape((-1, 2)).T
    return Results(
        scene, image, objects, score, SE3.from_tq(np.array(poses).reshape((-1, 7))), time
    )


def format_results(results: Results) -> str:
    """The text of a result file, with header."""
    lines = [_HEADER]
    matrices = results.poses.matrix()
    for i, matrix in enumerate(matrices):
        rotation = " ".join(repr(float(v)) for v in matrix[:3, :3].ravel())
        translation = " ".join(repr(float(v)) for v in matrix[:3, 3] / _MILLIMETRE)
        ids = f"{results.scene_id[i]},{results.im_id[i]},{results.obj_id[i]}"
        score, time = float(results.score[i]), float(results.time[i])
        lines.append(f"{ids},{score!r},{rotation},{translation},{time!r}")
    return "\n".join(lines) + "\n"


def read_results(path: str | os.PathLike[str]) -> Results:
    """As `parse_results`, of a file."""
    return parse_results(read_text(path), os.fspath(path))


def write_results(path: str | os.PathLike[str], results: Results) -> None:
    """As `format_results`, to a file, all or nothing."""
    write_text(path, format_results(results))
