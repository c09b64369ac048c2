# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""The filter of a run, with the stamps in nanoseconds and the names that the node gives it."""

from __future__ import annotations

import copy
import math
from collections.abc import Sequence
from uuid import uuid4

import numpy as np

from posemix._core import (
    BodyCamera,
    FrameEstimate,
    ObjectHypothesis,
    ObjectModel,
    Observation,
    StampAdmission,
    StampedSlam,
    StampJump,
)
from posemix.bags.filter_runs import ClassTable
from posemix.density import ConcentratedGaussian
from posemix.lie import SE3
from posemix.noise import pose_covariance
from posemix.ros.configuration import Configuration
from posemix.ros.estimates import LiveEstimate
from posemix.ros.known_classes import KnownClasses
from posemix.ros.maps import SavedMap
from posemix.ros.surroundings import ReadyImage

__all__ = ["LiveRun"]

_MOST_STAMPS = 4096


def _check_names(class_ids: Sequence[str]) -> None:
    """Refuses an image before any of its detections is taken in."""
    for name in class_ids:
        if not name or any(ord(letter) < 32 for letter in name):
            raise ValueError(f"got a detection of the class {name!r}, expected a name without control characters")


class LiveRun:
    """A filter from its first image on.

    Parameters
    ----------
    configuration : Configuration
        Detectors, models and settings.
    known : KnownClasses
        Symmetries, and classes of several objects.
    start : SE3
        T_world_body at the first image.
    start_ns : int
        Its stamp [ns].
    cameras : sequence of BodyCamera
        The rig; empty where there is one camera.

    Raises
    ------
    ValueError
        When a setting is out of range or models do not fit each other.
    """

    def __init__(
        self,
        configuration: Configuration,
        known: KnownClasses,
        start: SE3 | None = None,
        start_ns: int = 0,
        cameras: Sequence[BodyCamera] = (),
    ) -> None:
        self._configuration = configuration
        self.start_ns = start_ns
        # The newest stamp that the filter knows, which an image that tells it nothing does not move.
        self._newest_s = 0.0
        # Whether all images of the run were taken in by this filter, which knows nothing else.
        self.is_whole = True
        self._stamps: dict[float, int] = {}
        self._with_odometry: dict[int, SE3 | None] = {}
        # Whether the odometry was not known where the run began.
        self.lacks_odometry = configuration.has_odometry and start is None
        # Before this stamp the filter knows nothing [s].
        self._since_s = -math.inf
        # The runs whose images are in the estimate, this one among them.
        self.lineage = frozenset([uuid4().hex])
        of = configuration
        covariance = pose_covariance(np.radians(of["start_rotation_sd_deg"]), of["start_translation_sd_m"])
        body = ConcentratedGaussian(SE3() if start is None else start, covariance)
        self._begin(body, of.models(known.symmetries, known.several), cameras)

    def _begin(
        self, body: ConcentratedGaussian[SE3], models: Sequence[ObjectModel], cameras: Sequence[BodyCamera]
    ) -> None:
        of = self._configuration
        tracker = copy.copy(of.tracker)
        tracker.cameras = list(cameras)
        self.slam = StampedSlam(body, list(models), tracker, of.motion, of.stamped)
        self._name(models)

    def _name(self, models: Sequence[ObjectModel]) -> None:
        self._classes = {model.id: model.class_id or model.id for model in models}
        self._table = ClassTable(models, bool(self._configuration["on_sight"]))

    def why_late(self, stamp_ns: int) -> str:
        """Why an image with a stamp is left out that is too late."""
        stamp_s = self._seconds(stamp_ns)
        if stamp_s < self._since_s:
            return "an image is from before a map was found or models changed: it is left out"
        return (
            f"an image is {self._newest_s - stamp_s:.1f} s older than the newest one, and stamped.history_s is "
            f"{self._configuration.stamped.history_s:g} s: it is left out"
        )

    def jump_to(self, stamp_ns: int) -> str:
        """Says how a stamp has jumped; empty where it has not, and where the filter refuses it."""
        of, step_s = self._configuration.stamped, self._seconds(stamp_ns) - self._newest_s
        if self._seconds(stamp_ns) > self._newest_s + of.jump_ahead_s:
            return f"the stamp is {step_s:.1f} s after the newest one before it"
        if of.on_jump_back == StampJump.reset and self._seconds(stamp_ns) < self._newest_s - of.jump_back_s:
            return f"the stamp is {-step_s:.1f} s before the newest one"
        return ""

    def _seconds(self, stamp_ns: int) -> float:
        return (stamp_ns - self.start_ns) * 1e-9

    def put(self, ready: ReadyImage) -> tuple[list[StampAdmission], int, bool]:
        """Takes an image in: what became of its observations, the number of its other detections, and whether it shows
        nothing and is too late.

        Raises
        ------
        ValueError
            For an observation that is not valid, and a stamp that has jumped.
        """
        image = ready.image
        _check_names(image.class_ids)
        stamp_s = self._seconds(image.stamp_ns)
        observations = self._observations(ready, stamp_s)
        ignored = len(image.class_ids) - len(observations)
        if stamp_s < self._since_s:
            return [StampAdmission.too_late] * len(observations), ignored, not observations
        self._stamps[stamp_s] = image.stamp_ns
        if ready.odometry is not None and self._with_odometry.get(image.stamp_ns) is None:
            self.slam.add_odometry(stamp_s, ready.odometry)
            self._with_odometry[image.stamp_ns] = ready.odometry
            self._newest_s = max(self._newest_s, stamp_s)
        admissions = [self.slam.add(observation) for observation in observations]
        is_late = False
        if not observations and self._configuration["empty_is_image"]:
            # What other detectors find may be there all the same.
            detector = image.source if len(self._configuration.sources) > 1 else None
            camera = image.frame if self._configuration.cameras else ""
            is_late = self.slam.add_image(stamp_s, camera, detector) == StampAdmission.too_late
            self._newest_s = max(self._newest_s, stamp_s)
        if admissions:
            self._newest_s = max(self._newest_s, stamp_s)
        return admissions, ignored, is_late

    def _observations(self, ready: ReadyImage, stamp_s: float) -> list[Observation]:
        image = ready.image
        return [
            Observation(
                ready.components[row], object=name, class_id=of_class, detector=image.source, stamp_s=stamp_s,
                score=image.scores[row], camera=image.frame if self._configuration.cameras else "",
            )
            for row, name, of_class in self._table.assigned(image.class_ids, image.scores)
        ]  # fmt: skip

    def estimate(self, arrival_s: float, body: str) -> LiveEstimate | None:
        """The estimate after an image that came at a time, or after another change; None before the first."""
        found = self.slam.finish()
        if found is None:
            return None
        stamp_ns = self._stamps.get(found.stamp_s, self.start_ns + round(found.stamp_s * 1e9))
        self._forget_stamps(stamp_ns)
        return LiveEstimate(
            stamp_ns, arrival_s, found.estimate, self._with_odometry.get(stamp_ns), body,
            self._hypotheses(found.estimate), {name: self._classes.get(name, name) for name in found.estimate.ids},
        )  # fmt: skip

    def _hypotheses(self, estimate: FrameEstimate) -> dict[str, list[ObjectHypothesis]]:
        return {
            name: sorted(self.slam.hypotheses(name), key=lambda h: -h.probability)
            for name, world in estimate.objects.items()
            if world is not None
        }

    def _forget_stamps(self, newest_ns: int) -> None:
        if len(self._stamps) > _MOST_STAMPS:
            oldest = newest_ns - round(self._configuration.stamped.jump_back_s * 1e9)
            self._stamps = {s: ns for s, ns in self._stamps.items() if ns >= oldest}
            self._with_odometry = {ns: pose for ns, pose in self._with_odometry.items() if ns >= oldest}

    def models(self, known: KnownClasses, others: Sequence[ObjectModel] = ()) -> list[ObjectModel]:
        """Models of all objects that there are, and of `others`, as the configuration has them and without priors."""
        of = self._configuration
        found = {model.id: model for model in of.models(known.symmetries, known.several)}
        for model in [*self.slam.objects, *others]:
            if model.id not in found:
                name = model.class_id or model.id
                symmetries = known.symmetries.get(name, model.symmetries)
                found[model.id] = of.model(model.id, model.class_id, symmetries=symmetries)
        return list(found.values())

    def go_on_with(self, models: Sequence[ObjectModel]) -> None:
        """A new filter goes on from the last estimate, of objects with what their priors say.

        Late input from before does not count any more.

        Raises
        ------
        ValueError
            When models do not fit each other; nothing is changed.
        """
        last = self.slam.finish()
        assert last is not None
        self._begin(last.estimate.camera, models, self.slam.cameras)
        self._since_s = last.stamp_s
        odometry = self._with_odometry.get(self._stamps.get(last.stamp_s, -1))
        if odometry is not None:
            self.slam.add_odometry(last.stamp_s, odometry)
        self.is_whole = False

    def forget(self, names: Sequence[str]) -> None:
        """Forgets objects.

        Raises
        ------
        ValueError
            For a name that there is not, naming those that there are; nothing is changed.
        """
        known = [model.id for model in self.slam.objects]
        for name in names:
            if name not in known:
                raise ValueError(f"there is no object '{name}'; known are: {', '.join(known) or 'none'}")
        for name in names:
            self.slam.forget(name)
        self.is_whole = False

    def saved(self, body: str, known: KnownClasses) -> SavedMap:
        """The state, to be saved."""
        newest = max(self._with_odometry, default=None)
        return SavedMap(
            self.slam, self.start_ns, body, lineage=self.lineage, since_s=self._since_s,
            several=frozenset(known.several), symmetries=frozenset(known.symmetries),
            odometry=None if newest is None else (newest, self._with_odometry[newest]),
        )  # fmt: skip

    @classmethod
    def of_saved(
        cls, configuration: Configuration, known: KnownClasses, found: SavedMap
    ) -> LiveRun:
        """A run that goes on where another was saved.

        Raises
        ------
        ValueError
            For a map that another program has saved, and one that was made with other settings or models.
        """
        if found.start_ns is None:
            raise ValueError("the map is not one that a node has saved last in this file, so that it cannot go on")
        then = KnownClasses(dict(known.symmetries), known.several | found.several)
        for model in found.slam.objects:
            name = model.class_id or model.id
            if name in found.symmetries:
                then.symmetries.setdefault(name, model.symmetries)
        run = cls(configuration, then, SE3(), found.start_ns, found.slam.cameras)
        differences = found.slam.configuration_differences(run.slam)
        if differences:
            raise ValueError(f"the map was made with other parameters of: {', '.join(differences)}; it cannot go on")
        run.slam = found.slam
        last = found.slam.finish()
        run._newest_s = 0.0 if last is None else last.stamp_s
        run._name(found.slam.objects)
        known.symmetries.update(then.symmetries)
        known.several |= then.several
        run.is_whole = False
        run.lineage, run._since_s = found.lineage, found.since_s
        if found.odometry is not None:
            run._with_odometry = dict([found.odometry])
        return run
