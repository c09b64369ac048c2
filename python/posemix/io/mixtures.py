# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Mixture files and posteriors."""

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
    """What a mixture file holds: a mixture over the pose T_from_to and the names of its frames."""

    from_frame: str
    to_frame: str
    mixture: PoseMixture


def read_mixture(path: Path) -> MixtureFile:
    """A mixture file in any convention that it states.

    Raises
    ------
    ValueError
        Naming the file and the place in it.
    """
    return MixtureFile(*_core.read_mixture(os.fspath(path)))


def write_mixture(
    path: Path,
    mixture: PoseMixture,
    from_frame: str,
    to_frame: str,
    convention: MixtureConvention | None = None,
) -> None:
    """A mixture file.

    Parameters
    ----------
    path : path
        The file.
    mixture : Mixture
        Over poses T_from_to.
    from_frame, to_frame : str
        Names of the frames, 1 to 100 printable characters without blanks.
    convention : MixtureConvention, optional
        How it is stated: as in the library unless given, which reads back bit by bit.

    Raises
    ------
    ValueError
        For a mixture or names that a file cannot hold.
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
        Name of what made it.
    stamp : float
        Its time [s].
    poses : list of NamedPose
        One per pose of every component.
    mixture : Mixture
        Over all poses jointly.
    """

    method: str
    stamp: float
    poses: list[NamedPose]
    mixture: Mixture[ConcentratedGaussian[SE3]]


def read_posterior(path: Path) -> PosteriorFile:
    """A posterior.json; ValueError names the file and the place in it."""
    return PosteriorFile(*_core.read_posterior(os.fspath(path)))


def write_posterior(path: Path, file: PosteriorFile) -> None:
    """A posterior.json; numbers read back bit by bit."""
    _core.write_posterior(os.fspath(path), file.method, file.stamp, file.poses, file.mixture)
