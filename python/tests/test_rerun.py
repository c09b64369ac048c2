# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Recordings are written as .rrd files and read back."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rrd import columns, rr
from slam_scene import Scene

from posemix import SE3, SO3, ConcentratedGaussian, Mixture, TrackHealth, plot
from posemix import rerun as log

COVARIANCE = np.diag([0.02, 0.01, 0.03, 1e-4, 4e-4, 9e-4])


@pytest.fixture
def logged(tmp_path: Path) -> Callable[[Callable[[Any], None]], dict[str, dict[str, list[Any]]]]:
    """Runs what logs, and returns columns by entity and name, rows in the order of time."""

    def run(use: Callable[[Any], None]) -> dict[str, dict[str, list[Any]]]:
        path = tmp_path / "recording.rrd"
        recording = rr.RecordingStream("posemix_test", recording_id="test")
        recording.save(str(path))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            use(recording)
        recording.disconnect()
        return columns(path)

    return run


def test_pose_at_a_time(logged: Any) -> None:
    pose = SE3(SO3.exp([0.1, 0.2, 0.3]), [1.0, 2.0, 3.0])

    def use(recording: Any) -> None:
        log.set_time(1.5, recording=recording)
        log.log_pose("world/camera", pose, axis_length=0.25, recording=recording)

    row = logged(use)["world/camera"]
    np.testing.assert_allclose(row["Transform3D:translation"][0], [[1.0, 2.0, 3.0]])
    np.testing.assert_allclose(
        row["Transform3D:quaternion"][0], [pose.rotation.quaternion], rtol=1e-6
    )
    np.testing.assert_allclose(row["TransformAxes3D:axis_length"][0], [0.25])
    assert row["time"] == [1_500_000_000]


def test_ellipsoid_has_the_covariance(logged: Any) -> None:
    density = ConcentratedGaussian(SE3(SO3.exp([0.3, 0.1, 2.0]), [1.0, -1.0, 0.5]), COVARIANCE)
    row = logged(
        lambda r: log.log_ellipsoid("e", density, sigmas=2.0, colour="#102030", recording=r)
    )["e"]
    np.testing.assert_allclose(row["Ellipsoids3D:centers"][0], [[1.0, -1.0, 0.5]])
    turn = SO3(row["Ellipsoids3D:quaternions"][0][0]).matrix()
    half = np.array(row["Ellipsoids3D:half_sizes"][0][0]) / 2.0
    expected = plot.position_covariance(density.mean, density.covariance)
    np.testing.assert_allclose(turn @ np.diag(half**2) @ turn.T, expected, atol=1e-6)
    assert row["Ellipsoids3D:colors"][0][0] >> 8 == 0x102030


def test_ghosts_are_as_solid_as_they_are_likely(logged: Any) -> None:
    light = ConcentratedGaussian(SE3(translation=[1.0, 0.0, 0.0]), COVARIANCE)
    heavy = ConcentratedGaussian(SE3(SO3.exp([0, 0, np.pi / 2]), [2.0, 0.0, 0.0]), COVARIANCE)
    mixture = Mixture([light, heavy], [0.2, 0.8])
    found = logged(
        lambda r: log.log_hypotheses("world/mug", mixture, axis_length=0.1, recording=r)
    )
    axes = found["world/mug/axes"]
    assert axes["Arrows3D:labels"][0] == ["0.800", "", "", "0.200", "", ""]
    vectors = np.array(axes["Arrows3D:vectors"][0])
    np.testing.assert_allclose(vectors[0], [0.0, 0.1, 0.0], atol=1e-7)
    np.testing.assert_allclose(vectors[3], [0.1, 0.0, 0.0], atol=1e-7)
    np.testing.assert_allclose(np.array(axes["Arrows3D:origins"][0])[:, 0], [2, 2, 2, 1, 1, 1])
    alpha = [colour & 0xFF for colour in axes["Arrows3D:colors"][0]]
    assert alpha == [212] * 3 + [82] * 3
    assert len(found["world/mug/ellipsoids"]["Ellipsoids3D:centers"][0]) == 2


def test_single_component(logged: Any) -> None:
    single = Mixture([ConcentratedGaussian(SE3(), COVARIANCE)])
    found = logged(lambda r: log.log_hypotheses("m", single, recording=r))
    assert found["m/axes"]["Arrows3D:labels"][0] == ["1.000", "", ""]


def test_the_heaviest_component_has_the_name(logged: Any) -> None:
    two = [ConcentratedGaussian(SE3(translation=[x, 0.0, 0.0]), COVARIANCE) for x in (1.0, 2.0)]
    mixture = Mixture(two, [0.75, 0.25])
    found = logged(lambda r: log.log_hypotheses("m", mixture, name="mug", colour="#102030", recording=r))
    assert found["m/axes"]["Arrows3D:labels"][0] == ["mug 0.750", "", "", "0.250", "", ""]
    assert found["m/ellipsoids"]["Ellipsoids3D:colors"][0][0] >> 8 == 0x102030


def test_numbers_over_time(logged: Any) -> None:
    def use(recording: Any) -> None:
        for i in range(3):
            log.set_time(0.1 * i, recording=recording)
            value = float("nan") if i == 1 else 2.0 * i
            log.log_scalars("errors", {"rotation_deg": value, "weight": 0.5}, recording=recording)

    found = logged(use)
    assert found["errors/rotation_deg"]["Scalars:scalars"] == [[0.0], [4.0]]
    assert found["errors/weight"]["Scalars:scalars"] == [[0.5]] * 3
    assert found["errors/weight"]["time"] == [0, 100_000_000, 200_000_000]


def test_whole_estimate(logged: Any) -> None:
    poses = SE3(SO3.identity(4), np.arange(12.0).reshape((4, 3)))
    stamps = [0.0, 0.5, 1.0, 1.5]
    covariances = np.tile(COVARIANCE, (4, 1, 1))
    found = logged(
        lambda r: log.log_tracking("world/camera", stamps, poses, covariances, recording=r)
    )
    moved = np.array(found["world/camera/pose"]["Transform3D:translation"])[:, 0]
    np.testing.assert_allclose(moved, poses.translation)
    way = found["world/camera/way"]
    np.testing.assert_allclose(way["LineStrips3D:strips"][0][0], poses.translation)
    assert "time" not in way
    assert len(found["world/camera/ellipsoid"]["Ellipsoids3D:centers"]) == 4
    with pytest.raises(ValueError, match="stamps has shape"):
        log.log_tracking("a", stamps[:2], poses, covariances)


def test_a_trail_is_the_path_of_some_seconds(logged: Any) -> None:
    poses = SE3(SO3.identity(5), np.arange(15.0).reshape((5, 3)))
    covariances = np.tile(COVARIANCE, (5, 1, 1))
    covariances[1] = np.nan
    stamps = 0.5 * np.arange(5)
    found = logged(
        lambda r: log.log_tracking("cup", stamps, poses, covariances, trail_s=1.0, recording=r)
    )
    strips = [np.array(row[0]) for row in found["cup/way"]["LineStrips3D:strips"]]
    for strip, rows in zip(strips, [[0], [0, 2], [2, 3], [2, 3, 4]], strict=True):
        np.testing.assert_allclose(strip, poses.translation[rows])
    assert found["cup/way"]["time"] == [0, 1_000_000_000, 1_500_000_000, 2_000_000_000]


def test_state_of_a_track(logged: Any) -> None:
    def use(recording: Any) -> None:
        before = None
        for i, health in enumerate((TrackHealth.good, TrackHealth.good, TrackHealth.lost)):
            log.set_time(float(i), recording=recording)
            models = {"static": 0.25, "moving": 0.75}
            log.log_state("cup", health, 0.5 * i, models, before=before, recording=recording)
            before = health

    found = logged(use)
    assert found["cup/health"]["TextLog:text"] == [["good"], ["lost"]]
    assert found["cup/health"]["TextLog:level"] == [["INFO"], ["WARN"]]
    assert found["cup/health"]["time"] == [0, 2_000_000_000]
    assert found["cup/existence"]["Scalars:scalars"] == [[0.0], [0.5], [1.0]]
    assert found["cup/motion_models/moving"]["Scalars:scalars"] == [[0.75]] * 3


def test_a_run(logged: Any) -> None:
    run = Scene(20).run()
    found = logged(lambda r: log.log_run("world", run, recording=r))
    moved = np.array(found["world/camera/pose"]["Transform3D:translation"])[:, 0]
    np.testing.assert_allclose(moved, run.camera.poses.translation, rtol=1e-6)
    existences = run.existences("mug")
    shown = [row[0] for row in found["world/mug/existence"]["Scalars:scalars"]]
    np.testing.assert_array_equal(shown, existences[~np.isnan(existences)])
    words = [health.name for health in run.healths("mug")]
    changes = [w for i, w in enumerate(words) if i == 0 or w != words[i - 1]]
    assert [row[0] for row in found["world/mug/health"]["TextLog:text"]] == changes
    assert not [path for path in found if "motion_models" in path]
