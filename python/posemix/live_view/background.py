# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Views that do not hold up what they show."""

from __future__ import annotations

import threading
from collections import deque

from posemix.live_view.frames import LiveFrame
from posemix.live_view.view import View

__all__ = ["BackgroundView"]


class BackgroundView(View):
    """Shows frames by another view in a thread of its own, so that the caller never waits for it.

    Parameters
    ----------
    view : View
        The view, which is closed with this one.
    depth : int
        Number of frames that may wait; of more the oldest are dropped.

    Attributes
    ----------
    dropped : int
        Number of frames that were dropped.
    problem : str
        What the view last failed by; empty: nothing. Frames after it are shown all the same.
    """

    def __init__(self, view: View, depth: int = 1) -> None:
        if depth < 1:
            raise ValueError(f"depth is {depth}; expected at least 1")
        self.dropped, self.problem = 0, ""
        self._view = view
        self._waiting: deque[LiveFrame] = deque()
        self._depth = depth
        self._changed = threading.Condition()
        self._is_busy = self._is_over = False
        self._thread = threading.Thread(target=self._run, name="posemix-view", daemon=True)
        self._thread.start()

    def show(self, frame: LiveFrame) -> bool:
        """Hands over a frame."""
        with self._changed:
            if self._is_over:
                return False
            if len(self._waiting) == self._depth:
                self._waiting.popleft()
                self.dropped += 1
            self._waiting.append(frame)
            self._changed.notify_all()
        return True

    def wait(self, timeout_s: float | None = None) -> bool:
        """Waits until all frames were shown; False where that takes longer than the time [s]."""
        with self._changed:
            return self._changed.wait_for(lambda: not self._waiting and not self._is_busy, timeout_s)

    def _run(self) -> None:
        while True:
            with self._changed:
                self._is_busy = False
                self._changed.notify_all()
                self._changed.wait_for(lambda: self._waiting or self._is_over)
                if not self._waiting:
                    return
                frame, self._is_busy = self._waiting.popleft(), True
            try:
                self._view.show(frame)
            except Exception as error:  # whatever a viewer fails by must not end the estimator
                self.problem = f"{type(error).__name__}: {error}"

    def close(self) -> None:
        """Shows what still waits, but for some seconds at most, and closes the view."""
        with self._changed:
            if self._is_over:
                return
            self._is_over = True
            self._changed.notify_all()
        self._thread.join(10.0)
        self._view.close()
