# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""How far apart two densities or mixtures are, and how to turn one kind into the other."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from posemix import _core
from posemix._core import ConversionSettings, DivergenceSamplingSettings
from posemix.density import ConcentratedGaussian, ProjectedGaussian
from posemix.mixture import Mixture
from posemix.random import RandomStream, stream_of

__all__ = [
    "Conversion", "DivergenceEstimate", "gaussian_kl", "gaussian_wasserstein", "isd_monte_carlo", "kl_monte_carlo",
    "exact_kl", "mixture_wasserstein", "runnalls_bound", "symmetric_kl_monte_carlo", "to_concentrated", "to_projected",
]  # fmt: skip

D = TypeVar("D", bound="ConcentratedGaussian[Any] | ProjectedGaussian[Any]")


@dataclass(frozen=True)
class DivergenceEstimate:
    """A sampled divergence.

    Attributes
    ----------
    value : float
        Nats; of the integral square distance rad^-3 m^-3.
    error : float
        One standard error.
    evaluations : int
        Points at which the densities were evaluated.
    """

    value: float
    error: float
    evaluations: int


def _estimate(
    name: str,
    p: Mixture[Any],
    q: Mixture[Any],
    seed: int | RandomStream,
    settings: DivergenceSamplingSettings | None,
) -> DivergenceEstimate:
    function = getattr(_core, name)
    found = function(
        p._handle, q._handle, stream_of(seed), settings or DivergenceSamplingSettings()
    )
    return DivergenceEstimate(*found)


def kl_monte_carlo(
    p: Mixture[Any],
    q: Mixture[Any],
    seed: int | RandomStream,
    settings: DivergenceSamplingSettings | None = None,
) -> DivergenceEstimate:
    """The Kullback-Leibler divergence D(p || q) of two mixtures, of any kinds, by sampling.

    Parameters
    ----------
    p, q : Mixture
        On one group.
    seed : int or RandomStream
        Of the randomised points.
    settings : DivergenceSamplingSettings, optional
        How many points.

    Examples
    --------
    >>> import numpy as np
    >>> from posemix import SE3, ConcentratedGaussian, Mixture, kl_monte_carlo
    >>> p = Mixture([ConcentratedGaussian(SE3(), 0.01 * np.eye(6))])
    >>> abs(kl_monte_carlo(p, p, seed=1).value) < 1e-12
    True
    """
    return _estimate("kl_monte_carlo", p, q, seed, settings)


def symmetric_kl_monte_carlo(
    p: Mixture[Any],
    q: Mixture[Any],
    seed: int | RandomStream,
    settings: DivergenceSamplingSettings | None = None,
) -> DivergenceEstimate:
    """D(p || q) + D(q || p), as `kl_monte_carlo`."""
    return _estimate("symmetric_kl_monte_carlo", p, q, seed, settings)


def isd_monte_carlo(
    p: Mixture[Any],
    q: Mixture[Any],
    seed: int | RandomStream,
    settings: DivergenceSamplingSettings | None = None,
) -> DivergenceEstimate:
    """The integral of (p - q)^2 over the group, as `kl_monte_carlo`."""
    return _estimate("isd_monte_carlo", p, q, seed, settings)


def gaussian_kl(p: D, q: D) -> float:
    """D(p || q) of two densities as of the Gaussians in a common tangent space [nats]."""
    return float(_core.gaussian_kl(p._handle, q._handle))


def exact_kl(p: ProjectedGaussian[Any], q: ProjectedGaussian[Any]) -> float:
    """D(p || q) of two projected Gaussians under their distributions, by cubature [nats]."""
    return float(_core.exact_kl(p._handle, q._handle))


def runnalls_bound(a: D, weight_a: float, b: D, weight_b: float) -> float:
    """Runnalls' upper bound on the divergence that merging two components causes [nats]."""
    if not (weight_a > 0.0 and weight_b > 0.0):
        raise ValueError(f"weights are {weight_a} and {weight_b}; expected positive numbers")
    return float(
        _core.runnalls_bound(math.log(weight_a), a._handle, math.log(weight_b), b._handle)
    )


def gaussian_wasserstein(
    p: ConcentratedGaussian[Any], q: ConcentratedGaussian[Any], length_scale: float = 1.0
) -> float:
    """The 2-Wasserstein distance of two Gaussians in a common tangent space.

    Parameters
    ----------
    p, q : ConcentratedGaussian
        Densities on one group.
    length_scale : float
        Metres that one radian counts as.
    """
    return float(_core.gaussian_wasserstein(p._handle, q._handle, length_scale))


def mixture_wasserstein(
    p: Mixture[ConcentratedGaussian[Any]],
    q: Mixture[ConcentratedGaussian[Any]],
    length_scale: float = 1.0,
) -> float:
    """The MW2 distance: components moved onto each other at the least cost [m]."""
    return float(_core.mixture_wasserstein(p._handle, q._handle, length_scale))


@dataclass(frozen=True)
class Conversion(Generic[D]):
    """A mixture of the other kind.

    Attributes
    ----------
    mixture : Mixture
        The converted mixture.
    kl_lost, kl_error : float
        D(original || converted) and its standard error [nats].
    components_split : int
        Components that became several.
    within_limit : bool
        Whether every component's loss meets the limit.
    """

    mixture: Mixture[D]
    kl_lost: float
    kl_error: float
    components_split: int
    within_limit: bool


def to_projected(
    mixture: Mixture[ConcentratedGaussian[Any]],
    seed: int | RandomStream,
    settings: ConversionSettings | None = None,
) -> Conversion[ProjectedGaussian[Any]]:
    """A mixture of concentrated Gaussians as one of projected Gaussians."""
    handle, *rest = _core.to_projected(
        mixture._handle, stream_of(seed), settings or ConversionSettings()
    )
    return Conversion(Mixture._of(handle), *rest)


def to_concentrated(
    mixture: Mixture[ProjectedGaussian[Any]],
    seed: int | RandomStream,
    settings: ConversionSettings | None = None,
) -> Conversion[ConcentratedGaussian[Any]]:
    """A mixture of projected Gaussians as one of concentrated Gaussians."""
    handle, *rest = _core.to_concentrated(
        mixture._handle, stream_of(seed), settings or ConversionSettings()
    )
    return Conversion(Mixture._of(handle), *rest)
