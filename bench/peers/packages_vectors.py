# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Gaussians and mixtures on R^6: scikit-learn, FilterPy, Stone Soup and PyRecEst, which have none on SE(3)."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
from packages_lie import Array, Job, numbers, pairs

ITERATIONS = 5
FIRST, SECOND = 0.3, 0.7  # the weights of two Gaussians that are merged


def sklearn_jobs(folder: Path) -> dict[str, Job]:
    from sklearn.mixture import GaussianMixture

    samples = numbers(folder, "em_samples", -1, 6)
    means = numbers(folder, "em_means", -1, 6)
    count = len(means)

    def start(precisions: Array) -> GaussianMixture:
        return GaussianMixture(
            count, max_iter=ITERATIONS, tol=0.0, reg_covar=0.0, weights_init=np.full(count, 1 / count),
            means_init=means, precisions_init=precisions,
        )  # fmt: skip

    def fit() -> GaussianMixture:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # it has not converged, as was meant
            return start(np.tile(np.eye(6) / 0.04, (count, 1, 1))).fit(samples)

    def found(mixture: GaussianMixture) -> Array:
        covariances = mixture.covariances_.reshape(count, 36)
        return np.concatenate([mixture.weights_[:, None], mixture.means_, covariances], 1)

    given = start(np.linalg.inv(numbers(folder, "em_covariances", -1, 6, 6)))
    given.weights_, given.means_ = given.weights_init, means
    given.precisions_cholesky_ = np.linalg.cholesky(given.precisions_init)
    return {
        "em": (fit, found, ITERATIONS),
        "log_density_vectors": (lambda: given.score_samples(samples), np.asarray, len(samples)),
    }


def gaussians(folder: Path) -> tuple[Array, Array]:
    return numbers(folder, "tangents", -1, 6), numbers(folder, "covariances", -1, 6, 6)


def filterpy_jobs(folder: Path) -> dict[str, Job]:
    from filterpy.stats import multivariate_multiply

    x, p = gaussians(folder)

    def fused() -> list[Any]:
        return [multivariate_multiply(x[i], p[i], x[-1 - i], p[-1 - i]) for i in range(len(x))]

    return {"fuse_vectors": (fused, pairs, len(x))}


def stonesoup_jobs(folder: Path) -> dict[str, Job]:
    from stonesoup.mixturereducer.gaussianmixture import GaussianMixtureReducer
    from stonesoup.types.state import WeightedGaussianState

    x, p = gaussians(folder)
    first = [WeightedGaussianState(mean, covariance, weight=FIRST) for mean, covariance in zip(x, p, strict=True)]
    second = [WeightedGaussianState(mean, covariance, weight=SECOND) for mean, covariance in zip(x, p, strict=True)]
    reducer = GaussianMixtureReducer()

    def merged() -> list[Any]:
        return [reducer.merge_components(a, b) for a, b in zip(first, second[::-1], strict=True)]

    def found(states: list[Any]) -> Array:
        return pairs([(state.mean, state.covar) for state in states])

    return {"merge_vectors": (merged, found, len(x))}


def pyrecest_jobs(folder: Path) -> dict[str, Job]:
    from pyrecest.distributions import GaussianDistribution, GaussianMixture

    x, p = gaussians(folder)
    samples = numbers(folder, "em_samples", -1, 6)
    means, covariances = numbers(folder, "em_means", -1, 6), numbers(folder, "em_covariances", -1, 6, 6)
    one = [GaussianDistribution(mean, covariance) for mean, covariance in zip(x, p, strict=True)]
    weights = np.array([FIRST, SECOND])
    mixture = GaussianMixture(
        [GaussianDistribution(mean, covariance) for mean, covariance in zip(means, covariances, strict=True)],
        np.full(len(means), 1 / len(means)),
    )

    def fused() -> list[Any]:
        return [a.multiply(b) for a, b in zip(one, one[::-1], strict=True)]

    def merged() -> list[Any]:
        return [GaussianMixture([a, b], weights).to_gaussian() for a, b in zip(one, one[::-1], strict=True)]

    def found(gaussian: list[Any]) -> Array:
        return pairs([(g.mu, g.C) for g in gaussian])

    return {
        "fuse_vectors": (fused, found, len(x)),
        "merge_vectors": (merged, found, len(x)),
        "log_density_vectors": (lambda: np.log(mixture.pdf(samples)), np.asarray, len(samples)),
    }
