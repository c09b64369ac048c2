# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Streams of random numbers: the same seed gives the same numbers on every machine."""

from posemix._core import RandomStream

__all__ = ["RandomStream"]


def stream_of(seed: int | RandomStream) -> RandomStream:
    """The stream itself, or the stream with index 0 of a seed."""
    return seed if isinstance(seed, RandomStream) else RandomStream(seed, 0)
