# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""What the tests share."""

from __future__ import annotations

import numpy as np
import pytest

from posemix import SE3, ConcentratedGaussian, Mixture, SO3


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20221124)


def covariance(rng: np.random.Generator, rotation_sd: float, translation_sd: float) -> np.ndarray:
    """A full covariance with standard deviations of about these sizes [rad, m]."""
    scale = np.diag([rotation_sd] * 3 + [translation_sd] * 3)
    a = rng.normal(size=(6, 12))
    return scale @ (a @ a.T / 12) @ scale


def two_modes(angle: float = np.pi) -> Mixture:
    """Weights 0.7 and 0.3, the second turned about z."""
    p = np.diag([0.02, 0.03, 0.05, 4e-4, 5e-4, 6e-4])
    turned = SE3(SO3.exp([0, 0, angle]), [0.01, 0.02, 0.0])
    return Mixture([ConcentratedGaussian(SE3(), p), ConcentratedGaussian(turned, p)], [0.7, 0.3])
