# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Learns the noise of a detector from detections with their truth.

T   true pose of the object in the camera's frame, T_camera_object
Y   detected pose, T_camera_object:
      Y = T Exp(n)        with probability 1 - p - c, the object seen as it is
      Y = T D Exp(n)      with probability p, the object taken for itself turned by half
      Y uniform           with probability c, clutter
n   error of a detection, n ~ N(0, R): rotation [rad], then translation as a fraction of the
    range, along the viewing ray (NoiseFrame.ray): z along the ray, x and y across it
R   covariance of n, diagonal
D   pose of the wrong mode in the object's frame, half a turn about its z axis

T and Y are known; R, p, c and D are learned. The result is printed as TOML for a sequence file.
"""

import sys

import numpy as np
import numpy.typing as npt
import posemix as px

# The square root of the diagonal of R.
sd = np.array([*np.radians([4.0, 4.0, 2.0]), 0.008, 0.008, 0.04])
R = np.diag(sd**2)
D = px.SE3(px.SO3.exp([0.0, 0.0, np.pi]))
p = 0.15
c = 0.05
random = np.random.default_rng(1)


def draw_error(M: px.SE3) -> npt.NDArray[np.float64]:
    """A draw of n, carried from the viewing ray at the mode M to the axes of M."""
    at_M = px.along_camera(px.NoiseComponent(covariance=R, frame=px.NoiseFrame.ray), M)
    n = random.multivariate_normal(np.zeros(6), at_M.covariance)
    to_mode = M.rotation.inverse()
    return np.concatenate([to_mode.act(n[:3]), to_mode.act(n[3:])])


def uniform_pose(T: px.SE3) -> px.SE3:
    """Any rotation, within a metre of T."""
    return px.SE3(px.SO3(random.normal(size=4)), T.translation + random.uniform(-0.5, 0.5, size=3))


# Three recordings of 500 frames with known T and simulated Y.
recording = np.repeat([0, 1, 2], 500)
truths, detected = [], []
for frame in [*range(500)] * 3:
    T = px.SE3(px.SO3.exp([0.01 * frame, 0.5, 0.0]), [0.2, -0.1, 0.5 + 0.002 * frame])
    u = random.uniform()
    M = T * D if u < p else T
    Y = M * px.SE3.exp(draw_error(M))
    if u > 1.0 - c:
        Y = uniform_pose(T)
    truths.append(T)
    detected.append(Y)

fit = px.fit_noise(
    px.with_misses(truths), px.with_misses(detected), recording=recording,
    settings=px.NoiseFitSettings(max_components=1), seed=1,
)  # fmt: skip
print(fit.to_toml("my_detector"))

# The simulated noise is found again: frame, R, p, c and D.
components = fit.noise.components
found = (
    fit.frame == px.NoiseFrame.ray
    and len(components) == 2
    and np.allclose(np.diag(components[0].covariance), np.diag(R), rtol=0.25)
    and abs(components[1].weight - p) < 0.04
    and abs(fit.noise.clutter.weight - c) < 0.03
    and components[1].offset.is_approx(D, 0.05)
)
print("good" if found else "not good: the learned noise is not the simulated one")
sys.exit(0 if found else 1)
