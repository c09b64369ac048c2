# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Files: sequence files and results of object SLAM, mixtures, trajectories, BOP. docs/formats.md describes them.

Readers raise ValueError ``file:line: got ..., expected ...``; writers put a file or a folder in place as a whole or not
at all, and raise OSError where the system refuses.
"""

from __future__ import annotations

import collections.abc
import os
import pathlib
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray
from posemix._core import (
    AngleUnit,
    LengthUnit,
    MixtureConvention,
    PoseKind,
    Side,
    SimulationConfig,
    SymmetryGroup,
    TangentOrder,
)
from posemix.density import ConcentratedGaussian, ProjectedGaussian
from posemix.lie import SE3
from posemix.mixture import Mixture
from posemix.recording import optional_rows
from posemix.runs import SlamJob, SlamRun
from posemix.simulation import SimulatedSequence

__all__ = [
    "AngleUnit", "BopModel", "BopRows", "GraspOutcomes", "GraspTrial", "LengthUnit", "MixtureConvention", "MixtureFile",
    "NamedPose", "ObjectBox", "PoseKind", "PoseSamples", "PosteriorFile", "Side", "SimulationFile", "StampedPoses",
    "TangentOrder", "read_bop_model", "read_bop_models", "read_bop_rows", "read_grasp_outcomes", "read_mixture",
    "read_object_poses", "read_pose_samples", "read_posterior", "read_simulation", "read_slam_job",
    "read_symmetry_file", "read_tum", "write_mixture", "write_object_poses", "write_poses", "write_posterior",
    "write_report", "write_results", "write_simulation", "write_tum",
]  # fmt: skip

Path = str | os.PathLike[str]


def read_slam_job(
    path: Path, data: Path | None = None, overrides: collections.abc.Sequence[str] = ()
) -> SlamJob:
    """A sequence file and every file that it names.

    Parameters
    ----------
    path : path
        The sequence file (TOML).
    data : path, optional
        Folder below which the recording's files lie; unless given the sequence file's own, POSEMIX_DATA and
        ../shared/data.
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


def write_report(
    results: Path,
    out: Path | None = None,
    title: str | None = None,
    meshes: collections.abc.Mapping[str, tuple[Path, float]] | None = None,
) -> pathlib.Path:
    """One HTML file that shows results in a browser, as ``posemix report``; no network, no server.

    Parameters
    ----------
    results : path
        A folder of `write_results`, ``posemix slam`` or ``posemix study``, a folder of mixture files, or one of these.
    out : path, optional
        Where it is written; unless given report.html in the folder, or beside the mixture file.
    title : str, optional
        Unless given, from the results.
    meshes : mapping, optional
        By object id, a PLY file and the length of its unit [m]: 1e-3 for BOP's models.

    Returns
    -------
    pathlib.Path
        The file written.

    Raises
    ------
    ValueError
        Naming file and place: no results, a damaged file, a mesh of no object.
    OSError
        Where the system refuses, or the package was built without the page (npm was missing).
    """
    paths = {id: (os.fspath(ply), unit) for id, (ply, unit) in (meshes or {}).items()}
    target = None if out is None else os.fspath(out)
    return pathlib.Path(_core.write_report(os.fspath(results), target, title, paths))


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
    _core.write_simulation(os.fspath(folder), file.config, file.filter, simulated._handle, seed)


PoseMixture = Mixture[ConcentratedGaussian[SE3]] | Mixture[ProjectedGaussian[SE3]]


@dataclass(frozen=True)
class MixtureFile:
    """What a mixture file holds: a mixture over the pose T_from_to and the names of its frames."""

    from_frame: str
    to_frame: str
    mixture: PoseMixture


def read_mixture(path: Path) -> MixtureFile:
    """A mixture file in any convention that it states.

    Raises
    ------
    ValueError
        Naming the file and the place in it.
    """
    source, target, handle = _core.read_mixture(os.fspath(path))
    return MixtureFile(source, target, Mixture._of(handle))


def write_mixture(
    path: Path,
    mixture: PoseMixture,
    from_frame: str,
    to_frame: str,
    convention: MixtureConvention | None = None,
) -> None:
    """A mixture file.

    Parameters
    ----------
    path : path
        The file.
    mixture : Mixture
        Over poses T_from_to.
    from_frame, to_frame : str
        Names of the frames, 1 to 100 printable characters without blanks.
    convention : MixtureConvention, optional
        How it is stated: as in the library unless given, which reads back bit by bit.

    Raises
    ------
    ValueError
        For a mixture or names that a file cannot hold.
    """
    _core.write_mixture(
        os.fspath(path), from_frame, to_frame, mixture._handle, convention or MixtureConvention()
    )


@dataclass(frozen=True)
class NamedPose:
    """A pose of a joint density by name; an object's name is its id."""

    name: str
    kind: PoseKind


@dataclass(frozen=True)
class PosteriorFile:
    """posterior.json: a joint mixture over camera and objects.

    Attributes
    ----------
    method : str
        What made it, for people.
    stamp : float
        Its time [s].
    poses : list of NamedPose
        One per pose of every component.
    mixture : Mixture
        Over all poses jointly.
    """

    method: str
    stamp: float
    poses: list[NamedPose]
    mixture: Mixture[ConcentratedGaussian[SE3]]


def read_posterior(path: Path) -> PosteriorFile:
    """A posterior.json; ValueError names the file and the place in it."""
    method, stamp, poses, handle = _core.read_posterior(os.fspath(path))
    return PosteriorFile(method, stamp, [NamedPose(*p) for p in poses], Mixture._of(handle))


def write_posterior(path: Path, file: PosteriorFile) -> None:
    """A posterior.json; numbers read back bit by bit."""
    names = [(pose.name, pose.kind) for pose in file.poses]
    _core.write_posterior(os.fspath(path), file.method, file.stamp, names, file.mixture._handle)


@dataclass(frozen=True, eq=False)
class StampedPoses:
    """Poses at times.

    Attributes
    ----------
    stamps : ndarray, shape (n,)
        Strictly increasing [s].
    poses : SE3, shape (n,)
        T_a_b of the file's two frames; NaN for a miss, see `is_known`.
    """

    stamps: FloatArray
    poses: SE3

    def __len__(self) -> int:
        return len(self.stamps)


def read_tum(
    path: Path, allow_misses: bool = False, zero_translation_is_miss: bool = False
) -> StampedPoses:
    """A trajectory in TUM's format: lines ``stamp tx ty tz qx qy qz qw``.

    Parameters
    ----------
    path : path
        The file.
    allow_misses : bool
        A line of seven zeros is a frame without a pose; else an error.
    zero_translation_is_miss : bool
        A pose with zero translation is one too.

    Raises
    ------
    ValueError
        Naming file and line.
    """
    stamps, rows = _core.read_tum(os.fspath(path), allow_misses, zero_translation_is_miss)
    return StampedPoses(stamps, SE3._wrap(rows, (len(rows),)))


def write_tum(
    path: Path, stamps: npt.ArrayLike, poses: SE3, misses_as_zeros: bool = False
) -> None:
    """A trajectory in TUM's format, 12 significant digits.

    Parameters
    ----------
    path : path
        The file.
    stamps : array_like, shape (n,)
        Times [s].
    poses : SE3, shape (n,)
        NaN for a miss.
    misses_as_zeros : bool
        Misses become lines of zeros; else they are left out.
    """
    times = np.ascontiguousarray(stamps, dtype=np.float64)
    _core.write_tum(os.fspath(path), times, optional_rows(poses), misses_as_zeros)


def read_object_poses(path: Path) -> dict[str, SE3]:
    """Static poses T_world_object by id: lines ``id tx ty tz qx qy qz qw``."""
    return _core.read_object_poses(os.fspath(path))


def write_object_poses(path: Path, poses: collections.abc.Mapping[str, SE3]) -> None:
    """Static poses T_world_object by id, 12 significant digits."""
    _core.write_object_poses(os.fspath(path), dict(poses))


@dataclass(frozen=True, eq=False)
class PoseSamples:
    """Poses with weights.

    Attributes
    ----------
    poses : SE3, shape (n,)
        Samples.
    weights : ndarray, shape (n,), or None
        None: all count the same.
    """

    poses: SE3
    weights: FloatArray | None


def read_pose_samples(
    path: Path, residuals: Side | None = None, weights: str | None = None
) -> PoseSamples:
    """Poses of a .csv, .npy, .tum or .txt file.

    Parameters
    ----------
    path : path
        The file.
    residuals : Side, optional
        Residuals of estimates ``est_tx`` ... to truths ``gt_tx`` ... of a CSV file, in place of poses.
    weights : str, optional
        Column of the weights of a CSV file; ``weight`` where there is such a column.

    Raises
    ------
    ValueError
        Naming file and line.
    """
    poses, counts = _core.read_pose_samples(os.fspath(path), residuals, weights)
    return PoseSamples(poses, np.array(counts) if counts else None)


def write_poses(path: Path, poses: SE3) -> None:
    """Poses in the format that the file's name says: .csv, .npy, .tum or .txt."""
    _core.write_poses(os.fspath(path), poses)


@dataclass(frozen=True, eq=False)
class BopRows:
    """The rows of a BOP results file.

    Attributes
    ----------
    scene, image, object : ndarray of int, shape (n,)
        Ids.
    score : ndarray, shape (n,)
        The estimator's confidence, larger is surer.
    poses : SE3, shape (n,)
        T_camera_object [m].
    """

    scene: npt.NDArray[np.int64]
    image: npt.NDArray[np.int64]
    object: npt.NDArray[np.int64]
    score: FloatArray
    poses: SE3

    def __len__(self) -> int:
        return len(self.score)


def read_bop_rows(path: Path) -> BopRows:
    """A BOP results file: CSV ``scene_id,im_id,obj_id,score,R,t,time``; millimetres become metres.

    Raises
    ------
    ValueError
        Naming file and line.
    """
    keys, poses = _core.read_bop_rows(os.fspath(path))
    scene, image, object, score = zip(*keys, strict=True)
    ids = [np.array(values, dtype=np.int64) for values in (scene, image, object)]
    return BopRows(ids[0], ids[1], ids[2], np.array(score, dtype=np.float64), poses)


@dataclass(frozen=True, eq=False)
class ObjectBox:
    """An axis-aligned box in the object's frame: lowest corner and size, shape (3,) each [m]."""

    lowest_m: FloatArray
    size_m: FloatArray

    def corners(self) -> FloatArray:
        """The corners, shape (8, 3) [m]."""
        steps = np.indices((2, 2, 2)).reshape(3, 8).T
        return np.asarray(self.lowest_m + steps * self.size_m)


@dataclass(frozen=True, eq=False)
class BopModel:
    """What models_info.json says of one object.

    Attributes
    ----------
    diameter_m : float
        The largest distance of two vertices [m].
    symmetries : SymmetryGroup
        Discrete times continuous.
    box : ObjectBox or None
        Where the entry has one.
    """

    diameter_m: float
    symmetries: SymmetryGroup
    box: ObjectBox | None


def _bop_model(values: Any) -> BopModel:
    diameter, symmetries, box = values
    return BopModel(diameter, symmetries, None if box is None else ObjectBox(*box))


def read_bop_models(path: Path) -> dict[int, BopModel]:
    """BOP's models_info.json by object id; ValueError names the file and the entry."""
    models = _core.read_bop_models(os.fspath(path))
    return {id: _bop_model(values) for id, values in models.items()}


def read_bop_model(path: Path, object: int) -> BopModel:
    """One entry of models_info.json; what is wrong with the others does not matter."""
    return _bop_model(_core.read_bop_model(os.fspath(path), object))


def read_symmetry_file(path: Path) -> dict[int, SymmetryGroup]:
    """Symmetries by object id: a TOML file with tables ``[symmetries.ID]``, or models_info.json."""
    return _core.read_symmetry_file(os.fspath(path))


@dataclass(frozen=True)
class GraspTrial:
    """One estimate of an object in one image, and what became of the grasps planned with it.

    Attributes
    ----------
    dataset, estimator : str
        Whose.
    scene, image, object : int
        Ids.
    score : float
        The estimator's own confidence.
    outcomes : list of bool or None
        Success of the grasp, one entry per gripper; None where it was not tried.
    """

    dataset: str
    estimator: str
    scene: int
    image: int
    object: int
    score: float
    outcomes: list[bool | None]


@dataclass(frozen=True, eq=False)
class GraspOutcomes:
    """Trials of several estimators.

    Attributes
    ----------
    grippers : list of str
        Names.
    trials : list of GraspTrial
        Rows of the tables.
    estimates, truths : SE3, shape (n,)
        T_camera_object of every trial.
    """

    grippers: list[str]
    trials: list[GraspTrial]
    estimates: SE3
    truths: SE3


def read_grasp_outcomes(folder: Path) -> GraspOutcomes:
    """Every table ``DATASET_ESTIMATOR.csv`` of a folder; ValueError names file and line."""
    grippers, trials, estimates, truths = _core.read_grasp_outcomes(os.fspath(folder))
    return GraspOutcomes(grippers, [GraspTrial(*t) for t in trials], estimates, truths)
