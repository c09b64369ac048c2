# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Tracks while a run is going on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from posemix._arrays import FloatArray
from posemix._core import ObjectModel
from posemix.bags.states import TrackState
from posemix.bags.track_messages import PoseMixture, Track
from posemix.density import ConcentratedGaussian
from posemix.lie import SE3


@dataclass
class _Rows:
    """Rows of one track."""

    stamps: list[int] = field(default_factory=list)
    poses: list[FloatArray] = field(default_factory=list)
    covariances: list[FloatArray] = field(default_factory=list)
    mixtures: list[PoseMixture] = field(default_factory=list)
    states: list[TrackState] = field(default_factory=list)

    def add(
        self,
        stamp: int,
        density: ConcentratedGaussian[SE3],
        mixture: PoseMixture | None = None,
        state: TrackState | None = None,
    ) -> None:
        if self.stamps and self.stamps[-1] == stamp:
            # What came late has changed the estimate.
            for rows in (self.stamps, self.poses, self.covariances, self.mixtures, self.states):
                del rows[-1:]
        self.stamps.append(stamp)
        self.poses.append(density.mean.to_tq())
        self.covariances.append(density.covariance)
        if mixture is not None:
            self.mixtures.append(mixture)
        if state is not None:
            self.states.append(state)

    def track(self, name: str, class_id: str) -> Track:
        return Track(
            name, class_id, np.array(self.stamps, dtype=np.int64),
            SE3.from_tq(np.array(self.poses).reshape((-1, 7))),
            np.array(self.covariances).reshape((-1, 6, 6)), tuple(self.mixtures),
            tuple(self.states),
        )  # fmt: skip


class TrackRows:
    """The tracks of a camera and of objects, one row per frame; a frame again replaces the row before."""

    def __init__(self, models: Sequence[ObjectModel]) -> None:
        self._models = models
        self.clear()

    def clear(self) -> None:
        """Forgets all rows."""
        self._stamp = 0
        self._camera = _Rows()
        self._objects = [_Rows() for _ in self._models]

    def begin(self, stamp: int, camera: ConcentratedGaussian[SE3]) -> None:
        """Begins the rows of one frame, T_world_camera at a time [ns]."""
        self._stamp = stamp
        self._camera.add(stamp, camera)

    def add(
        self,
        index: int,
        world: ConcentratedGaussian[SE3],
        mixture: PoseMixture,
        state: TrackState | None = None,
    ) -> None:
        """Adds T_world_object of an object, with its hypotheses and the state of its track."""
        self._objects[index].add(self._stamp, world, mixture, state)

    def of_camera(self) -> Track:
        """The track of the camera."""
        return self._camera.track("camera", "")

    def of_objects(self) -> list[Track]:
        """The tracks of the objects that were seen."""
        return [
            rows.track(model.id, model.class_id or model.id)
            for model, rows in zip(self._models, self._objects, strict=True)
            if rows.stamps
        ]
