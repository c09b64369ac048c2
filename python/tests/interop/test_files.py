# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""TUM, KITTI, g2o and BOP files, against evo and GTSAM."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from .oracle import assert_same

from posemix import SE3, SO3, ConcentratedGaussian, interop
from posemix.interop import bop, g2o, kitti, tum


def test_tum_and_evo(peer: Any, poses: SE3, tmp_path: Path) -> None:
    evo = peer("evo.tools.file_interface", "evo")
    stamps = 1.6e9 + np.arange(len(poses)) / 30.0
    ours, theirs = tmp_path / "ours.txt", tmp_path / "theirs.txt"
    tum.write(ours, stamps, poses)
    found = evo.read_tum_trajectory_file(str(ours))
    times, back = interop.evo.from_trajectory(found)
    np.testing.assert_array_equal(times, stamps)
    assert back.is_approx(poses)
    evo.write_tum_trajectory_file(str(theirs), interop.evo.to_trajectory(stamps, poses))
    times, back = tum.read(theirs)
    np.testing.assert_allclose(times, stamps, atol=1e-6)
    assert back.is_approx(poses, 1e-8)


def test_kitti_and_evo(peer: Any, poses: SE3, tmp_path: Path) -> None:
    evo = peer("evo.tools.file_interface", "evo")
    ours, theirs = tmp_path / "ours.txt", tmp_path / "theirs.txt"
    kitti.write(ours, poses)
    assert interop.evo.from_path(evo.read_kitti_poses_file(str(ours))).is_approx(poses, 1e-8)
    evo.write_kitti_poses_file(str(theirs), interop.evo.to_path(poses))
    assert kitti.read(theirs).is_approx(poses, 1e-8)


def test_tum_reads_back_to_the_last_bit(poses: SE3) -> None:
    stamps, back = tum.parse(tum.format(np.arange(20.0), poses))
    np.testing.assert_array_equal(stamps, np.arange(20.0))
    np.testing.assert_allclose(back.to_tq(), poses.to_tq(), rtol=0, atol=2e-16)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("0 1 2 3 0 0 0 1\n1 2 3\n", "t.txt:2: got 3 numbers, expected 8"),
        ("# head\n\n0 1 2 3 0 0 0 0\n", "t.txt:3: got a quaternion of zeros"),
        ("0 1 2 x 0 0 0 1\n", "t.txt:1: got 'x', expected a number"),
        ("0 1 2 nan 0 0 0 1\n", "t.txt:1: got 'nan', expected a finite number"),
    ],
)
def test_tum_errors_name_the_line(text: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        tum.parse(text, "t.txt")


def test_kitti_errors_name_the_line() -> None:
    with pytest.raises(ValueError, match="k:1: .*"):
        kitti.parse("2 0 0 0 0 1 0 0 0 0 1 0\n", "k")
    with pytest.raises(ValueError, match="k:2: got 11 numbers, expected 12"):
        kitti.parse("1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1\n", "k")


@pytest.fixture
def graph(poses: SE3, covariance: np.ndarray) -> g2o.Graph:
    steps = poses[:-1].inverse() * poses[1:]
    triangles = [
        g2o.to_information(ConcentratedGaussian(step, covariance), rotation="rotation_vector")[1]
        for step in steps
    ]
    ids = np.arange(len(poses))
    edges = np.column_stack([ids[:-1], ids[1:]])
    return g2o.Graph(ids, poses, edges, steps, np.array(triangles), fixed=(0,))


def test_g2o_as_gtsam_reads_it(peer: Any, graph: g2o.Graph, covariance: Any, tmp_path: Path) -> None:
    gtsam = peer("gtsam", "gtsam")
    path = tmp_path / "graph.g2o"
    g2o.write(path, graph)
    factors, values = gtsam.readG2o(str(path), True)
    assert (factors.size(), values.size()) == (19, 20)
    factor = factors.at(4)
    theirs = interop.gtsam.from_gaussian(
        factor.measured(), np.linalg.inv(factor.noiseModel().R().T @ factor.noiseModel().R())
    )
    assert_same(theirs.covariance, covariance, 1e-8)
    again = tmp_path / "again.g2o"
    gtsam.writeG2o(factors, values, str(again))
    back = g2o.read(again)
    assert back.poses.is_approx(graph.poses, 1e-4)
    np.testing.assert_allclose(back.information, graph.information, rtol=1e-4, atol=1e-1)


def test_g2o_text(graph: g2o.Graph) -> None:
    back = g2o.parse(g2o.format(graph))
    np.testing.assert_array_equal(back.ids, graph.ids)
    np.testing.assert_array_equal(back.edges, graph.edges)
    np.testing.assert_array_equal(back.information, graph.information)
    assert back.poses.is_approx(graph.poses)
    assert back.fixed == (0,)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("VERTEX_SE2 0 1 2 3\n", "g:1: got VERTEX_SE2, expected VERTEX_SE3:QUAT"),
        ("VERTEX_SE3:QUAT a 0 0 0 0 0 0 1\n", "g:1: got 'a', expected 1 vertex ids"),
        ("VERTEX_SE3:QUAT 1 0 0 0 0 0 0 1\n" * 2, "g:2: vertex 1 is there twice"),
        ("EDGE_SE3:QUAT 0 1 0 0 0 0 0 0 1 1\n", "g:1: got 8 numbers, expected 28"),
    ],
)
def test_g2o_errors_name_the_line(text: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        g2o.parse(text, "g")


def test_bop_results_in_millimetres(poses: SE3, tmp_path: Path) -> None:
    n = len(poses)
    ids = np.arange(n)
    results = bop.Results(ids // 5, ids, ids % 3, np.linspace(0, 1, n), poses, np.full(n, -1.0))
    path = tmp_path / "results.csv"
    bop.write_results(path, results)
    head, first, *_ = path.read_text().splitlines()
    assert head == "scene_id,im_id,obj_id,score,R,t,time"
    x = float(first.split(",")[5].split()[0])
    assert x == pytest.approx(1000.0 * poses.translation[0, 0], rel=1e-12)
    back = bop.read_results(path)
    assert back.poses.is_approx(poses, 1e-12)
    np.testing.assert_array_equal(back.scene_id, results.scene_id)
    np.testing.assert_array_equal(back.score, results.score)
    assert bop.parse_results(path.read_text().split("\n", 1)[1]).poses.is_approx(poses, 1e-12)


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ("1,2,3,1,1 0 0 0 1 0 0 0 1,0 0 0", "r:1: got 6 columns, expected 7"),
        ("1,x,3,1,1 0 0 0 1 0 0 0 1,0 0 0,-1", "expected three integers"),
        ("1,2,3,1,1 0 0 0 1 0 0 0,0 0 0,-1", "r:1: R: got 8 numbers, expected 9"),
        ("1,2,3,1,2 0 0 0 1 0 0 0 1,0 0 0,-1", "r:1: R: "),
    ],
)
def test_bop_errors_name_the_line(row: str, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        bop.parse_results(row + "\n", "r")


MODELS = {
    "1": {"diameter": 100.0},
    "5": {
        "diameter": 172.0,
        "symmetries_discrete": [[-1, 0, 0, 8, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]],
    },
    "13": {
        "diameter": 58.0,
        "symmetries_continuous": [{"axis": [0, 0, 2], "offset": [10, 0, 0]}],
        "symmetries_discrete": [[1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1]],
    },
}


def test_bop_symmetries() -> None:
    models = bop.parse_models(json.dumps(MODELS))
    assert len(models[1].elements) == 1
    flip = models[5].elements[1]
    np.testing.assert_allclose(flip.translation, [0.008, 0.0, 0.0])
    assert flip.rotation.angle() == pytest.approx(np.pi)
    (axis,) = models[13].axes
    np.testing.assert_allclose(axis.direction, [0.0, 0.0, 1.0])
    np.testing.assert_allclose(axis.turned(1.2).act(axis.point), axis.point, atol=1e-15)
    back = bop.parse_models(bop.format_models(models))
    assert back[13].elements.is_approx(models[13].elements)
    assert back[13].diameter == pytest.approx(0.058)
    np.testing.assert_allclose(back[13].axes[0].point, axis.point)


def test_bop_symmetries_in_steps() -> None:
    model = bop.parse_models(json.dumps(MODELS))[13]
    motions = bop.discretized(model, 0.1)
    assert len(motions) == 2 * 32
    assert motions[0].is_approx(SE3())
    expected = model.elements[1] * model.axes[0].turned(2 * np.pi * 5 / 32)
    assert motions[32 + 5].is_approx(expected)
    assert len(bop.discretized(bop.parse_models(json.dumps(MODELS))[5], 0.1)) == 2


def test_noise_modes_cover_the_symmetries(covariance: np.ndarray) -> None:
    models = bop.parse_models(json.dumps(MODELS))
    both = bop.noise_modes(models[5], covariance)
    assert [mode.weight for mode in both] == [0.5, 0.5]
    assert both[1].offset.is_approx(models[5].elements[1])
    np.testing.assert_allclose(both[0].covariance, covariance)
    # About an axis: the second moments of a uniform angle, the axis' point standing still.
    model = models[13]
    modes = bop.noise_modes(model, 1e-12 * np.eye(6))
    angles = np.linspace(-np.pi, np.pi, 20_001)
    errors = model.axes[0].turned(angles).log()
    np.testing.assert_allclose(
        modes[0].covariance, errors.T @ errors / len(angles), atol=1e-3 * np.pi**2 / 3
    )


@pytest.mark.parametrize(
    ("models", "message"),
    [
        ({"a": {}}, "got the key 'a', expected an object id"),
        ({"1": {}}, "m: 1: expected an object with the key diameter"),
        ({"1": {"diameter": 1, "symmetries_discrete": [[1, 2]]}}, r"symmetries_discrete\[0\]"),
        ({"1": {"diameter": 1, "symmetries_continuous": [{"axis": [0, 0, 1]}]}}, "axis and offset"),
    ],
)
def test_bop_model_errors(models: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        bop.parse_models(json.dumps(models), "m")


def test_files_are_written_whole_or_not(tmp_path: Path, poses: SE3) -> None:
    with pytest.raises(FileNotFoundError):
        tum.write(tmp_path / "missing" / "a.txt", np.zeros(20), poses)
    assert SO3().angle() == 0.0
    assert list(tmp_path.iterdir()) == []
