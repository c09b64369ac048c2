# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Object SLAM from one bag to another."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from posemix._arrays import FloatArray
from posemix.bags.read import Recording, read
from posemix.bags.write import PoseMixture, Track, write
from posemix.density import ConcentratedGaussian
from posemix.lie import SE3
from posemix.mixture import Mixture
from posemix.noise import pose_covariance
from posemix.slam import (
    Candidate,
    FrameInput,
    MotionModel,
    MultiObjectSlamSettings,
    ObjectModel,
    ObjectSlam,
    ObjectSlamSettings,
)

__all__ = ["BagRun", "models_of", "run_slam", "track_objects"]

Progress = Callable[[int, int], bool | None]


@dataclass(frozen=True)
class BagRun:
    """Object SLAM over a recording.

    Attributes
    ----------
    recording : Recording
        The detections and odometry of the bag.
    models : list of ObjectModel
        Models of the objects.
    camera : Track
        T_world_camera.
    objects : list of Track
        T_world_object of every detected object from its first detection on, with its hypotheses.
    ignored : dict of str to int
        Numbers of detections of classes without a model.
    """

    recording: Recording
    models: list[ObjectModel]
    camera: Track
    objects: list[Track]
    ignored: dict[str, int]


def models_of(recording: Recording) -> list[ObjectModel]:
    """A model for every object of a recording, with the default noise.

    A class with at most one detection per frame becomes one object with the name of the class. Another class becomes as
    many objects as it has detections in one frame, NAME_1, NAME_2, ..., which are distinguished by their poses.
    """
    seen = recording.detections
    most: Counter[str] = Counter()
    pairs = Counter(zip(seen.frame.tolist(), seen.class_id, strict=True))
    for (_, name), count in pairs.items():
        most[name] = max(most[name], count)
    models = []
    for name in sorted(most):
        if most[name] == 1:
            models.append(ObjectModel(id=name))
            continue
        models += [ObjectModel(id=f"{name}_{i + 1}", class_id=name) for i in range(most[name])]
    return models


@dataclass
class _Rows:
    """Rows of a track during a run."""

    stamps: list[int] = field(default_factory=list)
    poses: list[FloatArray] = field(default_factory=list)
    covariances: list[FloatArray] = field(default_factory=list)
    mixtures: list[PoseMixture] = field(default_factory=list)

    def add(
        self, stamp: int, density: ConcentratedGaussian[SE3], mixture: PoseMixture | None = None
    ) -> None:
        self.stamps.append(stamp)
        self.poses.append(density.mean.to_tq())
        self.covariances.append(density.covariance)
        if mixture is not None:
            self.mixtures.append(mixture)

    def track(self, name: str, class_id: str) -> Track:
        return Track(
            name, class_id, np.array(self.stamps, dtype=np.int64), SE3.from_tq(np.array(self.poses)),
            np.array(self.covariances), tuple(self.mixtures),
        )  # fmt: skip


def _inputs(recording: Recording, models: Sequence[ObjectModel]) -> Iterator[FrameInput]:
    """The input frames: candidates for a class with several models, otherwise the detection of highest score."""
    classes = Counter(model.class_id or model.id for model in models)
    single = {m.class_id or m.id: m.id for m in models if classes[m.class_id or m.id] == 1}
    seen, stamps = recording.detections, recording.stamps
    rows: list[list[int]] = [[] for _ in stamps]
    for row, frame in enumerate(seen.frame.tolist()):
        rows[frame].append(row)
    for k, of_frame in enumerate(rows):
        detections: dict[str, SE3] = {}
        candidates = []
        for row in sorted(of_frame, key=lambda r: -seen.score[r]):
            name, pose = seen.class_id[row], seen.poses[row]
            if name in single:
                detections.setdefault(single[name], pose)
            elif name in classes:
                candidates.append(Candidate(name, pose, float(seen.score[row])))
        motion = None
        if k > 0 and recording.has_odometry[k - 1] and recording.has_odometry[k]:
            motion = recording.odometry[k - 1].inverse() * recording.odometry[k]
        dt = float(stamps[k] - stamps[k - 1]) if k > 0 else 0.0
        yield FrameInput(dt, motion, detections, candidates)


class _Hypotheses:
    """The hypotheses of every object at one frame."""

    def __init__(self, slam: ObjectSlam) -> None:
        self._many = slam.multi_object
        self._joint = slam.posterior if self._many is None else None

    def of(self, index: int, pose_index: int) -> PoseMixture:
        if self._joint is not None:
            return self._joint.marginal(pose_index)
        assert self._many is not None
        found = self._many.hypotheses(index)
        densities = [ConcentratedGaussian(h.pose, h.covariance) for h in found]
        return Mixture(densities, [h.probability for h in found])


def track_objects(
    recording: Recording,
    models: Sequence[ObjectModel] | None = None,
    settings: ObjectSlamSettings | None = None,
    *,
    camera_prior: ConcentratedGaussian[SE3] | None = None,
    progress: Progress | None = None,
) -> BagRun:
    """Runs object SLAM over the result of `read`.

    Parameters
    ----------
    recording : Recording
        Detections and odometry.
    models : sequence of ObjectModel, optional
        Detections are assigned to models by their class: `class_id`, or `id` if that is empty. The result of
        `models_of` unless given.
    settings : ObjectSlamSettings, optional
        Filter and motion model. Without settings and without odometry, the motion model is constant velocity.
    camera_prior : ConcentratedGaussian, optional
        Prior of T_world_camera at the first frame. By default its mean is the odometry's pose at that frame, with
        standard deviations of 0.05 deg and 2 mm.
    progress : callable, optional
        Called with (frames done, frames in all). If it returns False, the run stops and the frames done so far are
        returned.
    """
    objects = models_of(recording) if models is None else list(models)
    if settings is None:
        settings = ObjectSlamSettings()
        if not recording.has_odometry.any():
            motion = settings.motion
            motion.model = MotionModel.constant_velocity
            settings.motion = motion
    _require_candidates_allowed(objects, settings)
    start = recording.odometry[0] if recording.has_odometry[0] else SE3()
    prior = camera_prior or ConcentratedGaussian(start, pose_covariance(np.radians(0.05), 0.002))
    slam = ObjectSlam(prior, objects, settings)
    camera, rows = _Rows(), [_Rows() for _ in objects]
    for k, frame in enumerate(_inputs(recording, objects)):
        slam.step(frame)
        stamp, joint, hypotheses = int(recording.stamps_ns[k]), slam.estimate, _Hypotheses(slam)
        camera.add(stamp, joint.marginal(0))
        for j in range(len(objects)):
            index = slam.pose_index(j)
            if index is not None:
                rows[j].add(stamp, joint.marginal(index), hypotheses.of(j, index))
        if progress is not None and progress(k + 1, len(recording.stamps_ns)) is False:
            break
    known = {model.class_id or model.id for model in objects}
    ignored = Counter(name for name in recording.detections.class_id if name not in known)
    tracks = [
        track.track(model.id, model.class_id or model.id)
        for model, track in zip(objects, rows, strict=True)
        if track.stamps
    ]
    return BagRun(recording, objects, camera.track("camera", ""), tracks, dict(ignored))


def _require_candidates_allowed(
    models: Sequence[ObjectModel], settings: ObjectSlamSettings
) -> None:
    shared = [m.class_id for m in models if m.class_id]
    twice = sorted(name for name, count in Counter(shared).items() if count > 1)
    if twice and not isinstance(settings.tracker, MultiObjectSlamSettings):
        raise ValueError(
            f"class '{twice[0]}' has several models, which only the multi-object filter tells apart"
        )


def run_slam(
    path: str | os.PathLike[str],
    out: str | os.PathLike[str] | None = None,
    *,
    detections: str,
    odometry: str | None = None,
    odometry_frame: str | None = None,
    camera_frame: str | None = None,
    max_gap_s: float = 0.2,
    models: Sequence[ObjectModel] | None = None,
    settings: ObjectSlamSettings | None = None,
    camera_prior: ConcentratedGaussian[SE3] | None = None,
    world_frame: str | None = None,
    storage: Literal["mcap", "sqlite3", "ros1"] = "mcap",
    progress: Progress | None = None,
) -> BagRun:
    """Reads a bag, runs object SLAM and writes camera, objects and their hypotheses as a bag.

    Parameters
    ----------
    path, detections, odometry, odometry_frame, camera_frame, max_gap_s
        As for `read`.
    out, storage
        As for `write`; nothing is written without `out`.
    models, settings, camera_prior, progress
        As for `track_objects`.
    world_frame : str, optional
        Name of the world frame in the written bag; by default the odometry's frame, or "world" without odometry.

    Raises
    ------
    ValueError, FileNotFoundError, FileExistsError
        As for `read` and `write`.
    """
    if out is not None and os.path.exists(out):
        raise FileExistsError(f"{os.fspath(out)}: there is something already")
    recording = read(
        path, detections=detections, odometry=odometry, odometry_frame=odometry_frame,
        camera_frame=camera_frame, max_gap_s=max_gap_s,
    )  # fmt: skip
    result = track_objects(
        recording, models, settings, camera_prior=camera_prior, progress=progress
    )
    if out is not None:
        frame = world_frame or recording.odometry_frame or "world"
        write(out, [result.camera, *result.objects], frame=frame, storage=storage)
    return result
