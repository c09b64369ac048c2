# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from .oracle import assert_same, jacobian_of, sampled_covariance

from posemix import SE3, SO3, ConcentratedGaussian
from posemix.interop import euler, ros


@pytest.fixture
def message_types(peer: Any) -> Any:
    typesys = peer("rosbags.typesys", "rosbags")
    return typesys.get_typestore(typesys.Stores.ROS2_HUMBLE).types


CASES = [("rotation_vector", "parent"), ("rotation_vector", "child"), ("rpy", "parent")]


def moved(pose: SE3, d: np.ndarray, reading: str, frame: str) -> SE3:
    """The pose with the error that a reader of the message has in mind; translation first."""
    dt, theta = d[..., :3], d[..., 3:]
    r, t = pose.rotation, pose.translation
    if reading == "rpy":
        return SE3(euler.from_rpy(euler.to_rpy(r) + theta), t + dt)
    if frame == "child":
        return SE3(r * SO3.exp(theta), t + r.act(dt))
    return SE3(SO3.exp(theta) * r, t + dt)


@pytest.mark.parametrize(("reading", "frame"), CASES)
def test_message_and_back(
    message_types: Any,
    pose: SE3,
    density: ConcentratedGaussian[SE3],
    reading: Any,
    frame: Any,
) -> None:
    message = ros.to_pose_with_covariance(
        density, reading=reading, frame=frame, types=message_types
    )
    assert message.covariance.shape == (36,)
    assert message.pose.position.x == pose.translation[0]
    assert message.pose.orientation.w == pose.rotation.quaternion[3]
    back = ros.from_pose_with_covariance(message, reading=reading, frame=frame)
    assert back.mean.is_approx(pose)
    assert_same(back.covariance, density.covariance, 1e-10)
    jacobian = jacobian_of(lambda d: moved(pose, d, reading, frame), pose)
    matrix = np.reshape(message.covariance, (6, 6))
    assert_same(jacobian @ matrix @ jacobian.T, density.covariance, 1e-6)


@pytest.mark.parametrize(("reading", "frame"), CASES)
def test_samples_have_the_covariance(
    pose: SE3, covariance: np.ndarray, reading: Any, frame: Any
) -> None:
    found = ros.covariance_from_ros(pose, covariance.ravel(), reading=reading, frame=frame)
    drawn = sampled_covariance(lambda d: moved(pose, d, reading, frame), pose, covariance)
    assert_same(found, drawn, 0.05)


def test_serialized_message(peer: Any, density: ConcentratedGaussian[SE3]) -> None:
    typesys = peer("rosbags.typesys", "rosbags")
    store = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE)
    message = ros.to_pose_with_covariance(
        density, reading="rotation_vector", frame="parent", types=store.types
    )
    name = "geometry_msgs/msg/PoseWithCovariance"
    back = store.deserialize_cdr(store.serialize_cdr(message, name), name)
    found = ros.from_pose_with_covariance(back, reading="rotation_vector", frame="parent")
    assert_same(found.covariance, density.covariance, 1e-12)


def test_readings_agree_only_where_the_pose_is_not_turned(covariance: np.ndarray) -> None:
    for turn, agrees in (([0.0, 0.0, 0.0], True), ([0.0, 0.6, 0.3], False)):
        mean = SE3(SO3.exp(turn), [1.0, 2.0, 3.0])
        a = ros.covariance_from_ros(
            mean, covariance.ravel(), reading="rotation_vector", frame="parent"
        )
        b = ros.covariance_from_ros(mean, covariance.ravel(), reading="rpy", frame="parent")
        assert np.allclose(a, b, rtol=1e-12) == agrees


def test_what_is_refused(pose: SE3, covariance: np.ndarray) -> None:
    values = covariance.ravel()
    with pytest.raises(ValueError, match="reading is 'euler'"):
        ros.covariance_from_ros(pose, values, reading="euler", frame="parent")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="frame is 'map'"):
        ros.covariance_from_ros(pose, values, reading="rpy", frame="map")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="is of the frame 'parent'"):
        ros.covariance_from_ros(pose, values, reading="rpy", frame="child")
    with pytest.raises(ValueError, match=r"expected \(..., 36\)"):
        ros.covariance_from_ros(pose, covariance, reading="rpy", frame="parent")
