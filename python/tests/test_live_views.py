# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""What all live views have in common, and views in the background."""

from __future__ import annotations

import threading
import time
from pathlib import Path

import numpy as np
import posemix as px
import pytest
from live_scene import LiveScene, live_frame

from posemix.live_view import BackgroundView, LiveFrame, LiveRecording, View
from posemix.live_view.view import Way


def test_a_view_does_not_change_the_estimator() -> None:
    shown, alone = LiveScene(10), LiveScene(10)
    for slam, _ in zip(shown.steps(), alone.steps(), strict=True):
        LiveFrame.of(slam)
    mine, theirs = shown.slam.finish(), alone.slam.finish()
    assert mine.estimate.camera.mean.to_tq().tolist() == theirs.estimate.camera.mean.to_tq().tolist()
    assert mine.estimate.existences == theirs.estimate.existences


def test_other_estimators_are_named(tmp_path: Path) -> None:
    scene = LiveScene(1)
    with LiveRecording(tmp_path) as recording, pytest.raises(TypeError, match="got a ObjectSlam, expected a StampedS"):
        recording.update(px.ObjectSlam(scene.prior, scene.models))


def test_there_is_nothing_before_the_first_estimate(tmp_path: Path) -> None:
    recording = LiveRecording(tmp_path)
    assert not recording.update(LiveScene(1).slam)
    assert recording.frames == 0


@pytest.mark.parametrize("most", [2, 3, 10, 11])
def test_a_way_is_bounded_and_has_its_ends(most: int) -> None:
    way = Way(most)
    for k in range(1000):
        way.add(0.1 * k, np.array([k, 0.0, 0.0]))
        x = way.positions[:, 0]
        assert len(way) <= most + 1 and x[0] == 0 and x[-1] == k
        assert (np.diff(x) > 0).all()
    gaps = np.diff(way.positions[:, 0])
    assert gaps[:-1].max(initial=0) <= 2 * gaps[:-1].min(initial=np.inf) or most == 2


def test_a_long_way_is_shown_less_often() -> None:
    way = Way(most=1000)
    shown = 0
    for k in range(10_000):
        way.add(0.1 * k, np.array([k, 0.0, 0.0]))
        shown += len(way) if way.is_due(0.1 * k) else 0
    assert 0.9 * 500 <= shown / 1000.0 <= 550


def test_a_trail_is_short() -> None:
    way = Way(trail_s=1.0)
    for k in range(100):
        way.add(0.1 * k, np.array([k, 0.0, 0.0]))
    np.testing.assert_allclose(way.positions[:, 0], np.arange(89, 100), atol=1)
    with pytest.raises(ValueError, match="most is 1"):
        Way(1)


class Slow(View):
    def __init__(self) -> None:
        self.seen: list[float] = []
        self.go = threading.Event()
        self.is_closed = False

    def show(self, frame: LiveFrame) -> bool:
        self.go.wait(10.0)
        if frame.stamp_s == 3.0:
            raise RuntimeError("the viewer has gone away")
        self.seen.append(frame.stamp_s)
        return True

    def close(self) -> None:
        self.is_closed = True


def test_a_view_in_the_background_holds_nothing_up() -> None:
    frame, slow = live_frame(), Slow()
    view = BackgroundView(slow, depth=2)
    start = time.monotonic()
    for k in range(6):
        assert view.show(LiveFrame(float(k), frame.estimate, frame.hypotheses))
        if k == 0:
            assert not view.wait(0.05)
    assert time.monotonic() - start < 5.0
    slow.go.set()
    assert view.wait(10.0)
    assert slow.seen[-2:] == [4.0, 5.0] and len(slow.seen) + view.dropped == 6
    view.show(LiveFrame(3.0, frame.estimate, frame.hypotheses))
    view.show(LiveFrame(7.0, frame.estimate, frame.hypotheses))
    view.close()
    view.close()
    assert slow.is_closed and slow.seen[-1] == 7.0
    assert view.problem == "RuntimeError: the viewer has gone away"
    assert not view.show(frame)
    with pytest.raises(ValueError, match="depth is 0"):
        BackgroundView(slow, depth=0)
