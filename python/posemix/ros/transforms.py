# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Transforms between frames as they come, over a window of time."""

from __future__ import annotations

from bisect import bisect_left, insort
from collections.abc import Sequence

from posemix.bags.transforms import ancestors
from posemix.lie import SE3

__all__ = ["LiveLine", "LiveTransforms"]

Row = Sequence[float]


class LiveLine:
    """Poses over a window of time, or one pose for all times.

    Parameters
    ----------
    window_ns : int
        Poses that are older than the newest by more are forgotten [ns]. A pose that comes with such a stamp tells that
        the clock has jumped back: then all others are.
    """

    def __init__(self, window_ns: int) -> None:
        self._window = window_ns
        self._rows: list[tuple[int, Row]] = []
        self._static: Row | None = None

    def add(self, stamp_ns: int | None, row: Row) -> None:
        """Adds a pose tx, ty, tz, qx, qy, qz, qw at a time, or without one for all times."""
        if stamp_ns is None:
            self._static, self._rows = row, []
            return
        rows = self._rows
        if rows and stamp_ns < rows[-1][0] - self._window:
            rows.clear()
        if not rows or stamp_ns > rows[-1][0]:
            rows.append((stamp_ns, row))
        else:
            place = bisect_left(rows, stamp_ns, key=lambda item: item[0])
            if rows[place][0] == stamp_ns:
                rows[place] = (stamp_ns, row)
            else:
                insort(rows, (stamp_ns, row), key=lambda item: item[0])
        # In steps, so that a pose costs the same on average whatever the window.
        if len(rows) > 64 and rows[len(rows) // 2][0] < rows[-1][0] - self._window:
            del rows[: len(rows) // 2]

    @property
    def newest_ns(self) -> int | None:
        """The newest stamp [ns]; None before the first, and of one pose for all times."""
        return self._rows[-1][0] if self._rows else None

    def at(self, stamp_ns: int, max_gap_s: float) -> SE3 | None:
        """The pose at a time, to the last bit as `posemix.bags` interpolates it; None where it is not known.

        Where one of the two that it lies between is none, such as a quaternion of zeros, it is not known.
        """
        try:
            return self._at(stamp_ns, max_gap_s)
        except ValueError:
            return None

    def _at(self, stamp_ns: int, max_gap_s: float) -> SE3 | None:
        rows = self._rows
        if not rows:
            return None if self._static is None else _IDENTITY * _pose(self._static)
        after = bisect_left(rows, stamp_ns, key=lambda item: item[0])
        if after < len(rows) and rows[after][0] == stamp_ns:
            return _IDENTITY * _pose(rows[after][1])
        if after == 0 or after == len(rows):
            return None
        begin, end = rows[after - 1][0], rows[after][0]
        width = (end - begin) * 1e-9
        if not width <= max_gap_s:
            return None
        start = _pose(rows[after - 1][1])
        share = (stamp_ns - begin) * 1e-9 / width
        return SE3.exp(share * (_pose(rows[after][1]) * start.inverse()).log()) * start


_IDENTITY = SE3()


def _pose(row: Row) -> SE3:
    # Twice, as bags do: rounded quaternions are not quite those of one normalisation.
    return SE3.from_tq(SE3.from_tq(row).to_tq())


class LiveTransforms:
    """The tree of frames over a window of time.

    Parameters
    ----------
    window_s : float
        Transforms that are older than the newest of their frame by more are forgotten [s].

    Examples
    --------
    >>> from posemix.ros import LiveTransforms
    >>> transforms = LiveTransforms(10.0)
    >>> for stamp in (0, 100_000_000):
    ...     transforms.take("odom", "base", [stamp * 1e-9, 0, 0, 0, 0, 0, 1], stamp)
    >>> transforms.at("odom", "base", 50_000_000, 0.2).translation.round(3)
    array([0.05, 0.  , 0.  ])
    >>> transforms.at("odom", "base", 200_000_000, 0.2) is None
    True
    """

    def __init__(self, window_s: float) -> None:
        self._parents: dict[str, str] = {}
        self._window_ns = round(window_s * 1e9)
        self._live: dict[str, LiveLine] = {}

    def take(self, parent: str, child: str, row: Row, stamp_ns: int | None) -> None:
        """Takes T_parent_child at a time, or without a stamp for all times.

        A child that gets another parent is from now on below that one alone.
        """
        if self._parents.get(child) != parent:
            self._parents[child] = parent
            self._live[child] = LiveLine(self._window_ns)
        self._live[child].add(stamp_ns, row)

    def clear(self) -> None:
        """Forgets all transforms but those for all times, as after a jump of the clock."""
        for child in [c for c, line in self._live.items() if line.newest_ns is not None]:
            del self._live[child], self._parents[child]

    def parent(self, frame: str) -> str | None:
        """The parent of a frame."""
        return self._parents.get(frame)

    def root(self, frame: str) -> str:
        """The last of the frames above a frame, or itself."""
        try:
            return ancestors(self._parents, frame)[-1]
        except ValueError:  # a ring
            return frame

    def at(self, target: str, source: str, stamp_ns: int, max_gap_s: float) -> SE3 | None:
        """T_target_source at a time; None where it is not known."""
        if target == source:
            return SE3()
        try:
            up, down = ancestors(self._parents, source), ancestors(self._parents, target)
        except ValueError:  # a ring
            return None
        top = next((frame for frame in up if frame in down), None)
        if top is None:
            return None
        ways = []
        for chain in (down, up):
            total = _IDENTITY
            for frame in chain[: chain.index(top)]:
                pose = self._live[frame].at(stamp_ns, max_gap_s)
                if pose is None:
                    return None
                total = pose * total
            ways.append(total)
        return ways[0].inverse() * ways[1]
