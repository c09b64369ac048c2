# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Object SLAM in a robot's loop: one call per frame.

C    in SE(3), T_world_camera: the camera, C_0 ~ N(C0, P0)
X    in SE(3), T_world_mug: the mug, which stands still; never seen before
u_k  odometry, T_camera(k-1)_camera(k): C_k = C_(k-1) u_k Exp(w), w ~ N(0, Q) per second
z_k  detection, T_camera_mug: z_k = C_k^-1 X Exp(v), v ~ N(0, R), but in a quarter of the frames
     z_k = C_k^-1 X F Exp(v): the mug looks alike from both sides
F    half a turn about the mug's z axis

The filter is given P0, Q, R and that a quarter of the detections are wrong. It estimates C_k and X with covariances,
the alternatives for X, and the probability that its estimate of X is on the right mode.
"""

import math
import sys

import numpy as np
import posemix as px

random = np.random.default_rng(1)


def noise(covariance: np.ndarray) -> px.SE3:
    """Exp of a draw from N(0, covariance), a diagonal one."""
    return px.SE3.exp(np.sqrt(np.diag(covariance)) * random.standard_normal(6))


dt = 0.1
P0 = px.pose_covariance(math.radians(0.1), 0.001)
Q = px.pose_covariance(math.radians(0.2), 0.002)
R = px.pose_covariance(math.radians(4.0), 0.005)
C0 = px.SE3()
X = px.SE3.exp([0.0, 0.4, 0.0, 0.0, 0.0, 0.0])
X = px.SE3(translation=[0.1, 0.0, 0.9]) * X
F = px.SE3.exp([0.0, 0.0, math.pi, 0.0, 0.0, 0.0])

motion = px.MotionSettings(noise=px.ProcessNoise(covariance=Q, per=px.NoisePer.second))
settings = px.ObjectSlamSettings(motion=motion, record_hypotheses=True)
mug = px.ObjectModel(
    id="mug",
    noise=px.DetectorNoise([px.NoiseComponent(weight=0.75, covariance=R)], px.Clutter(weight=0.25)),
)
slam = px.ObjectSlam(px.ConcentratedGaussian(C0, P0), [mug], settings)

C = C0 * noise(P0)
estimate = slam.step(px.FrameInput(detections={"mug": C.inverse() * X * noise(R)}))
for _ in range(1, 100):
    u = px.SE3(translation=[-0.005, 0.0, 0.0]) * px.SE3.exp([0.0, 0.005, 0.0, 0.0, 0.0, 0.0])
    C = C * u * noise(dt * Q)
    seen = X * F if random.random() < 0.25 else X
    z = C.inverse() * seen * noise(R)
    estimate = slam.step(px.FrameInput(dt=dt, motion=u, detections={"mug": z}))

found = estimate.object("mug")
assert found.world is not None and found.mode_probability is not None  # as it was seen
error_deg = math.degrees(np.linalg.norm((found.world.mean * X.inverse()).log()[:3]))
print(f"mug: error {error_deg:.2f} deg, on the right mode with probability {found.mode_probability:.3f}")
for other in found.alternatives:
    turned = math.degrees(np.linalg.norm((other.pose * X.inverse()).log()[:3]))
    print(f"  alternative at {turned:5.1f} deg, probability {other.probability:.3f}")
good = error_deg < 3.0 and found.mode_probability > 0.8
print("good" if good else "not good: expected less than 3 deg, probability above 0.8")
sys.exit(0 if good else 1)
