# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""A running estimator, seen live: a camera looks at a table from changing places, at 20 Hz.

    python live_view.py rerun                    then: rerun rerun+http://127.0.0.1:9876/proxy
    python live_view.py foxglove                 then, in Foxglove, open a connection to ws://localhost:8765
    python live_view.py rerun --address run.rrd  a file, at once; foxglove: a name that ends in .mcap
    python live_view.py report --folder run      the HTML report, run/report.html

The mug looks the same from both sides: every detection of it has two poses. The can is carried about, and the drill is
taken away after half of the time, which the detector says by images in which it is not.
"""

import argparse
import math
import time

import numpy as np
import posemix as px
from posemix.live_view import Frustum, LiveRecording, open_view

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("view", choices=["rerun", "foxglove", "report"])
parser.add_argument("--address", default="", help="address of the view, or its file")
parser.add_argument("--folder", default="live-view", help="folder of the report")
parser.add_argument("--seconds", type=float, default=20.0, help="length of the run")
options = parser.parse_args()

random = np.random.default_rng(1)
PERIOD_S = 0.05
FORWARD = px.SE3.from_matrix(np.array([[0.0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 0, 1]]))
HALF_TURN = px.SE3.exp([0.0, 0.0, math.pi, 0.0, 0.0, 0.0])
SPREAD = np.array([0.03, 0.03, 0.03, 0.005, 0.005, 0.01])
PLACES = {
    "mug": px.SE3(px.SO3.exp([0.0, 0.0, 0.4]), [1.0, 0.1, 0.1]),
    "box": px.SE3(px.SO3.exp([0.0, 0.0, -0.8]), [1.1, -0.35, 0.1]),
    "can": px.SE3(translation=[0.9, 0.45, 0.15]),
    "drill": px.SE3(px.SO3.exp([0.0, 0.0, 2.0]), [1.5, 0.0, 0.1]),
}


def camera_at(t: float) -> px.SE3:
    """T_world_camera."""
    turn = px.SE3.exp([0.15 * math.sin(0.5 * t), -0.35 * math.sin(0.3 * t), 0.0, 0.0, 0.0, 0.0])
    place = [0.1 * math.sin(0.4 * t), 0.6 * math.sin(0.3 * t), 0.5 + 0.05 * math.sin(t)]
    return px.SE3(translation=place) * FORWARD * turn


def detected(name: str, t: float) -> px.Observation:
    """What the detector says of an object: one pose, or two that exclude each other."""
    world = PLACES[name]
    if name == "can":
        world = px.SE3(translation=[0.05 * math.sin(t), 0.005 * t, 0.0]) * world * px.SE3.exp([0, 0, 0.3 * t, 0, 0, 0])
    seen = camera_at(t).inverse() * world * px.SE3.exp(SPREAD * random.standard_normal(6))
    components = [px.ObservationComponent(seen)]
    if name == "mug":
        components = [
            px.ObservationComponent(seen, weight=0.55), px.ObservationComponent(seen * HALF_TURN, weight=0.45)
        ]  # fmt: skip
    return px.Observation(components, object=name, stamp_s=t)


carried = px.MotionModels(models=[px.ConstantVelocityMotion()])
models = [px.ObjectModel(id=name, motion=carried if name == "can" else px.MotionModels()) for name in PLACES]
slam = px.StampedSlam(px.ConcentratedGaussian(camera_at(0.0), px.pose_covariance(0.001, 0.002)), models)
frustum = Frustum(width=640, height=480, fx=600, fy=600, cx=320, cy=240)
is_live = options.view != "report" and not options.address.endswith((".rrd", ".mcap"))
view = (
    LiveRecording(options.folder, name="table")
    if options.view == "report"
    else open_view(options.view, options.address, frustum=frustum, **({"up": "z"} if options.view == "rerun" else {}))
)

with view:
    begin = time.monotonic()
    for k in range(round(options.seconds / PERIOD_S)):
        t = k * PERIOD_S
        slam.add_odometry(t, camera_at(t))
        for name in PLACES:
            is_there = name != "drill" or t < 0.5 * options.seconds
            if is_there and random.random() < 0.7:
                slam.add(detected(name, t))
        slam.add_image(t)
        view.update(slam)
        if is_live:
            time.sleep(max(begin + t + PERIOD_S - time.monotonic(), 0.0))
    if isinstance(view, LiveRecording):
        print(view.write_report())

found = slam.finish()
assert found is not None
for name, health in found.estimate.healths.items():
    print(f"{name}: {health.name}, exists with probability {found.estimate.existences[name]:.3f}")
assert len(slam.hypotheses("mug")) == 2
