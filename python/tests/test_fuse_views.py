# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Observations, and the fusion of views."""

from __future__ import annotations

import pickle

import numpy as np
import posemix as px
import pytest


def views(flipped: int | None = None) -> tuple[px.SE3, list[px.View]]:
    """Four cameras around a cup, of which one sees it upside down."""
    cup = px.SE3.exp([0.3, 0.1, 0.2, 0.02, 0.01, 0.0])
    made = []
    for v in range(4):
        camera = px.SE3.exp([0, 0.7 * v, 0, 0, 0, 0]) * px.SE3.exp([0, 0, 0, 0, 0, -0.8])
        seen = camera.inverse() * cup
        if v == flipped:
            seen = seen * px.SE3.exp([0, 0, np.pi, 0, 0, 0])
        made.append(px.View(camera, [px.Observation([px.ObservationComponent(seen)], class_id="cup")]))
    return cup, made


def test_views_agree() -> None:
    cup, seen = views()
    (instance,) = px.fuse_views(seen)
    assert instance.class_id == "cup"
    assert instance.probability > 0.99
    assert np.linalg.norm((cup.inverse() * instance.density.means[0]).log()) < 1e-6
    assert [support.view for support in instance.support] == [0, 1, 2, 3]
    assert pickle.loads(pickle.dumps(instance)) == instance


def test_symmetries_and_settings_count() -> None:
    _, seen = views(flipped=1)
    (alone,) = px.fuse_views(seen)
    assert alone.supporting_views < 3.2
    half_turn = px.ViewClass(symmetries=px.SymmetryGroup.turns([0, 0, 1], 2))
    (symmetric,) = px.fuse_views(seen, {"cup": half_turn})
    assert symmetric.supporting_views > 3.8
    (unseen,) = px.fuse_views(seen[:1], settings=px.FuseViewsSettings(detection_probability=0.9))
    assert unseen.probability > 0.5


def test_what_is_not_valid_is_refused() -> None:
    _, seen = views()
    component = px.ObservationComponent(px.SE3())
    with pytest.raises(ValueError, match="weights"):
        px.Observation([component, component])
    with pytest.raises(ValueError, match=r"components\[0\]\.covariance"):
        px.Observation([component.replace(covariance=-np.eye(6))])
    with pytest.raises(ValueError, match=r"views\[0\]\.observations\[0\]"):
        px.fuse_views([px.View(px.SE3(), [px.Observation([component])])])
    with pytest.raises(ValueError, match="max_components"):
        px.fuse_views(seen, settings=px.FuseViewsSettings(max_components=0))
