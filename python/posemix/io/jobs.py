# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Sequence files, results of object SLAM and simulated recordings."""

from __future__ import annotations

import collections.abc
import os
from dataclasses import dataclass

from posemix import _core
from posemix._core import SimulationConfig
from posemix.io.paths import Path
from posemix.runs import SlamJob, SlamRun
from posemix.simulation import SimulatedSequence

__all__ = [
    "SimulationFile",
    "read_simulation",
    "read_slam_job",
    "write_results",
    "write_simulation",
]

def read_slam_job(
    path: Path, data: Path | None = None, overrides: collections.abc.Sequence[str] = ()
) -> SlamJob:
    """Reads a sequence file and every file that it names.

    Parameters
    ----------
    path : path
        The sequence file (TOML).
    data : path, optional
        Folder of the recording's files; by default the sequence file's own, then POSEMIX_DATA or the cache of
        ``posemix data``.
    overrides : sequence of str
        Settings ``key=value``, as for ``posemix slam --set``.

    Raises
    ------
    ValueError
        With file, line and key.
    """
    folder = None if data is None else os.fspath(data)
    return SlamJob._of(_core.read_slam_job(os.fspath(path), folder, list(overrides)))


def write_results(folder: Path, job: SlamJob, run: SlamRun) -> None:
    """Writes the files of ``posemix slam``: trajectories, metrics, posterior, trace, picture.

    Parameters
    ----------
    folder : path
        The folder; it appears, or its files are replaced, as a whole.
    job : SlamJob
        The job.
    run : SlamRun
        The result of the job; with recorded hypotheses for the trace.

    Raises
    ------
    ValueError
        When an estimate is not finite.
    OSError
        If the system refuses.
    """
    handle = job._compiled()
    metrics = _core.evaluate(job.sequence._compiled(), run._handle)
    _core.write_results(os.fspath(folder), handle, run._handle, metrics)


@dataclass(frozen=True)
class SimulationFile:
    """The content of a simulation file.

    Attributes
    ----------
    config : SimulationConfig
        The configuration of the simulation.
    filter : list of (str, str)
        The table [filter] for the sequence file: keys, and values in the form of TOML.
    """

    config: SimulationConfig
    filter: list[tuple[str, str]]


def read_simulation(
    path: Path, overrides: collections.abc.Sequence[str] = ()
) -> SimulationFile:
    """Reads the configuration of ``posemix simulate``; arguments as for `read_slam_job`."""
    config, table = _core.read_simulation(os.fspath(path), list(overrides))
    return SimulationFile(config, [(key, value) for key, value in table])


def write_simulation(
    folder: Path, file: SimulationFile, simulated: SimulatedSequence, seed: int
) -> None:
    """Writes a simulated recording as files for ``posemix slam``.

    Parameters
    ----------
    folder : path
        The folder; it appears as a whole.
    file : SimulationFile
        The configuration of the simulation.
    simulated : SimulatedSequence
        The recording.
    seed : int
        The seed of the simulation, which is recorded in the files.
    """
    _core.write_simulation(os.fspath(folder), file.config, file.filter, simulated, seed)
