# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Filters over the frames of a recording: by the stamps, or in the order of arrival."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

import numpy as np

from posemix.bags.observations import named
from posemix.bags.read import Detections, Recording
from posemix.bags.states import TrackState
from posemix.bags.track_rows import TrackRows
from posemix._core import ObjectHypothesis
from posemix.lie import SE3
from posemix.live_view.frames import LiveFrame, mixture_of
from posemix.live_view.view import View
from posemix.slam import (
    Candidate,
    FrameEstimate,
    FrameInput,
    ObjectModel,
    ObjectSlam,
    Observation,
    ObservationComponent,
    StampAdmission,
    StampedSlam,
)


class ClassTable:
    """Which object or class a detection is of, by the class that it has.

    Parameters
    ----------
    models : sequence of ObjectModel
        Detections are assigned to models by `class_id`, or `id` if that is empty.
    on_sight : bool
        Whether a class that no model has is an object of its own, named as the class.
    """

    def __init__(self, models: Sequence[ObjectModel], on_sight: bool = False) -> None:
        self._classes = Counter(model.class_id or model.id for model in models)
        self._single = {
            m.class_id or m.id: m.id for m in models if self._classes[m.class_id or m.id] == 1
        }
        self._on_sight = on_sight

    def assigned(
        self, class_ids: Sequence[str], scores: Sequence[float]
    ) -> list[tuple[int, str, str]]:
        """Of the detections of one image the rows, the highest score first, with the object or the class of each.

        A class with one model has one row at most; rows of other classes than those of the models are left out.
        """
        found: list[tuple[int, str, str]] = []
        taken = set()
        for row in sorted(range(len(class_ids)), key=lambda r: -scores[r]):
            name = class_ids[row]
            if self._classes[name] > 1:
                found.append((row, "", name))
            elif name not in taken and (name in self._single or self._on_sight):
                taken.add(name)
                found.append((row, self._single.get(name, name), ""))
        return found


def _assigned(
    recording: Recording, models: Sequence[ObjectModel]
) -> Iterator[list[tuple[int, str, str]]]:
    """The rows of every frame with the object or the class that each is of."""
    table = ClassTable(models)
    seen = recording.detections
    rows: list[list[int]] = [[] for _ in recording.stamps_ns]
    for row, frame in enumerate(seen.frame.tolist()):
        rows[frame].append(row)
    for of_frame in rows:
        found = table.assigned([seen.class_id[r] for r in of_frame], seen.score[of_frame].tolist())
        yield [(of_frame[row], name, of_class) for row, name, of_class in found]


def _inputs(recording: Recording, models: Sequence[ObjectModel]) -> Iterator[FrameInput]:
    """The input frames: candidates for a class with several models, otherwise the detection of highest score."""
    seen, stamps = recording.detections, recording.stamps
    for k, rows in enumerate(_assigned(recording, models)):
        detections = {name: seen.poses[row] for row, name, _ in rows if name}
        candidates = [
            Candidate(of_class, seen.poses[row], float(seen.score[row]))
            for row, _, of_class in rows
            if of_class
        ]
        motion = None
        if k > 0 and recording.has_odometry[k - 1] and recording.has_odometry[k]:
            motion = recording.odometry[k - 1].inverse() * recording.odometry[k]
        dt = float(stamps[k] - stamps[k - 1]) if k > 0 else 0.0
        yield FrameInput(dt, motion, detections, candidates)


def _observations(
    recording: Recording, models: Sequence[ObjectModel]
) -> list[list[Observation]]:
    """The observations of every frame, each of an object where its class has one model."""
    seen = recording.detections
    return [
        [named(_observation(seen, row, recording), name, of_class) for row, name, of_class in rows]
        for rows in _assigned(recording, models)
    ]


def _observation(seen: Detections, row: int, recording: Recording) -> Observation:
    if seen.observations:
        return seen.observations[row]
    return Observation(
        [ObservationComponent(seen.poses[row])], class_id=seen.class_id[row], score=float(seen.score[row]),
        stamp_s=float(recording.stamps[seen.frame[row]]),
    )  # fmt: skip


def by_stamps(
    recording: Recording, models: Sequence[ObjectModel], slam: ObjectSlam, tracks: TrackRows
) -> Iterator[Counter[StampAdmission]]:
    """Runs a filter over the best poses, and yields after every frame."""
    for k, frame in enumerate(_inputs(recording, models)):
        slam.step(frame)
        joint, posterior = slam.estimate, slam.posterior
        tracks.begin(int(recording.stamps_ns[k]), joint.marginal(0))
        for j in range(len(models)):
            index = slam.pose_index(j)
            if index is not None:
                tracks.add(j, joint.marginal(index), posterior.marginal(index))
        yield Counter()


def by_arrival(
    recording: Recording,
    models: Sequence[ObjectModel],
    slam: StampedSlam,
    has_odometry: bool,
    tracks: TrackRows,
    views: Sequence[View] = (),
) -> Iterator[Counter[StampAdmission]]:
    """Runs the multi-object filter over the observations, and yields what became of those of every frame.

    Views are shown every estimate.
    """
    stamps = recording.stamps.tolist()
    stamps_ns = dict(zip(stamps, recording.stamps_ns.tolist(), strict=True))
    arrivals = recording.arrivals_ns if len(recording.arrivals_ns) else recording.stamps_ns
    observations = _observations(recording, models)
    for k in np.argsort(arrivals, kind="stable").tolist():
        counts: Counter[StampAdmission] = Counter()
        resets = slam.counts.resets
        if has_odometry and recording.has_odometry[k]:
            slam.add_odometry(stamps[k], recording.odometry[k])
        if not observations[k]:
            slam.add_image(stamps[k])
        counts.update(slam.add(observation) for observation in observations[k])
        if slam.counts.resets > resets:
            tracks.clear()
        found = slam.finish()
        if found is not None:
            tracks.begin(stamps_ns[found.stamp_s], found.estimate.camera)
            hypotheses = _add_objects(slam, found.estimate, tracks)
            if views:
                seen = _detected(observations[k]) if found.stamp_s == stamps[k] else {}
                frame = LiveFrame(found.stamp_s, found.estimate, hypotheses, seen)
                for view in views:
                    view.show(frame)
        yield counts


def _add_objects(
    slam: StampedSlam, estimate: FrameEstimate, tracks: TrackRows
) -> dict[str, list[ObjectHypothesis]]:
    """Adds the objects that were seen, and returns their hypotheses."""
    hypotheses = {}
    for j, name in enumerate(estimate.ids):
        of_object = estimate.object(name)
        if of_object.world is not None:
            hypotheses[name] = found = slam.hypotheses(name)
            tracks.add(j, of_object.world, mixture_of(found), TrackState.of(of_object))
    return hypotheses


def _detected(observations: Sequence[Observation]) -> dict[str, SE3]:
    """The heaviest pose of every observation that is of an object by its name."""
    return {o.object: max(o.components, key=lambda c: c.weight).pose for o in observations if o.object}
