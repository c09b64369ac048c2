// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "posemix/base/random.hpp"
#include "posemix/lie/pose_covariance.hpp"
#include "posemix/slam/consistency.hpp"

/// Series of poses whose errors are drawn from what is said of them.
namespace posemix::testing {

/// A covariance with correlations between everything, along the axes of the estimate.
inline Matrix6d body_covariance() {
  Matrix6d body = pose_covariance({0.02, 0.03, 0.01}, {0.005, 0.01, 0.02});
  body(0, 4) = body(4, 0) = 0.5 * 0.02 * 0.01;
  body(1, 2) = body(2, 1) = -0.3 * 0.03 * 0.01;
  return body;
}

inline Vector6d standard_normal(RandomStream& stream) {
  Vector6d z;
  for (double& x : z) x = stream.normal();
  return z;
}

/// A path whose estimates are off by T_true = T_est Exp(P^1/2 z), and state P times `stated`.
inline std::vector<EstimateWithTruth> series_of(std::size_t frames, double stated,
                                                const std::function<Vector6d()>& z) {
  std::vector<EstimateWithTruth> series;
  for (std::size_t k = 0; k < frames; ++k) {
    const auto t = static_cast<double>(k);
    const SE3d truth(SO3d::exp(Eigen::Vector3d(0.01 * t, 0.4, -0.02 * t)),
                     Eigen::Vector3d(3.0 * std::cos(0.02 * t), 2.0, 0.01 * t));
    const Matrix6d root = body_covariance().llt().matrixL();
    const SE3d estimate = truth * SE3d::exp(-(root * z()));
    const Matrix6d covariance = estimate.adjoint_congruence(body_covariance());
    series.push_back({0.1 * t, PoseDensity(estimate, stated * covariance), truth});
  }
  return series;
}

inline std::vector<EstimateWithTruth> white_series(std::size_t frames, double stated,
                                                   std::uint64_t seed) {
  RandomStream stream(seed);
  return series_of(frames, stated, [&] { return standard_normal(stream); });
}

/// Errors of unit variance whose correlation falls by the factor `keep` from frame to frame.
inline std::function<Vector6d()> slow_errors(RandomStream& stream, double keep) {
  auto z = std::make_shared<Vector6d>(standard_normal(stream));
  return [&stream, keep, z] {
    const Vector6d now = *z;
    *z = keep * now + std::sqrt(1.0 - keep * keep) * standard_normal(stream);
    return now;
  };
}

}  // namespace posemix::testing
