# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""All results of a detection as one observation, at its stamp."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pytest
from .bag_maker import KINDS, BagMaker

from posemix import (
    SE3,
    SO3,
    ConcentratedGaussian,
    StampedSlamSettings,
    StampJump,
    bags,
    pose_covariance,
)
from posemix.interop.ros import covariance_from_ros, to_pose

POSE = SE3(SO3.exp([0.3, -0.2, 0.1]), [0.1, 0.0, 1.0])
FLIPPED = POSE * SE3(SO3.exp([0.0, 0.0, np.pi]))
# x y z rx ry rz along fixed axes.
COVARIANCE = np.diag([1e-4, 4e-4, 9e-4, 1e-3, 2e-3, 3e-3])
ZEROS = np.zeros(36)

Result = tuple[str, float, SE3, Any]


def detect(
    bag: BagMaker,
    seconds: float,
    results: Sequence[Result],
    *,
    late: float = 0.0,
    flat: bool = False,
    array_seconds: float | None = None,
    frame: str = "camera",
) -> None:
    """Adds a message with one detection; `flat`: a Detection2D, as detectors of boxes in the image publish it."""
    made = []
    for class_id, score, pose, covariance in results:
        made.append(bag.result(class_id, score, pose))
        made[-1].pose.covariance = np.array(covariance, dtype=np.float64).ravel()
    header = bag.header(seconds, frame)
    extra: dict[str, Any] = {"id": ""}
    if flat:
        if bag.ros == 1:
            center = bag.make("geometry_msgs/msg/Pose2D", x=0.0, y=0.0, theta=0.0)
            data = np.zeros(0, dtype=np.uint8)
            extra = {
                "source_img": bag.make(
                    "sensor_msgs/msg/Image",
                    header=header, height=0, width=0, encoding="", is_bigendian=0, step=0, data=data,
                )
            }  # fmt: skip
        else:
            point = bag.make("vision_msgs/msg/Point2D", x=0.0, y=0.0)
            center = bag.make("vision_msgs/msg/Pose2D", position=point, theta=0.0)
        box = bag.make("vision_msgs/msg/BoundingBox2D", center=center, size_x=1.0, size_y=1.0)
    else:
        center = to_pose(SE3(), types=bag.store.types)
        box = bag.make("vision_msgs/msg/BoundingBox3D", center=center, size=bag.vector([1, 1, 1]))
        if bag.ros == 1:
            extra = {"source_cloud": bag.cloud(header)}
    kind = f"vision_msgs/msg/Detection{2 if flat else 3}D"
    found = bag.make(kind, header=header, results=made, bbox=box, **extra)
    of_array = seconds if array_seconds is None else array_seconds
    array = bag.make(f"{kind}Array", header=bag.header(of_array, frame), detections=[found])
    bag.add(seconds + late, "/objects", f"{kind}Array", array)


def observation_of(bag: BagMaker, results: Sequence[Result], **options: Any) -> Any:
    detect(bag, 0.0, results, **options)
    (found,) = bags.read(bag.write(), detections="/objects").detections.observations
    return found


@pytest.mark.parametrize("flat", [False, True])
@pytest.mark.parametrize("kind", KINDS)
def test_results_are_components(maker: Callable[[str], BagMaker], kind: str, flat: bool) -> None:
    results = [("7", 0.6, POSE, COVARIANCE), ("3", 0.5, SE3(), ZEROS), ("7", 0.2, FLIPPED, ZEROS)]
    found = observation_of(maker(kind), results, flat=flat)
    assert (found.class_id, found.object, found.score) == ("7", "", 0.6)
    np.testing.assert_allclose([c.weight for c in found.components], [0.75, 0.25])
    first, second = found.components
    assert first.pose.is_approx(POSE, 1e-12)
    assert second.pose.is_approx(FLIPPED, 1e-12)
    assert second.covariance is None
    # The same density by another way: the left perturbation of the message's covariance, moved to the right.
    left = covariance_from_ros(POSE, COVARIANCE.ravel(), reading="rotation_vector", frame="parent")
    to_right = np.linalg.inv(POSE.adjoint())
    np.testing.assert_allclose(first.covariance, to_right @ left @ to_right.T, atol=1e-15)


def test_covariances_of_errors_along_the_camera(maker: Callable[[str], BagMaker]) -> None:
    """Poses drawn as the message defines its covariance have the covariance of the component."""
    (component,) = observation_of(maker("mcap"), [("7", 1.0, POSE, COVARIANCE)]).components
    rng = np.random.default_rng(2)
    errors = rng.multivariate_normal(np.zeros(6), COVARIANCE * 1e-2, size=20000)
    drawn = SE3(SO3.exp(errors[:, 3:]) * POSE.rotation, POSE.translation + errors[:, :3])
    tangents = (POSE.inverse() * drawn).log()
    # Sampling errors of variances are 1 % here.
    np.testing.assert_allclose(np.cov(tangents.T) * 1e2, component.covariance, atol=1e-4)


@pytest.mark.parametrize(
    ("scores", "weights"),
    [
        ([0.9, 0.9, 0.2], [0.45, 0.45, 0.1]),
        ([30.0, 10.0], [0.75, 0.25]),
        ([0.5, 0.0], [1.0]),
        ([0.0, 0.0], [0.5, 0.5]),
        ([-1.0, -7.0, 2.0], [1 / 3] * 3),
        ([np.inf, 1.0], [0.5, 0.5]),
        ([1e308, 1e308], [0.5, 0.5]),
    ],
)
def test_weights_are_scores_where_they_can_be(
    maker: Callable[[str], BagMaker], scores: list[float], weights: list[float]
) -> None:
    results = [("7", score, POSE, ZEROS) for score in scores]
    if np.isfinite(scores).all():
        found = observation_of(maker("mcap"), results)
        np.testing.assert_allclose([c.weight for c in found.components], weights)
    of_all = bags.weights_of_scores(scores)
    np.testing.assert_allclose(of_all[of_all > 0], weights)


def test_fields_that_hold_no_covariance(maker: Callable[[str], BagMaker]) -> None:
    unknown = COVARIANCE.copy()
    unknown[0, 0] = -1
    for i, none in enumerate([ZEROS, np.eye(6), unknown]):
        assert bags.is_placeholder_covariance(np.ravel(none))
        bag = maker("mcap")
        bag.path = bag.path / str(i)
        bag.path.parent.mkdir(exist_ok=True)
        (component,) = observation_of(bag, [("7", 1.0, POSE, none)]).components
        assert component.covariance is None
    assert not bags.is_placeholder_covariance(COVARIANCE.ravel())
    assert not bags.is_placeholder_covariance(0.01 * np.eye(6).ravel())


@pytest.mark.parametrize(
    ("entry", "reason"),
    [
        ((4, 4, -1e-3), "eigenvalue -0.001, expected a positive definite"),
        ((0, 1, 1e-4), "not symmetric"),
        ((2, 2, np.nan), "not finite"),
    ],
)
def test_a_covariance_that_is_none(
    maker: Callable[[str], BagMaker], entry: tuple[int, int, float], reason: str
) -> None:
    bad = COVARIANCE.copy()
    bad[entry[:2]] = entry[2]
    bag = maker("mcap")
    detect(bag, 0.5, [("7", 1.0, POSE, COVARIANCE), ("7", 1.0, POSE, bad)])
    with pytest.raises(ValueError, match=rf"/objects: detection 0 at 1700000000500000000 ns: result 1: .*{reason}"):
        bags.read(bag.write(), detections="/objects")


def test_the_frame_of_the_detection(maker: Callable[[str], BagMaker]) -> None:
    """In another frame the poses are others, and errors along the object's axes are the same."""
    bag = maker("mcap")
    mount = SE3.exp([0.4, 0.1, 0.2, 0.1, 0.2, 0.3])
    bag.transform(0.0, "base", "camera", mount, "/tf_static")
    detect(bag, 0.0, [("7", 0.5, POSE, COVARIANCE), ("7", 0.5, FLIPPED, ZEROS)])
    path = bag.write()
    (camera,) = bags.read(path, detections="/objects").detections.observations
    (base,) = bags.read(path, detections="/objects", camera_frame="base").detections.observations
    for here, there in zip(camera.components, base.components, strict=True):
        assert there.pose.is_approx(mount * here.pose, 1e-12)
    np.testing.assert_array_equal(base.components[0].covariance, camera.components[0].covariance)


def test_stamps_of_detections_come_first(maker: Callable[[str], BagMaker]) -> None:
    """An array may have the time at which it was published."""
    bag = maker("mcap")
    for i in range(3):
        detect(bag, i / 10, [("7", 1.0, POSE, np.eye(6))], flat=True, array_seconds=i / 10 + 0.07)
    recording = bags.read(bag.write(), detections="/objects")
    np.testing.assert_allclose(recording.stamps, [0.0, 0.1, 0.2], atol=1e-9)
    assert recording.stamps_ns[0] % 1_000_000_000 == 0
    assert [o.stamp_s for o in recording.detections.observations] == recording.stamps.tolist()


def test_arrays_of_one_image_are_one_frame(maker: Callable[[str], BagMaker]) -> None:
    bag = maker("mcap")
    for i in range(2):
        detect(bag, i / 10, [("7", 1.0, POSE, ZEROS)], array_seconds=i / 10 + 0.05)
        detect(bag, i / 10, [("9", 1.0, POSE, ZEROS)], array_seconds=i / 10 + 0.07)
    recording = bags.read(bag.write(), detections="/objects")
    assert recording.detections.frame.tolist() == [0, 0, 1, 1]
    assert recording.detections.class_id == ("7", "9", "7", "9")
    np.testing.assert_allclose(recording.stamps, [0.0, 0.1], atol=1e-9)


def test_boxes_in_the_image_have_no_pose(maker: Callable[[str], BagMaker]) -> None:
    bag = maker("mcap")
    detect(bag, 0.0, [("7", 1.0, POSE, ZEROS)], flat=True)
    with pytest.raises(ValueError, match="boxes in the image"):
        bags.read(bag.write(), detections="/objects", pose="bbox")


def test_both_poses_of_every_detection_stay(maker: Callable[[str], BagMaker]) -> None:
    """Two results with weights: both ways round are hypotheses from the first frame on."""
    bag = maker("mcap")
    for i in range(6):
        detect(bag, i / 10, [("7", 0.7, POSE, ZEROS), ("7", 0.3, FLIPPED, ZEROS)])
    found = bags.run_slam(bag.write(), detections="/objects")
    for mixture in found.objects[0].mixtures:
        apart = [(POSE.inverse() * density.mean).rotation.angle() for density in mixture]
        assert min(apart) < 0.2
        assert max(apart) > 3.0


def test_a_given_covariance_is_used(maker: Callable[[str], BagMaker]) -> None:
    def spread(name: str, covariance: Any) -> float:
        bag = maker("mcap")
        bag.path = bag.path.parent / name
        for i in range(3):
            detect(bag, i / 10, [("7", 1.0, POSE, covariance)])
        track = bags.run_slam(bag.write(), detections="/objects").objects[0]
        return float(np.trace(track.covariances[0]))

    default = spread("none", ZEROS)
    assert spread("identity", np.eye(6)) == default
    assert spread("wide", np.diag([1e-2] * 3 + [1e-1] * 3)) > 2 * default


@pytest.mark.parametrize("odometry", [False, True])
def test_late_messages_are_taken_in_at_their_stamps(
    maker: Callable[[str], BagMaker], odometry: bool
) -> None:
    """Late within the history: the end is that of the sorted stream; beyond it they are refused and counted."""

    def run(name: str, late: dict[int, float]) -> bags.BagRun:
        bag = maker("mcap")
        bag.path = bag.path.parent / name
        rng = np.random.default_rng(1)
        for i in range(20):
            noise = SE3.exp(0.01 * rng.standard_normal(6))
            moved = SE3(translation=[0.02 * i, 0.0, 0.0])
            if odometry:
                bag.odometry(i / 10, moved)
            pose = (moved.inverse() if odometry else SE3()) * POSE * noise
            detect(bag, i / 10, [("7", 1.0, pose, ZEROS)], late=late.get(i, 0.0), frame="base")
        return bags.run_slam(
            bag.write(), detections="/objects", odometry="/odom" if odometry else None,
            stamped=StampedSlamSettings(history_s=1.0),
        )  # fmt: skip

    ordered = run("ordered", {})
    assert (ordered.late, ordered.too_late) == (0, 0)
    assert len(ordered.objects[0].stamps_ns) == 20
    mixed = run("mixed", {4: 0.75, 9: 0.35, 13: 0.21})
    assert (mixed.late, mixed.too_late) == (3, 0)
    # A row per time at which the newest stamp is another one.
    assert (np.diff(mixed.objects[0].stamps_ns) > 0).all()
    for a, b in ((ordered.camera, mixed.camera), (ordered.objects[0], mixed.objects[0])):
        assert a.stamps_ns[-1] == b.stamps_ns[-1]
        np.testing.assert_array_equal(a.poses[-1].to_tq(), b.poses[-1].to_tq())
        np.testing.assert_array_equal(a.covariances[-1], b.covariances[-1])
    refused = run("refused", {4: 1.55})
    assert (refused.late, refused.too_late) == (0, 1)


def test_a_clock_that_jumps_back(maker: Callable[[str], BagMaker]) -> None:
    bag = maker("mcap")
    for i, seconds in enumerate([100.0, 100.1, 0.0, 0.1, 0.2]):
        detect(bag, seconds, [("7", 1.0, POSE, ZEROS)], late=200.0 + i - seconds)
    path = bag.write()
    with pytest.raises(ValueError, match="jumped back"):
        bags.run_slam(path, detections="/objects")
    prior = ConcentratedGaussian(SE3(), pose_covariance(0.001, 0.002))
    found = bags.run_slam(
        path, detections="/objects", camera_prior=prior, stamped=StampedSlamSettings(on_jump_back=StampJump.reset)
    )
    assert len(found.camera.stamps_ns) == 3
