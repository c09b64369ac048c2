# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""A running estimator in Foxglove, by the protocol of its viewers and by its files."""

from __future__ import annotations

import math
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from foxglove_client import FoxgloveClient, decoded
from live_scene import LiveScene
from test_live_rerun import FRUSTUM, free_port

pytest.importorskip("foxglove")

from posemix import TrackHealth
from posemix.live_view import FoxgloveView, LiveFrame, open_view

TF, SCENE, HEALTH, MUG = "/posemix/tf", "/posemix/scene", "/posemix/health", "/posemix/objects/mug"


def near(view: FoxgloveView) -> None:
    """Waits until the server knows of subscriptions."""
    for _ in range(200):
        if view._scene.has_sinks():
            return
        time.sleep(0.05)
    raise AssertionError("nobody has subscribed")


def test_a_viewer_sees_the_estimate() -> None:
    scene = LiveScene(20)
    steps = scene.steps()
    with FoxgloveView(f"127.0.0.1:{free_port()}", frustum=FRUSTUM, world_frame="map", rate_hz=1000) as view:
        view.update(next(steps))
        with FoxgloveClient(view.port or 0) as client:
            client.wait_for(MUG)
            assert client.info["name"] == "posemix"
            client.subscribe(TF, SCENE, HEALTH, MUG)
            near(view)
            for slam in steps:
                view.update(slam)
            found = client.poll(1.0)
    frame = LiveFrame.of(scene.slam)
    assert frame is not None
    last = {topic: (stamp, message) for topic, stamp, message in found}
    assert {stamp for stamp, _ in (last[TF], last[SCENE], last[MUG])} == {round(1e9 * frame.stamp_s)}
    transforms = {t.child_frame_id: t for t in last[TF][1].transforms}
    assert set(transforms) == {"camera", "mug", "box"}
    for name, pose in (("camera", frame.estimate.camera.mean), ("mug", frame.estimate.objects["mug"].mean)):
        t, q = transforms[name].translation, transforms[name].rotation
        assert transforms[name].parent_frame_id == "map"
        np.testing.assert_allclose([t.x, t.y, t.z], pose.translation)
        np.testing.assert_allclose([q.x, q.y, q.z, q.w], pose.rotation.quaternion)
    # An entity stays until there is another one of its name.
    entities = {e.id: e for topic, _, message in found if topic == SCENE for e in message.entities}
    assert set(entities) == {"mug/hypotheses", "box/hypotheses", "camera/way", "camera/frustum"}
    assert {e.id for e in last[SCENE][1].entities} >= set(entities) - {"camera/way"}
    assert 15 <= len(entities["camera/way"].lines[0].points) <= 20
    assert entities["camera/frustum"].frame_id == "camera"
    assert len(entities["camera/frustum"].lines[0].points) == 16
    state = last[MUG][1]
    assert state["existence"] == frame.estimate.existences["mug"]
    assert state["health"] == frame.estimate.healths["mug"].name
    assert state["mode_probability"] == frame.estimate.mode_probabilities["mug"]
    assert [h["id"] for h in state["hypotheses"]] == [h.id for h in sorted_hypotheses(frame)]
    logged = [message.message for topic, _, message in found if topic == HEALTH and message.name == "mug"]
    assert logged[-1] == state["health"]


def sorted_hypotheses(frame: LiveFrame) -> list[Any]:
    return sorted(frame.hypotheses["mug"], key=lambda h: -h.probability)


def test_ellipsoids_and_axes_are_those_of_all_hypotheses(tmp_path: Path) -> None:
    scene = LiveScene(20)
    with FoxgloveView(file=tmp_path / "live.mcap", rate_hz=1000) as view:
        for slam in scene.steps():
            view.update(slam)
    frame = LiveFrame.of(scene.slam)
    assert frame is not None
    entity = next(e for e in rows(tmp_path / "live.mcap")[SCENE][-1][1].entities if e.id == "mug/hypotheses")
    found = sorted_hypotheses(frame)
    total = sum(h.probability for h in found)
    assert len(entity.spheres) == len(found) and len(entity.arrows) == 3 * len(found)
    for hypothesis, sphere in zip(found, entity.spheres, strict=True):
        p = sphere.pose.position
        np.testing.assert_allclose([p.x, p.y, p.z], hypothesis.pose.translation)
        assert sphere.color.a == pytest.approx(0.05 + 0.6 * hypothesis.probability / total)
        # The volume is that of the covariance, 3 sigma.
        size = sphere.size
        at = hypothesis.pose.translation
        skew = np.array([[0, -at[2], at[1]], [at[2], 0, -at[0]], [-at[1], at[0], 0]])
        jacobian = np.hstack([-skew, np.eye(3)])
        expected = np.linalg.det(jacobian @ hypothesis.covariance @ jacobian.T)
        assert (size.x * size.y * size.z / 6**3) ** 2 == pytest.approx(expected, rel=1e-6)
    # Arrows lie along their x axes, which are those of the leading pose.
    for axis in range(3):
        q = entity.arrows[axis].pose.orientation
        x = np.array([1 - 2 * (q.y**2 + q.z**2), 2 * (q.x * q.y + q.z * q.w), 2 * (q.x * q.z - q.y * q.w)])
        np.testing.assert_allclose(x, found[0].pose.rotation.matrix()[:, axis], atol=1e-9)
    assert entity.texts[0].text.startswith("mug") and frame.estimate.healths["mug"].name in (
        "good", entity.texts[0].text.split(" ")[1].rstrip(":")
    )  # fmt: skip


def rows(path: Path) -> dict[str, list[tuple[int, Any]]]:
    """The messages of an MCAP file by topic."""
    reader = pytest.importorskip("mcap.reader")
    found: dict[str, list[tuple[int, Any]]] = {}
    with path.open("rb") as file:
        for schema, channel, message in reader.make_reader(file).iter_messages():
            decoded_one = decoded(channel.message_encoding, schema.name, schema.data, message.data)
            found.setdefault(channel.topic, []).append((message.log_time, decoded_one))
    return found


def test_a_file_has_every_frame_and_is_not_overwritten(tmp_path: Path) -> None:
    scene = LiveScene(10)
    with open_view("foxglove", str(tmp_path / "live.mcap"), rate_hz=1000) as view:
        for slam in scene.steps():
            assert view.update(slam)
        view.close()
    found = rows(tmp_path / "live.mcap")
    stamps = [round(1e9 * scene.stamp(k)) for k in range(10)]
    assert [stamp for stamp, _ in found[TF]] == stamps == [stamp for stamp, _ in found[SCENE]]
    assert found[MUG][0][1]["hypotheses"]
    with pytest.raises(FileExistsError, match="live.mcap"):
        FoxgloveView(file=tmp_path / "live.mcap")


def test_what_moves_has_a_way(tmp_path: Path) -> None:
    with FoxgloveView(file=tmp_path / "live.mcap", rate_hz=1000, model_names={"mug": ["walk"]}) as view:
        for slam in LiveScene(15, moves=True).steps():
            view.update(slam)
    found = rows(tmp_path / "live.mcap")
    ways = {e.id for _, message in found[SCENE] for e in message.entities if e.id.endswith("/way")}
    assert set(ways) == {"camera/way", "mug/way"}
    assert found[MUG][-1][1]["motion_models"] == {"walk": pytest.approx(1.0)}


def test_what_began_again_is_taken_away() -> None:
    with FoxgloveView(f"127.0.0.1:{free_port()}") as view:
        first = LiveScene(5, start_s=100.0)
        steps = first.steps()
        view.update(next(steps))
        with FoxgloveClient(view.port or 0) as client:
            client.wait_for(MUG)
            client.subscribe(SCENE)
            near(view)
            for slam in steps:
                view.update(slam)
            mug = client.channels[MUG]["id"]
            again = LiveScene(5)
            view.update(next(again.steps()))
            found = client.poll(1.0)
    deleted = [d.id for _, _, message in found for d in message.deletions]
    assert {"mug/hypotheses", "camera/way"} <= set(deleted)
    assert mug in client.gone
    last = found[-1][2]
    assert {e.id for e in last.entities} >= {"camera/way"} and not last.deletions


def test_an_object_that_is_forgotten_has_no_topic_any_more(tmp_path: Path) -> None:
    scene = LiveScene(5)
    with FoxgloveView(file=tmp_path / "live.mcap", rate_hz=1000) as view:
        for slam in scene.steps():
            view.update(slam)
        frame = LiveFrame.of(scene.slam)
        assert frame is not None
        without = LiveFrame(frame.stamp_s + 1.0, frame.estimate, {"box": frame.hypotheses["box"]})
        assert without.names == ["box"] and view.show(without)
    scenes = rows(tmp_path / "live.mcap")[SCENE]
    assert [d.id for d in scenes[-1][1].deletions] == ["mug/hypotheses"]
    assert not any(d for _, message in scenes[:-1] for d in message.deletions)


def test_lost_objects_are_warnings(tmp_path: Path) -> None:
    scene = LiveScene(30)
    with FoxgloveView(file=tmp_path / "live.mcap", rate_hz=1000) as view:
        for slam in scene.steps():
            view.update(slam)
        for k in range(300):  # nothing is seen any more of what should be
            stamp = scene.stamp(29) + 0.1 * (k + 1)
            scene.slam.add_odometry(stamp, scene.sequence.odometry[29])
            scene.slam.add_image(stamp)
            view.update(scene.slam)
    assert scene.slam.estimate().estimate.healths["mug"] == TrackHealth.lost
    logged = [m for _, m in rows(tmp_path / "live.mcap")[HEALTH] if m.name == "mug"]
    assert [m.message for m in logged][-2:] == ["lost", "lost: register again"]
    warning = logged[-1].level
    assert warning > logged[0].level


def test_places_that_cannot_be_used(tmp_path: Path) -> None:
    with FoxgloveView(f"127.0.0.1:{free_port()}") as view:
        with pytest.raises(OSError, match=f"127.0.0.1:{view.port}: cannot be listened at: Address already in use"):
            FoxgloveView(f"127.0.0.1:{view.port}")
    for bad in ("here", "localhost:", "localhost:70000", "ws://localhost:8765", "a:b:1"):
        with pytest.raises(ValueError, match="expected HOST:PORT or :PORT"):
            FoxgloveView(bad)
    with pytest.raises(OSError, match="cannot be listened at"):
        FoxgloveView("203.0.113.1:8765")
    with pytest.raises(ValueError, match="expected one of address and file"):
        FoxgloveView(":8765", file=tmp_path / "a.mcap")
    with pytest.raises(ValueError, match="view is 'rviz'; expected one of rerun, foxglove"):
        open_view("rviz")


def test_without_the_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "foxglove", None)
    with pytest.raises(ImportError, match=r"needs the package foxglove: pip install posemix\[foxglove\]"):
        FoxgloveView()


def test_a_frustum_has_corners() -> None:
    corners = FRUSTUM.corners()
    assert corners[0] == pytest.approx((-320 / 600 * 0.2, -240 / 610 * 0.2, 0.2))
    assert corners[2] == pytest.approx((320 / 600 * 0.2, 240 / 610 * 0.2, 0.2))
    with pytest.raises(ValueError, match="fx is nan; expected a positive number"):
        type(FRUSTUM)(640, 480, math.nan, 1.0, 0.0, 0.0)
