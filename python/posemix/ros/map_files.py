# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Which maps a node has loaded and saved, and which of their files must not be written over."""

from __future__ import annotations

from collections import deque
from pathlib import Path

from posemix.ros.maps import SavedMap, read_map

__all__ = ["MapFiles"]

_FILES = 100


def _resolved(path: str) -> Path:
    return Path(path).expanduser().resolve()


class MapFiles:
    """The files with maps that a node knows.

    Attributes
    ----------
    loaded : SavedMap or None
        The map that was loaded last, as it is in its file; where none was, the one that was saved last.
    saved : deque of str
        SHA-256 of what this run has saved, which may be copied without what stands beside it.
    """

    def __init__(self) -> None:
        self.loaded: SavedMap | None = None
        self.saved: deque[str] = deque(maxlen=_FILES)
        self._loaded_from: Path | None = None
        self._files: set[Path] = set()
        # Those of whose maps nothing is in the run: they would be lost.
        self._missing: set[Path] = set()

    def was_loaded(self, path: str, found: SavedMap, *, is_in_run: bool) -> None:
        """A map was loaded; one that is not in the run is looked for."""
        self.loaded, self._loaded_from = found, _resolved(path)
        self._files.add(self._loaded_from)
        if is_in_run:
            self.was_found()
        else:
            self._missing.add(self._loaded_from)

    def was_found(self) -> None:
        """The map that was loaded is in the run."""
        if self._loaded_from is not None:
            self._missing.discard(self._loaded_from)

    def was_saved(self, path: str, digest: str) -> None:
        """All that is known is in a file."""
        place = _resolved(path)
        self.saved.append(digest)
        self._files.add(place)
        self._missing.discard(place)
        if self.loaded is None or self._loaded_from == place:
            self.loaded, self._loaded_from = read_map(path), place

    def run_is_lost(self) -> None:
        """A run begins anew: nothing of any map is in it, and what the old one has saved is news to it."""
        self._missing = set(self._files)
        self.saved.clear()

    def require_kept(self, path: str) -> None:
        """Raises ValueError where a map that is not in the run would be written over."""
        if _resolved(path) in self._missing:
            raise ValueError(
                f"nothing of what is in {path} is in this run, and it would be lost; ~/save writes over it all the same"
            )
