# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""What all views of a running estimator have in common: how often they show, and paths that do not grow without end."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections import deque
from types import TracebackType
from typing import TYPE_CHECKING

import numpy as np

from posemix._arrays import FloatArray
from posemix._core import StampedSlam
from posemix.live_view.frames import LiveFrame

if TYPE_CHECKING:
    from typing_extensions import Self

__all__ = ["PacedView", "View", "Way"]

# Part of the period by which a frame may be early: stamps of cameras are not exact.
_EARLY = 0.05
# Positions of a path that are shown per second.
_SHOWN_PER_S = 500.0


class View(ABC):
    """Shows or records what an estimator says, frame by frame."""

    def update(self, slam: StampedSlam) -> bool:
        """Shows the present estimate of a running estimator, which is not changed.

        Returns whether there was something to show, as `show` does: before the first estimate there is nothing.
        """
        frame = LiveFrame.of(slam)
        return frame is not None and self.show(frame)

    @abstractmethod
    def show(self, frame: LiveFrame) -> bool:
        """Shows an estimate; False where the view leaves it out."""

    @abstractmethod
    def close(self) -> None:
        """Ends the view; calling it again does nothing."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


class PacedView(View):
    """A view that shows so many frames per second at most.

    Parameters
    ----------
    rate_hz : float
        Frames per second of the estimates' time that are taken at most; infinity: all.
    """

    def __init__(self, rate_hz: float) -> None:
        if not rate_hz > 0:
            raise ValueError(f"rate_hz is {rate_hz}; expected a positive number")
        self._period_s = 1.0 / rate_hz
        self._shown_s = -math.inf

    def show(self, frame: LiveFrame) -> bool:
        """Shows an estimate; False where it follows the last one sooner than `rate_hz` allows.

        A time before the last one is that of a system that began again: all shown before is cleared.
        """
        after = frame.stamp_s - self._shown_s
        if 0 <= after < (1 - _EARLY) * self._period_s:
            return False
        if after < 0:
            self._clear()
        self._shown_s = frame.stamp_s
        self._show(frame)
        return True

    @abstractmethod
    def _show(self, frame: LiveFrame) -> None:
        """Shows a frame."""

    @abstractmethod
    def _clear(self) -> None:
        """Takes away what is shown."""


class Way:
    """The positions of a path; whatever its length, no more than some of them are kept.

    Parameters
    ----------
    most : int
        Number of positions at most. Where there are more, every second one is left out, but for the last.
    trail_s : float, optional
        Time for which positions are kept [s]; by default they are kept for good.
    """

    def __init__(self, most: int = 2000, trail_s: float | None = None) -> None:
        if most < 2:
            raise ValueError(f"most is {most}; expected at least 2")
        self._most, self._trail_s = most, math.inf if trail_s is None else trail_s
        self._rows: deque[tuple[float, FloatArray]] = deque()
        # Of the positions that came, every so many-th is kept; their number since one that was.
        self._stride, self._count = 1, 0
        self._due_s = -math.inf

    def add(self, stamp_s: float, position: FloatArray) -> None:
        """Adds a position [m] at a time [s]."""
        rows = self._rows
        # The last one may be there only because it was the last.
        if rows and (self._count - 1) % self._stride:
            rows.pop()
        rows.append((stamp_s, position))
        self._count += 1
        while rows[0][0] < stamp_s - self._trail_s:
            rows.popleft()
        if len(rows) > self._most:
            self._rows = deque(list(rows)[::2])
            self._stride *= 2
            is_there = self._rows[-1][0] == stamp_s
            if not is_there:
                self._rows.append((stamp_s, position))
            self._count = 1 if is_there else 1 + self._stride // 2

    def is_due(self, stamp_s: float) -> bool:
        """Whether to show the path again: the longer it is, the less often, as viewers keep every one that they get."""
        if stamp_s < self._due_s:
            return False
        self._due_s = stamp_s + len(self._rows) / _SHOWN_PER_S
        return True

    @property
    def positions(self) -> FloatArray:
        """The positions, shape (n, 3)."""
        return np.array([position for _, position in self._rows]).reshape((-1, 3))

    def __len__(self) -> int:
        return len(self._rows)
