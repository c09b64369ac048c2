# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from .bag_maker import KINDS, SECOND, START

from posemix import SE3, SO3, ConcentratedGaussian, Mixture, TrackHealth, bags


def mixture(shift: float) -> Mixture[ConcentratedGaussian[SE3]]:
    base = SE3(SO3.exp([0.3, shift, 0.2]), [1.0, 2.0, shift])
    flipped = base * SE3(SO3.exp([0.0, 0.0, np.pi]))
    covariance = np.diag([0.01, 0.02, 0.03, 1e-4, 2e-4, 3e-4])
    return Mixture(
        [ConcentratedGaussian(base, covariance), ConcentratedGaussian(flipped, 2 * covariance)],
        [0.3, 0.7],
    )


def track(name: str = "object 7", class_id: str = "7") -> bags.Track:
    mixtures = tuple(mixture(0.1 * i) for i in range(5))
    return bags.Track(
        name, class_id, START + np.arange(5) * SECOND // 10,
        SE3.from_tq(np.stack([m[1].mean.to_tq() for m in mixtures])),
        np.stack([m[1].covariance for m in mixtures]), mixtures,
    )  # fmt: skip


def camera() -> bags.Track:
    poses = SE3.exp(np.linspace(0, 1, 18).reshape((3, 6)))
    return bags.Track("camera", "", START + np.arange(3) * SECOND, poses, np.tile(np.eye(6), (3, 1, 1)))


def with_states() -> bags.Track:
    states = [
        bags.TrackState(TrackHealth.none),
        bags.TrackState(TrackHealth.tentative, 0.1 + 0.2, False, (1 / 3, 2 / 3)),
        bags.TrackState(TrackHealth.good, 1.0, False, (1e-300, 1.0)),
        bags.TrackState(TrackHealth.inconsistent, 0.9),
        bags.TrackState(TrackHealth.lost, 5e-324, True, (0.5, 0.5)),
    ]
    return replace(track(), states=tuple(states))


@pytest.mark.parametrize("kind", KINDS)
def test_states_and_back(tmp_path: Path, kind: Any) -> None:
    from rosbags.highlevel import AnyReader

    path = tmp_path / ("out.bag" if kind == "ros1" else "out")
    written = with_states()
    bags.write(path, [camera(), written], frame="world", storage=kind)
    assert bags.read_track(path, written.name).states == written.states
    assert bags.read_track(path, "camera").states == ()
    with AnyReader([path]) as reader:
        found = {c.topic: [] for c in reader.connections}
        for connection, arrival, data in reader.messages():
            found[connection.topic].append((arrival, reader.deserialize(data, connection.msgtype)))
    states = found["/posemix/object_7/state"]
    assert [arrival for arrival, _ in states] == written.stamps_ns.tolist()
    assert [message.status[0].level for _, message in states] == [1, 1, 0, 2, 2]
    assert states[-1][1].status[0].message == "lost" and states[-1][1].status[0].name == "object 7"
    ((arrival, path_message),) = found["/posemix/object_7/path"]
    assert arrival == written.stamps_ns[-1] and path_message.header.frame_id == "world"
    places = [[p.pose.position.x, p.pose.position.y, p.pose.position.z] for p in path_message.poses]
    np.testing.assert_allclose(places, written.poses.translation)


@pytest.mark.parametrize("kind", KINDS)
def test_tracks_and_back(tmp_path: Path, kind: Any) -> None:
    path = tmp_path / ("out.bag" if kind == "ros1" else "out")
    bags.write(path, [camera(), track()], frame="world", storage=kind)
    for written in (camera(), track()):
        found = bags.read_track(path, written.name)
        np.testing.assert_array_equal(found.stamps_ns, written.stamps_ns)
        assert found.poses.is_approx(written.poses, 1e-12)
        np.testing.assert_allclose(found.covariances, written.covariances, atol=1e-12)
        assert found.class_id == written.class_id
        assert len(found.mixtures) == len(written.mixtures)
    # The heaviest component comes first.
    for a, b in zip(found.mixtures, written.mixtures, strict=True):
        np.testing.assert_allclose(a.weights, b.weights[::-1])
        assert a[0].mean.is_approx(b[1].mean)
        np.testing.assert_allclose(a[1].covariance, b[0].covariance, atol=1e-12)


def test_messages_are_what_ros_expects(tmp_path: Path) -> None:
    from rosbags.highlevel import AnyReader

    path = tmp_path / "out"
    bags.write(path, [track()], frame="world")
    with AnyReader([path]) as reader:
        kinds = {c.topic: c.msgtype for c in reader.connections}
        assert kinds == {
            "/posemix/object_7/pose": "geometry_msgs/msg/PoseWithCovarianceStamped",
            "/posemix/object_7/mixture": "vision_msgs/msg/Detection3D",
        }
        for connection, arrival, data in reader.messages():
            message: Any = reader.deserialize(data, connection.msgtype)
            assert message.header.frame_id == "world"
            assert message.header.stamp.sec * SECOND + message.header.stamp.nanosec == arrival
            if connection.msgtype.endswith("Detection3D"):
                assert message.id == "object 7"
                assert [r.hypothesis.class_id for r in message.results] == ["7", "7"]
                assert sum(r.hypothesis.score for r in message.results) == pytest.approx(1.0)
                assert message.bbox.center == message.results[0].pose.pose


def test_what_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "out"
    with pytest.raises(ValueError, match="two tracks have the topic /posemix/a_b"):
        bags.write(path, [track("a b"), track("a/b")], frame="world")
    with pytest.raises(ValueError, match="got the class 'mug', expected an integer"):
        bags.write(path, [track(class_id="mug")], frame="world", storage="ros1")
    assert list(tmp_path.iterdir()) == []
    bags.write(path, [track()], frame="world")
    with pytest.raises(FileExistsError, match="something already"):
        bags.write(path, [track()], frame="world")
    with pytest.raises(ValueError, match="no topic /posemix/mug/pose; there are: /posemix/object_7"):
        bags.read_track(path, "mug")
    with pytest.raises(ValueError, match="expected 'mcap', 'sqlite3' or 'ros1'"):
        bags.write(tmp_path / "b", [], frame="world", storage="zip")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="track 'x': 2 stamps"):
        bags.Track("x", "", np.arange(2), SE3.identity(3), np.zeros((2, 6, 6)))
    with pytest.raises(ValueError, match="track 'object 7': 5 stamps, .* 5 mixtures, 1 states"):
        replace(track(), states=(bags.TrackState(TrackHealth.good),))
