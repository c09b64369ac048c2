# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Colours, planes and labels that the functions of this package share."""

from __future__ import annotations

from typing import Any, Literal, TypeAlias

from posemix._peers import peer

__all__ = ["PALETTE", "Axes", "Plane"]

Axes: TypeAlias = Any
Plane: TypeAlias = Literal["xy", "xz", "yz", "yx", "zx", "zy"]

# Okabe and Ito (2008), without black and yellow.
PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")


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


def label_space(ax: Axes, plane: str) -> None:
    """Labels the axes and gives all of them the same scale."""
    if is_3d(ax):
        ax.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]")
        ax.set_aspect("equal", adjustable="datalim")
        return
    ax.set(xlabel=f"{plane[0]} [m]", ylabel=f"{plane[1]} [m]")
    ax.set_aspect("equal", adjustable="datalim")
