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
    """A sequence file and every file that it names.

    Parameters
    ----------
    path : path
        The sequence file (TOML).
    data : path, optional
        Folder below which the recording's files lie; unless given the sequence file's own, then
        POSEMIX_DATA or the cache of ``posemix data``.
    overrides : sequence of str
        ``key=value``, as ``posemix slam --set``.

    Raises
    ------
    ValueError
        Naming file, line and key.
    """
    folder = None if data is None else os.fspath(data)
    return SlamJob._of(_core.read_slam_job(os.fspath(path), folder, list(overrides)))


def write_results(folder: Path, job: SlamJob, run: SlamRun) -> None:
    """The files that ``posemix slam`` writes: trajectories, metrics, posterior, trace, picture.

    Parameters
    ----------
    folder : path
        Appears, or its files are replaced, as a whole.
    job : SlamJob
        What was run.
    run : SlamRun
        Its result; with recorded hypotheses for the trace.

    Raises
    ------
    ValueError
        When an estimate is not finite.
    OSError
        Where the system refuses.
    """
    handle = job._compiled()
    metrics = _core.evaluate(job.sequence._compiled(), run._handle)
    _core.write_results(os.fspath(folder), handle, run._handle, metrics)


@dataclass(frozen=True)
class SimulationFile:
    """What a simulation file says.

    Attributes
    ----------
    config : SimulationConfig
        What is simulated.
    filter : list of (str, str)
        The table [filter] for the sequence file: keys, and values as TOML writes them.
    """

    config: SimulationConfig
    filter: list[tuple[str, str]]


def read_simulation(
    path: Path, overrides: collections.abc.Sequence[str] = ()
) -> SimulationFile:
    """The configuration of ``posemix simulate``; arguments as of `read_slam_job`."""
    config, table = _core.read_simulation(os.fspath(path), list(overrides))
    return SimulationFile(config, [(key, value) for key, value in table])


def write_simulation(
    folder: Path, file: SimulationFile, simulated: SimulatedSequence, seed: int
) -> None:
    """A simulated recording as files that ``posemix slam`` reads.

    Parameters
    ----------
    folder : path
        Appears as a whole.
    file : SimulationFile
        What was simulated.
    simulated : SimulatedSequence
        The recording.
    seed : int
        It was simulated with, for the record.
    """
    _core.write_simulation(os.fspath(folder), file.config, file.filter, simulated, seed)
