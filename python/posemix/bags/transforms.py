# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Transforms between frames over time, from /tf and /tf_static."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from posemix._arrays import FloatArray
from posemix.lie import SE3

__all__ = ["Nanoseconds", "Timeline", "TransformBuffer", "ancestors"]

Nanoseconds = npt.NDArray[np.int64]


def ancestors(parents: Mapping[str, str], frame: str) -> list[str]:
    """A frame and all above it; raises ValueError naming them where they form a ring."""
    chain = [frame]
    while chain[-1] in parents:
        parent = parents[chain[-1]]
        if parent in chain:
            raise ValueError(f"the frames {', '.join(chain)} form a ring")
        chain.append(parent)
    return chain


class Timeline:
    """Poses over time, or one pose for all times.

    Parameters
    ----------
    stamps_ns : ndarray of int, shape (n,)
        Times in any order [ns]; of equal times the last is used. Empty: one pose for all times.
    poses : SE3, shape (n,), or (1,)
        Poses at these times.
    """

    def __init__(self, stamps_ns: Nanoseconds, poses: SE3) -> None:
        self.is_static = len(stamps_ns) == 0
        if self.is_static:
            self._stamps, self._poses = stamps_ns, poses
            return
        last_first = stamps_ns[::-1]
        self._stamps, index = np.unique(last_first, return_index=True)
        self._poses = poses[len(stamps_ns) - 1 - index]

    def at(self, stamps_ns: Nanoseconds, max_gap_s: float) -> tuple[SE3, npt.NDArray[np.bool_]]:
        """Poses at the given times, interpolated along geodesics, and whether they are known.

        Poses are not known before the first and after the last stamp, nor in gaps longer than `max_gap_s` seconds; the
        values returned for them have no meaning.
        """
        n = len(stamps_ns)
        if self.is_static:
            return SE3.identity(n) * self._poses[0], np.ones(n, dtype=bool)
        after = np.searchsorted(self._stamps, stamps_ns, side="left")
        exact = np.isin(stamps_ns, self._stamps)
        inside = (after > 0) & (after < len(self._stamps))
        b = np.clip(after, 0, len(self._stamps) - 1)
        a = np.where(exact, b, np.clip(after - 1, 0, len(self._stamps) - 1))
        width = (self._stamps[b] - self._stamps[a]) * 1e-9
        share = np.zeros(n)
        moves = (width > 0.0) & inside
        share[moves] = (stamps_ns - self._stamps[a])[moves] * 1e-9 / width[moves]
        start, end = self._poses[a], self._poses[b]
        found = SE3.exp(share[:, None] * (end * start.inverse()).log()) * start
        return found, exact | (inside & (width <= max_gap_s))


class TransformBuffer:
    """A tree of frames.

    Examples
    --------
    >>> import numpy as np
    >>> from posemix import SE3
    >>> from posemix.bags import TransformBuffer
    >>> buffer = TransformBuffer()
    >>> buffer.add("base", "camera", SE3(translation=[0.1, 0.0, 0.0]))
    >>> poses, found = buffer.lookup("camera", "base", np.array([0]), max_gap_s=0.1)
    >>> poses.translation
    array([[-0.1,  0. ,  0. ]])
    """

    def __init__(self) -> None:
        self._rows: dict[str, list[FloatArray]] = defaultdict(list)
        self._times: dict[str, list[int]] = defaultdict(list)
        self._parents: dict[str, str] = {}
        self._lines: dict[str, Timeline] = {}

    def add(self, parent: str, child: str, pose: SE3, stamp_ns: int | None = None) -> None:
        """Adds T_parent_child at a time, or without a stamp for all times.

        Raises
        ------
        ValueError
            If the child already has another parent.
        """
        known = self._parents.setdefault(child, parent)
        if known != parent:
            raise ValueError(f"frame '{child}' has two parents, '{known}' and '{parent}'")
        if stamp_ns is None:
            self._rows[child], self._times[child] = [pose.to_tq()], []
        elif self._times[child] or not self._rows[child]:
            self._rows[child].append(pose.to_tq())
            self._times[child].append(stamp_ns)
        self._lines.pop(child, None)

    @property
    def frames(self) -> list[str]:
        """Names of all frames."""
        return sorted({*self._parents, *self._parents.values()})

    def _line(self, child: str) -> Timeline:
        if child not in self._lines:
            times = np.array(self._times[child], dtype=np.int64)
            self._lines[child] = Timeline(times, SE3.from_tq(np.array(self._rows[child])))
        return self._lines[child]

    def lookup(
        self, target: str, source: str, stamps_ns: Nanoseconds, *, max_gap_s: float
    ) -> tuple[SE3, npt.NDArray[np.bool_]]:
        """T_target_source at the given times.

        Parameters
        ----------
        target, source : str
            Frames.
        stamps_ns : ndarray of int, shape (n,)
            Times [ns].
        max_gap_s : float
            Longest gap between two transforms that is interpolated [s].

        Returns
        -------
        poses : SE3, shape (n,)
        found : ndarray of bool, shape (n,)
            Whether all transforms between the two frames are known.

        Raises
        ------
        ValueError
            If no transforms connect the frames; the message names them.
        """
        identity, always = SE3.identity(len(stamps_ns)), np.ones(len(stamps_ns), dtype=bool)
        if target == source:
            return identity, always
        up, down = ancestors(self._parents, source), ancestors(self._parents, target)
        shared = [frame for frame in up if frame in down]
        if not shared:
            there = ", ".join(self.frames) or "none"
            raise ValueError(
                f"no transform joins '{source}' and '{target}': the first ends at '{up[-1]}', the other at "
                f"'{down[-1]}'; frames there are: {there}"
            )
        result, known = [], always
        for chain in (down, up):
            total = identity
            for frame in chain[: chain.index(shared[0])]:
                pose, found = self._line(frame).at(stamps_ns, max_gap_s)
                total, known = pose * total, known & found
            result.append(total)
        return result[0].inverse() * result[1], known
