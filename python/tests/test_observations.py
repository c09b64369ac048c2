# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Observations: errors name the argument and its index, in constructors, slam and files."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import posemix as px
import pytest

BODY = px.ConcentratedGaussian(px.SE3(), px.pose_covariance(1e-3, 1e-3))
SEEN = px.ObservationComponent(px.SE3(translation=[0.0, 0.0, 1.0]))


def observation(**changed: Any) -> px.Observation:
    return px.Observation([SEEN], **{"object": "mug", **changed})


def with_second(**changed: Any) -> px.Observation:
    return px.Observation([SEEN, SEEN.replace(**{"weight": 0.0, **changed})], object="mug")


def slam() -> px.StampedSlam:
    return px.StampedSlam(BODY, [px.ObjectModel(id="mug")])


INDEFINITE = np.diag([1.0, 1.0, 1.0, 1.0, 1.0, -1.0])
WRONG: dict[str, tuple[str, Callable[[], Any]]] = {
    "weight": (r"components\[1\]\.weight is -0.5, expected zero or more", lambda: with_second(weight=-0.5)),
    "sum": ("the weights of the components sum to 1.5, expected one", lambda: with_second(weight=0.5)),
    "covariance": (
        r"components\[1\]\.covariance is not positive definite", lambda: with_second(covariance=INDEFINITE)
    ),
    "nan": (
        r"components\[1\]\.covariance holds a value that is not finite",
        lambda: with_second(covariance=np.full((6, 6), np.nan)),
    ),
    "clutter": ("clutter is 1, expected a probability above 0", lambda: observation(clutter=1.0)),
    "sure clutter": ("clutter is 0.99999", lambda: observation(clutter=1.0 - 1e-12)),
    "stamp": ("stamp_s is nan, expected a number in", lambda: observation(stamp_s=np.nan)),
    "score": ("score is inf, expected a finite number", lambda: observation(score=np.inf)),
    "no name": ("observation: has neither object nor class_id", lambda: slam().add(observation(object=""))),
    "two names": ("observation: has both object and class_id", lambda: slam().add(observation(class_id="cup"))),
    "far": (
        r"components\[1\]\.pose has a position of 1e\+60 m, expected at most 1e\+08 m",
        lambda: slam().add(with_second(pose=px.SE3(translation=[0, 0, 1e60]))),
    ),
    "odometry": ("odom_body is no pose", lambda: slam().add_odometry(0.0, np.full((4, 4), np.nan))),
    "frame": (
        r"observations\[1\]: has neither object nor class_id",
        lambda: px.ObjectSlam(BODY, [px.ObjectModel(id="mug")]).step(
            px.FrameInput(observations=[observation(), observation(object="")])
        ),
    ),
}  # fmt: skip


@pytest.mark.parametrize(("message", "action"), WRONG.values(), ids=WRONG)
def test_errors_name_the_argument(message: str, action: Callable[[], Any]) -> None:
    with pytest.raises(ValueError, match=message):
        action()


def test_errors_of_files_name_row_and_column(tmp_path: Path) -> None:
    path = tmp_path / "o.csv"
    path.write_text(
        "stamp_s,camera,detector,id,class,sighting,weight,tx_m,ty_m,tz_m,qx,qy,qz,qw\n"
        "0,,,a,,0,1,0,0,1,0,0,0,1\n1,,,a,,1,1,0,0,1e9,0,0,0,1\n"
    )
    with pytest.raises(ValueError, match=r'o\.csv:3: got tz_m = "1e9", expected metres, at most 1e\+08'):
        px.read_observations(path)
    with pytest.raises(ValueError, match="has neither id nor class"):
        px.write_observations(path, [observation(object="")])


CORNERS = [[500.2, 300.1], [531.5, 301.9], [532.3, 270.4], [500.9, 268.8]]


def tags(size_m: float) -> px.TagMap:
    return px.TagMap(default_size_m=size_m)


def recording(corners: list[list[float]]) -> tuple[list[px.CornerSighting], list[px.RigCamera]]:
    sightings = [px.CornerSighting(stamp_s=0.1 * i, topic="a", tag=1, corners=corners) for i in range(5)]
    return sightings, [px.RigCamera(name="a", model=px.CameraModel([600.0, 600.0, 640.0, 512.0]))]


DOUBTS = {
    "size": ("edge of 150 m, expected 0.003 to 3 m", CORNERS, 150.0, None),
    "noise": ("is 119 px, expected 0.001 to 3 px", CORNERS, 0.15, px.CornerNoise(119.0)),
    "square": (
        "square tag to", [[400.0, 300.0], [530.0, 301.0], [502.0, 190.0], [450.0, 210.0]], 0.15, None
    ),
}  # fmt: skip


@pytest.mark.parametrize(("message", "corners", "size", "noise"), DOUBTS.values(), ids=DOUBTS)
def test_hardly_true_corners_warn(
    message: str, corners: list[list[float]], size: float, noise: px.CornerNoise | None, tmp_path: Path
) -> None:
    settings = px.FiducialSettings(noise=noise)
    with pytest.warns(UserWarning, match=message):
        px.observe_fiducials(*recording(corners), tags(size), settings)
    with pytest.warns(UserWarning, match=message):
        px.write_fiducials(tmp_path / "out", *recording(corners), tags(size), settings)


def test_plausible_corners_do_not_warn() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        px.observe_fiducials(*recording(CORNERS), tags(0.15))
