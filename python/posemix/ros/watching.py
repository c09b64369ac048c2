# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""What the node shows live, and records for its report. It needs no ROS."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from posemix.live_view import BackgroundView, LiveFrame, LiveRecording, open_view
from posemix.ros.estimates import LiveEstimate

__all__ = ["Watch"]

# Frames that may wait for the recording, some seconds of a fast camera.
_DEPTH = 300


class Watch:
    """A live view and a recording, by the parameters of the node; both work in threads of their own.

    Parameters
    ----------
    values : mapping
        Values of the node's parameters: `view`, `view_address`, `view_hz`, `report_folder`, `report_frames`,
        `world_frame`.
    name : str
        Name of the node, for the title of the report.

    Raises
    ------
    ValueError, OSError, ImportError
        For an address that is none or is in use, a folder that cannot be written, a package that is missing.
    """

    def __init__(self, values: Mapping[str, Any], name: str) -> None:
        self._views: list[BackgroundView] = []
        self._recording: LiveRecording | None = None
        self._reported: float | None = None
        self._last_s: float | None = None
        self._lock = threading.Lock()
        if values["view"] != "none":
            more = {"up": "z"} if values["view"] == "rerun" else {"world_frame": values["world_frame"]}
            view = open_view(values["view"], values["view_address"], rate_hz=values["view_hz"], **more)
            self._views.append(BackgroundView(view))
        if values["report_folder"]:
            try:
                self._begin_recording(values, name)
            except BaseException:
                self.close()
                raise

    def _begin_recording(self, values: Mapping[str, Any], name: str) -> None:
        folder = _new_folder(Path(values["report_folder"]).expanduser())
        self._recording = LiveRecording(
            folder, name=name, max_frames=values["report_frames"], rate_hz=values["view_hz"]
        )
        self._views.append(BackgroundView(self._recording, _DEPTH))

    def show(self, estimate: LiveEstimate) -> None:
        """Shows and records an estimate."""
        if self._views:
            self._last_s = estimate.stamp_ns * 1e-9
            frame = LiveFrame(self._last_s, estimate.frame, estimate.hypotheses)
            for view in self._views:
                view.show(frame)

    @property
    def problems(self) -> list[str]:
        """What views have failed by since the last call."""
        found = []
        for view in self._views:
            if view.problem:
                found.append(f"a live view has failed: {view.problem}")
                view.problem = ""
        return found

    def report(self) -> tuple[bool, str]:
        """Writes the report of what was recorded so far: whether it could, and its path or the reason."""
        if self._recording is None:
            return False, "nothing is recorded: report_folder is empty"
        with self._lock:
            last_s = self._last_s
            self._views[-1].wait(5.0)
            try:
                path = self._recording.write_report()
            except Exception as error:  # who waits for an answer gets one
                return False, str(error)
            self._reported = last_s
            return True, str(path)

    def report_meanwhile(self, then: Callable[[tuple[bool, str]], None]) -> None:
        """Writes the report in a thread of its own, and calls `then` there with what `report` returns."""
        threading.Thread(target=lambda: then(self.report()), name="posemix-report", daemon=True).start()

    def report_at_end(self) -> tuple[bool, str] | None:
        """Writes the report where one is wanted and there is something new to report."""
        if self._recording is None or self._last_s is None or self._last_s == self._reported:
            return None
        return self.report()

    def close(self) -> None:
        """Lets go of the port and the files."""
        for view in self._views:
            view.close()
        self._views = []


def _new_folder(parent: Path) -> Path:
    """A folder for one run in the folder of all, by the date."""
    name = time.strftime("%Y%m%d-%H%M%S")
    for more in range(1000):
        folder = parent / (f"{name}-{more}" if more else name)
        try:
            folder.mkdir(parents=True)
        except FileExistsError:
            continue
        return folder
    raise FileExistsError(f"{parent / name}: there is something already")
