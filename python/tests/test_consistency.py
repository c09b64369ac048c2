# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Consistency of series of poses, against numpy and scipy."""

from __future__ import annotations

import re

import numpy as np
import posemix as px
import pytest
from scipy import linalg, stats

P = np.diag([4e-4, 9e-4, 1e-4, 2.5e-5, 1e-4, 4e-4])
P[0, 4] = P[4, 0] = 1e-4
P[1, 2] = P[2, 1] = -1e-4


def series(frames: int, seed: int, scale: float = 1.0) -> tuple[px.SE3, np.ndarray, px.SE3]:
    """Estimates whose left errors are drawn from P, with P times `scale` as their covariance, and the truth."""
    errors = np.random.default_rng(seed).multivariate_normal(np.zeros(6), P, frames)
    steps = np.arange(frames)
    truth = px.SE3.exp(np.outer(steps, [0.01, 0.0, 0.02, 0.01, 0.0, 0.0]))
    return px.SE3.exp(-errors) * truth, np.tile(scale * P, (frames, 1, 1)), truth


def left_errors(estimates: px.SE3, truth: px.SE3) -> np.ndarray:
    """Log(T_true T_est^-1) by matrix logarithms of scipy."""
    matrices = truth.matrix() @ np.linalg.inv(estimates.matrix())
    logs = np.array([np.real(linalg.logm(m)) for m in matrices])
    return np.stack([logs[:, 2, 1], logs[:, 0, 2], logs[:, 1, 0], *logs[:, :3, 3].T], axis=1)


def test_nees_bands_and_coverage_are_those_of_scipy() -> None:
    estimates, covariances, truth = series(60, 1)
    report = px.consistency(estimates, covariances, truth)
    e = left_errors(estimates, truth)
    nees = np.einsum("ni,ij,nj->n", e, np.linalg.inv(P), e)
    np.testing.assert_allclose([f.nees for f in report.frames], nees, rtol=1e-8)
    turned = np.einsum("ni,ij,nj->n", e[:, :3], np.linalg.inv(P[:3, :3]), e[:, :3])
    np.testing.assert_allclose([f.rotation_nees for f in report.frames], turned, rtol=1e-8)
    assert report.pose.anees == pytest.approx(nees.mean() / 6, rel=1e-9)
    assert report.pose.median == pytest.approx(np.median(nees) / 6, rel=1e-9)
    assert report.pose.worst_stamp_s == np.argmax(nees)
    chi2 = stats.chi2(6)
    band = report.pose.frame_band
    np.testing.assert_allclose([band.low, band.high], chi2.ppf([0.025, 0.975]) / 6, rtol=1e-9)
    everything = stats.chi2(360).ppf([0.025, 0.975]) / 360
    band = report.pose.independent_band
    np.testing.assert_allclose([band.low, band.high], everything, rtol=1e-9)
    inside = (nees / 6 >= chi2.ppf(0.025) / 6) & (nees / 6 <= chi2.ppf(0.975) / 6)
    assert report.pose.within_frame_band == pytest.approx(inside.mean())
    np.testing.assert_allclose(report.pose.coverage.nominal, chi2.cdf([1, 4, 9]), rtol=1e-9)
    shares = [(nees <= k * k).mean() for k in (1, 2, 3)]
    np.testing.assert_allclose(report.pose.coverage.shares, shares)
    assert "ANEES" in repr(report)


def test_position_is_that_of_the_body_and_directions_solve_the_eigenproblem() -> None:
    estimates, covariances, truth = series(40, 2)
    report = px.consistency(estimates, covariances, truth, axes=px.ErrorAxes.reference)
    # At the body along the axes of the world: the error of the position itself, to first order.
    adjoints = (px.SE3(translation=estimates.translation).inverse()).adjoint()
    e = np.einsum("nij,nj->ni", adjoints, left_errors(estimates, truth))
    moved = adjoints @ covariances @ adjoints.transpose(0, 2, 1)
    by_axis = {axis.axis: axis for axis in report.axes}
    for i, name in enumerate(("rotation x", "rotation y", "rotation z", "position x", "position y", "position z")):
        normalized = e[:, i] / np.sqrt(moved[:, i, i])
        assert by_axis[name].mean_error == pytest.approx(e[:, i].mean(), rel=1e-6, abs=1e-12)
        assert by_axis[name].normalized_rms == pytest.approx(np.sqrt((normalized**2).mean()), rel=1e-6)
    ratios = linalg.eigh(e.T @ e, moved.sum(axis=0), eigvals_only=True)
    assert report.most_overconfident.ratio == pytest.approx(ratios[-1], rel=1e-6)
    assert report.most_cautious.ratio == pytest.approx(ratios[0], rel=1e-6)
    assert np.abs(report.most_cautious.correlation).max() <= 1 + 1e-9


def test_a_factor_on_the_covariance_is_found() -> None:
    consistent = px.consistency(*series(800, 3))
    assert consistent.verdict is px.ConsistencyVerdict.consistent
    assert consistent.pose.interval.low < 1 < consistent.pose.interval.high
    cautious = px.consistency(*series(800, 3, 4.0))
    assert cautious.verdict is px.ConsistencyVerdict.cautious
    assert cautious.pose.anees == pytest.approx(consistent.pose.anees / 4, rel=1e-9)
    assert px.consistency(*series(800, 3, 0.25)).verdict is px.ConsistencyVerdict.overconfident


def test_correlated_errors_have_fewer_effective_frames() -> None:
    rng = np.random.default_rng(4)
    z = np.empty((2000, 6))
    z[0] = rng.normal(size=6)
    for k in range(1, len(z)):
        z[k] = 0.95 * z[k - 1] + np.sqrt(1 - 0.95**2) * rng.normal(size=6)
    truth = px.SE3.identity(len(z))
    report = px.consistency(px.SE3.exp(0.01 * z), np.tile(1e-4 * np.eye(6), (len(z), 1, 1)), truth)
    keep = 0.95**2
    expected = len(z) * (1 - keep) / (1 + keep)
    assert 0.5 * expected < report.pose.effective_frames < 1.6 * expected
    assert report.pose.interval.low < 1 < report.pose.interval.high


def test_symmetries_leave_the_turn_out() -> None:
    estimates, covariances, truth = series(500, 5)
    turns = np.random.default_rng(6).uniform(-3, 3, 500)
    turned = truth * px.SE3(px.SO3.exp(np.outer(turns, [0, 0, 1])))
    report = px.consistency(estimates, covariances, turned, symmetries=px.SymmetryGroup.turns([0, 0, 1], 0))
    assert (report.pose.dof, report.rotation.dof, len(report.axes)) == (5, 2, 5)
    assert report.pose.anees == pytest.approx(1, abs=0.1)
    ball = px.SymmetryGroup(axes=[px.SymmetryAxis(direction=axis) for axis in ([1, 0, 0], [0, 1, 0])])
    assert px.consistency(estimates, covariances, turned, symmetries=ball).rotation is None


def test_poses_are_matched_in_time_and_aligned() -> None:
    estimates, covariances, truth = series(100, 7)
    plain = px.consistency(estimates, covariances, truth)
    order = np.arange(100) * 0.1
    matched = px.consistency(
        estimates,
        covariances,
        truth[::2],
        stamps=order,
        truth_stamps=order[::2] + 0.003,
    )
    assert len(matched.frames) == 50
    assert matched.frames[1].nees == plain.frames[2].nees
    moved = px.SE3.exp([0.3, 0.2, -1.0, 5.0, 1.0, 2.0]) * truth
    first = px.consistency(estimates, covariances, moved, alignment=px.Alignment.first)
    assert len(first.frames) == 99
    assert px.consistency(estimates, covariances, moved, alignment=px.Alignment.se3).pose.anees < 10


def test_what_does_not_fit_is_named() -> None:
    estimates, covariances, truth = series(10, 8)
    for wrong in (covariances[:9], covariances[0], np.zeros(6), covariances[None], covariances[:, :5, :5]):
        shape = re.escape(str(wrong.shape))
        with pytest.raises(ValueError, match=rf"covariances has shape {shape}; expected \(10, 6, 6\)"):
            px.consistency(estimates, wrong, truth)
    with pytest.raises(ValueError, match=r"covariances has shape \(6, 6\); expected \(1, 6, 6\)"):
        px.consistency(estimates[0], covariances[0], truth[0])
    with pytest.raises(ValueError, match="4 true poses for 10 estimates"):
        px.consistency(estimates, covariances, truth[:4])
    with pytest.raises(ValueError, match=r"covariances\[0\] is not positive definite"):
        px.consistency(estimates, -covariances, truth)
    with pytest.raises(ValueError, match="pairs"):
        px.consistency(estimates[:1], covariances[:1], truth[:1])
    with pytest.raises(ValueError, match="stamps has 3 entries"):
        px.consistency(estimates, covariances, truth, stamps=[1, 2, 3])
    with pytest.raises(ValueError, match="increase"):
        px.consistency(estimates, covariances, truth, stamps=np.zeros(10))
