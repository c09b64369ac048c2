# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Files of the BOP benchmark, and symmetries."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray
from posemix._core import SymmetryGroup
from posemix.io.paths import Path
from posemix.lie import SE3

__all__ = [
    "BopModel",
    "BopRows",
    "ObjectBox",
    "read_bop_model",
    "read_bop_models",
    "read_bop_rows",
    "read_symmetry_file",
]

@dataclass(frozen=True, eq=False)
class BopRows:
    """The rows of a BOP results file.

    Attributes
    ----------
    scene, image, object : ndarray of int, shape (n,)
        Ids.
    score : ndarray, shape (n,)
        The estimator's confidence, larger is surer.
    poses : SE3, shape (n,)
        T_camera_object [m].
    """

    scene: npt.NDArray[np.int64]
    image: npt.NDArray[np.int64]
    object: npt.NDArray[np.int64]
    score: FloatArray
    poses: SE3

    def __len__(self) -> int:
        return len(self.score)


def read_bop_rows(path: Path) -> BopRows:
    """A BOP results file: CSV ``scene_id,im_id,obj_id,score,R,t,time``; millimetres become metres.

    Raises
    ------
    ValueError
        Naming file and line.
    """
    keys, poses = _core.read_bop_rows(os.fspath(path))
    scene, image, object, score = zip(*keys, strict=True)
    ids = [np.array(values, dtype=np.int64) for values in (scene, image, object)]
    return BopRows(ids[0], ids[1], ids[2], np.array(score, dtype=np.float64), poses)


@dataclass(frozen=True, eq=False)
class ObjectBox:
    """An axis-aligned box in the object's frame: lowest corner and size, shape (3,) each [m]."""

    lowest_m: FloatArray
    size_m: FloatArray

    def corners(self) -> FloatArray:
        """The corners, shape (8, 3) [m]."""
        steps = np.indices((2, 2, 2)).reshape(3, 8).T
        return np.asarray(self.lowest_m + steps * self.size_m)


@dataclass(frozen=True, eq=False)
class BopModel:
    """What models_info.json says of one object.

    Attributes
    ----------
    diameter_m : float
        The largest distance of two vertices [m].
    symmetries : SymmetryGroup
        Discrete times continuous.
    box : ObjectBox or None
        Where the entry has one.
    """

    diameter_m: float
    symmetries: SymmetryGroup
    box: ObjectBox | None


def _bop_model(values: Any) -> BopModel:
    diameter, symmetries, box = values
    return BopModel(diameter, symmetries, None if box is None else ObjectBox(*box))


def read_bop_models(path: Path) -> dict[int, BopModel]:
    """BOP's models_info.json by object id; ValueError names the file and the entry."""
    models = _core.read_bop_models(os.fspath(path))
    return {id: _bop_model(values) for id, values in models.items()}


def read_bop_model(path: Path, object: int) -> BopModel:
    """One entry of models_info.json; what is wrong with the others does not matter."""
    return _bop_model(_core.read_bop_model(os.fspath(path), object))


def read_symmetry_file(path: Path) -> dict[int, SymmetryGroup]:
    """Symmetries by object id: a TOML file with tables ``[symmetries.ID]``, or models_info.json."""
    return _core.read_symmetry_file(os.fspath(path))
