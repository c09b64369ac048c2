# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Estimates as messages of Foxglove: transforms, scenes, states of objects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from posemix._arrays import FloatArray
from posemix._core import ObjectEstimate
from posemix._peers import peer
from posemix.lie import SE3, SO3
from posemix.live_view.frames import Frustum, PoseMixture
from posemix.live_view.tables import position_sd_m
from posemix.plot.space import position_ellipsoids
from posemix.plot.style import AXIS_COLOURS

__all__ = ["STATE_SCHEMA", "SceneMaker", "foxglove", "state_of"]

_AXIS_M = 0.1
# Probability from which a hypothesis has a label.
_LABELLED = 0.02
# Turns x, along which arrows are drawn, to x, y and z.
_TO_AXIS = (SO3(), SO3.exp([0, 0, np.pi / 2]), SO3.exp([0, -np.pi / 2, 0]))
_NUMBER = {"type": ["number", "null"]}
_NUMBERS = {"type": "array", "items": {"type": "number"}}
STATE_SCHEMA = {
    "type": "object",
    "title": "posemix.ObjectState",
    "properties": {
        "health": {"type": "string"},
        "register_again": {"type": "boolean"},
        "existence": _NUMBER,
        "mode_probability": _NUMBER,
        "position_sd_m": {"type": "number"},
        "motion_models": {"type": "object"},
        "hypotheses": {
            "type": "array",
            "items": {
                "type": "object",
                "properties": {
                    "id": {"type": "integer"},
                    "probability": {"type": "number"},
                    "position": _NUMBERS,
                    "quaternion_xyzw": _NUMBERS,
                },
            },
        },
    },
}


def foxglove(module: str = "") -> Any:
    """The package foxglove, or a module of it."""
    name = f"foxglove.{module}" if module else "foxglove"
    return peer(name, "posemix.live_view.FoxgloveView", "posemix[foxglove]")


def state_of(
    estimate: ObjectEstimate, hypotheses: Sequence[Any], model_names: Sequence[str]
) -> dict[str, Any]:
    """The state of an object, by `STATE_SCHEMA`."""
    return {
        "health": estimate.health.name,
        "register_again": estimate.register_again,
        "existence": estimate.existence,
        "mode_probability": estimate.mode_probability,
        "position_sd_m": position_sd_m(estimate),
        "motion_models": dict(zip(model_names, map(float, estimate.motion_models), strict=True)),
        "hypotheses": [
            {
                "id": h.id,
                "probability": h.probability,
                "position": h.pose.translation.tolist(),
                "quaternion_xyzw": h.pose.rotation.quaternion.tolist(),
            }
            for h in sorted(hypotheses, key=lambda h: -h.probability)
        ],
    }


class SceneMaker:
    """Makes the messages of one time.

    Parameters
    ----------
    world_frame : str
        Name of the frame of the world.
    """

    def __init__(self, world_frame: str) -> None:
        self._m = foxglove("messages")
        self._world = world_frame
        self._stamp: Any = None

    def begin(self, stamp_ns: int) -> None:
        """The messages that follow are of this time [ns]."""
        self._stamp = self._m.Timestamp(*divmod(stamp_ns, 1_000_000_000))

    def transforms(self, poses: Mapping[str, SE3]) -> Any:
        """The FrameTransforms of poses in the world, by the names of their frames."""
        found = [
            self._m.FrameTransform(
                timestamp=self._stamp, parent_frame_id=self._world, child_frame_id=name,
                translation=self._vector(pose.translation), rotation=self._quaternion(pose.rotation.quaternion),
            )
            for name, pose in poses.items()
        ]  # fmt: skip
        return self._m.FrameTransforms(transforms=found)

    def hypotheses(self, name: str, label: str, mixture: PoseMixture, colour: str) -> Any:
        """The entity of an object: of every hypothesis axes and the ellipsoid of its position (3 sigma)."""
        order = np.argsort(-mixture.log_weights, kind="stable")
        weights, means = mixture.weights[order], mixture.means[order]
        centres, sizes, quaternions = position_ellipsoids(means, mixture.covariances[order], 3.0)
        spheres = [
            self._m.SpherePrimitive(
                pose=self._pose(centre, quaternion), size=self._vector(2.0 * size),
                color=self._colour(colour, 0.05 + 0.6 * weight),
            )
            for centre, size, quaternion, weight in zip(centres, sizes, quaternions, weights, strict=True)
        ]  # fmt: skip
        arrows = [
            self._arrow(mean, axis, 0.15 + 0.85 * float(weight))
            for mean, weight in zip(means, weights, strict=True)
            for axis in range(3)
        ]
        texts = [
            self._text(mean, f"{label} {weight:.3f}" if i == 0 else f"{weight:.3f}", float(max(weight, 0.3)))
            for i, (mean, weight) in enumerate(zip(means, weights, strict=True))
            if i == 0 or weight >= _LABELLED
        ]
        return self._entity(f"{name}/hypotheses", self._world, spheres=spheres, arrows=arrows, texts=texts)

    def line(self, name: str, points: FloatArray, colour: str) -> Any:
        """The entity of a path in the world."""
        strip = self._m.LinePrimitive(
            type=self._m.LinePrimitiveLineType.LineStrip, thickness=2.0, scale_invariant=True,
            points=self._points(points), color=self._colour(colour, 1.0),
        )  # fmt: skip
        return self._entity(f"{name}/way", self._world, lines=[strip])

    def frustum(self, frame: str, frustum: Frustum) -> Any:
        """The entity of what a camera sees, in the frame of the camera."""
        corners = frustum.corners()
        edges = [row for i, corner in enumerate(corners) for row in ((0.0, 0.0, 0.0), corner, corner, corners[i - 1])]
        lines = self._m.LinePrimitive(
            type=self._m.LinePrimitiveLineType.LineList, thickness=1.5, scale_invariant=True,
            points=self._points(np.array(edges)), color=self._colour("#444444", 1.0),
        )  # fmt: skip
        return self._entity(f"{frame}/frustum", frame, lines=[lines])

    def update(self, entities: Sequence[Any], gone: Sequence[str] = ()) -> Any:
        """The SceneUpdate of entities, without those that are gone."""
        m = self._m
        kind = m.SceneEntityDeletionType.MatchingId
        deletions = [m.SceneEntityDeletion(timestamp=self._stamp, type=kind, id=name) for name in gone]
        return m.SceneUpdate(deletions=deletions, entities=list(entities))

    def log(self, name: str, message: str, is_bad: bool) -> Any:
        """The Log of a change of health."""
        level = self._m.LogLevel.Warning if is_bad else self._m.LogLevel.Info
        return self._m.Log(timestamp=self._stamp, level=level, name=name, message=message)

    def _entity(self, name: str, frame: str, **primitives: Any) -> Any:
        return self._m.SceneEntity(timestamp=self._stamp, frame_id=frame, id=name, **primitives)

    def _vector(self, values: Any) -> Any:
        x, y, z = (float(v) for v in values)
        return self._m.Vector3(x=x, y=y, z=z)

    def _points(self, rows: FloatArray) -> list[Any]:
        return [self._m.Point3(x=x, y=y, z=z) for x, y, z in rows.tolist()]

    def _quaternion(self, values: Any) -> Any:
        x, y, z, w = (float(v) for v in values)
        return self._m.Quaternion(x=x, y=y, z=z, w=w)

    def _pose(self, position: Any, quaternion: Any) -> Any:
        return self._m.Pose(position=self._vector(position), orientation=self._quaternion(quaternion))

    def _colour(self, colour: str, alpha: float) -> Any:
        r, g, b = (int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5))
        return self._m.Color(r=r, g=g, b=b, a=float(alpha))

    def _arrow(self, pose: SE3, axis: int, alpha: float) -> Any:
        turned = pose.rotation * _TO_AXIS[axis]
        return self._m.ArrowPrimitive(
            pose=self._pose(pose.translation, turned.quaternion), shaft_length=0.8 * _AXIS_M, shaft_diameter=0.006,
            head_length=0.2 * _AXIS_M, head_diameter=0.014, color=self._colour(AXIS_COLOURS[axis], alpha),
        )  # fmt: skip

    def _text(self, pose: SE3, text: str, alpha: float) -> Any:
        above = pose.translation + [0.0, 0.0, 1.3 * _AXIS_M]
        return self._m.TextPrimitive(
            pose=self._pose(above, (0.0, 0.0, 0.0, 1.0)), billboard=True, font_size=14.0, scale_invariant=True,
            color=self._colour("#555555", alpha), text=text,
        )  # fmt: skip
