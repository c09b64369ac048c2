# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Where to grasp an object whose pose is a mixture.

X     in SE(3), T_world_mug
p(X)  = a N(X; M, P) + (1 - a) N(X; M D, P): two peaks that are less than a tolerance apart
D     a displacement of 8 mm along x
B     the box of poses that the gripper tolerates, about the identity: 10 deg, 1 cm
m     in SE(3), T_world_grasp: where the gripper expects the mug
s(m)  = P(X in {m Y: Y in B}): the probability of success

The best m is not the heaviest peak M, but between the two peaks.
"""

import math
import sys

import posemix as px

a = 0.6
P = px.pose_covariance(math.radians(3.0), 0.004)
M = px.SE3()
D = px.SE3(translation=[0.008, 0.0, 0.0])
p = px.Mixture(
    [px.ConcentratedGaussian(M, P), px.ConcentratedGaussian(M * D, P)], weights=[a, 1.0 - a]
)
B = px.ToleranceBox(rotation=[math.radians(10.0)] * 3, translation=[0.01] * 3)

at_peak = px.success_probability(p, B, M, seed=1)
best = px.best_grasp(p, B, seed=1)
x = best.pose.translation[0]
print(f"at the heaviest peak: s = {at_peak.probability:.4f} +- {at_peak.error:.4f}")
print(f"best, {1e3 * x:.1f} mm along x: s = {best.success.probability:.4f} +- {best.success.error:.4f}")

good = best.success.probability > at_peak.probability + 0.02 and 0.001 < x < 0.007
print("good" if good else "not good: expected a better place between the peaks")
sys.exit(0 if good else 1)
