# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Square tags against OpenCV."""

from __future__ import annotations

import gzip
import os
from pathlib import Path

import numpy as np
import pytest

import posemix as px

cv2 = pytest.importorskip("cv2")
optimize = pytest.importorskip("scipy.optimize")

SIZE = 0.15
INTRINSICS = [600.0, 602.0, 640.0, 512.0]
MATRIX = np.array([[600.0, 0, 640], [0, 602, 512], [0, 0, 1]])
RADTAN = np.array([-0.2, 0.05, 0.001, -0.0005])
FISHEYE = np.array([-0.013, -0.0099, 0.0121, -0.0045])
# In the order of AprilTag, and in that of IPPE_SQUARE.
POINTS = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * SIZE / 2
SQUARE = POINTS[[3, 2, 1, 0]]


def camera(distortion: np.ndarray | None) -> px.CameraModel:
    if distortion is None:
        return px.CameraModel(INTRINSICS)
    return px.CameraModel(INTRINSICS, px.DistortionModel.radtan, distortion)


def random_view(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Rotation matrix and translation of a tag that faces the camera, at any tilt up to 88 degrees."""
    z = np.exp(rng.uniform(np.log(0.3), np.log(6.0)))
    t = np.array([rng.uniform(-0.8, 0.8) * z, rng.uniform(-0.6, 0.6) * z, z])
    axis = np.cross(t, rng.normal(size=3))
    normal = cv2.Rodrigues(np.radians(rng.uniform(0, 88)) * axis / np.linalg.norm(axis))[0] @ (-t / np.linalg.norm(t))
    x = np.cross(rng.normal(size=3), normal)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(normal, x), normal]), t


def opencv_minima(pixels: np.ndarray, distortion: np.ndarray | None) -> list[tuple[float, np.ndarray]]:
    """Squared error and rotation of both solutions of IPPE after refinement, without those that are one."""
    image = pixels[[3, 2, 1, 0]]
    _, rotations, translations, _ = cv2.solvePnPGeneric(
        SQUARE, image, MATRIX, distortion, flags=cv2.SOLVEPNP_IPPE_SQUARE
    )

    def errors(x: np.ndarray) -> np.ndarray:
        return (cv2.projectPoints(SQUARE, x[:3], x[3:], MATRIX, distortion)[0][:, 0] - image).ravel()

    found: list[tuple[float, np.ndarray]] = []
    for start in zip(rotations, translations, strict=True):
        r, t = cv2.solvePnPRefineLM(SQUARE, image, MATRIX, distortion, *(x.copy() for x in start))
        # OpenCV stops after 20 steps; what is left is the same search by MINPACK.
        end = optimize.least_squares(errors, np.concatenate([r, t]).ravel(), method="lm", xtol=1e-14, ftol=1e-14)
        rotation = cv2.Rodrigues(end.x[:3])[0]
        if end.x[5] > 0 and all(np.linalg.norm(rotation - other) > 1e-4 for _, other in found):
            found.append((2 * end.cost, rotation))
    return sorted(found, key=lambda minimum: minimum[0])


@pytest.mark.parametrize("distortion", [None, RADTAN], ids=["pinhole", "radtan"])
def test_minima_are_those_of_opencv(distortion: np.ndarray | None) -> None:
    rng = np.random.default_rng(1)
    both = 0
    for i in range(250):
        rotation, t = random_view(rng)
        pixels = cv2.projectPoints(POINTS, cv2.Rodrigues(rotation)[0], t, MATRIX, distortion)[0][:, 0]
        pixels += rng.normal(size=pixels.shape) * [0.0, 0.2, 0.5, 1.0][i % 4]
        expected = opencv_minima(pixels, distortion)
        minima = px.tag_minima(pixels, SIZE, camera(distortion))
        both += len(expected) == 2
        for error, matrix in expected:
            distances = [np.linalg.norm(m.pose.rotation.matrix() - matrix) for m in minima]
            assert min(distances) < 1e-5, f"view {i}"
            assert minima[int(np.argmin(distances))].squared_error == pytest.approx(error, abs=1e-6)
    assert both > 150


def test_fisheye_is_that_of_opencv() -> None:
    rng = np.random.default_rng(2)
    fisheye = px.CameraModel(INTRINSICS, px.DistortionModel.equidistant, FISHEYE)
    points = rng.normal(size=(200, 3)) * [1.0, 1.0, 0.3] + [0, 0, 1.2]
    points = points[points[:, 2] > 0.3]
    pixels = cv2.fisheye.projectPoints(points[:, None], np.zeros(3), np.zeros(3), MATRIX, FISHEYE)[0][:, 0]
    np.testing.assert_allclose(fisheye.project(points), pixels, atol=1e-8)
    inside = np.hypot(*(pixels - INTRINSICS[2:]).T) < 700
    straight = cv2.fisheye.undistortPoints(pixels[inside][:, None], MATRIX, FISHEYE, criteria=(3, 200, 1e-15))[:, 0]
    rays = fisheye.rays(pixels[inside])
    np.testing.assert_allclose(rays[:, :2] / rays[:, 2:], straight, rtol=1e-6, atol=1e-9)
    assert np.isnan(px.CameraModel(INTRINSICS).project([[0.0, 0.0, -1.0]])).all()


def test_minima_of_a_fisheye_are_minima() -> None:
    rng = np.random.default_rng(3)
    fisheye = px.CameraModel(INTRINSICS, px.DistortionModel.equidistant, FISHEYE)

    def errors(x: np.ndarray, pixels: np.ndarray) -> np.ndarray:
        image = cv2.fisheye.projectPoints(POINTS[:, None], x[:3], x[3:], MATRIX, FISHEYE)[0][:, 0]
        return (image - pixels).ravel()

    for _ in range(50):
        rotation, t = random_view(rng)
        truth = np.concatenate([cv2.Rodrigues(rotation)[0].ravel(), t])
        pixels = errors(truth, np.zeros((4, 2))).reshape(4, 2) + rng.normal(size=(4, 2)) * 0.3
        minima = px.tag_minima(pixels, SIZE, fisheye)
        assert minima
        for minimum in minima:
            x = np.concatenate([minimum.pose.rotation.log(), minimum.pose.translation])
            end = optimize.least_squares(errors, x, args=(pixels,), method="lm", xtol=1e-14, ftol=1e-14)
            assert minimum.squared_error == pytest.approx(2 * end.cost, abs=1e-7)
            assert np.linalg.norm(x[3:] - end.x[3:]) < 1e-5 * np.linalg.norm(t)


def rendered(truth: px.SE3, model: px.CameraModel) -> np.ndarray:
    """A picture of tag 5 of the family 36h11."""
    tags = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    border = [100] * 4
    printed = cv2.copyMakeBorder(cv2.aruco.generateImageMarker(tags, 5, 400), *border, cv2.BORDER_CONSTANT, value=255)
    paper = np.array([[-0.75, 0.75], [0.75, 0.75], [0.75, -0.75], [-0.75, -0.75]]) * SIZE
    edges = model.project([(truth.matrix() @ [x, y, 0, 1])[:3] for x, y in paper])
    pixels = np.array([[0, 0], [600, 0], [600, 600], [0, 600]]) - 0.5
    warp = cv2.getPerspectiveTransform(pixels.astype(np.float32), edges.astype(np.float32))
    return cv2.warpPerspective(printed, warp, (1280, 1024), flags=cv2.INTER_AREA, borderValue=128)


@pytest.mark.parametrize("refinement", [cv2.aruco.CORNER_REFINE_SUBPIX, cv2.aruco.CORNER_REFINE_APRILTAG])
def test_a_rendered_tag_is_seen_where_it_is(refinement: int) -> None:
    model = px.CameraModel(INTRINSICS)
    facing = px.SE3.exp([np.pi, 0, 0, 0, 0, 0])
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = refinement
    tags = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    detector = cv2.aruco.ArucoDetector(tags, parameters)
    for tilt in ([0.5, 0.3, 0.2], [0.9, -0.4, 1.5], [-0.2, 0.8, -2.5]):
        truth = px.SE3(translation=[0.05, -0.02, 0.8]) * facing * px.SE3.exp([*tilt, 0, 0, 0])
        (corners,), ids, _ = detector.detectMarkers(rendered(truth, model))
        assert ids.ravel().tolist() == [5]
        # The quads of libapriltag count from the edge of the first pixel.
        corners = corners[0] - (0.5 if refinement == cv2.aruco.CORNER_REFINE_APRILTAG else 0.0)
        seen = px.tag_poses(corners, SIZE, model, px.CornerNoise(0.3, dof=4.0), order=px.CornerOrder.aruco)
        errors = (truth.inverse() * seen.poses).log()
        nearest = int(np.argmin(np.linalg.norm(errors[:, :3], axis=1)))
        # Corners of a detector are good to some tenths of a pixel: a centimetre and three degrees at 0.8 m.
        assert np.linalg.norm(errors[nearest, :3]) < 0.05 and np.linalg.norm(errors[nearest, 3:]) < 0.01
        assert nearest == 0
        assert seen.covariances.shape == (len(seen), 6, 6)


def test_noise_is_learned_from_minima() -> None:
    rng = np.random.default_rng(4)
    model = camera(None)
    minima = []
    for _ in range(800):
        rotation, t = random_view(rng)
        pixels = cv2.projectPoints(POINTS, cv2.Rodrigues(rotation)[0], t, MATRIX, None)[0][:, 0]
        minima.append(px.tag_minima(pixels + rng.normal(size=pixels.shape) * 0.25, SIZE, model))
    fit = px.fit_corner_noise(minima)
    assert fit.converged and fit.noise.sd_px == pytest.approx(0.25, rel=0.1) and fit.noise.dof > 10


def test_a_recording_is_read_and_written(tmp_path: Path) -> None:
    rng = np.random.default_rng(5)
    rows = ["stamp_s,topic,tag,u0_px,v0_px,u1_px,v1_px,u2_px,v2_px,u3_px,v3_px"]
    for i in range(60):
        rotation, t = random_view(rng)
        pixels = cv2.projectPoints(POINTS, cv2.Rodrigues(rotation)[0], t, MATRIX, None)[0][:, 0]
        pixels += rng.normal(size=pixels.shape) * 0.2
        rows.append(f"{0.1 * i},/tags,{i % 4}," + ",".join(f"{x:.4f}" for x in pixels.ravel()))
    (tmp_path / "corners.csv.gz").write_bytes(gzip.compress("\n".join(rows).encode()))
    corners = px.read_corners(tmp_path / "corners.csv.gz")
    assert len(corners) == 60 and corners[3].tag == 3 and corners[3].corners.shape == (4, 2)
    cameras = [px.RigCamera("left", px.CameraModel(INTRINSICS), topics=["/tags"])]
    tags = px.TagMap(default_size_m=SIZE, ignored={3})
    seen = px.observe_fiducials(corners, cameras, tags)
    assert seen.sightings == 60 and seen.ignored == 15 and len(seen) == 45 - seen.without_pose
    assert seen.noise[0].camera == "left"
    total = np.bincount(seen.sighting, seen.weights)
    np.testing.assert_allclose(total, 1.0, atol=1e-12)
    assert seen.poses.shape == seen.weights.shape and len(seen.cameras) == len(seen.tags) == len(seen)
    px.write_fiducials(tmp_path / "out", corners, cameras, tags)
    table = (tmp_path / "out" / "observations.csv").read_text().splitlines()
    assert len(table) == 1 + len(seen.weights)
    with pytest.raises(ValueError, match="corners.csv.gz:2: got the topic"):
        px.observe_fiducials(corners, [px.RigCamera("right", px.CameraModel(INTRINSICS))], tags)
    with pytest.raises(ValueError, match="expected 4"):
        px.CameraModel(INTRINSICS, px.DistortionModel.equidistant, [0.1])
    with pytest.raises(ValueError, match="corners"):
        px.tag_minima(np.zeros((3, 2)), SIZE, camera(None))


@pytest.mark.skipif("POSEMIX_DATA" not in os.environ, reason="no recorded sequences: set POSEMIX_DATA")
def test_files_of_tagslam_are_read() -> None:
    folder = Path(os.environ["POSEMIX_DATA"]) / "tagslam" / "test_9"
    cameras = px.read_cameras(folder / "cameras.yaml", folder / "camera_poses.yaml")
    tags = px.read_tag_map(folder / "tagslam.yaml")
    assert [c.name for c in cameras] == ["cam0", "cam1"] and cameras[1].rig_camera.covariance.shape == (6, 6)
    assert tags.size_m[3] == 0.15
    assert 20 in tags.ignored and tags.priors[3].pose.translation == pytest.approx([1.742, 3.033, 1.14])
    seen = px.observe_fiducials(px.read_corners(folder / "corners.csv.gz"), cameras, tags)
    assert len(seen) == 4077 and seen.ignored == 93
