# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Which objects lie within the images, by the cameras' intrinsics."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from posemix._arrays import FloatArray
from posemix.bags.messages import frame_of
from posemix.ros.estimates import LiveEstimate
from posemix.ros.transforms import LiveTransforms

__all__ = ["CameraSights"]


@dataclass(frozen=True)
class _Camera:
    matrix: FloatArray
    size: FloatArray

    def shows(self, point: FloatArray) -> bool:
        """Whether a point, in the camera's frame, is in the image; distortion is left aside."""
        if not point[2] > 0.0:
            return False
        pixel = (self.matrix @ (point / point[2]))[:2]
        return bool((pixel >= 0.0).all() and (pixel <= self.size).all())


class CameraSights:
    """Cameras by their frames, as sensor_msgs/CameraInfo tells them."""

    def __init__(self) -> None:
        self._cameras: dict[str, _Camera] = {}

    def take(self, message: Any) -> None:
        """Takes a sensor_msgs/CameraInfo.

        Raises
        ------
        ValueError
            For one of a camera that is not calibrated, whose focal lengths are zero, and one without a size.
        """
        frame, matrix = frame_of(message.header), np.array(message.k, dtype=np.float64).reshape((3, 3))
        size = np.array([message.width, message.height], dtype=np.float64)
        if not (np.isfinite(matrix).all() and matrix[0, 0] > 0.0 and matrix[1, 1] > 0.0 and (size > 0.0).all()):
            raise ValueError(
                f"camera '{frame}' has focal lengths of {matrix[0, 0]:g} and {matrix[1, 1]:g} pixels and an image of "
                f"{size[0]:g} by {size[1]:g}; expected positive ones"
            )
        self._cameras[frame] = _Camera(matrix, size)

    def in_view(self, estimate: LiveEstimate, transforms: LiveTransforms, max_gap_s: float) -> dict[str, bool]:
        """Of every object that was seen whether its place is in any of the images; none without any camera."""
        found: dict[str, bool] = {}
        for frame, camera in self._cameras.items():
            pose = transforms.at(estimate.body, frame, estimate.stamp_ns, max_gap_s)
            if pose is None:
                continue
            to_camera = (estimate.frame.camera.mean * pose).inverse()
            for name, of_object in estimate.hypotheses.items():
                point = to_camera.act(of_object[0].pose.translation)
                found[name] = found.get(name, False) or camera.shows(point)
        return found
