# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Numeric answers that know nothing of posemix's formulas."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from posemix import SE3

STEP = 1e-6


def jacobian_of(moved: Callable[[np.ndarray], SE3], mean: SE3) -> np.ndarray:
    """Central differences of Log(moved(d) mean^-1) at d = 0, shape (6, 6)."""
    back = mean.inverse()
    columns = [
        ((moved(STEP * axis) * back).log() - (moved(-STEP * axis) * back).log()) / (2.0 * STEP)
        for axis in np.eye(6)
    ]
    return np.stack(columns, axis=1)


def sampled_covariance(
    moved: Callable[[np.ndarray], SE3], mean: SE3, covariance: np.ndarray, count: int = 20_000
) -> np.ndarray:
    """Covariance of Log(moved(d) mean^-1) over draws d ~ N(0, covariance)."""
    draws = np.random.default_rng(3).multivariate_normal(np.zeros(6), covariance, size=count)
    errors = (moved(draws) * mean.inverse()).log()
    return np.asarray(errors.T @ errors / count)


def assert_same(actual: np.ndarray, expected: np.ndarray, relative: float) -> None:
    """Matrices that differ by at most a part of the larger deviations in each entry."""
    scale = np.sqrt(np.outer(np.diagonal(expected), np.diagonal(expected)))
    assert np.abs((actual - expected) / scale).max() < relative
