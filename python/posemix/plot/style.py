# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Colours, planes and labels that the functions of this package share."""

from __future__ import annotations

from typing import Any, Literal, TypeAlias

import numpy as np

from posemix._arrays import FloatArray
from posemix._peers import peer

__all__ = ["AXIS_COLOURS", "PALETTE", "Axes", "Plane"]

Axes: TypeAlias = Any
Plane: TypeAlias = Literal["xy", "xz", "yz", "yx", "zx", "zy"]

# The colours of objects and lines: those of the report and of the program's pictures, in the same order, which readers
# with any colour vision can distinguish.
PALETTE = (
    "#AA9117", "#B12CBE", "#296E79", "#DC68B5", "#4B9BCF", "#856224", "#9079FE", "#A27558", "#9249EB", "#CD3BA2",
)  # fmt: skip

# Colours of x, y and z, and of nothing else.
AXIS_COLOURS = ("#D8232A", "#1E8E3E", "#2F62DC")
# Colour of the ground truth, and of what is not an object.
TRUTH_COLOUR = "#8A8A8A"


def colour_of(index: int) -> str:
    """The colour with this index; colours repeat."""
    return PALETTE[index % len(PALETTE)]


def matplotlib(module: str) -> Any:
    """A module of matplotlib."""
    return peer(f"matplotlib.{module}", "posemix.plot", "posemix[plot]")


def art3d() -> Any:
    """The module of matplotlib with three-dimensional artists."""
    return peer("mpl_toolkits.mplot3d.art3d", "posemix.plot", "posemix[plot]")


def is_3d(ax: Axes) -> bool:
    """Whether axes have three dimensions."""
    return getattr(ax, "name", "") == "3d"


def plane_indices(plane: str) -> list[int]:
    """The indices of the two coordinates of a plane; raises ValueError for other words."""
    if len(plane) != 2 or plane[0] == plane[1] or not set(plane) <= set("xyz"):
        raise ValueError(f"plane is {plane!r}; expected two of x, y and z, as 'xy'")
    return ["xyz".index(letter) for letter in plane]


def quads(grid: FloatArray) -> FloatArray:
    """The faces between the points of a grid, shape (n, 4, 3)."""
    corners = [grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]]
    return np.stack(corners, axis=2).reshape((-1, 4, 3))


def filled(ax: Axes, shape: FloatArray, shade: str, **style: Any) -> Any:
    """A region that is drawn: faces in space, the outline in a plane."""
    if is_3d(ax):
        artist = art3d().Poly3DCollection(shape, facecolors=shade, **style)
        ax.add_collection3d(artist, autolim=False)
        ax.auto_scale_xyz(*shape.reshape((-1, 3)).T)
    else:
        artist = matplotlib("patches").Polygon(shape, facecolor=shade, **style)
        ax.add_patch(artist)
        ax.autoscale_view()
    return artist


def label_space(ax: Axes, plane: str) -> None:
    """Labels the axes and gives all of them the same scale."""
    if is_3d(ax):
        ax.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")
        ax.set_aspect("equal", adjustable="datalim")
        return
    ax.set(xlabel=f"{plane[0]} [m]", ylabel=f"{plane[1]} [m]")
    ax.set_aspect("equal", adjustable="datalim")
