# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Recordings of live runs, and what their reports are made of."""

from __future__ import annotations

import json
import subprocess
import sys
import threading
import tracemalloc
from pathlib import Path

import numpy as np
import posemix as px
import pytest
from live_scene import LiveScene, live_frame

from posemix.live_view import LiveFrame, LiveRecording


def recorded(folder: Path, scene: LiveScene, **options: object) -> LiveRecording:
    recording = LiveRecording(folder, **options)
    for slam in scene.steps():
        recording.update(slam)
    return recording


def trace(folder: Path) -> dict:
    return json.loads((folder / "trace.json").read_text())


def test_the_trace_is_that_of_a_run(tmp_path: Path) -> None:
    """The same recording, live and by `run`, has the same trace up to what only a job knows."""
    scene = LiveScene(30)
    recorded(tmp_path / "live", scene).write_results()
    job = px.SlamJob(
        name="live", method="multi-object", sequence=scene.sequence, camera_prior=scene.prior, models=scene.models,
        settings=scene.settings, trace_hypotheses=8,
    )  # fmt: skip
    px.write_results(tmp_path / "run", job, px.run(job))
    live, run = trace(tmp_path / "live"), trace(tmp_path / "run")
    assert set(live) == set(run) - {"run"}
    for key in ("type", "schema", "frames", "stamps_s", "order", "merges"):
        assert live[key] == run[key], key
    # A live run has no ground truth, and so no NEES, which are of all keys null here.
    assert set(live["camera"]) == set(run["camera"]) - {"nees"}
    of_objects = [(live["objects"][name], run["objects"][name]) for name in run["order"]]
    for mine, theirs in of_objects:
        assert set(mine) == set(theirs) - {"nees_dof"}
        for key in ("status", "health", "register_again"):
            assert mine[key] == theirs[key], key
        for key in ("existence", "mode_probability", "nis"):
            assert close(mine[key], theirs[key]), key
        for k, alternatives in enumerate(mine["alternatives"]):
            assert [a["id"] for a in alternatives] == [a["id"] for a in theirs["alternatives"][k]]
    for mine, theirs in [(live["camera"], run["camera"]), *((m[p], t[p]) for m, t in of_objects for p in PLACES)]:
        for key in ("pose", "sd", "position_covariance", "covariance"):
            for a, b in zip(mine[key], theirs[key], strict=True):
                assert (a is None) == (b is None) and (a is None or close(a, b)), key


PLACES = ("world", "relative")


def close(a: list, b: list) -> bool:
    numbers = [np.array([np.nan if v is None else v for v in row], dtype=float) for row in (a, b)]
    return np.allclose(*numbers, rtol=1e-5, atol=1e-9, equal_nan=True)


def test_the_report_shows_the_run(tmp_path: Path) -> None:
    recording = recorded(tmp_path / "live", LiveScene(20, moves=True), name="table", model_names={"mug": ["walk"]})
    assert recording.write_report() == tmp_path / "live" / "report.html"
    page = (tmp_path / "live" / "report.html").read_text()
    start = page.index(">", page.index('id="posemix-report"')) + 1
    data = json.loads(page[start : page.index("</script>", start)].replace("\\u003c", "<"))
    assert data["kind"] == "slam" and data["title"] == "table: multi-object"
    assert data["trace"]["frames"] == 20 and data["trace"]["order"] == ["mug", "box"]
    assert data["trace"]["models"] == {"mug": ["walk"]}
    assert {"metrics.json", "mixture_mug.json", "mixture_box.json"} <= set(data["documents"])
    assert set(data["documents"]["metrics.json"]["objects"]) == {"mug", "box"}
    # The run goes on, and so may the recording.
    assert recording.write_report(tmp_path / "other.html", title="Again") == tmp_path / "other.html"
    assert "Again: " not in (tmp_path / "other.html").read_text()[:200]


def test_metrics_are_what_is_known_without_truth(tmp_path: Path) -> None:
    scene = LiveScene(20)
    recorded(tmp_path, scene).write_results()
    metrics = json.loads((tmp_path / "metrics.json").read_text())
    last = scene.slam.estimate().estimate
    mug = metrics["objects"]["mug"]
    assert mug["health"] == last.healths["mug"].name
    assert mug["existence"] == pytest.approx(last.existences["mug"], rel=1e-6)
    seen = int(px.is_known(scene.sequence.objects[0].detections).sum())
    assert mug["detections"] == seen
    assert sum(mug["health_shares"].values()) == pytest.approx(1.0)
    assert metrics["timing"]["frame_median_us"] > 0
    mixture = px.read_mixture(tmp_path / "mixture_mug.json")
    assert mixture.mixture[0].mean.is_approx(last.objects["mug"].mean, 1e-6)


def test_no_more_frames_than_wanted_and_none_of_them_in_memory(tmp_path: Path) -> None:
    """Many more frames than are kept: the file is bounded, and so is memory."""
    scene = LiveScene(3)
    for _ in scene.steps():
        pass
    frame = LiveFrame.of(scene.slam)
    assert frame is not None
    recording = LiveRecording(tmp_path, max_frames=50)
    tracemalloc.start()
    sizes = []
    for k in range(1600):
        recording.show(LiveFrame(0.1 * k, frame.estimate, frame.hypotheses))
        if k in (399, 1599):
            sizes.append(tracemalloc.get_traced_memory()[0])
    tracemalloc.stop()
    assert sizes[1] - sizes[0] < 20_000
    assert 25 <= recording.frames <= 51
    recording.write_results()
    found = trace(tmp_path)
    steps = np.diff(found["stamps_s"])
    assert found["frames"] == recording.frames and found["stamps_s"][0] == 0.0
    assert found["stamps_s"][-1] == pytest.approx(159.9)
    np.testing.assert_allclose(steps[:-1], steps[0])
    assert (tmp_path / "frames.jsonl").stat().st_size < 60 * 4000


def test_what_came_late_replaces_the_estimate_of_the_same_time(tmp_path: Path) -> None:
    scene = LiveScene(2)
    recording = LiveRecording(tmp_path)
    scene.slam.add_odometry(0.0, scene.sequence.odometry[0])
    recording.update(scene.slam)
    mug = px.Observation([px.ObservationComponent(scene.sequence.objects[0].detections[0])], object="mug", stamp_s=0.0)
    scene.slam.add(mug)
    assert recording.update(scene.slam) and recording.frames == 1
    recording.write_results()
    assert trace(tmp_path)["order"] == ["mug"]


def test_a_recording_begins_again_with_the_estimator(tmp_path: Path) -> None:
    recording = recorded(tmp_path, LiveScene(10, start_s=50.0))
    again = LiveScene(4)
    for slam in again.steps():
        recording.update(slam)
    recording.write_results()
    assert trace(tmp_path)["stamps_s"] == [again.stamp(k) for k in range(4)]


def test_a_recording_that_was_cut_off_has_what_was_written(tmp_path: Path) -> None:
    recorded(tmp_path, LiveScene(10))
    path = tmp_path / "frames.jsonl"
    lines = path.read_text().splitlines()
    assert json.loads(lines[0]) == {"type": "posemix.live", "schema": 1, "name": "live", "model_names": {}}
    assert [json.loads(line)["stamp_s"] for line in lines[1:]] == [LiveScene(10).stamp(k) for k in range(9)]
    path.write_text(path.read_text()[:-100])
    done = report_of(tmp_path)
    assert done.returncode == 0 and done.stdout.strip() == str(tmp_path / "report.html"), done.stderr
    assert trace(tmp_path)["frames"] == 8
    bad = {"[]\n": "is no recording", f"{lines[0]}\n": "there is no frame", "": "is no recording"}
    for text, expected in bad.items():
        path.write_text(text)
        done = report_of(tmp_path)
        assert done.returncode == 1 and expected in done.stderr and "Traceback" not in done.stderr
    path.unlink()
    assert "frames.jsonl" in report_of(tmp_path).stderr


def report_of(folder: Path) -> subprocess.CompletedProcess:
    command = [sys.executable, "-m", "posemix.live_view", str(folder)]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)


def test_a_report_is_made_while_frames_come(tmp_path: Path) -> None:
    frame = live_frame()
    recording = LiveRecording(tmp_path, max_frames=20)
    stop = threading.Event()

    def record() -> None:
        k = 0
        while not stop.is_set():
            # It begins again every now and then.
            recording.show(LiveFrame(0.1 * (k % 500), frame.estimate, frame.hypotheses))
            k += 1

    thread = threading.Thread(target=record)
    thread.start()
    try:
        for _ in range(20):
            recording.write_results()
            stamps = trace(tmp_path)["stamps_s"]
            assert 1 <= len(stamps) <= 21 and stamps == sorted(set(stamps))
    finally:
        stop.set()
        thread.join()


def test_objects_with_any_name_that_come_later(tmp_path: Path) -> None:
    scene = LiveScene(1)
    slam = px.StampedSlam(scene.prior, [], px.MultiObjectSlamSettings(on_sight=px.ObjectModel(id="any")))
    recording = LiveRecording(tmp_path)
    for k, names in enumerate([[], ["models/a b"], ["models/a b", "ü"]]):
        slam.add_odometry(0.1 * k, px.SE3())
        for name in names:
            seen = [px.ObservationComponent(px.SE3(translation=[0.1 * len(name), 0, 1.0]))]
            slam.add(px.Observation(seen, object=name, stamp_s=0.1 * k))
        recording.update(slam)
    assert recording.write_report().exists()
    found = trace(tmp_path)
    assert found["order"] == ["models/a b", "ü"]
    assert [pose is None for pose in found["objects"]["ü"]["world"]["pose"]] == [True, True, False]
    assert found["objects"]["ü"]["health"][:2] == ["none", "none"]
    assert (tmp_path / "mixture_models_a_b_0.json").exists()


def test_detections_are_in_the_trace_where_they_are_known(tmp_path: Path) -> None:
    scene = LiveScene(2)
    recording = LiveRecording(tmp_path)
    for k, slam in enumerate(scene.steps()):
        frame = LiveFrame.of(slam)
        assert frame is not None
        seen = {"mug": scene.sequence.objects[0].detections[k]} if k else {}
        recording.show(LiveFrame(frame.stamp_s, frame.estimate, frame.hypotheses, seen))
    recording.write_results()
    found = trace(tmp_path)["objects"]["mug"]["detection"]
    assert found[0] is None
    np.testing.assert_allclose(found[1], scene.sequence.objects[0].detections[1].to_tq(), atol=1e-8)


def test_errors_of_recordings(tmp_path: Path) -> None:
    recording = LiveRecording(tmp_path)
    with pytest.raises(ValueError, match="there is no frame to report so far"):
        recording.write_report()
    with pytest.raises(FileExistsError, match="frames.jsonl: there is a recording already"):
        LiveRecording(tmp_path)
    with pytest.raises(ValueError, match="max_frames is 1; expected at least 2"):
        LiveRecording(tmp_path / "other", max_frames=1)
    recording.close()
    frame = live_frame()
    assert not recording.show(frame)
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="file"):
        LiveRecording(tmp_path / "file")
