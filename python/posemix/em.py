# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Mixtures fitted to samples by expectation maximisation."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray, real_numbers
from posemix._core import BicSelection, EmResult, EmSettings
from posemix._elements import Elements
from posemix.density import rows_of
from posemix.lie import SE3, SO3
from posemix.mixture import Mixture
from posemix.random import RandomStream, stream_of

__all__ = ["BicSelection", "EmResult", "fit_mixture", "fit_mixture_by_bic"]

Distribution = Literal["concentrated", "projected"]


def _arguments(
    samples: SO3 | SE3, weights: npt.ArrayLike | None, distribution: str
) -> tuple[FloatArray, bool, list[float]]:
    if distribution not in ("concentrated", "projected"):
        raise ValueError(f"distribution is '{distribution}'; expected 'concentrated' or 'projected'")
    if len(Elements._checked(samples, "samples").shape) != 1:
        raise ValueError(f"samples have shape {samples.shape}; expected (n,)")
    counts = np.empty(0) if weights is None else real_numbers(weights, "weights")
    if weights is not None and counts.shape != samples.shape:
        raise ValueError(f"weights has shape {counts.shape}; expected {samples.shape}")
    return rows_of(samples), distribution == "projected", counts.tolist()


def fit_mixture(
    samples: SO3 | SE3,
    settings: EmSettings,
    seed: int | RandomStream,
    weights: npt.ArrayLike | None = None,
    distribution: Distribution = "concentrated",
    start: Mixture[Any] | None = None,
) -> EmResult[Any]:
    """The mixture of largest likelihood that EM finds.

    Parameters
    ----------
    samples : SO3 or SE3, shape (n,)
        Samples.
    settings : EmSettings
        Number of components, bounds, restarts.
    seed : int or RandomStream
        Seed of the starts.
    weights : array_like, shape (n,), optional
        Weight of every sample; all one unless given.
    distribution : {"concentrated", "projected"}
        Kind of the components.
    start : Mixture, optional
        The only start of EM; found from the samples unless given.

    Raises
    ------
    ValueError
        For too few samples, samples or weights that are not finite, settings out of range.

    References
    ----------
    MPG paper, section IV, whose M-step does not maximise the likelihood.

    Examples
    --------
    >>> import numpy as np
    >>> from posemix import SE3, ConcentratedGaussian, EmSettings, fit_mixture
    >>> distribution = ConcentratedGaussian(SE3(), np.diag([0.01] * 3 + [1e-4] * 3))
    >>> fit = fit_mixture(distribution.sample(2000, seed=1), EmSettings(components=1), seed=2)
    >>> fit.status
    EmStatus.converged
    """
    arguments = _arguments(samples, weights, distribution)
    return _core.fit_mixture(*arguments, settings, stream_of(seed), start)


def fit_mixture_by_bic(
    samples: SO3 | SE3,
    settings: EmSettings,
    seed: int | RandomStream,
    weights: npt.ArrayLike | None = None,
    distribution: Distribution = "concentrated",
) -> BicSelection[Any]:
    """Fits of 1 to ``settings.components`` components, and the one with the smallest BIC."""
    arguments = _arguments(samples, weights, distribution)
    return _core.fit_mixture_by_bic(*arguments, settings, stream_of(seed))
