# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Mixtures: weights, densities, fusion, reduction, divergences, EM."""

from __future__ import annotations

import copy
import pickle
from typing import Any

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
    gaussian_wasserstein,
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
    with pytest.raises(ValueError, match=r"log_weights has shape \(1, 2\); expected \(2,\)"):
        Mixture([density, density], log_weights=[[0.0, 0.0]])


def test_components_are_indexed_as_in_a_list() -> None:
    mixture = two_modes()
    assert mixture[-1] == mixture[1] and mixture[np.int64(-2)] == mixture[0]
    for index in (2, -3):
        with pytest.raises(IndexError, match=f"index is {index}; expected -2 to 1 for a mixture of 2"):
            mixture[index]
    with pytest.raises(TypeError, match="index is a float; expected a whole number"):
        mixture[0.5]  # type: ignore[index]


def joint_pair() -> tuple[Mixture, Mixture]:
    """A mixture over one pose, and the same as a joint mixture over (1,) poses."""
    single = two_modes()
    stacks = [
        ConcentratedGaussian(SE3.from_tq(density.mean.to_tq()[None]), density.covariance) for density in single
    ]
    return single, Mixture(stacks, single.weights)


def test_a_joint_mixture_over_one_pose_is_the_mixture_over_that_pose() -> None:
    single, joint = joint_pair()
    points = single.sample(50, seed=3)
    drawn = joint.sample(50, seed=3)
    assert drawn.shape == (50, 1) and drawn[:, 0].is_approx(points, 1e-12)
    np.testing.assert_allclose(joint.log_density(drawn), single.log_density(points), atol=1e-9)
    np.testing.assert_allclose(joint.responsibilities(drawn), single.responsibilities(points), atol=1e-12)
    assert joint.log_density(drawn[0]).shape == () and joint.responsibilities(drawn[0]).shape == (2,)
    stream = RandomStream(3)
    joint.sample(20, stream)
    assert joint.sample(30, stream).is_approx(drawn[20:], 0.0)


def test_a_joint_mixture_sums_what_its_components_say() -> None:
    near = ConcentratedGaussian(SE3.identity(2), 0.01 * np.eye(12))
    far = ConcentratedGaussian(SE3(translation=[[1.0, 0, 0], [0, 1.0, 0]]), 0.02 * np.eye(12))
    mixture = Mixture([near, far], [0.3, 0.7])
    points = mixture.sample(400, seed=1)
    terms = np.stack([near.log_density(points), far.log_density(points)], axis=1) + np.log([0.3, 0.7])
    np.testing.assert_allclose(mixture.log_density(points), logsumexp(terms, axis=1), atol=1e-12)
    shares = mixture.responsibilities(points)
    np.testing.assert_allclose(shares, np.exp(terms - logsumexp(terms, axis=1, keepdims=True)), atol=1e-12)
    # Within 4 standard errors of a share of 0.7 among 400.
    assert shares[:, 1].mean() == pytest.approx(0.7, abs=4 * np.sqrt(0.21 / 400))
    assert Mixture([near, far], [1.0, 0.0]).responsibilities(points[0]).tolist() == [1.0, 0.0]
    with pytest.raises(ValueError, match=r"points have shape \(\); expected \(..., 2\)"):
        mixture.log_density(SE3())
    with pytest.raises(ValueError, match="densities of one element; expected joint densities"):
        two_modes().marginal(0)


@pytest.mark.filterwarnings("error")
def test_no_component_is_responsible_where_all_densities_are_zero() -> None:
    gaussian = ConcentratedGaussian(SE3(), 0.01 * np.eye(6))
    points = SE3(translation=[[0, 0, 0], [1e200, 0, 0]])
    shares = Mixture([gaussian, gaussian]).responsibilities(points)
    assert shares[0].tolist() == [0.5, 0.5] and np.isnan(shares[1]).all()
    # The cut of projected Gaussians, half a turn from the mean.
    modes = [ProjectedGaussian.at_mean(SO3(), 0.01 * np.eye(3))] * 2
    assert np.isnan(Mixture(modes).responsibilities(SO3([1, 0, 0, 0]))).all()
    stack = ConcentratedGaussian(SE3.identity(1), 0.01 * np.eye(6))
    assert np.isnan(Mixture([stack, stack]).responsibilities(points[1:])).all()
    assert Mixture([stack, stack]).log_density(points[1:]) == -np.inf


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


def test_divergences_of_joint_densities_of_independent_poses_are_sums() -> None:
    first = ConcentratedGaussian(SE3(), 1e-4 * np.eye(6))
    second = ConcentratedGaussian(SE3.exp([0.01, 0, 0, 0, 0.01, 0]), 2e-4 * np.eye(6))

    def joint(a: ConcentratedGaussian[SE3], b: ConcentratedGaussian[SE3]) -> ConcentratedGaussian[Any]:
        covariance = np.zeros((12, 12))
        covariance[:6, :6], covariance[6:, 6:] = a.covariance, b.covariance
        return ConcentratedGaussian(SE3.from_tq(np.stack([a.mean.to_tq(), b.mean.to_tq()])), covariance)

    p, q = joint(first, second), joint(second, first)
    assert gaussian_kl(p, q) == pytest.approx(gaussian_kl(first, second) + gaussian_kl(second, first), rel=1e-12)
    distance = gaussian_wasserstein(first, second)
    assert gaussian_wasserstein(p, q) == pytest.approx(np.sqrt(2) * distance, rel=1e-9)
    assert mixture_wasserstein(Mixture([p]), Mixture([q])) == pytest.approx(np.sqrt(2) * distance, rel=1e-9)
    sampled = kl_monte_carlo(Mixture([p]), Mixture([q]), seed=1)
    assert sampled.value == pytest.approx(gaussian_kl(p, q), abs=5 * sampled.error + 1e-3)
    both = symmetric_kl_monte_carlo(Mixture([p]), Mixture([q]), seed=1)
    assert both.value == pytest.approx(2 * sampled.value, rel=0.05)
    of_one = ConcentratedGaussian(SE3.from_tq(first.mean.to_tq()[None]), first.covariance)
    with pytest.raises(ValueError, match="12 and 6 degrees of freedom"):
        kl_monte_carlo(Mixture([p]), Mixture([of_one]), seed=1)


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


@pytest.mark.parametrize("bounds", [{"max_sd": 0.5}, {"min_sd": 0.2}, {"diagonal": True}])
@pytest.mark.parametrize("distribution", ["concentrated", "projected"])
def test_a_start_beyond_the_bounds_of_em_is_put_within(bounds: dict[str, Any], distribution: str) -> None:
    cov = 0.01 * np.eye(6)
    cov[0, 1] = cov[1, 0] = 0.009
    cov[5, 5] = 1.0
    start: Any = Mixture([ConcentratedGaussian(SE3(), cov)])
    samples = start.sample(1000, seed=1)
    if distribution == "projected":
        start = Mixture([ProjectedGaussian.at_mean(SE3(), cov)])
    fit = fit_mixture(samples, EmSettings(components=1, **bounds), seed=1, start=start, distribution=distribution)
    found = fit.mixture.covariances[0]
    # Those of projected Gaussians are of half the rotation vector, and of the translation given it.
    scale = np.ones(6) if distribution == "concentrated" else np.array([2.0] * 3 + [1.0] * 3)
    deviations = np.sqrt(np.linalg.eigvalsh(found * np.outer(scale, scale)))
    assert deviations.max() < bounds.get("max_sd", np.inf) * 1.1
    assert deviations.min() > bounds.get("min_sd", 0.0) * 0.9
    if bounds.get("diagonal"):
        np.testing.assert_allclose(found, np.diag(np.diag(found)), atol=1e-12)


def test_em_refuses_bad_samples() -> None:
    with pytest.raises(ValueError, match="samples have shape"):
        fit_mixture(SE3(), EmSettings(), seed=1)
    with pytest.raises(ValueError, match="expected 'concentrated' or 'projected'"):
        fit_mixture(SE3.identity(20), EmSettings(), seed=1, distribution="normal")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="component"):
        fit_mixture(SE3.identity(3), EmSettings(), seed=1)
    for weights, shape in (([], r"\(0,\)"), (np.ones((20, 1)), r"\(20, 1\)"), (1.0, r"\(\)")):
        for fit in (fit_mixture, fit_mixture_by_bic):
            with pytest.raises(ValueError, match=rf"weights has shape {shape}; expected \(20,\)"):
                fit(SE3.identity(20), EmSettings(), seed=1, weights=weights)


def test_a_stream_goes_on_and_can_be_kept() -> None:
    mixture = two_modes()
    stream = RandomStream(7)
    first = mixture.sample(3, stream)
    kept = pickle.loads(pickle.dumps(stream))
    second = mixture.sample(3, stream)
    assert not first.is_approx(second)
    assert second.is_approx(mixture.sample(3, kept), 0.0)
