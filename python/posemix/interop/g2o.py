# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""g2o files: VERTEX_SE3:QUAT and EDGE_SE3:QUAT, x y z qx qy qz qw, information as its upper triangle.

The information is that of an error on the right, translation first. In g2o's own EdgeSE3 the rotation part of the error
is the vector part of a quaternion, half of the rotation vector for small angles; in GTSAM and most other programs that
write such files it is the rotation vector itself. So the caller has to state it:

rotation : {"quaternion_vector", "rotation_vector"}
    "quaternion_vector" for g2o itself, "rotation_vector" for GTSAM.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from posemix._arrays import FloatArray, as_floats
from posemix._files import numbered_lines, numbers, read_text, write_text
from posemix.density import ConcentratedGaussian
from posemix.interop.conventions import density_from, density_to, require_word
from posemix.lie import SE3

__all__ = [
    "Graph", "Rotation", "format", "from_information", "parse", "read", "to_information", "write",
]  # fmt: skip

Rotation: TypeAlias = Literal["quaternion_vector", "rotation_vector"]

_UPPER = np.triu_indices(6)


def _error_scale(rotation: Rotation) -> FloatArray:
    """Factors between the error in the file and [rho, phi]."""
    require_word(rotation, ("quaternion_vector", "rotation_vector"), "rotation")
    half = 0.5 if rotation == "quaternion_vector" else 1.0
    return np.array([1.0, 1.0, 1.0, half, half, half])


def from_information(
    measurement: SE3, information: npt.ArrayLike, *, rotation: Rotation
) -> ConcentratedGaussian[SE3]:
    """The density of an edge's measurement, to first order in the error.

    Parameters
    ----------
    measurement : SE3
        T_from_to.
    information : array_like, shape (21,) or (6, 6)
        Upper triangle row by row, or the matrix; translation before rotation.
    rotation : {"quaternion_vector", "rotation_vector"}
        The meaning of the error; see the module.
    """
    values = np.asarray(information, dtype=np.float64)
    matrix = _full(values) if values.shape == (21,) else as_floats(values, (6, 6), "information")
    scale = _error_scale(rotation)
    covariance = np.linalg.inv(scale[:, None] * matrix * scale)
    return density_from(
        measurement, 0.5 * (covariance + covariance.T), side="right", order="translation_first"
    )


def to_information(
    density: ConcentratedGaussian[SE3], *, rotation: Rotation
) -> tuple[SE3, FloatArray]:
    """Measurement and upper triangle of its information, shape (21,), the inverse of `from_information`."""
    mean, covariance = density_to(density, side="right", order="translation_first")
    scale = _error_scale(rotation)
    information = np.linalg.inv(scale[:, None] * covariance * scale)
    return mean, (0.5 * (information + information.T))[_UPPER]


def _full(triangle: FloatArray) -> FloatArray:
    matrix = np.zeros((6, 6))
    matrix[_UPPER] = triangle
    return matrix + np.triu(matrix, 1).T


@dataclass(frozen=True)
class Graph:
    """A pose graph.

    Attributes
    ----------
    ids : ndarray of int, shape (n,)
        Ids of the vertices.
    poses : SE3, shape (n,)
        T_world_vertex.
    edges : ndarray of int, shape (m, 2)
        Ids of the vertices from, to.
    measurements : SE3, shape (m,)
        T_from_to.
    information : ndarray, shape (m, 21)
        Upper triangles of the information, as in the file.
    fixed : tuple of int
        Ids of vertices that are fixed.
    """

    ids: npt.NDArray[np.int64]
    poses: SE3
    edges: npt.NDArray[np.int64]
    measurements: SE3
    information: FloatArray
    fixed: tuple[int, ...] = ()


def _ids(fields: list[str], count: int, where: str) -> list[int]:
    try:
        found = [int(field) for field in fields[:count]]
    except ValueError:
        found = []
    if len(found) != count:
        raise ValueError(f"{where}: got '{' '.join(fields[:count])}', expected {count} vertex ids")
    return found


def parse(text: str, name: str = "text") -> Graph:
    """Reads the graph of a text; tags other than VERTEX_SE3:QUAT, EDGE_SE3:QUAT and FIX are errors.

    Raises
    ------
    ValueError
        With the number of the line.
    """
    vertices: dict[int, list[float]] = {}
    edges: list[list[int]] = []
    values: list[list[float]] = []
    fixed: list[int] = []
    for number, line in numbered_lines(text):
        tag, *fields = line.split()
        where = f"{name}:{number}"
        if tag == "VERTEX_SE3:QUAT":
            (vertex,) = _ids(fields, 1, where)
            if vertex in vertices:
                raise ValueError(f"{where}: vertex {vertex} is there twice")
            vertices[vertex] = _pose_numbers(fields[1:], 7, where)
        elif tag == "EDGE_SE3:QUAT":
            edges.append(_ids(fields, 2, where))
            values.append(_pose_numbers(fields[2:], 28, where))
        elif tag == "FIX":
            fixed += _ids(fields, len(fields), where)
        else:
            raise ValueError(f"{where}: got {tag}, expected VERTEX_SE3:QUAT, EDGE_SE3:QUAT or FIX")
    table = np.array(values).reshape((-1, 28))
    return Graph(
        ids=np.array(list(vertices), dtype=np.int64),
        poses=SE3.from_tq(np.array(list(vertices.values())).reshape((-1, 7))),
        edges=np.array(edges, dtype=np.int64).reshape((-1, 2)),
        measurements=SE3.from_tq(table[:, :7]),
        information=table[:, 7:].copy(),
        fixed=tuple(fixed),
    )


def _pose_numbers(fields: list[str], count: int, where: str) -> list[float]:
    row = numbers(fields, count, where)
    if not any(row[3:7]):
        raise ValueError(f"{where}: got a quaternion of zeros, expected a rotation")
    return row


def format(graph: Graph) -> str:
    """The text of a graph; numbers are read back bit by bit."""

    def line(tag: str, ids: list[int], values: FloatArray) -> str:
        return " ".join([tag, *map(str, ids), *(repr(float(v)) for v in values)]) + "\n"

    lines = [
        line("VERTEX_SE3:QUAT", [vertex], values)
        for vertex, values in zip(graph.ids.tolist(), graph.poses.to_tq(), strict=True)
    ]
    lines += [f"FIX {vertex}\n" for vertex in graph.fixed]
    rows = np.hstack([graph.measurements.to_tq(), graph.information])
    lines += [
        line("EDGE_SE3:QUAT", ids, row) for ids, row in zip(graph.edges.tolist(), rows, strict=True)
    ]
    return "".join(lines)


def read(path: str | os.PathLike[str]) -> Graph:
    """Reads a file as `parse` reads a text."""
    return parse(read_text(path), os.fspath(path))


def write(path: str | os.PathLike[str], graph: Graph) -> None:
    """Writes the text of `format` to a file, as a whole or not at all."""
    write_text(path, format(graph))
