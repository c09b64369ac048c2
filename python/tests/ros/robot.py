# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""An engine of the node without ROS, and what a robot gives it."""

from __future__ import annotations

from typing import Any

import numpy as np
import posemix as px

from posemix import SE3, SO3
from posemix.ros import Engine, Image, LiveEstimate, configuration

SECOND = 1_000_000_000
START = 1_700_000_000 * SECOND
PLACES = {
    "mug": SE3(SO3.exp([0.1, 0.2, 0.3]), [0.2, 0.0, 0.9]),
    "box": SE3(SO3.exp([0.0, 0.4, 1.0]), [-0.2, 0.1, 1.0]),
    "jar": SE3(SO3.exp([0.9, 0.0, -1.0]), [0.0, -0.2, 1.1]),
    "can": SE3(SO3.exp([0.3, -0.5, 0.2]), [0.3, 0.3, 1.2]),
}
# Where the odometry begins anew after the robot was switched off.
ELSEWHERE = SE3.exp([0.0, 0.0, 0.7, 1.5, -0.4, 0.0])


def camera_at(seconds: float) -> SE3:
    """T_world_camera."""
    return SE3.exp([0.0, 0.03 * seconds, 0.0, 0.05 * seconds, 0.0, 0.0])


class Robot:
    """An engine, and what it is given."""

    def __init__(self, engine: Engine, odometry: SE3 | None = None) -> None:
        self.engine = engine
        # T_odom_world.
        self.odometry = SE3() if odometry is None else odometry

    def look(self, seconds: float, names: tuple[str, ...] | list[str], more: dict[str, list[SE3]] | None = None) -> Any:
        """An image in which objects are seen; `more` are places of others of their classes."""
        camera = camera_at(seconds)
        stamp = START + round(seconds * SECOND)
        self.engine.transforms.take("odom", "camera", (self.odometry * camera).to_tq().tolist(), stamp)
        seen = [(name, PLACES[name]) for name in names] + [(n, p) for n, of in (more or {}).items() for p in of]
        rng = np.random.default_rng(round(1000 * seconds))
        poses = [
            camera.inverse() * pose * SE3.exp(rng.normal(size=6) * [0.01, 0.01, 0.01, 0.002, 0.002, 0.002])
            for _, pose in seen
        ]
        self.engine.add(Image(
            stamp, "camera", "", 0.0, tuple(name for name, _ in seen), tuple(0.9 - 0.01 * i for i in range(len(seen))),
            ("camera",) * len(seen), tuple([px.ObservationComponent(pose)] for pose in poses),
        ))  # fmt: skip
        found = self.engine.ready(0.0)
        return found[-1] if found else None

    def drive(self, begin: float, end: float, names: tuple[str, ...] | list[str], period: float = 0.2) -> Any:
        found = None
        for i in range(round((end - begin) / period)):
            found = self.look(begin + period * i, names)
        return found


def robot(**more: Any) -> Robot:
    odometry = more.pop("odometry", None)
    return Robot(Engine(configuration({"start_rotation_sd_deg": 0.01, **more})), odometry)


def numbers(estimate: LiveEstimate) -> np.ndarray:
    rows = [[*h.pose.to_tq(), *h.covariance.ravel(), h.probability] for of in estimate.hypotheses.values() for h in of]
    return np.array(rows)


def where(estimate: LiveEstimate, name: str) -> SE3:
    return estimate.hypotheses[name][0].pose
