# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Object SLAM from one bag to another."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from posemix.bags.filter_runs import by_arrival, by_stamps
from posemix.bags.read import Recording, read
from posemix.bags.track_rows import TrackRows
from posemix.bags.write import Track, write
from posemix.density import ConcentratedGaussian
from posemix.lie import SE3
from posemix.live_view.view import View
from posemix.noise import pose_covariance
from posemix.runs import Progress
from posemix.slam import (
    MotionModel,
    MultiObjectSlamSettings,
    ObjectModel,
    ObjectSlam,
    ObjectSlamSettings,
    StampAdmission,
    StampedSlam,
    StampedSlamSettings,
)

__all__ = ["BagRun", "models_of", "run_slam", "track_objects"]


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
        T_world_object of every detected object from its first detection on, with its hypotheses and, by the
        multi-object filter, the state of its track.
    ignored : dict of str to int
        Numbers of detections of classes without a model.
    late, too_late : int
        Numbers of observations that came out of order: those that were taken in at their stamps, and those that were
        older than the history and refused.
    """

    recording: Recording
    models: list[ObjectModel]
    camera: Track
    objects: list[Track]
    ignored: dict[str, int]
    late: int = 0
    too_late: int = 0


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


def track_objects(
    recording: Recording,
    models: Sequence[ObjectModel] | None = None,
    settings: ObjectSlamSettings | None = None,
    *,
    camera_prior: ConcentratedGaussian[SE3] | None = None,
    stamped: StampedSlamSettings | None = None,
    view: View | Sequence[View] = (),
    progress: Progress | None = None,
) -> BagRun:
    """Runs object SLAM over the result of `read`.

    The multi-object filter takes in all results of a detection, with their weights and covariances, in the order in
    which they arrived and at their stamps. Other filters take in the best pose of each, in the order of the stamps.

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
    stamped : StampedSlamSettings, optional
        History over which late observations are taken in, and stamps that jump; for the multi-object filter.
    view : View or sequence of View
        Views of `posemix.live_view` that are shown every estimate of the multi-object filter, and stay open.
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
    views = [view] if isinstance(view, View) else list(view)
    if views and not isinstance(settings.tracker, MultiObjectSlamSettings):
        raise ValueError("a view is of the multi-object filter; expected its settings as tracker")
    start = recording.odometry[0] if recording.has_odometry[0] else SE3()
    prior = camera_prior or ConcentratedGaussian(start, pose_covariance(np.radians(0.05), 0.002))
    tracks = TrackRows(objects)
    if isinstance(settings.tracker, MultiObjectSlamSettings):
        slam = StampedSlam(prior, objects, settings.tracker, settings.motion, stamped)
        has_odometry = settings.motion.model in (MotionModel.odometry, MotionModel.given)
        frames = by_arrival(recording, objects, slam, has_odometry, tracks, views)
    else:
        frames = by_stamps(recording, objects, ObjectSlam(prior, objects, settings), tracks)
    late = too_late = 0
    for k, admissions in enumerate(frames):
        late += admissions[StampAdmission.replayed]
        too_late += admissions[StampAdmission.too_late]
        if progress is not None and progress(k + 1, len(recording.stamps_ns)) is False:
            break
    known = {model.class_id or model.id for model in objects}
    ignored = Counter(name for name in recording.detections.class_id if name not in known)
    return BagRun(
        recording, objects, tracks.of_camera(), tracks.of_objects(), dict(ignored), late, too_late
    )


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
    stamped: StampedSlamSettings | None = None,
    world_frame: str | None = None,
    storage: Literal["mcap", "sqlite3", "ros1"] = "mcap",
    view: View | Sequence[View] = (),
    progress: Progress | None = None,
) -> BagRun:
    """Reads a bag, runs object SLAM and writes camera, objects and their hypotheses as a bag.

    Parameters
    ----------
    path, detections, odometry, odometry_frame, camera_frame, max_gap_s
        As for `read`.
    out, storage
        As for `write`; nothing is written without `out`.
    models, settings, camera_prior, stamped, view, progress
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
        recording, models, settings, camera_prior=camera_prior, stamped=stamped, view=view, progress=progress
    )
    if out is not None:
        frame = world_frame or recording.odometry_frame or "world"
        write(out, [result.camera, *result.objects], frame=frame, storage=storage)
    return result
