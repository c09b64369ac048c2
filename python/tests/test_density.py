# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Densities: integrals, moments of the samples, operations against numpy."""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from conftest import covariance
from posemix import (
    SE3,
    SO3,
    ConcentratedGaussian,
    FuseSettings,
    ProjectedGaussian,
    back_project,
    between,
    between_arrays,
    compose,
    compose_arrays,
    fuse,
    fuse_arrays,
    inverse,
    inverse_arrays,
    recenter,
)


def uniform_rotations(rng: np.random.Generator, count: int) -> SO3:
    return SO3(rng.normal(size=(count, 4)))


@pytest.mark.parametrize("kind", [ConcentratedGaussian, ProjectedGaussian.at_mean])
def test_a_density_of_rotations_integrates_to_one(kind, rng: np.random.Generator) -> None:
    density = kind(SO3.exp([0.3, -1.0, 0.2]), np.diag([0.1, 0.2, 0.3]))
    values = np.exp(density.log_density(uniform_rotations(rng, 400_000)))
    haar = 8 * np.pi**2
    error = haar * values.std() / np.sqrt(len(values))
    assert haar * values.mean() == pytest.approx(1.0, abs=5 * error)
    assert error < 0.01


def test_log_density_is_the_normal_one_over_the_volume(rng: np.random.Generator) -> None:
    p = covariance(rng, 0.3, 0.05)
    mean = SE3.exp(rng.normal(size=6))
    xi = rng.multivariate_normal(np.zeros(6), p, size=50)
    volume = np.log(np.abs(np.linalg.det(SE3.left_jacobian(xi))))
    expected = multivariate_normal(np.zeros(6), p).logpdf(xi) - volume
    density = ConcentratedGaussian(mean, p)
    np.testing.assert_allclose(density.log_density(SE3.exp(xi) * mean), expected, atol=1e-9)


def test_samples_have_the_moments(rng: np.random.Generator) -> None:
    p = covariance(rng, 0.2, 0.05)
    density = ConcentratedGaussian(SE3.exp(rng.normal(size=6)), p)
    xi = (density.sample(200_000, seed=1) * density.mean.inverse()).log()
    spread = np.sqrt(np.diagonal(p))
    assert np.abs(xi.mean(axis=0) / spread).max() < 0.02
    assert np.abs((np.cov(xi.T) - p) / np.outer(spread, spread)).max() < 0.02
    again = density.sample(5, seed=1)
    assert again.is_approx(density.sample(5, seed=1), 0.0)


def test_a_joint_density_knows_its_parts(rng: np.random.Generator) -> None:
    poses = SE3.exp(rng.normal(size=(3, 6)))
    a = 0.1 * rng.normal(size=(18, 36))
    p = a @ a.T / 36
    joint = ConcentratedGaussian(poses, p)
    assert joint.sample(4, seed=2).shape == (4, 3)
    np.testing.assert_array_equal(joint.marginal(1).covariance, p[6:12, 6:12])
    given = joint.conditional([0], poses[:1])
    gain = p[6:, :6] @ np.linalg.inv(p[:6, :6])
    np.testing.assert_allclose(given.covariance, p[6:, 6:] - gain @ p[:6, 6:], atol=1e-12)
    relative = joint.relative_pose(0, 2)
    assert relative.mean.is_approx(poses[0].inverse() * poses[2], 1e-12)
    difference = p[12:, 12:] + p[:6, :6] - p[12:, :6] - p[:6, 12:]
    ad = poses[0].inverse().adjoint()
    np.testing.assert_allclose(relative.covariance, ad @ difference @ ad.T, atol=1e-12)
    values = joint.log_density(joint.sample(10, seed=3))
    assert values.shape == (10,)


def test_compose_and_inverse_are_first_order_algebra(rng: np.random.Generator) -> None:
    x = ConcentratedGaussian(SE3.exp(rng.normal(size=6)), covariance(rng, 0.1, 0.02))
    y = ConcentratedGaussian(SE3.exp(rng.normal(size=6)), covariance(rng, 0.1, 0.02))
    ad = x.mean.adjoint()
    product = compose(x, y)
    np.testing.assert_allclose(product.covariance, x.covariance + ad @ y.covariance @ ad.T, atol=1e-13)
    assert inverse(inverse(x)).mean.is_approx(x.mean)
    assert between(x, y).mean.is_approx(x.mean.inverse() * y.mean)
    body = x.mean.inverse().adjoint()
    np.testing.assert_allclose(x.body_covariance, body @ x.covariance @ body.T, atol=1e-13)


def test_batches_are_one_density_after_the_other(rng: np.random.Generator) -> None:
    means = SE3.exp(rng.normal(size=(2, 6, 6)))
    p = np.stack([covariance(rng, 0.1, 0.02) for _ in range(12)]).reshape(2, 6, 6, 6)
    mean, cov = compose_arrays(means[0], p[0], means[1], p[1])
    fused_mean, fused_cov, converged = fuse_arrays(means[0], p[0], means[0], p[1])
    assert converged.all()
    once = fuse_arrays(means[0], p[0], means[1], p[1], FuseSettings(max_iterations=1))
    assert not once[2].any()
    with pytest.raises(ValueError, match=r"covariances holds nan at index \(0, 0, 0\)"):
        compose_arrays(means[0], np.full((6, 6, 6), np.nan), means[1], p[1])
    inverse_mean, inverse_cov = inverse_arrays(means[0], p[0])
    between_mean, between_cov = between_arrays(means[0], p[0], means[1], p[1], threads=2)
    for i in range(6):
        x = ConcentratedGaussian(means[0][i], p[0, i])
        y = ConcentratedGaussian(means[1][i], p[1, i])
        one = compose(x, y)
        assert mean[i].is_approx(one.mean, 1e-12)
        np.testing.assert_allclose(cov[i], one.covariance, atol=1e-14)
        fused = fuse(x, ConcentratedGaussian(means[0][i], p[1, i])).density
        assert fused_mean[i].is_approx(fused.mean, 1e-9)
        np.testing.assert_allclose(fused_cov[i], fused.covariance, atol=1e-12)
        np.testing.assert_allclose(inverse_cov[i], inverse(x).covariance, atol=1e-13)
        assert inverse_mean[i].is_approx(inverse(x).mean, 1e-12)
        np.testing.assert_allclose(between_cov[i], between(x, y).covariance, atol=1e-13)
        assert between_mean[i].is_approx(between(x, y).mean, 1e-12)


def test_one_density_is_composed_with_all(rng: np.random.Generator) -> None:
    x = SE3.exp(rng.normal(size=6))
    y = SE3.exp(rng.normal(size=(11, 6)))
    p = covariance(rng, 0.1, 0.02)
    q = np.stack([covariance(rng, 0.1, 0.02) for _ in range(11)])
    left = compose_arrays(x, p, y, q)
    right = compose_arrays(y, q, x, p)
    for i in range(11):
        one = compose(ConcentratedGaussian(x, p), ConcentratedGaussian(y[i], q[i]))
        assert left[0][i].is_approx(one.mean, 1e-12)
        np.testing.assert_allclose(left[1][i], one.covariance, atol=1e-14)
        one = compose(ConcentratedGaussian(y[i], q[i]), ConcentratedGaussian(x, p))
        assert right[0][i].is_approx(one.mean, 1e-12)
        np.testing.assert_allclose(right[1][i], one.covariance, atol=1e-14)


def test_arrays_of_densities_have_one_shape_or_one_is_single(rng: np.random.Generator) -> None:
    def some(*shape: int) -> tuple[SE3, np.ndarray]:
        return SE3.exp(rng.normal(size=(*shape, 6))), np.broadcast_to(0.01 * np.eye(6), (*shape, 6, 6))

    for function in (compose_arrays, between_arrays, fuse_arrays):
        for left, right, expected in [
            ((1,), (6,), (6,)), ((6,), (1,), (6,)), ((), (2, 3), (2, 3)),
            ((1,), (0,), (0,)), ((), (1,), (1,)), ((), (), ()),
        ]:
            result = function(*some(*left), *some(*right))
            assert (result[0].shape, result[1].shape) == (expected, (*expected, 6, 6))
        with pytest.raises(ValueError, match=r"shapes \(2, 3\) and \(3, 2\); expected the same"):
            function(*some(2, 3), *some(3, 2))
        with pytest.raises(ValueError, match=r"shape \(2, 3\) and covariances of shape \(3, 2, 6, 6\); expected"):
            function(some(2, 3)[0], some(3, 2)[1], *some(2, 3))


def test_fusion_is_bayes_rule_for_narrow_densities(rng: np.random.Generator) -> None:
    p, q = covariance(rng, 1e-3, 1e-3), covariance(rng, 1e-3, 1e-3)
    d = 1e-3 * rng.normal(size=6)
    fused = fuse(ConcentratedGaussian(SE3(), p), ConcentratedGaussian(SE3.exp(d), q))
    information = np.linalg.inv(p) + np.linalg.inv(q)
    np.testing.assert_allclose(fused.density.covariance, np.linalg.inv(information), rtol=1e-2, atol=1e-9)
    expected = multivariate_normal(np.zeros(6), p + q).logpdf(d)
    assert fused.converged
    assert fused.log_overlap == pytest.approx(expected, abs=1e-3)


def test_recentring_is_undone(rng: np.random.Generator) -> None:
    density = ConcentratedGaussian(SE3.exp(rng.normal(size=6)), covariance(rng, 0.1, 0.02))
    anchor = SE3.exp(0.5 * rng.normal(size=6)) * density.mean
    mean, cov = recenter(density, anchor)
    np.testing.assert_allclose(mean, (density.mean * anchor.inverse()).log(), atol=1e-12)
    back = back_project(anchor, mean, cov)
    assert back.mean.is_approx(density.mean)
    np.testing.assert_allclose(back.covariance, density.covariance, atol=1e-12)


@pytest.mark.parametrize(
    "bad", [-np.eye(3), np.zeros((3, 3)), [[1, 2, 0], [2, 1, 0], [0, 0, 1]], np.eye(3) + np.eye(3, k=1)]
)
def test_back_projection_refuses_what_is_no_covariance(bad: Any) -> None:
    with pytest.raises(ValueError, match="covariance"):
        back_project(SO3(), [0.1, 0.0, 0.0], bad)


def test_fusion_finds_the_highest_of_several_modes() -> None:
    # Oracle: the mean of p q over 400,000 rotations drawn uniformly by SciPy.
    p = ConcentratedGaussian(SO3(), np.diag(np.radians([60, 40, 10]) ** 2))
    q = ConcentratedGaussian(SO3.exp([0.0, 0.0, -np.pi]), np.diag(np.radians([60, 60, 10]) ** 2))
    fused = fuse(p, q)
    assert fused.converged and abs(fused.log_overlap + 10.5) < 1.2


def test_projected_samples_follow_the_density(rng: np.random.Generator) -> None:
    density = ProjectedGaussian.at_mean(SO3.exp([0.1, 0.2, -0.3]), np.diag([0.3, 0.5, 0.2]))
    rotations = uniform_rotations(rng, 400_000)
    shares = np.exp(density.log_density(rotations))
    expected = np.average(rotations.matrix(), axis=0, weights=shares)
    found = density.sample(200_000, seed=5).matrix().mean(axis=0)
    np.testing.assert_allclose(found, expected, atol=0.02)
    wrong = density.sample_by_projection(200_000, seed=5).matrix().mean(axis=0)
    assert np.abs(wrong - expected).max() > 0.02


def test_copies_and_bad_covariances() -> None:
    density = ConcentratedGaussian(SE3(), np.eye(6))
    assert pickle.loads(pickle.dumps(density)) == density
    projected = ProjectedGaussian(SO3(), [0.1, 0, 0, 1, 2, 3], np.eye(6))
    assert pickle.loads(pickle.dumps(projected)) == projected
    for bad, message in [
        (-np.eye(6), "not positive definite"),
        (np.eye(5), r"shape \(5, 5\); expected \(6, 6\)"),
        (np.full((6, 6), np.nan), "not finite"),
        (np.triu(np.ones((6, 6))), "symmetric"),
    ]:
        with pytest.raises(ValueError, match=message):
            ConcentratedGaussian(SE3(), bad)
