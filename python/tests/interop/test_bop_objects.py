# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
from __future__ import annotations

import json

import numpy as np
import pytest

from posemix import SE3, ConcentratedGaussian, NoiseFrame, NullNoise, ObjectModel, ObjectSlam, SO3
from posemix.interop import bop

from .test_files import MODELS


def test_groups_of_bop_models(covariance: np.ndarray) -> None:
    models = bop.parse_models(json.dumps(MODELS))
    flip = bop.symmetry_group(models[5])
    turned = SE3(SO3.exp([0, 0, 3.0]), [0.004, 0.0, 0.0])
    assert abs(flip.closest(turned, SE3(), np.eye(6)).rotation.angle()) < 0.2
    round_one = bop.symmetry_group(models[13])
    closest = round_one.closest(models[13].axes[0].turned(1.3), SE3(), np.eye(6))
    assert closest.is_approx(SE3(), 1e-6)


def test_sets_that_are_no_group_are_refused() -> None:
    third = [list(row) for row in SO3.exp([0, 0, 2 * np.pi / 3]).matrix()]
    matrix = [*third[0], 0, *third[1], 0, *third[2], 0, 0, 0, 0, 1]
    text = json.dumps({"1": {"diameter": 50.0, "symmetries_discrete": [matrix]}})
    with pytest.raises(ValueError, match="symmetries"):
        bop.symmetry_group(bop.parse_models(text)[1])


def test_noise_of_bop_models(covariance: np.ndarray) -> None:
    model = bop.parse_models(json.dumps(MODELS))[5]
    noise = bop.detector_noise(model, covariance, null=NullNoise(weight=0.25, volume_m3=1.0))
    assert [c.weight for c in noise.components] == pytest.approx([0.375, 0.375])
    assert {c.frame for c in noise.components} == {NoiseFrame.object}
    assert noise.components[1].offset.is_approx(model.elements[1])
    camera = ConcentratedGaussian(SE3(), 1e-6 * np.eye(6))
    slam = ObjectSlam(camera, [ObjectModel(id="clamp", noise=noise)])
    slam.start({"clamp": SE3(translation=[0.0, 0.0, 1.0])})
    assert slam.multi_object is not None
    found = slam.multi_object.hypotheses(0)
    assert len(found) == 2
    expected = SE3(translation=[0.0, 0.0, 1.0]) * model.elements[1].inverse()
    assert any(h.pose.is_approx(expected, 1e-6) for h in found)
