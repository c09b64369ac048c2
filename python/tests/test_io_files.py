# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Round trips of files: trajectories, mixtures, posteriors, samples, observations."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import posemix as px
import pytest


def test_trajectories(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    poses = px.with_misses(px.SE3.exp(rng.normal(size=(4, 6))), [True, False, True, True])
    px.write_tum(tmp_path / "a.tum", [0, 0.5, 1.0, 1.5], poses)
    assert px.read_tum(tmp_path / "a.tum").stamps.tolist() == [0, 1.0, 1.5]
    px.write_tum(tmp_path / "b.tum", [0, 0.5, 1.0, 1.5], poses, misses_as_zeros=True)
    again = px.read_tum(tmp_path / "b.tum", allow_misses=True)
    assert len(again) == 4 and px.is_known(again.poses).tolist() == [True, False, True, True]
    np.testing.assert_allclose(again.poses._data, poses._data, atol=1e-11)
    with pytest.raises(ValueError, match="2 stamps and 4 poses"):
        px.write_tum(tmp_path / "c.tum", [0, 1], poses)
    for stamps, message in (
        ([1, np.nan, 2, 3], r"stamps\[1\] is nan, expected a finite number"),
        ([0, 1, 2, np.inf], r"stamps\[3\] is inf, expected a finite number"),
        ([0, 0, 1, 2], r"stamps\[1\] is 0 after 0, expected stamps that increase strictly"),
        ([0, 1, 2, 1.5], r"stamps\[3\] is 1.5 after 2, expected"),
    ):
        with pytest.raises(ValueError, match=message):
            px.write_tum(tmp_path / "c.tum", stamps, poses)
    assert not (tmp_path / "c.tum").exists()


@pytest.mark.parametrize("kind", ["concentrated", "projected"])
def test_mixtures(tmp_path: Path, kind: str) -> None:
    poses = px.SE3.exp(np.random.default_rng(2).normal(size=(3, 6)))
    covariance = np.diag([0.01, 0.02, 0.03, 1e-4, 2e-4, 3e-4])
    make: Any = px.ConcentratedGaussian if kind == "concentrated" else px.ProjectedGaussian.at_mean
    mixture = px.Mixture([make(pose, covariance) for pose in poses], [0.5, 0.3, 0.2])
    px.write_mixture(tmp_path / "m.json", mixture, "camera", "mug")
    file = px.read_mixture(tmp_path / "m.json")
    assert (file.from_frame, file.to_frame) == ("camera", "mug")
    assert file.mixture == mixture
    other = px.MixtureConvention(order=px.TangentOrder.translation_rotation, length=px.LengthUnit.mm)
    px.write_mixture(tmp_path / "n.json", mixture, "camera", "mug", other)
    again = px.read_mixture(tmp_path / "n.json").mixture
    np.testing.assert_allclose(again.covariances, mixture.covariances, rtol=1e-12)
    with pytest.raises(ValueError, match="frame|name"):
        px.write_mixture(tmp_path / "m.json", mixture, "two words", "mug")


def test_a_right_side_covariance_is_carried_over(tmp_path: Path) -> None:
    pose = px.SE3(px.SO3.exp([0.3, -0.2, 0.5]), [0.4, 0.1, 0.9])
    body = np.diag([0.01, 0.02, 0.03, 1e-4, 2e-4, 3e-4])
    adjoint = pose.adjoint()
    mixture = px.Mixture([px.ConcentratedGaussian(pose, adjoint @ body @ adjoint.T)])
    px.write_mixture(tmp_path / "m.json", mixture, "a", "b", px.MixtureConvention(side=px.Side.right))
    text = json.dumps(json.loads((tmp_path / "m.json").read_text()))
    assert '"right"' in text
    again = px.read_mixture(tmp_path / "m.json").mixture
    np.testing.assert_allclose(again[0].body_covariance, body, atol=1e-12)


def test_posteriors(tmp_path: Path) -> None:
    joint = px.ConcentratedGaussian(px.SE3.identity((2,)), np.eye(12))
    names = [px.NamedPose("camera", px.PoseKind.camera), px.NamedPose("mug", px.PoseKind.object)]
    file = px.PosteriorFile("by hand", 1.5, names, px.Mixture([joint]))
    px.write_posterior(tmp_path / "posterior.json", file)
    assert px.read_posterior(tmp_path / "posterior.json") == file
    with pytest.raises(ValueError, match="names|poses"):
        px.write_posterior(tmp_path / "p.json", px.PosteriorFile("", 0.0, names[:1], file.mixture))


@pytest.mark.parametrize("name", ["poses.csv", "poses.npy", "poses.tum"])
def test_pose_samples(tmp_path: Path, name: str) -> None:
    poses = px.SE3.exp(np.random.default_rng(3).normal(size=(5, 6)))
    px.write_poses(tmp_path / name, poses)
    samples = px.read_pose_samples(tmp_path / name)
    assert samples.poses.is_approx(poses, 1e-11) and samples.weights is None
    with pytest.raises(ValueError, match="expected a name in .csv"):
        px.write_poses(tmp_path / "poses.xml", poses)


def test_weights_and_residuals_of_csv(tmp_path: Path) -> None:
    columns = [f"{p}_{c}" for p in ("est", "gt") for c in ("tx", "ty", "tz", "qx", "qy", "qz", "qw")]
    rng = np.random.default_rng(4)
    estimate, truth = px.SE3.exp(rng.normal(size=(3, 6))), px.SE3.exp(rng.normal(size=(3, 6)))
    rows = np.hstack([estimate.to_tq(), truth.to_tq(), [[1.0], [2], [3]]])
    path = tmp_path / "pairs.csv"
    np.savetxt(path, rows, delimiter=",", header=",".join([*columns, "weight"]), comments="", fmt="%.17g")
    right = px.read_pose_samples(path, residuals=px.Side.right)
    assert right.poses.is_approx(truth.inverse() * estimate, 1e-12)
    assert right.weights is not None and right.weights.tolist() == [1, 2, 3]
    left = px.read_pose_samples(path, residuals=px.Side.left)
    assert left.poses.is_approx(estimate * truth.inverse(), 1e-12)


@pytest.mark.parametrize("name", ["seen.jsonl", "seen.jsonl.gz", "seen.csv", "seen.csv.gz"])
def test_observations(tmp_path: Path, name: str) -> None:
    covariance = 1e-4 * np.eye(6) + 1e-5
    poses = px.SE3.exp([[0.1, 0.2, 0.3, 0.4, 0.5, 0.6], [3.0, 0.0, 0.0, 0.1, 0.2, 0.3]])
    components = [
        px.ObservationComponent(poses[0], weight=2 / 3, covariance=covariance),
        px.ObservationComponent(poses[1], weight=1 / 3),
    ]
    seen = [
        px.Observation(components, object="7", camera="left", stamp_s=1 / 3, clutter=0.1),
        px.Observation([px.ObservationComponent(poses[1])], class_id="mug", score=-2.0),
    ]
    px.write_observations(tmp_path / name, seen)
    read = px.read_observations(tmp_path / name)
    if "jsonl" in name:
        assert read == seen
    assert [(o.object, o.class_id, o.camera, o.stamp_s) for o in read] == [
        ("7", "", "left", 1 / 3), ("", "mug", "", 0.0),
    ]  # fmt: skip
    assert (read[0].clutter, read[1].score) == (0.1, -2.0)
    np.testing.assert_allclose(read[0].components[0].covariance, covariance, rtol=1e-11)
    assert read[0].components[1].covariance is None
    assert read[0].components[1].pose.is_approx(poses[1], 1e-11)


def test_observations_that_are_none(tmp_path: Path) -> None:
    path = tmp_path / "seen.jsonl"
    path.write_text('{"stamp_s": 0, "id": "7", "components": []}\n')
    with pytest.raises(ValueError, match="seen.jsonl:1: .*no components"):
        px.read_observations(path)
    with pytest.raises(ValueError, match="expected a name in .csv or .jsonl"):
        px.read_observations(tmp_path / "seen.txt")


def test_an_old_name_in_a_mixture_file_warns(tmp_path: Path) -> None:
    mixture = px.Mixture([px.ConcentratedGaussian(px.SE3(), np.eye(6))])
    px.write_mixture(tmp_path / "m.json", mixture, "a", "b")
    text = (tmp_path / "m.json").read_text().replace('"distribution"', '"law"')
    (tmp_path / "m.json").write_text(text)
    with pytest.warns(FutureWarning, match="m.json: key 'law' is now 'distribution'"):
        assert px.read_mixture(tmp_path / "m.json").mixture == mixture
