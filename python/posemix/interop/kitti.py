# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""KITTI odometry poses: lines of twelve numbers, the upper three rows of a 4x4 matrix, metres."""

from __future__ import annotations

import os

import numpy as np

from posemix._files import numbered_lines, numbers, read_text, write_text
from posemix.lie import SE3

__all__ = ["format", "parse", "read", "write"]


def parse(text: str, name: str = "text") -> SE3:
    """Poses T_world_camera, shape (n,); KITTI's world is the first left camera.

    Raises
    ------
    ValueError
        With the number of the line, for a line that is not twelve finite numbers or whose matrix deviates from a
        rotation by more than 1e-3.
    """
    rows = []
    for number, line in numbered_lines(text):
        where = f"{name}:{number}"
        upper = np.array(numbers(line.split(), 12, where)).reshape((3, 4))
        matrix = np.vstack([upper, [0.0, 0.0, 0.0, 1.0]])
        try:
            rows.append(SE3.from_matrix(matrix, tolerance=1e-3).to_tq())
        except ValueError as error:
            raise ValueError(f"{where}: {error}") from None
    return SE3.from_tq(np.array(rows).reshape((-1, 7)))


def format(poses: SE3) -> str:
    """The text of poses, shape (n,)."""
    rows = poses.matrix()[:, :3].reshape((-1, 12))
    return "".join(" ".join(repr(float(v)) for v in row) + "\n" for row in rows)


def read(path: str | os.PathLike[str]) -> SE3:
    """Reads a file as `parse` reads a text."""
    return parse(read_text(path), os.fspath(path))


def write(path: str | os.PathLike[str], poses: SE3) -> None:
    """Writes the text of `format` to a file, as a whole or not at all."""
    write_text(path, format(poses))
