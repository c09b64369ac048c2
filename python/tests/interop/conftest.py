# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""What the tests against other packages share; at the end it is told which versions they were."""

from __future__ import annotations

import importlib.metadata
from collections.abc import Callable
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from posemix import SE3, ConcentratedGaussian

Peer = Callable[[str, str], ModuleType]
TESTED: dict[str, str] = {}


@pytest.fixture
def peer(record_property: Callable[[str, object], None]) -> Peer:
    """Imports a module of a distribution and records its version, or skips the test."""

    def imported(module: str, distribution: str) -> ModuleType:
        found: ModuleType = pytest.importorskip(module)
        TESTED[distribution] = importlib.metadata.version(distribution)
        record_property("peer", f"{distribution} {TESTED[distribution]}")
        return found

    return imported


def pytest_terminal_summary(terminalreporter: Any) -> None:
    if TESTED:
        terminalreporter.section("packages tested against")
        for name, version in sorted(TESTED.items()):
            terminalreporter.write_line(f"{name} {version}")


@pytest.fixture
def pose() -> SE3:
    """One pose, well turned and far from the origin."""
    return SE3.exp([0.7, -0.4, 1.1, 2.0, -1.5, 0.8])


@pytest.fixture
def poses() -> SE3:
    """An array of poses."""
    return SE3.exp(np.random.default_rng(5).normal(size=(20, 6)))


@pytest.fixture
def covariance() -> np.ndarray:
    """Full, with all correlations: about 1 degree and 2 cm."""
    root = np.random.default_rng(7).normal(size=(6, 6)) + 2.0 * np.eye(6)
    scale = np.array([0.01] * 3 + [0.01] * 3)
    return scale[:, None] * (root @ root.T) * scale


@pytest.fixture
def density(pose: SE3, covariance: np.ndarray) -> ConcentratedGaussian[SE3]:
    return ConcentratedGaussian(pose, covariance)
