# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Streams of random numbers: the same seed gives the same numbers on every machine."""

from __future__ import annotations

from posemix import _core
from posemix._arrays import FloatArray

__all__ = ["RandomStream"]


class RandomStream:
    """A stream of random numbers, Philox 4x32 by a counter.

    Parameters
    ----------
    seed : int
        Seed of the generator.
    stream : int
        Number of the stream: different streams of one seed are independent.

    Examples
    --------
    >>> from posemix import RandomStream
    >>> float(RandomStream(1).uniform(1)[0]) == float(RandomStream(1).uniform(1)[0])
    True
    """

    __slots__ = ("_handle",)

    def __init__(self, seed: int, stream: int = 0) -> None:
        self._handle = _core.RandomStream(seed, stream)

    def uniform(self, count: int) -> FloatArray:
        """Uniform deviates in [0, 1), shape (count,)."""
        return self._handle.uniform(count)

    def normal(self, count: int) -> FloatArray:
        """Standard normal deviates, shape (count,)."""
        return self._handle.normal(count)

    def __getstate__(self) -> object:
        return self._handle.__getstate__()

    def __setstate__(self, state: object) -> None:
        self._handle = _core.RandomStream.__new__(_core.RandomStream)
        self._handle.__setstate__(state)  # type: ignore[arg-type]


def stream_of(seed: int | RandomStream) -> _core.RandomStream:
    """The stream itself, or the first one of a seed."""
    return seed._handle if isinstance(seed, RandomStream) else _core.RandomStream(seed, 0)
