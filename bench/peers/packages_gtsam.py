# SPDX-License-Identifier: MIT
# SPDX-FileCopyrightText: posemix contributors
"""GTSAM: maps of Pose3, iSAM2 with robust noise, and the elimination of a factor graph with one discrete mode."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from packages_lie import Array, Job, adjoint, numbers

CAUCHY_SCALE = 2.862  # the library's default


def gtsam_jobs(folder: Path) -> dict[str, Job]:
    import gtsam

    xi = numbers(folder, "tangents", -1, 6)
    matrices = numbers(folder, "poses", -1, 4, 4)
    poses = [gtsam.Pose3(m) for m in matrices]
    rotations = [gtsam.Rot3(m[:3, :3]) for m in matrices]
    count = len(xi)

    def jacobians() -> list[Array]:
        # Its derivative is that of errors on the right: J_l^-1(xi) = J_r^-1(-xi).
        return [gtsam.Pose3.LogmapDerivative(-x) for x in xi]

    def as_matrices(found: list[Any]) -> Array:
        return np.array([element.matrix() for element in found])

    return {
        "so3_exp": (lambda: [gtsam.Rot3.Expmap(x[:3]) for x in xi], as_matrices, count),
        "so3_log": (lambda: [gtsam.Rot3.Logmap(r) for r in rotations], np.array, count),
        "se3_exp": (lambda: [gtsam.Pose3.Expmap(x) for x in xi], as_matrices, count),
        "se3_log": (lambda: [gtsam.Pose3.Logmap(pose) for pose in poses], np.array, count),
        "se3_left_jacobian_inverse": (jacobians, np.array, count),
        "se3_compose": (lambda: [a.compose(b) for a, b in zip(poses, poses[::-1], strict=True)], as_matrices, count),
        "robust": robust_job(folder),
        "hybrid": hybrid_job(folder),
    }


def robust_job(folder: Path) -> Job:
    """A prior of every pose and a detection of every object, with the Cauchy loss; iSAM2 until the estimate stays."""
    import gtsam

    covariance = numbers(folder, "frame_covariances", 12, 36, 36)[0]
    prior = numbers(folder, "frame_poses", 12, 6, 4, 4)[0]
    detections = [gtsam.Pose3(m) for m in numbers(folder, "robust_detections", -1, 4, 4)]
    sd = np.sqrt(numbers(folder, "frame_noise", -1, 6)[0])
    noise = gtsam.noiseModel.Robust.Create(
        gtsam.noiseModel.mEstimator.Cauchy.Create(CAUCHY_SCALE), gtsam.noiseModel.Diagonal.Sigmas(sd)
    )
    graph = gtsam.NonlinearFactorGraph()
    values = gtsam.Values()
    for i, pose in enumerate(prior):
        back = np.linalg.inv(adjoint(pose))  # its errors are on the right
        block = back @ covariance[6 * i : 6 * i + 6, 6 * i : 6 * i + 6] @ back.T
        graph.add(gtsam.PriorFactorPose3(i, gtsam.Pose3(pose), gtsam.noiseModel.Gaussian.Covariance(block)))
        values.insert(i, gtsam.Pose3(pose))
    for j, seen in enumerate(detections):
        graph.add(gtsam.BetweenFactorPose3(0, j + 1, seen, noise))
    parameters = gtsam.ISAM2Params()
    parameters.setRelinearizeThreshold(0.0)
    parameters.relinearizeSkip = 1

    def work() -> Any:
        isam = gtsam.ISAM2(parameters)
        isam.update(graph, values)
        before = isam.calculateEstimate()
        for _ in range(100):
            isam.update()
            now = isam.calculateEstimate()
            step = max(np.abs(before.atPose3(i).localCoordinates(now.atPose3(i))).max() for i in range(len(prior)))
            if step < 1e-9:
                break
            before = now
        return now

    return work, lambda found: np.array([found.atPose3(i).matrix() for i in range(len(prior))]), 1


def hybrid_job(folder: Path) -> Job:
    """One variable with a prior and a measurement whose noise has two modes."""
    import gtsam

    prior = numbers(folder, "hybrid_prior", 6)
    measured = numbers(folder, "hybrid_measured", 6)
    covariance = numbers(folder, "hybrid_prior_covariance", 6, 6)
    noise = numbers(folder, "hybrid_noise", 2, 6, 6)
    weights = np.array([0.7, 0.3])
    mode = (gtsam.symbol("m", 0), 2)
    key = gtsam.symbol("x", 0)

    def factor(mean: Array, covariance: Array) -> Any:
        whitening = np.linalg.inv(np.linalg.cholesky(covariance))
        return gtsam.JacobianFactor(key, whitening, whitening @ mean, gtsam.noiseModel.Unit.Create(6))

    def work() -> Any:
        graph = gtsam.HybridGaussianFactorGraph()
        graph.push_back(factor(prior, covariance))
        # A factor is exp(-error - scalar): the noise of a mode has its own normalisation.
        modes = [(factor(measured, r), float(np.linalg.slogdet(r)[1] / 2)) for r in noise]
        graph.push_back(gtsam.HybridGaussianFactor(mode, modes))
        graph.push_back(gtsam.DecisionTreeFactor([mode], list(weights)))
        return graph.eliminateSequential()

    def found(net: Any) -> Array:
        result: list[Any] = []
        for k in range(2):
            assignment = gtsam.DiscreteValues()
            assignment[mode[0]] = k
            choice = net.choose(assignment)
            information = np.asarray(choice.at(0).information())
            result += [
                [discrete_weight(net, assignment)],
                choice.optimize().at(key),
                np.linalg.inv(information).ravel(),
            ]
        return np.concatenate(result)

    return work, found, 1


def discrete_weight(net: Any, assignment: Any) -> float:
    """The probability of an assignment, from the discrete part of a hybrid Bayes net."""
    for i in range(net.size()):
        discrete = net.at(i).asDiscrete()
        if discrete is not None:
            return float(discrete(assignment))
    raise ValueError("the Bayes net has no discrete part")
