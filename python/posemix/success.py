# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Grasps under pose uncertainty: the probability of success and the best grasp.

Errors of estimates are poses T_truth^-1 T_estimate.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray, require_finite
from posemix._core import (
    BestGrasp,
    BestGraspSettings,
    GraspCandidate,
    RegionFit,
    RegionFitSettings,
    RegionPriors,
    SuccessEstimate,
    SuccessSettings,
    SymmetryGroup,
    ToleranceRegion,
)
from posemix.density import ConcentratedGaussian, ProjectedGaussian
from posemix.lie import SE3
from posemix.mixture import Mixture
from posemix.random import RandomStream, stream_of

__all__ = [
    "BestGrasp", "BestGraspSettings", "GraspCandidate", "RegionFit", "RegionFitSettings",
    "RegionPriors", "SuccessEstimate", "SuccessSettings", "ToleranceBox", "ToleranceRegion", "best_grasp",
    "bootstrap_regions", "fit_tolerance_region", "nearest_equivalent", "reduced_error", "success_probability",
]  # fmt: skip

PoseMixture = Mixture[ConcentratedGaussian[SE3]] | Mixture[ProjectedGaussian[SE3]]


@dataclass(frozen=True, eq=False)
class ToleranceBox:
    """The box of poses X = (R, t), in the frame of the grasp, that the grasp tolerates.

    It is ``|u_i|`` <= tan(rotation_i / 2), ``|t_i|`` <= translation_i, where R = R(u) in the gnomonic chart at the
    identity.

    Attributes
    ----------
    rotation : array_like, shape (3,) or ()
        Largest rotation about each axis, below pi [rad].
    translation : array_like, shape (3,) or ()
        Largest translation along each axis [m].

    References
    ----------
    MPG paper, section V.
    """

    rotation: npt.ArrayLike
    translation: npt.ArrayLike

    def __post_init__(self) -> None:
        for name in ("rotation", "translation"):
            values = np.asarray(getattr(self, name), dtype=np.float64)
            object.__setattr__(self, name, np.array(np.broadcast_to(values, (3,))))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, ToleranceBox):
            return NotImplemented
        return all(map(np.array_equal, self._sides(), other._sides()))

    __hash__ = None  # type: ignore[assignment]

    def _sides(self) -> tuple[FloatArray, FloatArray]:
        return np.asarray(self.rotation), np.asarray(self.translation)


def success_probability(
    mixture: PoseMixture,
    box: ToleranceBox,
    m: SE3,
    seed: int | RandomStream,
    settings: SuccessSettings | None = None,
) -> SuccessEstimate:
    """An unbiased estimate of the probability that a pose lies in m(B) = {m X : X in B}.

    Parameters
    ----------
    mixture : Mixture
        Mixture over poses, concentrated or projected.
    box : ToleranceBox
        The box B.
    m : SE3
        Frame of the grasp in the reference frame of the mixture.
    seed : int or RandomStream
        Seed of the randomised points.
    settings : SuccessSettings, optional
        Number of points.

    Raises
    ------
    ValueError
        For a box with a side that is not positive or a rotation of pi or more, fewer than 2 replicates, or no points.

    References
    ----------
    MPG paper, section V; Genz, Numerical Computation of Multivariate Normal Probabilities (1992).

    Examples
    --------
    >>> import numpy as np
    >>> from posemix import SE3, ConcentratedGaussian, Mixture, ToleranceBox, success_probability
    >>> mixture = Mixture([ConcentratedGaussian(SE3(), np.diag([0.01] * 3 + [1e-4] * 3))])
    >>> box = ToleranceBox(rotation=1.0, translation=[0.01, 1.0, 1.0])
    >>> round(success_probability(mixture, box, SE3(), seed=1).probability, 3)
    0.683
    """
    rotation, translation = box._sides()
    return _core.success_probability(
        mixture, rotation, translation, m, stream_of(seed), settings or SuccessSettings()
    )


def best_grasp(
    mixture: PoseMixture,
    box: ToleranceBox,
    seed: int | RandomStream,
    settings: BestGraspSettings | None = None,
) -> BestGrasp:
    """The m that maximises the probability that a pose lies in m(B); the search starts at the heaviest modes.

    Parameters
    ----------
    mixture : Mixture
        Mixture over poses.
    box : ToleranceBox
        The box B.
    seed : int or RandomStream
        Seed of the randomised points.
    settings : BestGraspSettings, optional
        Number of starts and of points, stopping criteria.

    Raises
    ------
    ValueError
        As for `success_probability`, and for no starts.
    """
    rotation, translation = box._sides()
    return _core.best_grasp(
        mixture, rotation, translation, stream_of(seed), settings or BestGraspSettings()
    )


def reduced_error(error: SE3, symmetry: SymmetryGroup) -> SE3:
    """Errors T_truth^-1 T_estimate with respect to the equivalent truth that makes the rotation least.

    Parameters
    ----------
    error : SE3, shape (...)
        Errors.
    symmetry : SymmetryGroup
        Symmetries of the object.
    """
    return _core.reduced_error(error, symmetry)


def nearest_equivalent(pose: SE3, reference: SE3, symmetry: SymmetryGroup) -> SE3:
    """The poses equivalent to `pose` whose rotations are nearest to those of `reference`.

    Parameters
    ----------
    pose, reference : SE3, shape (...) or ()
        Poses; a single one is used for all.
    symmetry : SymmetryGroup
        Symmetries of the object.
    """
    return _core.nearest_equivalent(pose, reference, symmetry)


def _outcomes(errors: SE3, successes: npt.ArrayLike) -> tuple[SE3, list[bool]]:
    require_finite(errors._data, "errors")
    return errors, np.asarray(successes, dtype=bool).reshape(-1).tolist()


def fit_tolerance_region(
    errors: SE3,
    successes: npt.ArrayLike,
    seed: int | RandomStream,
    settings: RegionFitSettings | None = None,
) -> RegionFit:
    """The maximum a posteriori region of errors that a grasp tolerates, given outcomes.

    Parameters
    ----------
    errors : SE3, shape (n,)
        T_truth^-1 T_estimate of the estimates that the grasps were planned with.
    successes : array_like of bool, shape (n,)
        Outcomes of the grasps.
    seed : int or RandomStream
        Seed of the starts.
    settings : RegionFitSettings, optional
        Priors, number of starts, limits of the search.

    Raises
    ------
    ValueError
        For numbers of errors and outcomes that differ, and when there is no start.
    """
    return _core.fit_tolerance_region(
        *_outcomes(errors, successes), settings or RegionFitSettings(), stream_of(seed)
    )


def bootstrap_regions(
    errors: SE3,
    successes: npt.ArrayLike,
    groups: npt.ArrayLike,
    count: int,
    seed: int | RandomStream,
    settings: RegionFitSettings | None = None,
) -> list[ToleranceRegion]:
    """Regions fitted to bootstrap samples of the outcomes, drawn by whole groups.

    Parameters
    ----------
    errors, successes, seed, settings
        As for `fit_tolerance_region`.
    groups : array_like of int, shape (n,)
        Groups of dependent outcomes, such as those of one image.
    count : int
        Number of regions.

    Raises
    ------
    ValueError
        As for `fit_tolerance_region`.
    """
    members: list[Any] = np.asarray(groups, dtype=np.intp).reshape(-1).tolist()
    chosen = settings or RegionFitSettings()
    arguments = _outcomes(errors, successes)
    return list(_core.bootstrap_regions(*arguments, members, count, chosen, stream_of(seed)))
