# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Grasps: against closed forms, the oracle of the C++ tests, and numpy."""

from __future__ import annotations

import copy
import math
import pickle

import numpy as np
import posemix as px
import pytest


def logistic(x: np.ndarray | float) -> np.ndarray:
    return 1.0 / (1.0 + np.exp(-np.asarray(x)))


SPREAD = np.array([0.01, 0.02, 0.015, 0.004, 0.006, 0.002])


def test_success_is_a_product_for_independent_coordinates() -> None:
    mixture = px.Mixture([px.ConcentratedGaussian(px.SE3(), np.diag(SPREAD**2))])
    box = px.ToleranceBox(rotation=math.radians(2.0), translation=0.005)
    limits = np.r_[box.rotation, box.translation]
    product = math.prod(math.erf(x / s / math.sqrt(2)) for x, s in zip(limits, SPREAD, strict=True))
    found = px.success_probability(mixture, box, px.SE3(), seed=2)
    assert found.probability == pytest.approx(product, abs=2e-4)
    assert found.error < 1e-3
    assert found.evaluations == 8 * 512


def test_success_agrees_with_counting_draws() -> None:
    here = px.SE3(px.SO3.exp([0.2, -0.4, 1.0]), [0.1, 0.2, 0.6])
    distribution = px.ProjectedGaussian.at_mean(here, np.diag(SPREAD**2))
    box = px.ToleranceBox([0.03, 0.05, 0.02], [0.004, 0.004, 0.004])
    found = px.success_probability(px.Mixture([distribution]), box, here, seed=1)
    inside = here.inverse() * distribution.sample(200_000, seed=2)
    quaternion = inside.rotation.quaternion
    chart = quaternion[:, :3] / quaternion[:, 3:]
    hits = (np.abs(chart) <= np.tan(np.asarray(box.rotation) / 2)).all(axis=1)
    hits &= (np.abs(inside.translation) <= box.translation).all(axis=1)
    assert found.probability == pytest.approx(hits.mean(), abs=4e-3)


def test_best_grasp_finds_the_heavier_peak() -> None:
    far = px.SE3(px.SO3.exp([0, 0, 1.0]), [0.1, 0, 0])
    mixture = px.Mixture(
        [px.ConcentratedGaussian(p, np.diag(SPREAD**2)) for p in (px.SE3(), far)], [0.3, 0.7]
    )
    best = px.best_grasp(mixture, px.ToleranceBox(0.02, 0.004), seed=1)
    assert np.linalg.norm((far.inverse() * best.pose).translation) < 1e-3
    assert len(best.candidates) == 2
    assert best.candidates[0].success.probability >= best.candidates[1].success.probability
    assert best.success.probability == best.candidates[0].success.probability


def test_a_tolerance_of_pi_allows_any_turn() -> None:
    flip = px.SE3(px.SO3.exp([0, 0, math.pi]), [0, 0, 0])
    mixture = px.Mixture([px.ConcentratedGaussian(p, np.diag(SPREAD**2)) for p in (px.SE3(), flip)], [0.7, 0.3])
    almost_all = px.ToleranceBox([2.0, 2.0, math.pi], 1.0)
    found = px.success_probability(mixture, almost_all, px.SE3(), seed=1)
    drawn = mixture.sample(200_000, seed=2).rotation.quaternion
    tilts = np.abs(drawn[:, :2]) <= math.tan(1.0) * np.abs(drawn[:, 3:])
    assert found.probability == pytest.approx(tilts.all(axis=1).mean(), abs=5e-3)
    assert 0.75 < found.probability < 0.99


def test_a_bad_box_is_refused_as_in_cpp() -> None:
    mixture = px.Mixture([px.ConcentratedGaussian(px.SE3(), np.eye(6))])
    with pytest.raises(ValueError, match="pi"):
        px.success_probability(mixture, px.ToleranceBox(3.2, 0.1), px.SE3(), seed=1)
    with pytest.raises(ValueError, match="replicates"):
        settings = px.SuccessSettings(replicates=1)
        px.success_probability(mixture, px.ToleranceBox(1.0, 0.1), px.SE3(), 1, settings)


def region() -> px.ToleranceRegion:
    return px.ToleranceRegion(
        centre=[0.05, 0, 0, 0.001, 0, 0],
        half_width=[0.2, 0.3, 0.25, 0.01, 0.012, 0.02],
        softness=0.2,
        lever=[0.0, 0.03, 0.01],
        success_inside=0.95,
        success_outside=0.02,
    )


def test_region_is_the_product_of_walls() -> None:
    r = region()
    errors = px.SE3.exp(np.random.default_rng(1).normal(size=(50, 6)) * 0.2)
    phi, t = errors.rotation.log(), errors.translation
    x = np.hstack([phi, t + np.cross(phi, r.lever)])
    soft = r.softness * r.half_width
    walls = logistic((x - r.centre + r.half_width) / soft) * logistic(
        (r.centre + r.half_width - x) / soft
    )
    expected = 0.02 + 0.93 * walls.prod(axis=1)
    np.testing.assert_allclose(r.success_probability(errors), expected, rtol=1e-12)


def test_regions_are_values() -> None:
    r = region()
    assert pickle.loads(pickle.dumps(r)) == copy.deepcopy(r) == r
    assert r != px.ToleranceRegion()
    with pytest.raises(ValueError, match=r"ToleranceRegion.centre has shape \(3,\); expected \(6,\)"):
        px.ToleranceRegion(centre=[1, 2, 3])
    r.centre = np.arange(6)
    assert r.centre.tolist() == [0, 1, 2, 3, 4, 5]
    assert "lever=[0, 0.03, 0.01]" in repr(r)


def outcomes(count: int) -> tuple[px.SE3, np.ndarray]:
    rng = np.random.default_rng(3)
    errors = px.SE3.exp(rng.normal(size=(count, 6)) * ([0.25] * 3 + [0.015] * 3))
    return errors, rng.random(count) < region().success_probability(errors)


def test_fitted_region_predicts_what_outcomes_came_from() -> None:
    errors, successes = outcomes(1500)
    fit = px.fit_tolerance_region(errors, successes, seed=1)
    assert (fit.successes, fit.failures) == (successes.sum(), (~successes).sum())
    truth = region().success_probability(errors)
    assert np.abs(fit.region.success_probability(errors) - truth).mean() < 0.05
    assert len(fit.identified) == 6
    again = px.bootstrap_regions(errors[:200], successes[:200], np.arange(200) // 4, 2, seed=1)
    assert len(again) == 2
    with pytest.raises(ValueError, match="1500 errors and 3 successes"):
        px.fit_tolerance_region(errors, [True] * 3, seed=1)


def test_sight_errors_by_numpy() -> None:
    rng = np.random.default_rng(4)
    truth = px.SE3(px.SO3.exp(rng.normal(size=(20, 3))), rng.normal(size=(20, 3)) + [0, 0, 4])
    estimate = px.SE3.exp(0.1 * rng.normal(size=(20, 6))) * truth
    errors = px.sight_error(estimate, truth)
    ray = estimate.translation / np.linalg.norm(estimate.translation, axis=1, keepdims=True)
    moved = estimate.translation - truth.translation
    np.testing.assert_allclose(errors[:, 5], (ray * moved).sum(axis=1), atol=1e-12)
    assert px.truth_with_error(estimate, errors).is_approx(truth, 1e-9)


def error_mixture() -> px.ErrorMixture:
    covariances = np.stack([np.diag(SPREAD**2), np.diag((5 * SPREAD) ** 2)])
    return px.ErrorMixture([0.8, 0.2], np.zeros((2, 6)), covariances)


def test_error_mixture_density_by_numpy() -> None:
    mixture = error_mixture()
    draws = mixture.sample(5000, seed=1)
    density = np.zeros(len(draws))
    for weight, covariance in zip(mixture.weights, mixture.covariances, strict=True):
        squared = np.einsum("ni,ij,nj->n", draws, np.linalg.inv(covariance), draws)
        density += weight * np.exp(-squared / 2) / np.sqrt(np.linalg.det(2 * np.pi * covariance))
    np.testing.assert_allclose(mixture.log_density(draws), np.log(density), rtol=1e-10)
    assert pickle.loads(pickle.dumps(mixture)).weights.tolist() == mixture.weights.tolist()
    fit = px.fit_error_mixture(draws[:1000], seed=1)
    assert fit.components >= 1
    assert (np.diff(fit.history) > -1e-6).all()
    assert np.abs(fit.errors.log_density(draws) - np.log(density)).mean() < 0.3


def test_consensus_of_one_is_its_density() -> None:
    estimate = px.SE3(px.SO3.exp([0.1, 0.2, 0.3]), [0, 0, 0.8])
    consensus = px.fuse_estimates(estimate, error_mixture(), seed=1)
    assert consensus.weights.sum() == pytest.approx(1.0)
    errors = px.sight_error(estimate, consensus.truths)
    mean = (consensus.weights[:, None] * errors).sum(axis=0)
    assert np.abs(mean / SPREAD).max() < 0.5
    few = consensus.resampled(50)
    assert few.effective_draws == pytest.approx(50)
    forgiving = px.ToleranceRegion()
    assert consensus.success_probability(estimate, forgiving) == pytest.approx(1.0)
    both = consensus.success_probability(px.SE3.identity((2,)), [region(), forgiving])
    assert both.shape == (2,)
    with pytest.raises(ValueError, match="correlation"):
        px.fuse_estimates(estimate, error_mixture(), 1, px.ConsensusSettings(correlation=2.0))


def test_scores_by_numpy() -> None:
    rng = np.random.default_rng(5)
    p = rng.random(400)
    won = rng.random(400) < p
    groups = np.arange(400) // 40
    assert px.brier_score(p, won) == pytest.approx(((p - won) ** 2).mean())
    assert px.log_loss(p, won) == pytest.approx(-np.log(np.where(won, p, 1 - p)).mean())
    assert px.accuracy(p, won) == pytest.approx(((p >= 0.5) == won).mean())
    pairs = (groups[:, None] == groups) & won[:, None] & ~won
    right = (p[:, None] > p)[pairs].mean()
    assert px.auc_within_groups(p, won, groups) == pytest.approx(right)
    bins = px.reliability(p, won, 5)
    index = np.minimum((p * 5).astype(int), 4)
    assert [b.count for b in bins] == np.bincount(index, minlength=5).tolist()
    error = sum(b.count * abs(b.success_rate - b.mean_probability) for b in bins) / 400
    assert px.calibration_error(p, won, 5) == pytest.approx(error)
    with pytest.raises(ValueError, match="probability 1 is 1.5"):
        px.brier_score([0.5, 1.5], [True, False])


def test_platt_calibration_undoes_overconfidence() -> None:
    rng = np.random.default_rng(6)
    truth = rng.normal(size=4000)
    won = rng.random(4000) < logistic(truth)
    fit = px.fit_platt(logistic(2.0 * truth), won)
    assert fit.slope == pytest.approx(0.5, abs=0.05)
    assert fit(np.array([[0.5]])).shape == (1, 1)


def test_logistic_regression_is_at_the_mode() -> None:
    rng = np.random.default_rng(7)
    x = rng.normal(size=(500, 2))
    won = rng.random(500) < logistic(x @ [1.5, -0.5] + 0.3)
    settings = px.LogisticSettings(weights_mean=[1.0, 0.0])
    model = px.fit_logistic(x, won, settings)
    residual = won - model.probability(x)
    np.testing.assert_allclose(x.T @ residual, model.weights - [1.0, 0.0], atol=1e-6)
    assert residual.sum() == pytest.approx(model.bias / 9.0, abs=1e-6)
    with pytest.raises(ValueError):
        px.fit_logistic(x, won[:3])


def test_symmetric_errors() -> None:
    half_turn = px.SymmetryGroup.turns([0, 0, 1], 2)
    error = px.SE3(px.SO3.exp([[0, 0, 3.0], [0, 0, 0.2]]))
    angles = px.reduced_error(error, half_turn).rotation.log()[:, 2]
    np.testing.assert_allclose(angles, [3.0 - np.pi, 0.2], atol=1e-12)
    near = px.nearest_equivalent(error, px.SE3(), half_turn)
    np.testing.assert_allclose(near.rotation.log()[:, 2], [3.0 - np.pi, 0.2], atol=1e-12)
