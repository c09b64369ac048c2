# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Images, odometry and transforms as they come, in; estimates, out. Without ROS, and without a clock of its own."""

from __future__ import annotations

import copy
from collections import deque
from collections.abc import Mapping

import numpy as np

from posemix._core import (
    BodyCamera,
    FrameEstimate,
    ObjectHypothesis,
    Observation,
    StampAdmission,
    StampedSlam,
    SymmetryGroup,
)
from posemix.bags.filter_runs import ClassTable
from posemix.density import ConcentratedGaussian
from posemix.lie import SE3
from posemix.noise import pose_covariance
from posemix.ros.configuration import Configuration
from posemix.ros.estimates import EngineCounts, LiveEstimate
from posemix.ros.messages import Image
from posemix.ros.surroundings import ReadyImage, Surroundings
from posemix.ros.transforms import LiveTransforms

__all__ = ["Engine"]

# Images in succession whose stamps are refused as too far ahead, after which the clock is taken to have jumped.
_AHEAD = 10


class Engine:
    """Object SLAM by stamps over what a live system says.

    Parameters
    ----------
    configuration : Configuration
        Detectors, models and settings.

    Raises
    ------
    ValueError
        When a setting is out of range or models do not fit each other.
    """

    def __init__(self, configuration: Configuration) -> None:
        self._configuration = configuration
        self.around = Surroundings(configuration)
        self.counts = EngineCounts()
        self.symmetries: dict[str, SymmetryGroup] = dict(configuration.symmetries)
        # Why the last image was dropped, refused, or taken without odometry.
        self.complaint = ""
        self._log: deque[ReadyImage] = deque(maxlen=int(configuration["replay_images"]))
        self._waiting: deque[Image] = deque()
        self._begin_again()
        self._slam_from(SE3(), [])  # which refuses what is not valid

    def _begin_again(self) -> None:
        self._slam: StampedSlam | None = None
        self._start_ns = 0
        self._stamps: dict[float, int] = {}
        self._with_odometry: dict[int, SE3 | None] = {}
        self._ahead = 0
        self._table = ClassTable([])
        self._classes: dict[str, str] = {}

    def reset(self) -> None:
        """Forgets objects, odometry, and images that wait; transforms for all times are kept."""
        self._begin_again()
        self._log.clear()
        self._waiting.clear()
        self.around.clear()
        self.counts.resets += 1

    @property
    def waiting(self) -> int:
        """Number of images that wait."""
        return len(self._waiting)

    @property
    def transforms(self) -> LiveTransforms:
        """The transforms that came."""
        return self.around.transforms

    def set_symmetries(self, symmetries: Mapping[str, SymmetryGroup]) -> LiveEstimate | None:
        """Takes symmetries of classes, also after images: those that are kept are played again with them.

        The estimate that follows is returned, where anything has changed.
        """
        changed = {
            name: group
            for name, group in symmetries.items()
            if name not in self.symmetries or self.symmetries[name] != group
        }
        if not changed:
            return None
        self.symmetries.update(changed)
        kept = list(self._log)
        if self._slam is None or not kept:
            return None
        counts, self.counts = self.counts, EngineCounts()
        self._slam = None
        self._stamps.clear()
        self._with_odometry.clear()
        self._log.clear()
        found = None
        for ready in kept:
            found = self._take(ready) or found
        self.counts = counts
        return found

    def add(self, image: Image) -> None:
        """Takes an image, which waits until `ready` finds what it needs."""
        self.around.see(image)
        self._waiting.append(image)
        while len(self._waiting) > int(self._configuration["queue_size"]):
            self._waiting.popleft()
            self.counts.dropped += 1
            self.complaint = "more images wait than queue_size"

    def ready(self, now_s: float) -> list[LiveEstimate]:
        """The estimates after the images that need not wait any more, in the order in which they came.

        Parameters
        ----------
        now_s : float
            Time by the clock of `Image.arrival_s` [s].
        """
        found = []
        for image in list(self._waiting):
            if image not in self._waiting:  # a jump of the clock has taken it away
                continue
            is_over = now_s - image.arrival_s >= self._configuration["transform_timeout_s"]
            prepared = self.around.ready(image, is_over=is_over)
            if prepared is None and not is_over:
                continue
            self._waiting.remove(image)
            if prepared is None:
                self.counts.dropped += 1
                self.complaint = self.around.complaint
                continue
            if prepared.odometry is None and self._configuration.has_odometry:
                self.counts.without_odometry += 1
                self.complaint = self.around.complaint
            estimate = self._take(prepared)
            if estimate is not None:
                found.append(estimate)
        return found

    def _slam_from(self, start: SE3, cameras: list[BodyCamera]) -> StampedSlam:
        of = self._configuration
        covariance = pose_covariance(np.radians(of["start_rotation_sd_deg"]), of["start_translation_sd_m"])
        models = of.models(self.symmetries)
        tracker = copy.copy(of.tracker)
        tracker.cameras = cameras
        self._classes = {model.id: model.class_id or model.id for model in models}
        self._table = ClassTable(models, bool(of["on_sight"]))
        return StampedSlam(ConcentratedGaussian(start, covariance), models, tracker, of.motion, of.stamped)

    def _take(self, ready: ReadyImage) -> LiveEstimate | None:
        image = ready.image
        if self._slam is None:
            self._start_ns = image.stamp_ns
            self._slam = self._slam_from(SE3() if ready.odometry is None else ready.odometry, ready.cameras)
        resets = self._slam.counts.resets
        try:
            self._put(self._slam, ready)
        except ValueError as error:
            self._refuse(str(error))
            return None
        self._ahead = 0
        self._log.append(ready)
        self.counts.images += 1
        if self._slam.counts.resets > resets:
            self._after_jump(ready)
        found = self._slam.finish()
        if found is None:
            return None
        stamp_ns = self._stamps[found.stamp_s]
        self._forget_stamps(stamp_ns)
        return LiveEstimate(
            stamp_ns, image.arrival_s, found.estimate, self._with_odometry.get(stamp_ns), self.around.body,
            self._hypotheses(self._slam, found.estimate),
            {name: self._classes.get(name, name) for name in found.estimate.ids},
        )  # fmt: skip

    def _put(self, slam: StampedSlam, ready: ReadyImage) -> None:
        image = ready.image
        stamp_s = (image.stamp_ns - self._start_ns) * 1e-9
        observations = self._observations(ready, stamp_s)
        self._stamps[stamp_s] = image.stamp_ns
        if ready.odometry is not None and self._with_odometry.get(image.stamp_ns) is None:
            slam.add_odometry(stamp_s, ready.odometry)
            self._with_odometry[image.stamp_ns] = ready.odometry
        for observation in observations:
            self._count(slam.add(observation))
        if not observations and self._configuration["empty_is_image"]:
            slam.add_image(stamp_s, image.frame if self._configuration.cameras else "")

    def _observations(self, ready: ReadyImage, stamp_s: float) -> list[Observation]:
        image = ready.image
        assigned = self._table.assigned(image.class_ids, image.scores)
        self.counts.ignored += len(image.class_ids) - len(assigned)
        return [
            Observation(
                ready.components[row], object=name, class_id=of_class, detector=image.source, stamp_s=stamp_s,
                score=image.scores[row], camera=image.frame if self._configuration.cameras else "",
            )
            for row, name, of_class in assigned
        ]  # fmt: skip

    def _count(self, admission: StampAdmission) -> None:
        self.counts.observations += 1
        self.counts.late += admission == StampAdmission.replayed
        self.counts.too_late += admission == StampAdmission.too_late

    def _refuse(self, why: str) -> None:
        self.counts.refused += 1
        self.complaint = why
        self._ahead = self._ahead + 1 if "ahead of the newest" in why else 0
        if self._ahead >= _AHEAD:
            self.reset()

    def _after_jump(self, ready: ReadyImage) -> None:
        """The filter has forgotten all before the image: so does what is around it."""
        self.counts.resets += 1
        stamp_ns = ready.image.stamp_ns
        self._log = deque([ready], maxlen=self._log.maxlen)
        self._stamps = {(stamp_ns - self._start_ns) * 1e-9: stamp_ns}
        self._with_odometry = {stamp_ns: ready.odometry}
        latest = stamp_ns + round(self._configuration.stamped.jump_back_s * 1e9)
        self._waiting = deque(image for image in self._waiting if image.stamp_ns <= latest)

    def _forget_stamps(self, newest_ns: int) -> None:
        if len(self._stamps) > 4096:
            oldest = newest_ns - round(self._configuration.stamped.jump_back_s * 1e9)
            self._stamps = {s: ns for s, ns in self._stamps.items() if ns >= oldest}
            self._with_odometry = {ns: pose for ns, pose in self._with_odometry.items() if ns >= oldest}

    def _hypotheses(self, slam: StampedSlam, estimate: FrameEstimate) -> dict[str, list[ObjectHypothesis]]:
        return {
            name: sorted(slam.hypotheses(name), key=lambda h: -h.probability)
            for name, world in estimate.objects.items()
            if world is not None
        }
