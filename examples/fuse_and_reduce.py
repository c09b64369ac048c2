# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Two looks at one object, fused, and the result reduced to two peaks.

X        in SE(3), T_camera_mug: what is asked for
p_i(X)   = a_i N(X; M_i, P) + (1 - a_i) N(X; M_i F, P): look i = 1, 2; it may be turned
N        a Gaussian in the exponential chart, X = Exp(xi) M, xi ~ N(0, P)
F        half a turn about the mug's z axis
q(X)     = p_1(X) p_2(X) / c: both looks, four peaks
r(X)     q with the two peaks that are left when those without weight are merged away

The peaks that agree keep a_1 a_2 and (1 - a_1)(1 - a_2) of the weight, up to a common factor, and half of the
covariance.
"""

import math
import sys

import numpy as np
import posemix as px

P = 1e-3 * np.eye(6)
F = px.SE3.exp([0.0, 0.0, math.pi, 0.0, 0.0, 0.0])


def look(a: float, M: px.SE3) -> px.Mixture[px.ConcentratedGaussian[px.SE3]]:
    """One look: upright with probability a, else turned."""
    peaks = [px.ConcentratedGaussian(M, P), px.ConcentratedGaussian(M * F, P)]
    return px.Mixture(peaks, weights=[a, 1.0 - a])


a_1, a_2 = 0.7, 0.6
p_1 = look(a_1, px.SE3(translation=[0.0, 0.0, 0.80]))
p_2 = look(a_2, px.SE3(translation=[0.0, 0.0, 0.82]))

q = px.fuse(p_1, p_2).density
r = px.reduce(q, px.ReductionSettings(max_components=2)).mixture

print(f"{len(q)} peaks, reduced to {len(r)}")
for weight, peak in zip(r.weights, r, strict=True):
    sd = math.sqrt(peak.covariance[5, 5])
    print(f"  weight {weight:.3f}, z {peak.mean.translation[2]:.3f} m, sd along z {sd:.4f} m")
expected = a_1 * a_2 / (a_1 * a_2 + (1.0 - a_1) * (1.0 - a_2))
good = (
    len(r) == 2
    and abs(r.weights[0] - expected) < 1e-3
    and abs(r[0].covariance[5, 5] - 0.5e-3) < 1e-5
)
print(f"{'good' if good else 'not good'}: expected weight {expected:.3f} and half of the covariance")
sys.exit(0 if good else 1)
