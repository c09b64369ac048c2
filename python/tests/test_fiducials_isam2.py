# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Scores of fiducial SLAM by known answers, and iSAM2 on a small simulated recording."""

from __future__ import annotations

import csv
import math
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

PROGRAMS = Path(__file__).parents[2] / "bench" / "python"
if not PROGRAMS.exists():
    pytest.skip("the programs are not beside the package", allow_module_level=True)
sys.path.insert(0, str(PROGRAMS))

import fiducials_files as files
import fiducials_score as score

Array = np.ndarray[Any, Any]

STAMPS = np.arange(60) / 10
CAMERAS = {"left": np.eye(4), "right": files.to_poses(np.array([0.2, 0, 0, 0, 0.1, 0, 1]))[0]}
ROTATION_SD, TRANSLATION_SD = 0.005, 0.003


def pose(rotation: Array | list[float], translation: Array | list[float]) -> Array:
    """Of a rotation vector and a translation."""
    vector = np.asarray(rotation, dtype=float)
    angle = np.linalg.norm(vector)
    axis = vector / angle if angle > 0 else vector
    numbers = np.concatenate([translation, np.sin(angle / 2) * axis, [np.cos(angle / 2)]])
    return files.to_poses(numbers)[0]


def rig_path(stamps: Array = STAMPS) -> files.Trajectory:
    """A circle about the tags' wall, looking ahead along z."""
    poses = [pose([0, 0.3 * math.sin(t), 0.1 * t], [math.cos(t), 0.5 * math.sin(t), 0.05 * t]) for t in stamps]
    return files.Trajectory(stamps, np.array(poses))


def tags() -> dict[str, Array]:
    """Tags 3 m ahead that look back, turned about the vertical axis by 0.6 to 0.8 rad."""
    return {str(i): pose([0, math.pi - 0.6 - 0.05 * i, 0], [i - 2.0, 0.3 * i - 0.6, 3]) for i in range(5)}


def second(camera_tag: Array) -> Array:
    """The other pose of a tag in a camera: its normal is mirrored at the line of sight."""
    sight, normal = -camera_tag[:3, 3] / np.linalg.norm(camera_tag[:3, 3]), camera_tag[:3, 2]
    axis = np.cross(normal, sight)
    angle = np.arctan2(np.linalg.norm(axis), normal @ sight)
    turned = camera_tag.copy()
    turned[:3, :3] = pose(2 * angle * axis / np.linalg.norm(axis), [0, 0, 0])[:3, :3] @ camera_tag[:3, :3]
    return turned


def write_folder(folder: Path, flipped: float, rng: np.random.Generator) -> None:
    """A folder as of `posemix fiducials`; in a part of the sightings the wrong pose has the larger weight."""
    covariance = np.diag([ROTATION_SD**2] * 3 + [TRANSLATION_SD**2] * 3)
    upper = ",".join(f"{x:g}" for x in covariance[files.UPPER])
    rows, sighting = [], 0
    for stamp, rig in zip(STAMPS, rig_path().poses, strict=True):
        for camera, mounting in CAMERAS.items():
            for name, tag in tags().items():
                noise = pose(rng.normal(0, ROTATION_SD, 3), rng.normal(0, TRANSLATION_SD, 3))
                seen = files.inverse(rig @ mounting) @ tag @ noise
                weights = (0.3, 0.7) if rng.random() < flipped else (0.7, 0.3)
                for weight, one in zip(weights, (seen, second(seen)), strict=True):
                    numbers = ",".join(files.pose_numbers(one))
                    rows.append(f"{stamp},{camera},,{name},,{sighting},{weight},{numbers},{upper}\n")
                sighting += 1
    folder.mkdir()
    columns = ["stamp_s", "camera", "detector", "id", "class", "sighting", "weight", *files.POSE_COLUMNS]
    (folder / "observations.csv").write_text(",".join([*columns, *files.COVARIANCE_COLUMNS]) + "\n" + "".join(rows))
    files.write_named_poses(folder / "cameras.csv", "camera", CAMERAS)


def write_odometry(folder: Path) -> None:
    """The true motion, in another frame."""
    path = rig_path()
    files.write_tum(folder / "odometry.tum", files.Trajectory(STAMPS, pose([0.3, 0.2, 1], [4, 5, 6]) @ path.poses))


def test_poses_survive_their_files(tmp_path: Path) -> None:
    files.write_tum(tmp_path / "path.tum", rig_path())
    back = files.read_tum(tmp_path / "path.tum")
    np.testing.assert_allclose(back.poses, rig_path().poses, atol=1e-10)
    half = pose([0, math.pi, 0], [1, 2, 3])  # qw is zero
    np.testing.assert_allclose(files.to_poses(np.array(files.pose_numbers(half), dtype=float))[0], half, atol=1e-10)


def test_interpolation_is_at_a_constant_rate_and_stops_at_gaps() -> None:
    ends = np.array([pose([0, 0, 0], [0, 0, 0]), pose([0, 0, 1], [1, 0, 0]), pose([0, 0, 1], [9, 0, 0])])
    path = files.Trajectory(np.array([0, 0.1, 5.0]), ends)
    poses, valid = path.at(np.array([-1.0, 0.025, 0.1, 3.0, 5.0, 6.0]))
    np.testing.assert_array_equal(valid, [False, True, True, False, True, False])
    np.testing.assert_allclose(poses[1], pose([0, 0, 0.25], [0.25, 0, 0]), atol=1e-12)
    np.testing.assert_allclose(poses[[2, 4]], ends[1:], atol=1e-12)


def test_a_path_in_another_frame_has_no_error_and_a_scaled_one_has() -> None:
    path, other = rig_path(), pose([1, 2, 0.5], [3, 2, 1])
    found = score.score_path(files.Trajectory(STAMPS, files.inverse(other) @ path.poses), path)
    assert found.max_m < 1e-12
    np.testing.assert_allclose(found.alignment, other, atol=1e-12)
    larger = path.poses.copy()
    larger[:, :3, 3] *= 1.1
    spread = path.poses[:, :3, 3] - path.poses[:, :3, 3].mean(axis=0)
    found = score.score_path(files.Trajectory(STAMPS, larger), path)
    assert found.rms_m == pytest.approx(0.1 * np.sqrt(np.mean(np.sum(spread**2, axis=1))), rel=1e-9)


def test_paths_without_common_stamps_are_refused() -> None:
    path = rig_path()
    with pytest.raises(ValueError, match="0 stamps"):
        score.score_path(files.Trajectory(STAMPS + 100, path.poses), path)


def test_reference_tags_do_not_follow_the_weights(tmp_path: Path) -> None:
    """Two of three leading poses are wrong; the true ones are where the tag stays."""
    write_folder(tmp_path / "tags", 0.66, np.random.default_rng(1))
    observations = files.read_sightings(tmp_path / "tags" / "observations.csv")
    found = score.reference_tags(observations, CAMERAS, rig_path())
    assert set(found) == set(tags())
    for name, tag in tags().items():
        assert score.angles_deg(found[name].pose, tag) < 0.2  # sd of the median of 120: 0.03 deg per axis
        assert found[name].share == 1
    best = observations.best()
    detector = score.wrong_modes(best, CAMERAS, found, rig_path())
    expected = observations.weights[1::2] > 0.5
    turns = score.angles_deg(observations.poses[::2], observations.poses[1::2])
    assert detector.sightings == 600 and detector.wrong == np.sum(expected & (turns > 15))


def test_wrong_modes_are_counted_by_sighting_frame_and_tag(tmp_path: Path) -> None:
    write_folder(tmp_path / "tags", 0, np.random.default_rng(3))
    best = files.read_sightings(tmp_path / "tags" / "observations.csv").best()
    truth = {name: score.ReferenceTag(tag, 1, 1, 0) for name, tag in tags().items()}
    assert score.wrong_modes(best, CAMERAS, truth, rig_path()).wrong == 0
    chosen = np.flatnonzero((best.ids == "3") & (best.stamps < 1.05))  # eleven frames, two cameras
    best.poses[chosen] = [second(one) for one in best.poses[chosen]]
    found = score.wrong_modes(best, CAMERAS, truth, rig_path())
    assert (found.wrong, found.wrong_frames, found.by_tag["3"]) == (22, 11, (120, 22))
    assert found.wrong_at_last == []
    last = best.rows(best.stamps < 1.05)
    assert score.wrong_modes(last, CAMERAS, truth, rig_path()).wrong_at_last == ["3"]
    assert found.share == 22 / 600 and found.frame_share == 11 / 60
    half = pose([0.5, 0, 0], [0, 0, 0])
    turned = {name: tag @ half if name == "2" else tag for name, tag in tags().items()}
    assert score.wrong_tags(turned, np.eye(4), truth) == ["2"]


def test_a_camera_without_a_pose_is_calibrated_by_the_reference(tmp_path: Path) -> None:
    write_folder(tmp_path / "tags", 0.1, np.random.default_rng(4))
    observations = files.read_sightings(tmp_path / "tags" / "observations.csv")
    found = score.calibrated_cameras(observations, {"left": CAMERAS["left"]}, rig_path())
    assert score.angles_deg(found["right"], CAMERAS["right"]) < 0.2
    assert np.linalg.norm(found["right"][:3, 3] - CAMERAS["right"][:3, 3]) < 0.02


@pytest.mark.parametrize("kernel", ["huber", "cauchy", "dcs"])
@pytest.mark.parametrize("with_odometry", [True, False])
def test_isam2_recovers_the_path_and_the_tags(tmp_path: Path, kernel: str, with_odometry: bool) -> None:
    pytest.importorskip("gtsam")
    import fiducials_isam2 as isam2

    write_folder(tmp_path / "tags", 0.05, np.random.default_rng(5))
    if with_odometry:
        write_odometry(tmp_path / "tags")
    report = isam2.run(tmp_path / "tags", tmp_path / "out", isam2.Settings(kernel=kernel))
    assert report["frames"] == 60 and report["tags"] == 5 and report["restarts"] == 0
    scores = score.score_folder(tmp_path / "tags", tmp_path / "out", rig_path())
    # A tag at 3 m places the rig to 3 m * 0.005 rad, ten sightings to 5 mm; 1 of 20 is wrong.
    assert scores["rms_m"] < 0.02
    assert scores["sightings"] == 600 and scores["wrong_share"] < 0.01 and scores["wrong_tags"] == 0
    assert 0.02 < scores["detector_wrong_share"] < 0.08
    assert ("odometry_rms_m" in scores) == with_odometry


def test_sightings_of_little_weight_are_not_used_but_scored(tmp_path: Path) -> None:
    pytest.importorskip("gtsam")
    import fiducials_isam2 as isam2

    write_folder(tmp_path / "tags", 0, np.random.default_rng(7))
    table = tmp_path / "tags" / "observations.csv"
    lines = table.read_text().splitlines(keepends=True)
    # Tag 4 and, after the first frame, the camera on the right are never certain.
    certain = [line.replace(",0.7,", ",0.95,").replace(",0.3,", ",0.05,") for line in lines]
    doubtful = [",4,," in line or (",right," in line and not line.startswith("0.0,")) for line in lines]
    chosen = [line if is_doubtful else other for line, other, is_doubtful in zip(lines, certain, doubtful, strict=True)]
    table.write_text("".join(chosen))
    report = isam2.run(tmp_path / "tags", tmp_path / "out", isam2.Settings(least_weight=0.9))
    assert report["frames"] == 60 and report["tags"] == 4
    scores = score.score_folder(tmp_path / "tags", tmp_path / "out", rig_path())
    assert scores["sightings"] == 480 and scores["wrong_share"] == 0


def test_known_tags_give_the_frame_of_the_map(tmp_path: Path) -> None:
    pytest.importorskip("gtsam")
    import fiducials_isam2 as isam2

    write_folder(tmp_path / "tags", 0, np.random.default_rng(6))
    upper = ",".join(f"{x:g}" for x in (1e-8 * np.eye(6))[files.UPPER])
    rows = [f"{name},0.15,{','.join(files.pose_numbers(tag))},{upper}\n" for name, tag in list(tags().items())[:2]]
    columns = ",".join(["id", "size_m", *files.POSE_COLUMNS, *files.COVARIANCE_COLUMNS])
    (tmp_path / "tags" / "tag_priors.csv").write_text(columns + "\n" + "".join(rows))
    isam2.run(tmp_path / "tags", tmp_path / "out", isam2.Settings(), with_priors=True)
    found = files.read_named_poses(tmp_path / "out" / "tags.csv", "id")
    for name, tag in tags().items():
        assert np.linalg.norm(found[name][:3, 3] - tag[:3, 3]) < 0.02 and score.angles_deg(found[name], tag) < 0.5


CAMERA = """cam0:
  camera_model: pinhole
  intrinsics: [400, 400, 640, 512]
  distortion_model: radtan
  distortion_coeffs: [0, 0, 0, 0]
  resolution: [1280, 1024]
  tagtopic: /tags
"""


def write_recording(folder: Path, rng: np.random.Generator) -> None:
    """Corners of tags with an edge of 0.3 m, with 0.2 px of noise, and odometry that drifts at twice the rate."""
    corners = 0.15 * np.array([[-1, -1, 0, 0], [1, -1, 0, 0], [1, 1, 0, 0], [-1, 1, 0, 0]]) + [0, 0, 0, 1]
    rows = ["stamp_s,topic,tag,u0_px,v0_px,u1_px,v1_px,u2_px,v2_px,u3_px,v3_px"]
    for stamp, rig in zip(STAMPS, rig_path().poses, strict=True):
        for name, tag in tags().items():
            seen = (files.inverse(rig) @ tag @ corners.T).T
            pixels = 400 * seen[:, :2] / seen[:, 2:3] + [640, 512] + rng.normal(0, 0.2, (4, 2))
            rows.append(",".join([f"{stamp}", "/tags", name, *(f"{x:.3f}" for x in pixels.ravel())]))
    folder.mkdir(parents=True)
    (folder / "corners.csv").write_text("\n".join(rows) + "\n")
    (folder / "cameras.yaml").write_text(CAMERA)
    path = rig_path(np.arange(119) / 20)
    files.write_tum(folder / "reference_rig.tum", path)
    drift = np.array([pose([0, 0, 0.03 * t], [0.04 * t, 0, 0]) for t in path.stamps])
    path.poses = pose([0.3, 0.2, 1], [4, 5, 6]) @ path.poses @ drift
    files.write_tum(folder / "odometry.tum", path)


def test_the_study_scores_isam2_beside_the_filter_from_the_same_input(tmp_path: Path) -> None:
    pytest.importorskip("gtsam", reason="GTSAM, the peer of `posemix study fiducials`, is not installed")
    program = os.environ.get("POSEMIX_PROGRAM")
    if not program:
        pytest.skip("POSEMIX_PROGRAM, the path of the program, is not set")
    write_recording(tmp_path / "tagslam" / "wall", np.random.default_rng(8))
    peer = f"'{sys.executable}' '{PROGRAMS / 'fiducials_isam2.py'}' --sequence-noise"
    command = [program, "study", "fiducials", "--data", str(tmp_path), "--out", str(tmp_path / "out"), "--quiet"]
    settings = ["size_m=0.3", "inputs=['best']", f'peers.isam2="{peer}"']
    subprocess.run([*command, *(word for one in settings for word in ("--set", one))], check=True)
    tables = []
    for table in ("fiducials.csv", "timing.csv"):
        with open(tmp_path / "out" / table) as file:
            tables.append(list(csv.DictReader(line for line in file if not line.startswith("#"))))
    for row in tables[0]:
        assert row["frames"] == "119" and row["frames_not_finite"] == "0"
        assert row["scored_sightings"] == row["sightings"] and row["scored_frames"] == "60"
        # Tags at 3 m are turned by degrees at 0.2 px, and place the rig to centimetres; the odometry is off by more.
        assert float(row["camera_rms_m"]) < 0.03 < float(row["odometry_rms_m"])
        assert float(row["wrong_frame_share"]) <= float(row["detector_wrong_frame_share"])
    assert [row["input"] for row in tables[0]] == [row["input"] for row in tables[1]] == ["best", "isam2"]
    assert len({row["detector_wrong_share"] for row in tables[0]}) == 1
    assert all(float(row["times_real_time"]) > 0 for row in tables[1])


def test_the_programs_describe_themselves() -> None:
    pytest.importorskip("gtsam")
    for program in ("fiducials_isam2.py", "fiducials_score.py"):
        shown = subprocess.run([sys.executable, PROGRAMS / program, "--help"], capture_output=True, text=True)
        assert shown.returncode == 0 and "FOLDER" in shown.stdout
