# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Files of the BOP benchmark, and files of symmetries."""

from __future__ import annotations

import os
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray
from posemix._core import BopModel, ObjectBox, read_bop_model, read_bop_models, read_symmetry_file
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
        Ids of scene, image and object.
    score : ndarray, shape (n,)
        Confidence of the estimator; larger is more certain.
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
    """Reads a BOP results file, CSV ``scene_id,im_id,obj_id,score,R,t,time``; lengths are converted to metres.

    Raises
    ------
    ValueError
        With file and line.
    """
    keys, poses = _core.read_bop_rows(os.fspath(path))
    scene, image, object, score = zip(*keys, strict=True)
    ids = [np.array(values, dtype=np.int64) for values in (scene, image, object)]
    return BopRows(ids[0], ids[1], ids[2], np.array(score, dtype=np.float64), poses)
