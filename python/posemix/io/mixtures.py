# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Mixture files and posterior files."""

from __future__ import annotations

import os
from dataclasses import dataclass

from posemix import _core
from posemix._core import AngleUnit, LengthUnit, MixtureConvention, NamedPose, PoseKind, Side, TangentOrder
from posemix.density import ConcentratedGaussian, ProjectedGaussian
from posemix.io.paths import Path
from posemix.lie import SE3
from posemix.mixture import Mixture

__all__ = [
    "AngleUnit",
    "LengthUnit",
    "MixtureConvention",
    "MixtureFile",
    "NamedPose",
    "PoseKind",
    "PosteriorFile",
    "Side",
    "TangentOrder",
    "read_mixture",
    "read_posterior",
    "write_mixture",
    "write_posterior",
]

PoseMixture = Mixture[ConcentratedGaussian[SE3]] | Mixture[ProjectedGaussian[SE3]]


@dataclass(frozen=True)
class MixtureFile:
    """The content of a mixture file: a mixture over the pose T_from_to, and the names of its frames."""

    from_frame: str
    to_frame: str
    mixture: PoseMixture


def read_mixture(path: Path) -> MixtureFile:
    """Reads a mixture file in any convention.

    Raises
    ------
    ValueError
        With the file and the place in it.
    """
    return MixtureFile(*_core.read_mixture(os.fspath(path)))


def write_mixture(
    path: Path,
    mixture: PoseMixture,
    from_frame: str,
    to_frame: str,
    convention: MixtureConvention | None = None,
) -> None:
    """Writes a mixture file.

    Parameters
    ----------
    path : path
        The file.
    mixture : Mixture
        Mixture over the pose T_from_to.
    from_frame, to_frame : str
        Names of the frames, 1 to 100 printable characters without blanks.
    convention : MixtureConvention, optional
        Convention of the file; by default that of the library, in which numbers are read back bit by bit.

    Raises
    ------
    ValueError
        For a mixture or names that a file cannot represent.
    """
    _core.write_mixture(
        os.fspath(path), from_frame, to_frame, mixture, convention or MixtureConvention()
    )


@dataclass(frozen=True)
class PosteriorFile:
    """posterior.json: a joint mixture over camera and objects.

    Attributes
    ----------
    method : str
        Display name of the method.
    stamp : float
        Time of the posterior [s].
    poses : list of NamedPose
        One per pose of every component.
    mixture : Mixture
        Joint mixture over all poses.
    """

    method: str
    stamp: float
    poses: list[NamedPose]
    mixture: Mixture[ConcentratedGaussian[SE3]]


def read_posterior(path: Path) -> PosteriorFile:
    """Reads a posterior.json; raises ValueError with the file and the place in it."""
    return PosteriorFile(*_core.read_posterior(os.fspath(path)))


def write_posterior(path: Path, file: PosteriorFile) -> None:
    """Writes a posterior.json; numbers are read back bit by bit."""
    _core.write_posterior(os.fspath(path), file.method, file.stamp, file.poses, file.mixture)
