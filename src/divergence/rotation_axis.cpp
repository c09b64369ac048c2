// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
#include "rotation_axis.hpp"

#include <cmath>
#include <functional>

namespace posemix::internal {
namespace {

constexpr double kRelativeTolerance = 1e-11;
constexpr double kQuaternionRounding = 1e-15;

using Peaks = std::vector<std::reference_wrapper<const RotationPeak>>;

Eigen::Vector3d half_step(const RotationPeak& from, const RotationPeak& to) {
  return (to.mean * from.mean.conjugate()).vec();
}

Eigen::Matrix3d covariance_of(const RotationPeak& peak) {
  return peak.root * peak.root.transpose();
}

/// The axis given by the means, otherwise by the first covariance that has a distinguished axis.
Eigen::Vector3d candidate(const Peaks& peaks) {
  Eigen::Vector3d farthest = Eigen::Vector3d::Zero();
  for (const RotationPeak& peak : peaks) {
    const Eigen::Vector3d step = half_step(peaks.front(), peak);
    if (step.norm() > farthest.norm()) farthest = step;
  }
  if (farthest.norm() > 1e4 * kQuaternionRounding) return farthest.normalized();
  for (const RotationPeak& peak : peaks) {
    // Eigenvalues are in rising order: the axis belongs to the one that is farther from the middle.
    const Eigen::Vector3d variances = peak.root.colwise().squaredNorm();
    const double low = variances[1] - variances[0];
    const double high = variances[2] - variances[1];
    if (std::max(low, high) <= kRelativeTolerance * variances[2]) continue;
    return peak.root.col(low > high ? 0 : 2).normalized();
  }
  return Eigen::Vector3d::UnitZ();
}

bool is_symmetric(const RotationPeak& first, const RotationPeak& peak,
                  const Eigen::Vector3d& axis) {
  const double smallest = peak.root.colwise().norm().minCoeff();
  const double off_axis = half_step(first, peak).cross(axis).norm();
  if (off_axis > kRelativeTolerance * smallest + kQuaternionRounding) return false;
  const Eigen::Matrix3d covariance = covariance_of(peak);
  const double along = axis.dot(covariance * axis);
  const double across = 0.5 * (covariance.trace() - along);
  const Eigen::Matrix3d expected =
      across * Eigen::Matrix3d::Identity() + (along - across) * axis * axis.transpose();
  return (covariance - expected).cwiseAbs().maxCoeff() <= kRelativeTolerance * smallest * smallest;
}

}  // namespace

std::optional<Eigen::Vector3d> common_axis(const RotationPair& pair) {
  Peaks peaks(pair.p.begin(), pair.p.end());
  peaks.insert(peaks.end(), pair.q.begin(), pair.q.end());
  Eigen::Vector3d axis = candidate(peaks);
  for (const RotationPeak& peak : peaks) {
    if (!is_symmetric(peaks.front(), peak, axis)) return std::nullopt;
  }
  return axis;
}

}  // namespace posemix::internal
