# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Detections while a bag is read, one row each."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from posemix._arrays import FloatArray
from posemix._core import ObservationComponent
from posemix.bags.messages import frame_of, stamp_of
from posemix.bags.observations import class_of, components_of, score_of
from posemix.interop.ros import from_pose

PoseOf = Literal["result", "bbox"]


@dataclass
class DetectionRows:
    """Rows of detections, and the frames that they are of: messages, or parts of one with a stamp of their own."""

    stamps: list[int] = field(default_factory=list)
    arrivals: list[int] = field(default_factory=list)
    cameras: list[str] = field(default_factory=list)
    frame: list[int] = field(default_factory=list)
    source: list[str] = field(default_factory=list)
    class_id: list[str] = field(default_factory=list)
    instance_id: list[str] = field(default_factory=list)
    score: list[float] = field(default_factory=list)
    poses: list[FloatArray] = field(default_factory=list)
    covariance: list[FloatArray] = field(default_factory=list)
    components: list[list[ObservationComponent]] = field(default_factory=list)
    # Of every stamp the frame, and the stamp of the array that it is from.
    _frames: dict[int, tuple[int, int]] = field(default_factory=dict)

    def take(self, message: Any, arrival: int, pose_of: PoseOf, where: str) -> None:
        """Adds the detections of a message.

        Raises
        ------
        ValueError
            For a pose or covariance that is none; it names the topic (`where`), the stamp and the detection.
        """
        of_array = stamp_of(message.header, arrival)
        camera = frame_of(message.header)
        frames: dict[int, int] = {}
        if len(message.detections) == 0:
            self._frame(of_array, of_array, arrival, camera)
        for number, detection in enumerate(message.detections):
            # The header of the array may have the time of publication, and the detection's that of the image.
            stamp = stamp_of(detection.header, of_array)
            if stamp not in frames:
                frames[stamp] = self._frame(stamp, of_array, arrival, camera)
            if len(detection.results) == 0:
                continue
            try:
                self._add(detection, frames[stamp], camera, pose_of)
            except ValueError as error:
                raise ValueError(
                    f"{where}: detection {number} at {stamp} ns: {error}"
                ) from None

    def _frame(self, stamp: int, of_array: int, arrival: int, camera: str) -> int:
        """The frame of a stamp: a new one, unless another array has detections of the same image."""
        index, other_array = self._frames.get(stamp, (len(self.stamps), of_array))
        if index < len(self.stamps) and other_array != of_array:
            return index
        index = len(self.stamps)
        self._frames[stamp] = (index, of_array)
        self.stamps.append(stamp)
        self.arrivals.append(arrival)
        self.cameras.append(camera)
        return index

    def _add(self, detection: Any, frame: int, camera: str, pose_of: PoseOf) -> None:
        results = detection.results
        best = results[0] if len(results) == 1 else max(results, key=score_of)
        shape = best.pose.pose if pose_of == "result" else detection.bbox.center
        pose = from_pose(shape)
        self.components.append(components_of(detection, best, pose, pose_of))
        self.frame.append(frame)
        self.source.append(frame_of(detection.header) or camera)
        self.class_id.append(class_of(best))
        self.instance_id.append(
            str(getattr(detection, "id", "") or getattr(detection, "tracking_id", ""))
        )
        self.score.append(score_of(best))
        self.poses.append(pose.to_tq())
        self.covariance.append(np.array(best.pose.covariance, dtype=np.float64))
