# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Reports: results as one HTML page."""

from __future__ import annotations

import collections.abc
import os
import pathlib

from posemix import _core
from posemix.io.paths import Path

__all__ = ["write_report"]

def write_report(
    results: Path,
    out: Path | None = None,
    title: str | None = None,
    meshes: collections.abc.Mapping[str, tuple[Path, float]] | None = None,
) -> pathlib.Path:
    """Writes one HTML file that shows results in a browser without network or server, like ``posemix report``.

    Parameters
    ----------
    results : path
        A folder of `write_results`, ``posemix slam`` or ``posemix study``, a folder of mixture files, or one of these.
    out : path, optional
        The file to write; by default report.html in the folder, or beside the mixture file.
    title : str, optional
        Title of the page; by default it is taken from the results.
    meshes : mapping, optional
        For an object id, a PLY file and the length of its unit [m]: 1e-3 for BOP's models.

    Returns
    -------
    pathlib.Path
        The file written.

    Raises
    ------
    ValueError
        With file and place: no results, a damaged file, a mesh for an unknown object.
    OSError
        If the system refuses, or the package was built without the page (npm was missing).
    """
    paths = {id: (os.fspath(ply), unit) for id, (ply, unit) in (meshes or {}).items()}
    target = None if out is None else os.fspath(out)
    return pathlib.Path(_core.write_report(os.fspath(results), target, title, paths))
