# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""A recording of a live run, for its report."""

from __future__ import annotations

import json
import os
import re
import threading
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from posemix._core import write_mixture, write_report
from posemix._files import whole_file
from posemix.live_view.entries import HEADER, entry_of
from posemix.live_view.frames import LiveFrame
from posemix.live_view.trace import FRAMES, write_results
from posemix.live_view.view import PacedView

__all__ = ["LiveRecording"]


class LiveRecording(PacedView):
    """Records a live run in a folder, frame by frame, from which its report is made at any time.

    Memory holds the last frame alone, and the file `frames.jsonl`, to which every frame is written at once, does not
    grow without end: where it has `max_frames`, every second frame is left out, from then on too. Where the estimator
    begins again at an earlier time, so does the recording. It may be used from several threads.

    Parameters
    ----------
    folder : path
        The folder, which is made; it must not have a recording already.
    name : str
        Name of the run, for the title of the report.
    max_frames : int
        Number of frames at most.
    rate_hz : float
        Frames per second of the estimates' time that are recorded at most.
    model_names : mapping of str to sequence of str, optional
        Names of the models of motion by the object's id; by default "0", "1", ...

    Raises
    ------
    FileExistsError
        If the folder has a recording.
    OSError
        If the system refuses.

    Examples
    --------
    >>> import tempfile
    >>> from posemix import SE3, ConcentratedGaussian, ObjectModel, Observation, ObservationComponent
    >>> from posemix import StampedSlam, pose_covariance
    >>> from posemix.live_view import LiveRecording
    >>> slam = StampedSlam(ConcentratedGaussian(SE3(), pose_covariance(0.001, 0.002)), [ObjectModel(id="mug")])
    >>> with tempfile.TemporaryDirectory() as folder, LiveRecording(folder) as recording:
    ...     for k in range(3):
    ...         _ = slam.add_odometry(0.1 * k, SE3())
    ...         mug = [ObservationComponent(SE3(translation=[0, 0, 0.8]))]
    ...         _ = slam.add(Observation(mug, object="mug", stamp_s=0.1 * k))
    ...         _ = recording.update(slam)
    ...     recording.write_report().name
    'report.html'
    """

    def __init__(
        self,
        folder: str | os.PathLike[str],
        *,
        name: str = "live",
        max_frames: int = 10_000,
        rate_hz: float = float("inf"),
        model_names: Mapping[str, Sequence[str]] | None = None,
    ) -> None:
        super().__init__(rate_hz)
        if max_frames < 2:
            raise ValueError(f"max_frames is {max_frames}; expected at least 2")
        self._folder, self._name, self._most = Path(folder), name, max_frames
        self._model_names = {of: list(names) for of, names in (model_names or {}).items()}
        # The second one is held for as long as a report takes.
        self._lock, self._report_lock = threading.RLock(), threading.RLock()
        self._folder.mkdir(parents=True, exist_ok=True)
        if self._path.exists():
            raise FileExistsError(f"{self._path}: there is a recording already")
        self._begin()

    @property
    def _path(self) -> Path:
        return self._folder / FRAMES

    def _begin(self) -> None:
        # Every so many-th frame is kept; the last one waits, as it is in the report in any case.
        self._stride, self._count, self._written = 1, 0, 0
        self._last: LiveFrame | None = None
        # A report may still read what was there before.
        self._path.unlink(missing_ok=True)
        self._file = self._path.open("w", encoding="utf-8", buffering=1)
        self._put({**HEADER, "name": self._name, "model_names": self._model_names})

    def _put(self, row: Mapping[str, Any]) -> None:
        self._file.write(json.dumps(row, separators=(",", ":")) + "\n")

    def show(self, frame: LiveFrame) -> bool:
        """Records an estimate; False where it follows the last one sooner than `rate_hz` allows."""
        with self._lock:
            if self._file.closed:
                return False
            # What came late has changed the estimate of the same time.
            if self._last is not None and frame.stamp_s == self._last.stamp_s:
                self._last = frame
                return True
            return super().show(frame)

    def _show(self, frame: LiveFrame) -> None:
        self._write_last()
        self._last = frame

    def _write_last(self) -> None:
        if self._last is None:
            return
        if self._count % self._stride == 0:
            self._put(entry_of(self._last))
            self._written += 1
            if self._written >= self._most:
                self._thin()
        self._count += 1
        self._last = None

    def _thin(self) -> None:
        """Leaves out every second frame of the file."""
        self._file.close()
        with self._path.open(encoding="utf-8") as old, whole_file(self._path) as new:
            new.write(next(old))
            for k, line in enumerate(old):
                if k % 2 == 0:
                    new.write(line)
        self._file = self._path.open("a", encoding="utf-8", buffering=1)
        self._stride *= 2
        self._written = (self._written + 1) // 2

    def _clear(self) -> None:
        self._file.close()
        self._begin()

    @property
    def frames(self) -> int:
        """Number of frames that are recorded."""
        with self._lock:
            return self._written + (self._last is not None)

    def write_results(self) -> Path:
        """Writes results into the folder, as `posemix slam` does, and returns it; the recording may go on meanwhile.

        These are `trace.json`, `metrics.json` with what is known without ground truth, and `mixture_ID.json` of every
        object at the last frame.

        Raises
        ------
        ValueError
            If there is no frame so far.
        OSError
            If the system refuses.
        """
        with self._report_lock, ExitStack() as files:
            with self._lock:
                last, count = self._last, self._written
                file = files.enter_context(self._path.open(encoding="utf-8"))
            more = [] if last is None else [entry_of(last)]
            write_results(self._folder, file, count, more)
            self._write_mixtures(last)
        return self._folder

    def _write_mixtures(self, frame: LiveFrame | None) -> None:
        for old in self._folder.glob("mixture_*.json"):
            old.unlink()
        for i, name in enumerate(frame.names if frame is not None else ()):
            assert frame is not None
            # Objects on sight have any name, which frames and files cannot have.
            plain = re.sub(r"[^\w.-]", "_", name[:80], flags=re.ASCII)
            plain = name if plain == name else f"{plain}_{i}"
            write_mixture(self._folder / f"mixture_{plain}.json", frame.mixture(name), "world", plain)

    def write_report(self, out: str | os.PathLike[str] | None = None, *, title: str | None = None) -> Path:
        """Writes the results and one HTML file that shows them, and returns its path; the recording may go on.

        Parameters
        ----------
        out : path, optional
            The file to write; by default report.html in the folder.
        title : str, optional
            Title of the page; by default the name of the run with the method.

        Raises
        ------
        ValueError
            If there is no frame so far.
        OSError
            If the system refuses, or the package was built without the page.
        """
        with self._report_lock:
            return write_report(self.write_results(), out, title)

    def close(self) -> None:
        """Ends the recording; reports can still be made."""
        with self._lock:
            if not self._file.closed:
                self._file.close()
