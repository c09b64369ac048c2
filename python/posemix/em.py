# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Mixtures fitted to samples by expectation maximisation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Generic, Literal, TypeVar

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._core import EmSettings, EmStatus
from posemix.density import ConcentratedGaussian, ProjectedGaussian, rows_of
from posemix.lie import SE3, SO3
from posemix.mixture import Mixture
from posemix.random import RandomStream, stream_of

__all__ = ["BicSelection", "EmResult", "fit_mixture", "fit_mixture_by_bic"]

D = TypeVar("D", bound="ConcentratedGaussian[Any] | ProjectedGaussian[Any]")

Distribution = Literal["concentrated", "projected"]


@dataclass(frozen=True)
class EmResult(Generic[D]):
    """A fitted mixture.

    Attributes
    ----------
    mixture : Mixture
        The most likely one that was found.
    log_likelihood : float
        Sum of weight times log density over the samples [nats].
    history : list of float
        Log-likelihood at the start and after every iteration.
    status : EmStatus
        How the run ended.
    parameters : int
        Free parameters.
    bic : float
        Bayesian information criterion; smaller is better.
    starts : int
        Starts that were tried.
    """

    mixture: Mixture[D]
    log_likelihood: float
    history: list[float]
    status: EmStatus
    parameters: int
    bic: float
    starts: int


@dataclass(frozen=True)
class BicSelection(Generic[D]):
    """Fits of 1, 2, ... components, and the index of the one with the smallest BIC."""

    fits: list[EmResult[D]]
    best: int

    @property
    def fit(self) -> EmResult[D]:
        """The best fit."""
        return self.fits[self.best]


def _result(found: Any) -> EmResult[Any]:
    return EmResult(Mixture._of(found[0]), *found[1:])


def _arguments(
    samples: SO3 | SE3, weights: npt.ArrayLike | None, distribution: str, name: str
) -> tuple[Any, list[float]]:
    if distribution not in ("concentrated", "projected"):
        raise ValueError(f"distribution is '{distribution}'; expected 'concentrated' or 'projected'")
    if len(samples.shape) != 1:
        raise ValueError(f"samples have shape {samples.shape}; expected (n,)")
    group = "so3" if isinstance(samples, SO3) else "se3"
    counts = [] if weights is None else np.asarray(weights, dtype=np.float64).tolist()
    return getattr(_core, f"{name}_{distribution}_{group}"), counts


def fit_mixture(
    samples: SO3 | SE3,
    settings: EmSettings,
    seed: int | RandomStream,
    weights: npt.ArrayLike | None = None,
    distribution: Distribution = "concentrated",
    start: Mixture[Any] | None = None,
) -> EmResult[Any]:
    """The most likely mixture that EM finds.

    Parameters
    ----------
    samples : SO3 or SE3, shape (n,)
        Samples.
    settings : EmSettings
        Number of components, bounds, restarts.
    seed : int or RandomStream
        Of the starts.
    weights : array_like, shape (n,), optional
        How often every sample counts.
    distribution : {"concentrated", "projected"}
        Kind of the components.
    start : Mixture, optional
        EM starts there and nowhere else.

    Raises
    ------
    ValueError
        For too few samples, samples or weights that are not finite, settings out of range.

    References
    ----------
    MPG paper, section IV, there with an M-step that does not maximise the likelihood.

    Examples
    --------
    >>> import numpy as np
    >>> from posemix import SE3, ConcentratedGaussian, EmSettings, fit_mixture
    >>> distribution = ConcentratedGaussian(SE3(), np.diag([0.01] * 3 + [1e-4] * 3))
    >>> fit = fit_mixture(distribution.sample(2000, seed=1), EmSettings(components=1), seed=2)
    >>> fit.status
    EmStatus.converged
    """
    function, counts = _arguments(samples, weights, distribution, "fit")
    handle = None if start is None else start._handle
    return _result(function(rows_of(samples), counts, settings, stream_of(seed), handle))


def fit_mixture_by_bic(
    samples: SO3 | SE3,
    settings: EmSettings,
    seed: int | RandomStream,
    weights: npt.ArrayLike | None = None,
    distribution: Distribution = "concentrated",
) -> BicSelection[Any]:
    """Fits of 1 to ``settings.components`` components, and which one the BIC prefers."""
    function, counts = _arguments(samples, weights, distribution, "fit_by_bic")
    fits, best = function(rows_of(samples), counts, settings, stream_of(seed))
    return BicSelection([_result(fit) for fit in fits], best)
