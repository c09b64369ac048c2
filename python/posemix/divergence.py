# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Divergences between densities or mixtures, and conversions from one kind to the other."""

from __future__ import annotations

import math
from typing import Any, TypeVar

from posemix import _core
from posemix._core import Conversion, ConversionSettings, DivergenceEstimate, DivergenceSamplingSettings
from posemix.density import ConcentratedGaussian, ProjectedGaussian
from posemix.mixture import Mixture, overloaded
from posemix.random import RandomStream, stream_of

__all__ = [
    "Conversion", "DivergenceEstimate", "gaussian_kl", "gaussian_wasserstein", "isd_monte_carlo", "kl_monte_carlo",
    "exact_kl", "mixture_wasserstein", "runnalls_bound", "symmetric_kl_monte_carlo", "to_concentrated", "to_projected",
]  # fmt: skip

D = TypeVar("D", bound="ConcentratedGaussian[Any] | ProjectedGaussian[Any]")


def kl_monte_carlo(
    p: Mixture[Any],
    q: Mixture[Any],
    seed: int | RandomStream,
    settings: DivergenceSamplingSettings | None = None,
) -> DivergenceEstimate:
    """The Kullback-Leibler divergence D(p || q) of two mixtures of any kinds [nats], by sampling.

    The density of a concentrated Gaussian is that within half a turn of its mean: where standard deviations of rotation
    are above about 1 rad it integrates to less than one, and the divergence is wrong by the log of that, and can come
    out negative. The same holds for the other divergences.

    Parameters
    ----------
    p, q : Mixture
        Mixtures on one group.
    seed : int or RandomStream
        Seed of the randomised points.
    settings : DivergenceSamplingSettings, optional
        Number of points.

    Examples
    --------
    >>> import numpy as np
    >>> from posemix import SE3, ConcentratedGaussian, Mixture, kl_monte_carlo
    >>> p = Mixture([ConcentratedGaussian(SE3(), 0.01 * np.eye(6))])
    >>> abs(kl_monte_carlo(p, p, seed=1).value) < 1e-12
    True
    """
    return _core.kl_monte_carlo(p, q, stream_of(seed), settings or DivergenceSamplingSettings())


def symmetric_kl_monte_carlo(
    p: Mixture[Any],
    q: Mixture[Any],
    seed: int | RandomStream,
    settings: DivergenceSamplingSettings | None = None,
) -> DivergenceEstimate:
    """D(p || q) + D(q || p) [nats]; arguments as for `kl_monte_carlo`."""
    return _core.symmetric_kl_monte_carlo(p, q, stream_of(seed), settings or DivergenceSamplingSettings())


def isd_monte_carlo(
    p: Mixture[Any],
    q: Mixture[Any],
    seed: int | RandomStream,
    settings: DivergenceSamplingSettings | None = None,
) -> DivergenceEstimate:
    """The integral of (p - q)^2 over the group; arguments as for `kl_monte_carlo`."""
    return _core.isd_monte_carlo(p, q, stream_of(seed), settings or DivergenceSamplingSettings())


def gaussian_kl(p: D, q: D) -> float:
    """D(p || q) of the Gaussians of two densities in a common tangent space [nats]."""
    return float(overloaded.gaussian_kl(p, q))


def exact_kl(p: ProjectedGaussian[Any], q: ProjectedGaussian[Any]) -> float:
    """D(p || q) of the distributions of two projected Gaussians in a common chart [nats]."""
    return float(_core.exact_kl(p, q))


def runnalls_bound(a: D, weight_a: float, b: D, weight_b: float) -> float:
    """Runnalls' upper bound on the divergence that merging two components causes [nats]."""
    if not (0.0 < weight_a < math.inf and 0.0 < weight_b < math.inf):
        raise ValueError(f"weights are {weight_a} and {weight_b}; expected positive numbers")
    return float(overloaded.runnalls_bound(math.log(weight_a), a, math.log(weight_b), b))


def gaussian_wasserstein(
    p: ConcentratedGaussian[Any], q: ConcentratedGaussian[Any], length_scale: float = 1.0
) -> float:
    """The 2-Wasserstein distance of two Gaussians in a common tangent space [m].

    Parameters
    ----------
    p, q : ConcentratedGaussian
        Densities on one group.
    length_scale : float
        Metres that one radian is weighed as.
    """
    return float(_core.gaussian_wasserstein(p, q, length_scale))


def mixture_wasserstein(
    p: Mixture[ConcentratedGaussian[Any]],
    q: Mixture[ConcentratedGaussian[Any]],
    length_scale: float = 1.0,
) -> float:
    """The MW2 distance: the root of the least cost of moving the components of p to those of q [m]."""
    return float(_core.mixture_wasserstein(p, q, length_scale))


def to_projected(
    mixture: Mixture[ConcentratedGaussian[Any]],
    seed: int | RandomStream,
    settings: ConversionSettings | None = None,
) -> Conversion[ProjectedGaussian[Any]]:
    """Converts a mixture of concentrated Gaussians to one of projected Gaussians."""
    found: Conversion[ProjectedGaussian[Any]] = _core.to_projected(
        mixture, stream_of(seed), settings or ConversionSettings()
    )
    return found


def to_concentrated(
    mixture: Mixture[ProjectedGaussian[Any]],
    seed: int | RandomStream,
    settings: ConversionSettings | None = None,
) -> Conversion[ConcentratedGaussian[Any]]:
    """Converts a mixture of projected Gaussians to one of concentrated Gaussians."""
    found: Conversion[ConcentratedGaussian[Any]] = _core.to_concentrated(
        mixture, stream_of(seed), settings or ConversionSettings()
    )
    return found
