# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""Errors of poses [tx, ty, tz, qx, qy, qz, qw] without other packages."""

import math


def multiply(p, q):
    """The quaternion product p q, x y z w."""
    px, py, pz, pw = p
    qx, qy, qz, qw = q
    return (pw * qx + px * qw + py * qz - pz * qy, pw * qy - px * qz + py * qw + pz * qx,
            pw * qz + px * qy - py * qx + pz * qw, pw * qw - px * qx - py * qy - pz * qz)


def rotate(q, v):
    x, y, z, _ = multiply(multiply(q, (*v, 0.0)), (-q[0], -q[1], -q[2], q[3]))
    return (x, y, z)


def distance(a, b):
    """Between the origins, metres."""
    return math.dist(a[:3], b[:3])


def angle_deg(a, b):
    dot = abs(sum(x * y for x, y in zip(a[3:], b[3:])))
    return math.degrees(2.0 * math.acos(min(1.0, dot)))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def log_error(true, estimate):
    """Log(T_true T_estimate^-1), rotation first."""
    x, y, z, w = multiply(true[3:], (-estimate[3], -estimate[4], -estimate[5], estimate[6]))
    if w < 0.0:
        x, y, z, w = -x, -y, -z, -w
    sine = math.sqrt(x * x + y * y + z * z)
    angle = 2.0 * math.atan2(sine, w)
    scale = angle / sine if sine > 1e-12 else 2.0
    phi = (x * scale, y * scale, z * scale)
    turned = rotate((x, y, z, w), estimate[:3])
    t = tuple(a - b for a, b in zip(true[:3], turned))
    # rho = J_l^-1(phi) t
    b = (1.0 - 0.5 * angle / math.tan(0.5 * angle)) / (angle * angle) if angle > 1e-6 else 1.0 / 12.0
    first, second = cross(phi, t), cross(phi, cross(phi, t))
    return (*phi, *(t[i] - 0.5 * first[i] + b * second[i] for i in range(3)))


def nees(true, estimate, covariance):
    """Normalised squared error per degree of freedom; covariance is the upper triangle, row by row."""
    error = log_error(true, estimate)
    n = 6
    matrix, values = [[0.0] * n for _ in range(n)], iter(covariance)
    for i in range(n):
        for j in range(i, n):
            matrix[i][j] = matrix[j][i] = next(values)
    factor, solved, total = [[0.0] * n for _ in range(n)], [0.0] * n, 0.0
    for i in range(n):
        for j in range(i):
            factor[i][j] = (matrix[i][j] - sum(factor[i][k] * factor[j][k] for k in range(j))) / factor[j][j]
        factor[i][i] = math.sqrt(max(matrix[i][i] - sum(v * v for v in factor[i][:i]), 1e-300))
        solved[i] = (error[i] - sum(factor[i][k] * solved[k] for k in range(i))) / factor[i][i]
        total += solved[i] ** 2
    return total / n
