# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Learns the noise of a detector from detections with their truth.

T   true pose of the object in the camera's frame, T_camera_object
Y   detected pose, T_camera_object:
      Y = T Exp(n)        with probability 1 - p, the object seen as it is
      Y = T D Exp(n)      with probability p, the object taken for itself turned by half
n   error of a detection, n ~ N(0, R): rotation [rad], then translation [m], along the object's axes
R   covariance of n, diagonal
D   pose of the wrong mode in the object's frame, half a turn about its z axis

T and Y are known; R, p and D are learned. The result is printed as TOML for a sequence file.
"""

import numpy as np

import posemix as px

sd = np.array([0.07, 0.07, 0.035, 0.005, 0.005, 0.02])  # the square root of the diagonal of R
R = np.diag(sd**2)
D = px.SE3(px.SO3.exp([0.0, 0.0, np.pi]))
p = 0.15

# Three recordings of 500 frames with known T and simulated Y.
random = np.random.default_rng(1)
recording = np.repeat([0, 1, 2], 500)
frames = len(recording)
turns = 0.01 * np.arange(frames)[:, None] * [1.0, 0.0, 0.0]
T = px.SE3(px.SO3.exp(turns), np.tile([0.2, -0.1, 0.8], (frames, 1)))
is_turned = random.uniform(size=frames) < p
M = px.SE3(px.SO3.exp(np.where(is_turned[:, None], [0.0, 0.0, np.pi], 0.0)))  # D where turned
n = random.normal(size=(frames, 6)) * sd
Y = T * M * px.SE3.exp(n)

fit = px.fit_noise(T, Y, recording=recording, settings=px.NoiseFitSettings(max_components=1), seed=1)
print(fit.to_toml("my_detector"))
for mode in fit.modes:
    print(f"mode of weight {mode.weight:.3f}, in {mode.recordings:.1f} recordings")

# The simulated noise is found again: frame, R, p and D.
right, wrong = fit.noise.components
assert fit.frame == px.NoiseFrame.object
assert np.allclose(np.diag(right.covariance), np.diag(R), rtol=0.25)
assert abs(wrong.weight - p) < 0.04
assert wrong.offset.is_approx(D, 0.05)
