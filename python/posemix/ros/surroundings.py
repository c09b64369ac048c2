# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""What is around a camera at a time: the frames of detections, the rig, odometry."""

from __future__ import annotations

from dataclasses import dataclass


from posemix._core import BodyCamera, ObservationComponent
from posemix.bags.observations import moved
from posemix.lie import SE3
from posemix.ros.configuration import Configuration
from posemix.ros.estimates import LiveEstimate
from posemix.ros.messages import Image
from posemix.ros.transforms import LiveLine, LiveTransforms, Row

__all__ = ["ReadyImage", "Surroundings"]


@dataclass(frozen=True)
class ReadyImage:
    """An image with what its stamp needs.

    Attributes
    ----------
    image : Image
        The image.
    odometry : SE3 or None
        T_odom_body at its stamp.
    components : tuple of list of ObservationComponent
        Poses of its detections in the frame of the camera.
    cameras : list of BodyCamera
        The rig.
    """

    image: Image
    odometry: SE3 | None
    components: tuple[list[ObservationComponent], ...]
    cameras: list[BodyCamera]


class Surroundings:
    """Transforms and odometry over a window of time.

    Parameters
    ----------
    configuration : Configuration
        Names of frames, gaps.
    """

    def __init__(self, configuration: Configuration) -> None:
        self._configuration = configuration
        # No longer than what counts as a jump of the clock, so that nothing from before one is left.
        self._window_s = configuration.stamped.jump_back_s
        self.transforms = LiveTransforms(self._window_s)
        # Frame of the body: that of the rig, or of the one camera; empty before the first image.
        self.body = ""
        # Why an image waits or is left out.
        self.complaint = ""
        self._forget()

    def _forget(self) -> None:
        self.odometry = LiveLine(round(self._window_s * 1e9))
        self._base = ""
        self.body = ""
        self._rig: list[BodyCamera] | None = None

    def clear(self) -> None:
        """Forgets all but transforms for all times."""
        self._forget()
        self.transforms.clear()

    def add_odometry(self, frame: str, child: str, row: Row, stamp_ns: int) -> None:
        """Takes T_frame_child of nav_msgs/Odometry at a time, as tx, ty, tz, qx, qy, qz, qw.

        Raises
        ------
        ValueError
            For another frame than `odom_frame`, which would make no sense of the poses.
        """
        if frame != self._configuration["odom_frame"]:
            expected = self._configuration["odom_frame"]
            raise ValueError(f"odometry is in the frame '{frame}'; expected odom_frame, '{expected}'")
        self._base = child
        self.odometry.add(stamp_ns, row)

    def see(self, image: Image) -> None:
        """Takes the body from the first image."""
        self.body = self.body or self._body_of(image)

    def _body_of(self, image: Image) -> str:
        if self._configuration.cameras:
            return str(self._configuration["body_frame"])
        return str(self._configuration["camera_frame"]) or image.frame

    def ready(self, image: Image, *, is_over: bool) -> ReadyImage | None:
        """The image with its poses in the frame of its camera, and with odometry; None where that is not known.

        Where the time for waiting `is_over`, it may be without odometry.
        """
        of = self._configuration
        components = self._components(image)
        cameras = self._cameras()
        if components is None or cameras is None:
            return None
        odometry = self._odometry_at(image.stamp_ns, of["max_gap_s"])
        if odometry is None and of.has_odometry:
            self.complaint = (
                f"no odometry at {image.stamp_ns} ns: {of['odometry_topic'] or '/tf'} has no pose of '{self.body}' in "
                f"'{of['odom_frame']}' (motion.model says how the camera moves without)"
            )
            if not is_over:
                return None
        return ReadyImage(image, odometry, components, cameras)

    def _components(self, image: Image) -> tuple[list[ObservationComponent], ...] | None:
        cameras = self._configuration.cameras
        camera = image.frame if cameras else self.body
        if cameras and image.frame not in cameras:
            self.complaint = f"an image is of the frame '{image.frame}'; expected one of cameras, {', '.join(cameras)}"
            return None
        found = []
        for frame, poses in zip(image.frames, image.components, strict=True):
            if frame != camera:
                by = self.transforms.at(camera, frame, image.stamp_ns, self._configuration["max_gap_s"])
                if by is None:
                    self.complaint = f"no transform from '{frame}' to '{camera}' at {image.stamp_ns} ns"
                    return None
                poses = moved(poses, by)
            found.append(poses)
        return tuple(found)

    def _odometry_at(self, stamp_ns: int, gap_s: float) -> SE3 | None:
        """T_odom_body."""
        if not self._configuration.has_odometry:
            return None
        if not self._configuration["odometry_topic"]:
            return self.transforms.at(self._configuration["odom_frame"], self.body, stamp_ns, gap_s)
        pose = self.odometry.at(stamp_ns, gap_s)
        to_body = None if pose is None else self.transforms.at(self._base, self.body, stamp_ns, gap_s)
        return None if pose is None or to_body is None else pose * to_body

    def _cameras(self) -> list[BodyCamera] | None:
        """The cameras of the rig; None until transforms say where they are."""
        if self._rig is None:
            found = []
            for name in self._configuration.cameras:
                pose = self.transforms.at(self.body, name, 2**62, 0.0)
                if pose is None:
                    self.complaint = f"no transform from camera '{name}' to '{self.body}' in /tf_static"
                    return None
                found.append(BodyCamera(name=name, body_camera=pose))
            self._rig = found
        return self._rig

    def below_world(self, estimate: LiveEstimate) -> tuple[str, SE3] | str | None:
        """The frame that the node puts below the world, and T_frame_body; why it does not, where it should.

        With odometry it is that of the odometry, without it the root of the tree in which the body is.
        """
        of, world = self._configuration, str(self._configuration["world_frame"])
        if not of["publish_world_tf"]:
            return None
        if of.has_odometry:
            child, pose = str(of["odom_frame"]), estimate.odometry
            if child == world:
                return None
            above = self.transforms.parent(child)
        else:
            child = self.transforms.root(estimate.body)
            pose = self.transforms.at(child, estimate.body, estimate.stamp_ns, of["max_gap_s"])
            above = world if child == world else None
        if above is not None:
            return (
                f"'{child if child != world else estimate.body}' is below '{above}' in /tf already, so that this node "
                f"does not say where it is in '{world}' (publish_world_tf)"
            )
        return None if pose is None else (child, pose)
