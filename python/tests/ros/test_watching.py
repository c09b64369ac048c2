# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The node's live view and report, without ROS."""

from __future__ import annotations

import json
import socket
import threading
from pathlib import Path
from typing import Any

import pytest

from posemix.ros import Engine, configuration
from posemix.ros.watching import Watch

from .test_modules import image


def watched(values: dict[str, Any], images: int = 10, watch: Watch | None = None) -> Watch:
    """A watch over an engine that has taken so many images in."""
    found = configuration({"motion.model": "still", **values})
    engine, watch = Engine(found), watch or Watch(found.values, "posemix")
    for k in range(images):
        engine.add(image(1.7e9 + 0.2 * k))
        for estimate in engine.ready(0.0):
            watch.show(estimate)
    return watch


def test_the_report_of_a_node(tmp_path: Path) -> None:
    watch = watched({"report_folder": str(tmp_path), "report_frames": 8, "view_hz": 100.0})
    is_written, page = watch.report()
    assert is_written and Path(page).read_text().startswith("<!")
    trace = json.loads((Path(page).parent / "trace.json").read_text())
    assert trace["name"] == "posemix" and trace["order"] == ["mug"]
    assert trace["stamps_s"][0] == pytest.approx(1.7e9) and trace["stamps_s"][-1] == pytest.approx(1.7e9 + 1.8)
    assert len(trace["stamps_s"]) <= 9
    assert watch.report_at_end() is None, "there is nothing new"
    watch.close()
    watch.close()
    assert not watch.problems


def test_a_report_in_the_background(tmp_path: Path) -> None:
    watch = watched({"report_folder": str(tmp_path)})
    done, found = threading.Event(), []
    watch.report_meanwhile(lambda result: (found.append(result), done.set()))
    assert done.wait(30.0) and found[0][0] and Path(found[0][1]).exists()
    watch.close()


def test_runs_have_folders_of_their_own(tmp_path: Path) -> None:
    values = {"report_folder": str(tmp_path / "new")}
    for _ in range(3):
        watched(values, 1).close()
    assert len(list((tmp_path / "new").iterdir())) == 3


def test_nothing_is_shown_or_recorded_by_default() -> None:
    watch = watched({})
    assert watch.report() == (False, "nothing is recorded: report_folder is empty")
    assert watch.report_at_end() is None
    watch.close()


def test_views_of_a_node(tmp_path: Path) -> None:
    pytest.importorskip("foxglove")
    pytest.importorskip("rerun")
    for view, name in (("rerun", "a.rrd"), ("foxglove", "a.mcap")):
        watch = watched({"view": view, "view_address": str(tmp_path / name)})
        watch.close()
        assert (tmp_path / name).stat().st_size > 1000
        assert not watch.problems


def test_a_view_that_cannot_be_leaves_nothing_behind(tmp_path: Path) -> None:
    pytest.importorskip("foxglove")
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        values = {"view": "foxglove", "view_address": f"127.0.0.1:{port}", "report_folder": str(tmp_path / "runs")}
        with pytest.raises(OSError, match=f"127.0.0.1:{port}: cannot be listened at"):
            watched(values)
    assert not (tmp_path / "runs").exists()
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="file"):
        watched({"view": "foxglove", "view_address": f"127.0.0.1:{port}", "report_folder": str(tmp_path / "file")})
    # The port was given back.
    watched({"view": "foxglove", "view_address": f"127.0.0.1:{port}"}, 1).close()


def test_bad_parameters_are_named() -> None:
    for bad, expected in (
        ({"view": "rviz"}, "view is 'rviz'; expected one of none, rerun, foxglove"),
        ({"view_hz": 0.0}, "view_hz is 0.0; expected a positive number"),
        ({"report_frames": 1}, "report_frames is 1; expected at least 2"),
    ):
        with pytest.raises(ValueError, match=expected):
            configuration(bad)
