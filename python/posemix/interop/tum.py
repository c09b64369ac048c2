# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""TUM trajectories: lines `stamp tx ty tz qx qy qz qw`, seconds and metres."""

from __future__ import annotations

import os

import numpy as np
import numpy.typing as npt

from posemix._arrays import FloatArray, as_floats
from posemix._files import numbered_lines, numbers, read_text, write_text
from posemix.lie import SE3

__all__ = ["format", "parse", "read", "write"]


def parse(text: str, name: str = "text") -> tuple[FloatArray, SE3]:
    """Stamps, shape (n,) [s], and poses T_world_body, shape (n,).

    Parameters
    ----------
    text : str
        Lines; blank ones and those that start with # are skipped.
    name : str
        Of the text, for errors.

    Raises
    ------
    ValueError
        Naming the line, for other than eight finite numbers and for a zero quaternion, with which some
        detectors say that they missed.
    """
    rows = []
    for number, line in numbered_lines(text):
        row = numbers(line.replace(",", " ").split(), 8, f"{name}:{number}")
        if not any(row[4:]):
            raise ValueError(f"{name}:{number}: got a quaternion of zeros, expected a rotation")
        rows.append(row)
    values = np.array(rows).reshape((-1, 8))
    return values[:, 0].copy(), SE3.from_tq(values[:, 1:])


def format(stamps: npt.ArrayLike, poses: SE3) -> str:
    """The text of stamps, shape (n,) [s], and poses, shape (n,); reads back to the last bit."""
    times = as_floats(stamps, (len(poses),), "stamps")
    rows = np.column_stack([times, poses.to_tq()])
    return "".join(" ".join(repr(float(v)) for v in row) + "\n" for row in rows)


def read(path: str | os.PathLike[str]) -> tuple[FloatArray, SE3]:
    """As `parse`, of a file."""
    return parse(read_text(path), os.fspath(path))


def write(path: str | os.PathLike[str], stamps: npt.ArrayLike, poses: SE3) -> None:
    """As `format`, to a file, all or nothing."""
    write_text(path, format(stamps, poses))
