# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Messages of detectors as values of posemix, by the rules of bags."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from posemix._core import ObservationComponent, SymmetryAxis, SymmetryGroup
from posemix.bags.rows import DetectionRows, PoseOf
from posemix.interop.ros import from_pose
from posemix.lie import SE3

__all__ = ["Image", "images_of", "symmetries_of"]


@dataclass(frozen=True, eq=False)
class Image:
    """What a detector says of one image.

    Attributes
    ----------
    stamp_ns : int
        Time of the image [ns].
    frame : str
        Frame of the camera, by the header of the message.
    source : str
        Name of the detector.
    arrival_s : float
        Time at which the message came, by a clock that does not jump [s].
    class_ids, scores, frames : tuple, length n
        Of every detection the class, the score, and the frame in which its poses are.
    components : tuple of list of ObservationComponent, length n
        All results of the class of the best one.
    """

    stamp_ns: int
    frame: str
    source: str
    arrival_s: float
    class_ids: tuple[str, ...] = ()
    scores: tuple[float, ...] = ()
    frames: tuple[str, ...] = ()
    components: tuple[list[ObservationComponent], ...] = ()


def images_of(
    message: Any,
    *,
    source: str = "",
    arrival_s: float = 0.0,
    now_ns: int = 0,
    pose: PoseOf = "result",
    frame: str = "",
    least_score: float = float("-inf"),
) -> list[Image]:
    """The images of a Detection3DArray or Detection2DArray, one per stamp; an empty array is one that shows nothing.

    Parameters
    ----------
    message : Detection3DArray or Detection2DArray
        A message of vision_msgs.
    source : str
        Name of the detector.
    arrival_s : float
        Time at which the message came [s].
    now_ns : int
        Stamp of a message that has none [ns].
    pose : {"result", "bbox"}
        The pose of a detection: those of its results, or the centre of its box.
    frame : str
        Frame of the camera, in place of that in the messages.
    least_score : float
        Detections with a smaller score are left out.

    Raises
    ------
    ValueError
        For a pose or covariance that is none; it names the stamp and the detection.
    """
    rows = DetectionRows()
    rows.take(message, now_ns, pose, source or "detections")
    found = []
    for index, stamp in enumerate(rows.stamps):
        camera = frame or rows.cameras[index]
        mine = [i for i, k in enumerate(rows.frame) if k == index and rows.score[i] >= least_score]
        # Frames of detections may stand in their own headers alone.
        sources = [frame or rows.source[i] for i in mine]
        found.append(
            Image(
                stamp, camera or next(iter(sources), ""), source, arrival_s,
                tuple(rows.class_id[i] for i in mine), tuple(rows.score[i] for i in mine),
                tuple(sources), tuple(rows.components[i] for i in mine),
            )
        )  # fmt: skip
    return found


def symmetries_of(message: Any) -> dict[str, SymmetryGroup]:
    """Symmetries by class, of happypose_msgs/ObjectSymmetriesArray.

    Raises
    ------
    ValueError
        For motions that are no group, naming the class.
    """
    found = {}
    for entry in message.objects:
        axes = [
            SymmetryAxis(direction=_vector(item.axis), point=_vector(item.offset))
            for item in entry.symmetries_continuous
        ]
        poses = [from_pose(item).to_tq() for item in entry.symmetries_discrete]
        elements = SE3.from_tq(np.array(poses).reshape((-1, 7)))
        try:
            found[str(entry.class_id)] = SymmetryGroup(elements, axes)
        except ValueError as error:
            raise ValueError(f"symmetries of '{entry.class_id}': {error}") from None
    return found


def _vector(message: Any) -> list[float]:
    return [float(message.x), float(message.y), float(message.z)]
