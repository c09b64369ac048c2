# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Trajectories with covariances out of bags, and their consistency."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import posemix as px
import pytest
from .bag_maker import KINDS, SECOND, START, BagMaker, base_at

from posemix import bags

# About and along fixed axes, translation first, as messages have it.
COVARIANCE = np.diag([1e-4, 4e-4, 1e-4, 1e-4, 1e-4, 9e-4])


@pytest.fixture
def recorded(maker: Callable[[str], BagMaker]) -> Callable[[str], Path]:
    """Odometry whose errors are as its covariance says, and the truth 2 ms later."""

    def written(kind: str) -> Path:
        bag = maker(kind)
        rng = np.random.default_rng(1)
        for i in range(200):
            true = base_at(i / 50)
            error = rng.multivariate_normal(np.zeros(6), COVARIANCE)
            pose = px.SE3(px.SO3.exp(-error[3:]) * true.rotation, true.translation - error[:3])
            bag.odometry(i / 50, pose, COVARIANCE.ravel())
            bag.pose(i / 50 + 0.002, "/truth", true)
        return bag.write()

    return written


@pytest.mark.parametrize("kind", KINDS)
def test_odometry_is_consistent_with_the_truth(recorded: Callable[[str], Path], kind: str) -> None:
    path = recorded(kind)
    odometry, truth = bags.read_poses(path, "/odom"), bags.read_poses(path, "/truth")
    assert odometry.stamps_ns[0] == START
    assert truth.stamps_ns[1] == START + round(0.022 * SECOND)
    assert np.isnan(truth.covariances).all()
    stamps, true_stamps = ((track.stamps_ns - START) * 1e-9 for track in (odometry, truth))
    report = px.consistency(
        odometry.poses, odometry.covariances, truth.poses, stamps=stamps, truth_stamps=true_stamps,
    )  # fmt: skip
    assert len(report.frames) == 200
    assert report.pose.anees == pytest.approx(1, abs=0.15)
    # Read as if along the axes of the body, it is another covariance.
    other = bags.read_poses(path, "/odom", frame="child")
    assert np.abs(other.covariances[100] - odometry.covariances[100]).max() > 1e-5


def test_errors_name_the_topic(maker: Callable[[str], BagMaker], drive: Callable[..., Path]) -> None:
    path = drive("mcap")
    with pytest.raises(ValueError, match="no topic /pose; there are: "):
        bags.read_poses(path, "/pose")
    with pytest.raises(ValueError, match="/objects is of vision_msgs"):
        bags.read_poses(path, "/objects")
