# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Mixtures: weights, densities, fusion, reduction, divergences, EM."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import pytest
from scipy.special import logsumexp

from conftest import two_modes
from posemix import (
    SE3,
    SO3,
    ConcentratedGaussian,
    ConversionSettings,
    EmSettings,
    EmStatus,
    MergeRule,
    MergeSettings,
    Mixture,
    ProjectedGaussian,
    RandomStream,
    ReductionSettings,
    compose,
    fit_mixture,
    fit_mixture_by_bic,
    fuse,
    gaussian_kl,
    inverse,
    isd_monte_carlo,
    kl_monte_carlo,
    merge,
    mixture_wasserstein,
    moments,
    reduce,
    symmetric_kl_monte_carlo,
    to_concentrated,
    to_projected,
)


def test_density_is_the_weighted_sum() -> None:
    mixture = two_modes()
    points = mixture.sample(100, seed=1)
    logs = np.stack([d.log_density(points) for d in mixture], axis=1) + mixture.log_weights
    np.testing.assert_allclose(mixture.log_density(points), logsumexp(logs, axis=1), atol=1e-12)
    shares = mixture.responsibilities(points)
    np.testing.assert_allclose(shares, np.exp(logs - logsumexp(logs, axis=1)[:, None]), atol=1e-12)
    angles = points.rotation.angle()
    assert np.mean(angles < 1.5) == pytest.approx(0.7, abs=0.15)


def test_weights_are_normalised_and_checked() -> None:
    density = ConcentratedGaussian(SE3(), np.eye(6))
    assert Mixture([density, density], [2, 6]).weights == pytest.approx([0.25, 0.75])
    assert Mixture([density], log_weights=[-900.0]).weights == pytest.approx([1.0])
    with pytest.raises(ValueError, match="weight 1 is -1.0"):
        Mixture([density, density], [1.0, -1.0])
    with pytest.raises(ValueError, match="1 weights for 2 components"):
        Mixture([density, density], [1.0])
    with pytest.raises(ValueError, match="at least one component"):
        Mixture([])
    with pytest.raises(ValueError, match="different kinds"):
        Mixture([density, ConcentratedGaussian(SO3(), np.eye(3))])
    with pytest.raises(IndexError):
        Mixture([density])[1]


def test_copies_are_equal() -> None:
    mixture = two_modes()
    assert pickle.loads(pickle.dumps(mixture)) == mixture
    assert copy.deepcopy(mixture) == mixture
    assert "0.7000" in repr(mixture) and "<table>" in mixture._repr_html_()


def test_fusing_two_modes_with_one_keeps_that_one() -> None:
    mixture = two_modes()
    sharp = Mixture([ConcentratedGaussian(SE3(), 1e-3 * np.eye(6))])
    fused = fuse(mixture, sharp)
    assert fused.density.weights.max() > 0.999
    assert fused.log_overlap < 20.0


def test_composition_takes_all_pairs() -> None:
    mixture = two_modes()
    product = compose(mixture, inverse(mixture))
    assert len(product) == 4
    np.testing.assert_allclose(sorted(product.weights), sorted([0.49, 0.21, 0.21, 0.09]), atol=1e-12)


@pytest.mark.parametrize("rule", list(MergeRule))
def test_a_merge_matches_the_moments_of_samples(rule: MergeRule) -> None:
    mixture = two_modes(0.3)
    one = merge(list(mixture), mixture.weights, MergeSettings(rule=rule)).density
    xi = (mixture.sample(200_000, seed=3) * one.mean.inverse()).log()
    spread = np.sqrt(np.diagonal(one.covariance))
    assert np.abs(xi.mean(axis=0) / spread).max() < 0.02
    assert np.abs((np.cov(xi.T) - one.covariance) / np.outer(spread, spread)).max() < 0.03
    whole = moments(mixture)
    assert whole.converged and whole.density.mean.is_approx(one.mean, 0.02)


def test_reduction_reports_what_it_did() -> None:
    mixture = two_modes()
    near = [ConcentratedGaussian(SE3.exp(0.01 * np.ones(6)) * d.mean, d.covariance) for d in mixture]
    four = Mixture([*mixture, *near], [0.4, 0.3, 0.2, 0.1])
    result = reduce(four, ReductionSettings(max_components=2, bound_loss=True))
    assert result.report.components_before == 4 and len(result.mixture) == 2
    assert len(result.report.merges) == 2 and len(result.report.destination) == 4
    assert result.report.bounded_loss is not None
    with pytest.raises(ValueError, match="max_components is 0"):
        reduce(four, ReductionSettings(max_components=0))


def test_divergences_agree_with_closed_forms() -> None:
    a = ConcentratedGaussian(SE3(), 1e-4 * np.eye(6))
    b = ConcentratedGaussian(SE3.exp([0.01, 0, 0, 0, 0.01, 0]), 2e-4 * np.eye(6))
    p, q = Mixture([a]), Mixture([b])
    expected = 0.5 * (6 * 0.5 + 2e-4 / 2e-4 - 6 + 6 * np.log(2))
    assert gaussian_kl(a, b) == pytest.approx(expected, rel=1e-3)
    sampled = kl_monte_carlo(p, q, seed=1)
    assert sampled.value == pytest.approx(expected, abs=5 * sampled.error + 1e-3)
    both = symmetric_kl_monte_carlo(p, q, seed=1)
    assert both.value == pytest.approx(gaussian_kl(a, b) + gaussian_kl(b, a), rel=0.01)
    assert isd_monte_carlo(p, q, seed=1).value > 0
    distance = np.sqrt(2e-4 + 6 * (np.sqrt(2e-4) - np.sqrt(1e-4)) ** 2)
    assert mixture_wasserstein(p, q) == pytest.approx(distance, rel=1e-3)


def test_converting_there_and_back_loses_little() -> None:
    mixture = two_modes()
    there = to_projected(mixture, seed=1)
    assert isinstance(there.mixture[0], ProjectedGaussian) and there.within_limit
    back = to_concentrated(there.mixture, seed=2, settings=ConversionSettings())
    assert kl_monte_carlo(mixture, back.mixture, seed=3).value < 0.02


@pytest.mark.parametrize("distribution", ["concentrated", "projected"])
def test_em_finds_two_modes(distribution: str) -> None:
    mixture = two_modes()
    settings = EmSettings(components=2, restarts=3)
    fit = fit_mixture(mixture.sample(4000, seed=1), settings, seed=2, distribution=distribution)
    assert fit.status == EmStatus.converged
    assert sorted(fit.mixture.weights) == pytest.approx([0.3, 0.7], abs=0.03)
    assert np.all(np.diff(fit.history) > -1e-6)
    samples = mixture.sample(1500, seed=4)
    chosen = fit_mixture_by_bic(samples, EmSettings(components=3), seed=5, distribution=distribution)
    assert len(chosen.fit.mixture) == 2


def test_em_refuses_bad_samples() -> None:
    with pytest.raises(ValueError, match="samples have shape"):
        fit_mixture(SE3(), EmSettings(), seed=1)
    with pytest.raises(ValueError, match="expected 'concentrated' or 'projected'"):
        fit_mixture(SE3.identity(20), EmSettings(), seed=1, distribution="normal")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="component"):
        fit_mixture(SE3.identity(3), EmSettings(), seed=1)


def test_a_stream_goes_on_and_can_be_kept() -> None:
    mixture = two_modes()
    stream = RandomStream(7)
    first = mixture.sample(3, stream)
    kept = pickle.loads(pickle.dumps(stream))
    second = mixture.sample(3, stream)
    assert not first.is_approx(second)
    assert second.is_approx(mixture.sample(3, kept), 0.0)
