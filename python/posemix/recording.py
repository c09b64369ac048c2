# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Recordings as arrays. In an array of poses, a frame without a pose is a row of NaN."""

from __future__ import annotations

import collections.abc
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from posemix import _core
from posemix._arrays import FloatArray, as_floats
from posemix.lie import SE3

__all__ = ["Candidate", "ObjectRecording", "Sequence", "is_known", "with_misses"]


def is_known(poses: SE3) -> npt.NDArray[np.bool_]:
    """Whether each entry of an array of poses is known, shape (...); unknown poses are rows of NaN."""
    return np.asarray(~np.isnan(poses._data).all(axis=-1))


def with_misses(
    poses: SE3 | npt.ArrayLike | collections.abc.Sequence[SE3 | None],
    known: npt.ArrayLike | None = None,
) -> SE3:
    """An array of poses in which frames without a pose are NaN.

    Parameters
    ----------
    poses : SE3, shape (n,), or array_like, shape (n, 7), or sequence of SE3 and None
        Poses; rows are ``[tx, ty, tz, qx, qy, qz, qw]``, or NaN for a frame without a pose.
    known : array_like of bool, shape (n,), optional
        False for a frame without a pose; its row of `poses` is ignored.

    Raises
    ------
    ValueError
        For another shape, a row that is only partly finite, and a quaternion of zero.

    Examples
    --------
    >>> from posemix import SE3, is_known, with_misses
    >>> detections = with_misses([SE3(), None, SE3(translation=[0, 0, 1.0])])
    >>> is_known(detections)
    array([ True, False,  True])
    """
    rows = _rows(poses)
    missing = np.isnan(rows).all(axis=1)
    if known is not None:
        mask = np.asarray(known, dtype=bool)
        if mask.shape != (len(rows),):
            raise ValueError(f"known has shape {mask.shape}; expected ({len(rows)},)")
        missing |= ~mask
    result = np.full((len(rows), 7), np.nan)
    result[~missing] = SE3.from_tq(rows[~missing]).to_tq()
    return SE3._wrap(result, (len(rows),))


def _rows(poses: Any) -> FloatArray:
    if isinstance(poses, SE3):
        rows = poses._data
    elif isinstance(poses, collections.abc.Sequence) and any(
        pose is None or isinstance(pose, SE3) for pose in poses
    ):
        rows = np.full((len(poses), 7), np.nan)
        for i, pose in enumerate(poses):
            if pose is not None:
                rows[i] = pose._data
    else:
        rows = as_floats(poses, (7,), "poses") if np.size(poses) else np.empty((0, 7))
    if rows.ndim != 2:
        raise ValueError(f"poses have shape {rows.shape[:-1]}; expected (n,)")
    return rows


def optional_rows(poses: SE3 | None) -> FloatArray:
    """Rows for the compiled part; none for None."""
    return np.empty((0, 7)) if poses is None else np.ascontiguousarray(_rows(poses))


def optional_poses(rows: FloatArray) -> SE3 | None:
    """The poses in rows of the compiled part, or None; the inverse of `optional_rows`."""
    return SE3._wrap(rows, (len(rows),)) if len(rows) else None


@dataclass(frozen=True)
class Candidate:
    """A detection that names the class of the object but not the instance.

    Attributes
    ----------
    class_id : str
        The class.
    camera_object : SE3
        T_camera_object as detected.
    score : float
        Confidence of the detector; larger is more certain.
    """

    class_id: str
    camera_object: SE3
    score: float = 0.0


def candidate_rows(
    candidates: collections.abc.Iterable[Candidate],
) -> list[tuple[str, SE3, float]]:
    """Candidates for the compiled part."""
    return [(c.class_id, c.camera_object, c.score) for c in candidates]


@dataclass(frozen=True, eq=False)
class ObjectRecording:
    """The recording of one object.

    Attributes
    ----------
    id : str
        Name of the object.
    detections : SE3, shape (n,)
        T_camera_object by the detector, NaN in frames without a detection; see `with_misses`.
    relative_truth : SE3, shape (n,), optional
        True T_camera_object.
    world_truth : SE3, shape (n,), optional
        True T_world_object.
    """

    id: str
    detections: SE3
    relative_truth: SE3 | None = None
    world_truth: SE3 | None = None

    def __repr__(self) -> str:
        seen = int(is_known(self.detections).sum())
        return f"<ObjectRecording '{self.id}', {seen} detections in {len(self.detections)} frames>"


@dataclass(frozen=True, eq=False)
class Sequence:
    """A recording. Arrays over frames have one entry per stamp, NaN in frames without a pose.

    Attributes
    ----------
    stamps : ndarray, shape (n,)
        Times of the frames, strictly increasing [s].
    odometry : SE3, shape (n,), optional
        T_odom_camera.
    camera_truth : SE3, shape (n,), optional
        True T_world_camera.
    objects : list of ObjectRecording
        Recordings of the objects.
    candidates : list of list of Candidate
        Detections that name only the class, per frame; none unless given.

    Raises
    ------
    ValueError
        When there is no frame, stamps do not increase, an array has the wrong length, two objects share an id, or
        a pose is not finite.

    Examples
    --------
    >>> import numpy as np
    >>> from posemix import SE3, ObjectRecording, Sequence
    >>> still = SE3.identity((5,))
    >>> Sequence(np.arange(5), still, objects=[ObjectRecording("mug", still)])
    <Sequence of 5 frames over 4 s, objects mug>
    """

    stamps: FloatArray
    odometry: SE3 | None = None
    camera_truth: SE3 | None = None
    objects: list[ObjectRecording] = field(default_factory=list)
    candidates: list[list[Candidate]] = field(default_factory=list)

    def __post_init__(self) -> None:
        stamps = np.ascontiguousarray(self.stamps, dtype=np.float64)
        object.__setattr__(self, "stamps", stamps)
        self._compiled()

    def __len__(self) -> int:
        return len(self.stamps)

    def _compiled(self) -> _core.Sequence:
        objects = [
            (
                recording.id,
                optional_rows(recording.detections),
                optional_rows(recording.relative_truth),
                optional_rows(recording.world_truth),
            )
            for recording in self.objects
        ]
        return _core.Sequence(
            self.stamps,
            optional_rows(self.odometry),
            optional_rows(self.camera_truth),
            objects,
            [candidate_rows(frame) for frame in self.candidates],
        )

    @classmethod
    def _of(cls, handle: _core.Sequence) -> Sequence:
        stamps, odometry, camera_truth, objects, candidates = handle.parts()
        return cls(
            stamps,
            optional_poses(odometry),
            optional_poses(camera_truth),
            [
                ObjectRecording(
                    id,
                    SE3._wrap(detections, (len(detections),)),
                    optional_poses(relative),
                    optional_poses(world),
                )
                for id, detections, relative, world in objects
            ],
            [[Candidate(*c) for c in frame] for frame in candidates],
        )

    def __repr__(self) -> str:
        names = ", ".join(recording.id for recording in self.objects) or "none"
        time = self.stamps[-1] - self.stamps[0]
        return f"<Sequence of {len(self)} frames over {time:.6g} s, objects {names}>"
