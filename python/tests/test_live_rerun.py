# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""A running estimator in Rerun, by recordings that are read back."""

from __future__ import annotations

import socket
import sys
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import posemix as px
import pytest
from live_scene import LiveScene
from rrd import columns, rr

from posemix.live_view import Frustum, LiveFrame, RerunView, open_view

FRUSTUM = Frustum(width=640, height=480, fx=600.0, fy=610.0, cx=320.0, cy=240.0)


def shown(path: Path, scene: LiveScene, **options: Any) -> dict[str, dict[str, list[Any]]]:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with RerunView(file=path, **options) as view:
            for slam in scene.steps():
                view.update(slam)
    return columns(path)


def test_camera_and_objects_are_those_of_the_estimate(tmp_path: Path) -> None:
    scene = LiveScene(20)
    found = shown(tmp_path / "live.rrd", scene, frustum=FRUSTUM, up="z")
    frame = LiveFrame.of(scene.slam)
    assert frame is not None and frame.names == ["mug", "box"]
    last = frame.estimate
    camera = found["world/camera/pose"]
    assert camera["time"][-1] == round(1e9 * frame.stamp_s)
    np.testing.assert_allclose(camera["Transform3D:translation"][-1][0], last.camera.mean.translation, rtol=1e-6)
    for name, world in last.objects.items():
        assert world is not None
        pose = found[f"world/{name}/pose"]["Transform3D:translation"][-1][0]
        np.testing.assert_allclose(pose, world.mean.translation, rtol=1e-6)
        ellipsoids = found[f"world/{name}/ellipsoids"]
        assert len(ellipsoids["Ellipsoids3D:centers"][-1]) == len(frame.hypotheses[name])
        labels = found[f"world/{name}/axes"]["Arrows3D:labels"][-1]
        of_object = last.object(name)
        shown_as = name if of_object.health.name == "good" else f"{name}, {of_object.health.name}:"
        assert labels[0].startswith(f"{shown_as} ") and len(labels) == 3 * len(frame.hypotheses[name])
        assert found[f"existence/{name}"]["Scalars:scalars"][-1] == [of_object.existence]
        assert found[f"mode_probability/{name}"]["Scalars:scalars"][-1] == [of_object.mode_probability]
    table = found["state"]["TextDocument:text"][-1][0]
    assert f"| mug | {last.healths['mug'].name} |" in table and "| box |" in table
    assert found["world/camera/pose/image"]["Pinhole:resolution"] == [[[640.0, 480.0]]]


def test_only_changes_of_health_are_in_the_log(tmp_path: Path) -> None:
    scene = LiveScene(25)
    expected: list[str] = []
    with RerunView(file=tmp_path / "live.rrd", rate_hz=1000.0) as view:
        for slam in scene.steps():
            view.update(slam)
            estimate = slam.estimate().estimate
            text = f"mug: {estimate.healths['mug'].name}"
            if estimate.objects["mug"] is not None and text not in expected[-1:]:
                expected.append(text)
    found = [row[0] for row in columns(tmp_path / "live.rrd")["health"]["TextLog:text"]]
    assert [text for text in found if text.startswith("mug")] == expected
    assert len(expected) > 1


def test_no_more_frames_than_wanted(tmp_path: Path) -> None:
    scene = LiveScene(21)
    stamps = [scene.stamp(k) for k in range(21)]
    rate = 0.5 / (stamps[1] - stamps[0])
    found = shown(tmp_path / "live.rrd", scene, rate_hz=rate)
    times = found["world/camera/pose"]["time"]
    np.testing.assert_allclose(times, [round(1e9 * s) for s in stamps[::2]], atol=1)


def test_what_moves_has_a_way_and_probabilities_of_models(tmp_path: Path) -> None:
    scene = LiveScene(20, moves=True)
    found = shown(tmp_path / "live.rrd", scene, model_names={"mug": ["walk"]}, rate_hz=1000.0)
    assert found["motion_models/mug/walk"]["Scalars:scalars"][-1] == [pytest.approx(1.0)]
    world = scene.slam.estimate().estimate.objects["mug"]
    way = found["world/mug/way"]["LineStrips3D:strips"]
    assert len(way[-1][0]) > len(way[0][0])
    seen = found["world/mug/pose"]["Transform3D:translation"]
    np.testing.assert_allclose(seen[-1][0], world.mean.translation, rtol=1e-6)
    assert "world/box/way" not in found


def test_objects_may_have_any_name(tmp_path: Path) -> None:
    scene = LiveScene(1)
    slam = px.StampedSlam(scene.prior, [], px.MultiObjectSlamSettings(on_sight=px.ObjectModel(id="any")))
    slam.add_odometry(0.0, px.SE3())
    seen = [px.ObservationComponent(px.SE3(translation=[0.1, 0, 1.0]))]
    slam.add(px.Observation(seen, object="models/a b", stamp_s=0.0))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with RerunView(file=tmp_path / "live.rrd") as view:
            view.update(slam)
    found = columns(tmp_path / "live.rrd")
    assert found[r"world/models\/a\ b/pose"]["Transform3D:translation"]
    assert found[r"existence/models\/a\ b"]["Scalars:scalars"]


def test_dates_are_a_timeline_of_their_own(tmp_path: Path) -> None:
    scene = LiveScene(3, start_s=1.7e9)
    camera = shown(tmp_path / "live.rrd", scene)["world/camera/pose"]
    assert "time" not in camera
    np.testing.assert_allclose(camera["date"][0], 1_700_000_000_000_000_000, atol=1000)


def test_what_began_again_is_cleared(tmp_path: Path) -> None:
    with RerunView(file=tmp_path / "live.rrd") as view:
        for slam in LiveScene(5, start_s=100.0).steps():
            view.update(slam)
        again = LiveScene(5)
        for slam in again.steps():
            view.update(slam)
    found = columns(tmp_path / "live.rrd")
    cleared = found["world/mug"]["Clear:is_recursive"]
    assert cleared == [[True]]
    first = found["world/camera/way"]["LineStrips3D:strips"][-1][0]
    start = again.prior.mean.translation
    assert np.linalg.norm(np.array(first[0]) - start) < 0.05


def test_viewers_connect_to_the_port(tmp_path: Path) -> None:
    port = free_port()
    view = RerunView(f":{port}", memory_limit="16MB")
    try:
        with pytest.raises(OSError, match=f"{port}: cannot be listened at: Address already in use"):
            RerunView(f":{port}")
        # Another view sends what it shows there, as to a viewer.
        with open_view("rerun", f"rerun+http://127.0.0.1:{port}/proxy") as sender:
            for slam in LiveScene(3).steps():
                assert sender.update(slam)
    finally:
        view.close()
        view.close()
    with pytest.raises(OSError, match="a viewer of Rerun .* does not listen there"):
        RerunView(f"rerun+http://127.0.0.1:{port}/proxy")


def test_a_viewer_that_goes_away_is_left_out() -> None:
    """Rerun waits some seconds for it, once, and not for every frame."""
    port = free_port()
    viewer = RerunView(f":{port}")
    scene = LiveScene(3)
    for _ in scene.steps():
        pass
    frame = LiveFrame.of(scene.slam)
    assert frame is not None
    sender = RerunView(f"rerun+http://127.0.0.1:{port}/proxy", rate_hz=1000.0)
    sender.show(frame)
    viewer.close()
    start = time.monotonic()
    for k in range(300):
        sender.show(LiveFrame(10.0 + 0.1 * k, frame.estimate, frame.hypotheses))
    assert time.monotonic() - start < 60.0
    sender.close()


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def test_bad_places(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="expected :PORT, as Rerun serves on all network interfaces"):
        RerunView("127.0.0.1:9876")
    with pytest.raises(ValueError, match="address is 'here'; expected HOST:PORT or :PORT"):
        RerunView("here")
    with pytest.raises(ValueError, match="expected one of address, file and recording"):
        RerunView(":9876", file=tmp_path / "a.rrd")
    with pytest.raises(ValueError, match="up is 'w'"):
        RerunView(file=tmp_path / "a.rrd", up="w")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="rate_hz is 0"):
        RerunView(file=tmp_path / "a.rrd", rate_hz=0)
    with pytest.raises(FileNotFoundError, match="nowhere"):
        RerunView(file=tmp_path / "nowhere" / "a.rrd")


def test_a_recording_of_the_caller_stays_open(tmp_path: Path) -> None:
    recording = rr.RecordingStream("mine")
    recording.save(str(tmp_path / "mine.rrd"))
    with RerunView(recording=recording) as view:
        for slam in LiveScene(2).steps():
            view.update(slam)
    recording.log("after", rr.TextLog("still there"))
    recording.disconnect()
    found = columns(tmp_path / "mine.rrd")
    assert found["after"]["TextLog:text"] == [["still there"]] and "world/camera/pose" in found


def test_without_the_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "rerun", None)
    with pytest.raises(ImportError, match=r"needs the package rerun: pip install posemix\[rerun\]"):
        RerunView()
