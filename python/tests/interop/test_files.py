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

from posemix import (
    SE3,
    SO3,
    BopModel,
    BopRows,
    ConcentratedGaussian,
    FrameInput,
    NoiseFrame,
    Clutter,
    ObjectModel,
    ObjectSlam,
    SymmetryGroup,
    interop,
    read_bop_models,
    read_bop_rows,
    read_tum,
    write_tum,
)
from posemix.interop import bop, g2o, kitti


def test_tum_and_evo(peer: Any, poses: SE3, tmp_path: Path) -> None:
    evo = peer("evo.tools.file_interface", "evo")
    stamps = 1.6e9 + np.arange(len(poses)) / 30.0
    ours, theirs = tmp_path / "ours.txt", tmp_path / "theirs.txt"
    write_tum(ours, stamps, poses)
    found = evo.read_tum_trajectory_file(str(ours))
    times, back = interop.evo.from_trajectory(found)
    np.testing.assert_array_equal(times, stamps)
    assert back.is_approx(poses)
    evo.write_tum_trajectory_file(str(theirs), interop.evo.to_trajectory(stamps, poses))
    back = read_tum(theirs)
    np.testing.assert_allclose(back.stamps, stamps, atol=1e-6)
    assert back.poses.is_approx(poses, 1e-8)


def test_kitti_and_evo(peer: Any, poses: SE3, tmp_path: Path) -> None:
    evo = peer("evo.tools.file_interface", "evo")
    ours, theirs = tmp_path / "ours.txt", tmp_path / "theirs.txt"
    kitti.write(ours, poses)
    assert interop.evo.from_path(evo.read_kitti_poses_file(str(ours))).is_approx(poses, 1e-8)
    evo.write_kitti_poses_file(str(theirs), interop.evo.to_path(poses))
    assert kitti.read(theirs).is_approx(poses, 1e-8)


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
    rows = BopRows(ids // 5, ids, ids % 3, np.linspace(0, 1, n), poses)
    path = tmp_path / "results.csv"
    bop.write_results(path, rows, time_s=0.25)
    head, first, *_ = path.read_text().splitlines()
    assert head == "scene_id,im_id,obj_id,score,R,t,time"
    *_, t, time = first.split(",")
    assert float(t.split()[0]) == pytest.approx(1000.0 * poses.translation[0, 0], rel=1e-12)
    assert time == "0.25"
    back = read_bop_rows(path)
    assert back.poses.is_approx(poses, 1e-12)
    np.testing.assert_array_equal(back.scene, rows.scene)
    np.testing.assert_array_equal(back.score, rows.score)


MODELS = {
    "1": {"diameter": 100.0, "min_x": -50, "min_y": -20, "min_z": -10, "size_x": 100, "size_y": 40, "size_z": 20},
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


@pytest.fixture
def models(tmp_path: Path) -> dict[int, BopModel]:
    path = tmp_path / "models_info.json"
    path.write_text(json.dumps(MODELS))
    return read_bop_models(path)


def test_bop_models_and_back(models: dict[int, BopModel], tmp_path: Path) -> None:
    flip = models[5].symmetries.elements[1]
    np.testing.assert_allclose(flip.translation, [0.008, 0.0, 0.0])
    path = tmp_path / "again.json"
    bop.write_models(path, models)
    back = read_bop_models(path)
    for key, model in models.items():
        assert back[key].diameter_m == pytest.approx(model.diameter_m)
        assert back[key].symmetries.elements.is_approx(model.symmetries.elements)
        assert len(back[key].symmetries.axes) == len(model.symmetries.axes)
    (axis,) = back[13].symmetries.axes
    np.testing.assert_allclose(axis.direction, [0.0, 0.0, 1.0])
    np.testing.assert_allclose(axis.point, [0.01, 0.0, 0.0])
    box = back[1].box
    assert box is not None
    np.testing.assert_allclose(box.size_m, [0.1, 0.04, 0.02])
    text = json.loads(path.read_text())
    assert "symmetries_discrete" not in text["1"]
    assert len(text["5"]["symmetries_discrete"]) == 1


def turned(angles: np.ndarray) -> SE3:
    """Turns about the line along z through (0.01, 0, 0), the axis of model 13."""
    line = SE3(translation=[0.01, 0.0, 0.0])
    return line * SE3(SO3.exp(np.multiply.outer(angles, [0.0, 0.0, 1.0]))) * line.inverse()


def test_bop_symmetries_in_steps(models: dict[int, BopModel]) -> None:
    group = models[13].symmetries
    motions = bop.discretized(group, 0.1)
    assert len(motions) == 2 * 32
    assert motions[0].is_approx(SE3())
    expected = group.elements[1] * turned(np.array(2 * np.pi * 5 / 32))
    assert motions[32 + 5].is_approx(expected)
    assert len(bop.discretized(models[5].symmetries, 0.1)) == 2
    with pytest.raises(ValueError, match="positive"):
        bop.discretized(group, 0.0)


def test_noise_modes_cover_the_symmetries(models: dict[int, BopModel], covariance: np.ndarray) -> None:
    flip = models[5].symmetries
    noise = bop.noise_modes(flip, covariance, clutter=Clutter(weight=0.25, volume_m3=1.0))
    assert [c.weight for c in noise.components] == pytest.approx([0.375, 0.375])
    assert {c.frame for c in noise.components} == {NoiseFrame.object}
    assert noise.components[1].offset.is_approx(flip.elements[1])
    np.testing.assert_allclose(noise.components[0].covariance, covariance)
    # About an axis: the second moments of a uniform angle, the axis' point standing still.
    around = bop.noise_modes(models[13].symmetries, 1e-12 * np.eye(6))
    errors = turned(np.linspace(-np.pi, np.pi, 20_001)).log()
    np.testing.assert_allclose(
        around.components[0].covariance, errors.T @ errors / len(errors), atol=1e-3 * np.pi**2 / 3
    )


def test_noise_modes_in_a_filter(models: dict[int, BopModel], covariance: np.ndarray) -> None:
    """One detection of an object that looks alike twice begins both hypotheses."""
    flip = models[5].symmetries
    noise = bop.noise_modes(flip, 0.01 * covariance)
    camera = ConcentratedGaussian(SE3(), 1e-6 * np.eye(6))
    slam = ObjectSlam(camera, [ObjectModel(id="clamp", noise=noise)])
    seen = SE3(translation=[0.0, 0.0, 1.0])
    slam.step(FrameInput(detections={"clamp": seen}))
    assert slam.multi_object is not None
    found = [hypothesis.pose for hypothesis in slam.multi_object.hypotheses(0)]
    for expected in (seen, seen * flip.elements[1].inverse()):
        assert any(pose.is_approx(expected, 1e-6) for pose in found)


def test_of_a_sphere_there_is_no_list() -> None:
    from posemix import SymmetryAxis

    axes = [SymmetryAxis(direction=direction) for direction in ([1, 0, 0], [0, 0, 1])]
    with pytest.raises(ValueError, match="3 axes; expected at most one"):
        bop.discretized(SymmetryGroup(axes=axes), 0.1)


def test_files_are_written_whole_or_not(tmp_path: Path, poses: SE3) -> None:
    with pytest.raises(FileNotFoundError):
        kitti.write(tmp_path / "missing" / "a.txt", poses)
    assert list(tmp_path.iterdir()) == []
